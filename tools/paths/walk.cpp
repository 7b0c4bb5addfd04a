#include "tools/paths/walk.h"

#include "tools/paths/poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pagoda::tools {
namespace {

constexpr double kFovyDegrees = 60;
constexpr double kTurnDegrees = 4;        // a frame: 120 degrees a second at 30 frames
constexpr double kStepOfEyeHeight = 0.1;  // a frame: brisk, so that 200 frames see some rooms
constexpr double kLikedClearance = 0.35;  // in eye heights; smoothing keeps it where the way has it
constexpr int kRelaxations = 100;         // smooths over about a metre

struct Footing {
    Vec3d eye;
    uint32_t spot;
};

// Pulls the way straight, never closer to a wall than it was or than kLikedClearance.
std::vector<Vec3d> relaxed(Inside& inside) {
    const FloorPlan& plan = inside.plan();
    const Tour& tour = inside.tour();
    std::vector<Footing> points;
    for (const uint32_t spot : tour.way()) points.push_back({tour.eyeAt(spot), spot});
    const double liked = kLikedClearance * inside.scale().eyeHeight / inside.scale().cell;
    std::vector<double> needed;
    for (const Footing& p : points) needed.push_back(std::min(plan.clearance(p.spot), liked));
    for (int round = 0; round < kRelaxations; ++round) {
        for (size_t i = 1; i + 1 < points.size(); ++i) {
            Vec3d eye = 0.5 * (points[i - 1].eye + points[i + 1].eye);
            Vec3i cell = inside.solid().cellAt(eye);
            cell.z = plan.cell(points[i].spot).z;
            const uint32_t spot = plan.find(cell);
            if (spot == FloorPlan::kNone || !tour.isPassable(spot)) continue;
            if (plan.clearance(spot) < needed[i]) continue;
            eye.z = tour.eyeAt(spot).z;
            points[i] = {eye, spot};
        }
    }
    std::vector<Vec3d> eyes;
    for (const Footing& p : points) eyes.push_back(p.eye);
    return eyes;
}

// Rounded corners and stairs without jolts; where rounding would touch something, the way itself.
std::vector<Vec3d> rounded(const std::vector<Vec3d>& eyes, double spacing, Inside& inside) {
    const double eyeHeight = inside.scale().eyeHeight;
    const std::vector<Vec3d> flat = smoothed(eyes, 0.12 * eyeHeight / spacing, false);
    const std::vector<Vec3d> steep = smoothed(eyes, 0.3 * eyeHeight / spacing, false);
    std::vector<Vec3d> result;
    for (size_t i = 0; i < eyes.size(); ++i) {
        const Vec3d eye(flat[i].x, flat[i].y, steep[i].z);
        result.push_back(inside.solid().isClear(eye, eye, 1) ? eye : eyes[i]);
    }
    return result;
}

std::vector<Pose> posesAlong(Inside& inside, const Pace& pace, const PathOptions& options) {
    const double spacing = 0.5 * inside.scale().cell;
    const std::vector<Vec3d> eyes = rounded(resampled(relaxed(inside), spacing), spacing, inside);
    const std::vector<Vec3d> gazes =
        gazesAlong(eyes, spacing, inside.solid(), inside.scale().eyeHeight, options.seed);
    std::vector<Pose> samples;
    for (size_t i = 0; i < eyes.size(); ++i) samples.push_back({eyes[i], gazes[i]});
    return march(samples, pace, options.frames, false, [&](const Vec3d& from, const Vec3d& to) {
        return inside.solid().isClear(from, to);
    });
}

}  // namespace

PathFrames makeWalk(const PathScene& scene, const PathOptions& options) {
    Inside inside(scene, options);
    const double eyeHeight = inside.scale().eyeHeight;
    const Pace pace =
        paceOf(options.speed * kStepOfEyeHeight * eyeHeight,
               std::min(options.speed * kTurnDegrees, 45.0), scene.diagonalModelUnits);
    scene.progress.beginStage("Walking", options.frames, "frames");
    Tour& tour = inside.tour();
    std::vector<Pose> poses;
    // Twice the way each time, so that all of it costs at most twice the last.
    for (size_t wantedSpots = 400; poses.size() < options.frames; wantedSpots *= 2) {
        while (tour.way().size() < wantedSpots) {
            scene.progress.check();
            tour.extend();
        }
        poses = posesAlong(inside, pace, options);
    }
    PathFrames frames;
    const double fovy = options.fovyDegrees > 0 ? options.fovyDegrees : kFovyDegrees;
    for (const Pose& pose : poses) {
        frames.push_back(cameraAt(scene, pose.eye, pose.gaze, 2 * eyeHeight, fovy));
    }
    scene.progress.advance(options.frames);
    return frames;
}

}  // namespace pagoda::tools
