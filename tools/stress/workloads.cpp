#include "tools/stress/workloads.h"

#include "ooc/base/error.h"
#include "tools/paths/makers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace pagoda::tools {
namespace {

constexpr std::array kWorkloads = {
    Workload{"orbit", "around the model, all of it in view"},
    Workload{"flythrough", "through its rooms at three times walking pace, or past its surface"},
    Workload{"zigzag", "the same way, looking left and right, with sudden returns"},
    Workload{"teleport", "four places, still at each"},
    Workload{"thrash", "the flythrough with 5% of the GPU memory that it needs", 0.05},
};
constexpr double kThroughSpeed = 3;
constexpr size_t kPlaces = 4;
// Zigzag: so many frames on, then so many back; so far to each side, there and back in so many.
constexpr size_t kFramesOn = 40, kFramesBack = 20, kFramesOfTurn = 24;
constexpr double kTurnDegrees = 75;

// From -1 to 1 and back within `period` frames, from 0 on.
double triangleWave(size_t frame, size_t period) {
    const double phase = static_cast<double>(frame % period) / static_cast<double>(period);
    return 1 - 4 * std::abs(phase < 0.75 ? phase - 0.25 : phase - 1.25);
}

void turn(hlod::Camera& camera, const Vec3d& axis, double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3d d = camera.target - camera.eye;
    // Rodrigues' formula.
    camera.target = camera.eye + d * std::cos(angle) + glm::cross(axis, d) * std::sin(angle) +
                    axis * (glm::dot(axis, d) * (1 - std::cos(angle)));
}

}  // namespace

std::span<const Workload> workloads() {
    return kWorkloads;
}

const WorkloadPath& WorkloadPaths::through() {
    if (!through_.path.frames.empty()) return through_;
    PathOptions options;
    options.frames = frames_;
    options.seed = seed_;
    options.speed = kThroughSpeed;
    through_.madeOf = "walk";
    try {
        through_.path = makePath(database_, up_, "walk", options, progress_);
    } catch (const Error&) {  // no rooms in it
        through_.madeOf = "fly";
        options.speed = 1;
        try {
            through_.path = makePath(database_, up_, "fly", options, progress_);
        } catch (const Error&) {  // nor anything to fly by
            through_.madeOf = "orbit";
            through_.path = makePath(database_, up_, "orbit", options, progress_);
        }
    }
    // A way that ends early is gone back.
    auto& frames = through_.path.frames;
    const size_t length = frames.size();
    for (size_t i = length; i < frames_; ++i) {
        const size_t there = i % (2 * length);
        frames.push_back(frames[there < length ? there : 2 * length - 1 - there]);
    }
    return through_;
}

WorkloadPath WorkloadPaths::zigzag() {
    const WorkloadPath& way = through();
    const Vec3d axis = hlod::upVector(up_);
    WorkloadPath zigzag = way;
    size_t place = 0;
    for (size_t i = 0; i < frames_; ++i) {
        hlod::Camera camera = way.path.frames[std::min(place, frames_ - 1)];
        turn(camera, axis, kTurnDegrees * triangleWave(i, kFramesOfTurn));
        zigzag.path.frames[i] = camera;
        const bool isOn = i % (kFramesOn + kFramesBack) < kFramesOn;
        place = isOn ? place + 1 : place - std::min<size_t>(place, 1);
    }
    return zigzag;
}

WorkloadPath WorkloadPaths::make(std::string_view workload) {
    WorkloadPath made;
    if (workload == "flythrough" || workload == "thrash") {
        made = through();
    } else if (workload == "zigzag") {
        made = zigzag();
    } else {
        PathOptions options;
        options.frames = frames_;
        options.seed = seed_;
        options.holdFrames = (frames_ + kPlaces - 1) / kPlaces;
        made.madeOf = workload;
        made.path = makePath(database_, up_, workload, options, progress_);
    }
    made.path.kind = workload;
    return made;
}

}  // namespace pagoda::tools
