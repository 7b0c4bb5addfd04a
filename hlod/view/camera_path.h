// camera_path.h: a list of cameras, one a frame, and its JSON: what `pagoda path` writes and what
// renderings, benchmarks and stress runs replay. Plain data and pure functions: any thread.
//
// {"kind": "walk", "seed": 1, "fps": 30, "model": {"name": "hall.pagoda", "diagonal": 41.2},
//  "width": 640, "height": 480,
//  "frames": [{"eye": [x,y,z], "target": [x,y,z], "up": [x,y,z], "fovy": degrees}, ...]}
// Only "frames" is needed, and of a frame its eye and target; the rest keeps a default. Unknown
// keys are errors.
#pragma once

#include "hlod/view/camera.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pagoda::hlod {

// Bounds of what is read: JSON takes about ten times its bytes in memory while it is parsed.
inline constexpr uint64_t kMaxPathBytes = uint64_t{40} << 20;
inline constexpr size_t kMaxPathFrames = 200'000;

struct CameraPath {
    std::string kind;  // orbit, walk, fly, teleport, or any word of another maker
    uint64_t seed = 0;
    double framesPerSecond = 30.0;       // how fast it is meant to be seen; > 0
    std::string modelName;               // what it was made for; empty: not said
    double modelDiagonalModelUnits = 0;  // 0: not said
    int widthPx = 0, heightPx = 0;       // of every frame; 0: whoever draws decides
    std::vector<Camera> frames;          // never empty once parsed
    [[nodiscard]] bool operator==(const CameraPath&) const = default;
};

// `defaults` gives what a frame leaves out. Throws Error with `source` as its path, and the byte
// or the frame as its place, when `text` is too long, no JSON or no path.
[[nodiscard]] CameraPath parseCameraPath(std::string_view text, const Camera& defaults,
                                         const std::string& source);
// The same path gives the same text, a frame a line; every number is the shortest that reads back
// as the same double.
[[nodiscard]] std::string cameraPathToJson(const CameraPath& path);

// Seen `factor` times as fast: frames 0, factor, 2 factor, ..., rounded down. factor >= 1
// (asserted).
[[nodiscard]] CameraPath atSpeed(const CameraPath& path, double factor);

// From a frame to the next.
struct PathStep {
    double turnDegrees = 0;     // between the directions of view
    double moveModelUnits = 0;  // between the eyes
};
[[nodiscard]] PathStep stepBetween(const Camera& from, const Camera& to);

}  // namespace pagoda::hlod
