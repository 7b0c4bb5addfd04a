// state_log.h: what the window does, as JSON lines in a file: for tests and for who wants to know.
// Every line has "event" and "steady_s" (the steady clock); "frame" lines also what is drawn:
//   {"event": "frame", "frame": 3, "width": 1280, "height": 800, "eye": [..], "target": [..],
//    "mode": "orbit", "strategy": "auto", "tau": 1, "effective_tau": 1, "drawn_nodes": 12,
//    "drawn_triangles": 4000, "missing_pages": 0, "settled": true, "frozen": false,
//    "colours": "the model's", "frame_ms": 3.1, "ui_ms": 0.2, "ui_gl_ms": 0.4}
// While a raw model is opened: opening (file), stage (stage), preview (a frame of it: frame, width,
// height, eye, target, triangles_seen, is_whole, discs, triangles), then made (file, database,
// is_built; opened follows), cancelled (file) or a message.
// Others: opened (file), resized, pick (node, point, ...), exact (the pick at full resolution:
// point, leaf, triangle, object, path of names; all null where the ray meets nothing), hidden
// (objects), objects (tree, rows, matches, searching: what the panel shows), screenshot (file),
// message (text, is_error), camera (json: copied), path (file, frames), closed (frames).
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <fstream>

namespace pagoda::viewer {

class StateLog {
public:
    // An empty path: nothing is written. Throws Error when the file cannot be written.
    explicit StateLog(const std::filesystem::path& path);

    [[nodiscard]] bool isOn() const { return file_.is_open(); }
    // Adds "steady_s"; the line is in the file on return.
    void write(const char* event, nlohmann::json line);

private:
    std::ofstream file_;
};

}  // namespace pagoda::viewer
