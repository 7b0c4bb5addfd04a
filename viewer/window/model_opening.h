// model_opening.h: how the window opens what is not a database yet. The window states it and shows
// it; who makes databases implements it (tools/opening/): the window links no builder.
// An Opening works on threads of its own. Meanwhile the window shows its Preview, its progress and
// a way to cancel; once it is done the window opens the database that it made.
#pragma once

#include "hlod/view/camera.h"
#include "ooc/base/box.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace pagoda::viewer {

// A corner of a triangle, or the middle of a disc.
struct PreviewVertex {
    Vec3f position;   // model units from Preview::origin
    Vec3f normal;     // unit length, of either side
    uint32_t colour;  // RGBA8 sRGB, red in the low byte; drawn opaque
};

// What has been read of a model so far, coarsely.
struct Preview {
    Vec3d origin{0.0};
    Box3d box;  // of what has been read; never empty
    hlod::UpAxis up = hlod::UpAxis::Z;
    double discModelUnits = 0.0;  // diameter of each disc
    std::vector<PreviewVertex> discs;
    std::vector<PreviewVertex> corners;  // three to a triangle
    uint64_t trianglesSeen = 0;
    bool isWhole = false;  // nothing of the model is left to be read
};

// For people: what is going on.
struct OpeningProgress {
    std::string stage;   // "build nodes"
    std::string detail;  // "1.2 M of 9.9 M triangles, 0.4 M triangles/s, 21 s left"
    double share = 0.0;  // of the stage, 0 to 1; negative: not known
};

class Opening {
public:
    enum class State { Working, Done, Cancelled, Failed };

    // Cancels, and waits until the work has ended.
    virtual ~Opening() = default;

    // What people call the model.
    [[nodiscard]] virtual const std::string& name() const = 0;
    // All from the window's thread; none waits.
    [[nodiscard]] virtual State state() const = 0;
    [[nodiscard]] virtual OpeningProgress progress() const = 0;
    // One that is newer than the last that was taken, or null.
    [[nodiscard]] virtual std::shared_ptr<const Preview> takePreview() = 0;
    // Lines for the user that came since the last call.
    [[nodiscard]] virtual std::vector<std::string> takeNotes() = 0;
    // The work ends soon: the state becomes Cancelled, unless it was done just before.
    virtual void cancel() = 0;
    // Done: the database; it was made now, or found as an earlier opening had made it.
    [[nodiscard]] virtual std::filesystem::path database() const = 0;
    [[nodiscard]] virtual bool isBuilt() const = 0;
    // Failed: one line that says what is wrong and what to do.
    [[nodiscard]] virtual std::string error() const = 0;
};

class ModelOpener {
public:
    virtual ~ModelOpener() = default;
    // Begins to open `model`; null when it is a database (or nothing else that we read), for the
    // window to open itself. Throws Error for what does not exist or has a kind that is not read.
    [[nodiscard]] virtual std::unique_ptr<Opening> open(const std::filesystem::path& model) = 0;
};

}  // namespace pagoda::viewer
