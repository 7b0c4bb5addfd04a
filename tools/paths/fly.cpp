#include "tools/paths/fly.h"

#include "ooc/base/error.h"
#include "tools/generate/random.h"
#include "tools/paths/walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pagoda::tools {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFovyDegrees = 50;
constexpr double kTurnDegrees = 3;            // a frame
constexpr double kMostMoveOfDiagonal = 0.02;  // a frame
constexpr size_t kNearPlaces = 7;
constexpr double kNearCells = 4;         // 3.6% of the diagonal
constexpr double kGazeSmoothing = 0.06;  // of the diagonal

// Open cells close to what stands upright (else to anything), spread out.
std::vector<size_t> nearPlaces(const PathScene& scene, const OpenSpace& space, Random& random) {
    std::vector<size_t> candidates, others;
    for (size_t cell = 0; cell < space.cellCount(); ++cell) {
        if (!space.isOpen(cell) || std::abs(space.distance(cell) - kNearCells) > 1) continue;
        (space.isBeside(cell, 5) ? candidates : others).push_back(cell);
    }
    if (candidates.size() < 10 * kNearPlaces)
        candidates.insert(candidates.end(), others.begin(), others.end());
    if (candidates.empty()) {
        throw Error(scene.database.path(), "", "has no surface that can be flown by",
                    "use --kind orbit");
    }
    std::vector<double> away(candidates.size(), INFINITY);
    std::vector<size_t> places;
    size_t next = random.next() % candidates.size();
    while (places.size() < kNearPlaces) {
        places.push_back(candidates[next]);
        const Vec3d at = space.centreOf(candidates[next]);
        next = 0;
        for (size_t i = 0; i < candidates.size(); ++i) {
            away[i] = std::min(away[i], glm::length(space.centreOf(candidates[i]) - at));
            if (away[i] > away[next]) next = i;
        }
    }
    return places;
}

// Places in order around the model, with a far one behind every second.
std::vector<size_t> waypoints(const PathScene& scene, const OpenSpace& space, Random& random) {
    const Vec3d centre = 0.5 * (scene.box.min + scene.box.max);
    const auto azimuth = [&](size_t cell) {
        const Vec3d d = space.centreOf(cell) - centre;
        return std::atan2(d.y, d.x);
    };
    std::vector<size_t> near = nearPlaces(scene, space, random);
    std::sort(near.begin(), near.end(), [&](size_t a, size_t b) {
        return std::pair(azimuth(a), a) < std::pair(azimuth(b), b);
    });
    std::vector<size_t> all;
    for (size_t i = 0; i < near.size(); ++i) {
        all.push_back(near[i]);
        if (i % 2 != 0) continue;
        const size_t next = near[(i + 1) % near.size()];
        const double from = azimuth(near[i]);
        double to = azimuth(next);
        if (to <= from) to += 2 * kPi;
        const Vec3d outward = directionOf(0.5 * (from + to), random.range(0.2, 0.5));
        double far = random.range(0.75, 0.95) * scene.diagonalModelUnits;
        while (!space.isOpen(centre + far * outward) && far > 0) far -= space.cellSize();
        if (far > 0) all.push_back(space.cellAt(centre + far * outward));
    }
    return all;
}

// Pulls the closed curve straight where that stays in the open and does not leave the surface.
void relax(std::vector<Vec3d>& points, const OpenSpace& space, int rounds) {
    const size_t count = points.size();
    for (int round = 0; round < rounds; ++round) {
        for (size_t i = 0; i < count; ++i) {
            const Vec3d middle = 0.5 * (points[(i + count - 1) % count] + points[(i + 1) % count]);
            if (space.isOpen(middle)) points[i] = middle;
        }
    }
}

// How good a picture of the model is in that direction, from 0 to 1.5: surfaces in most of it, but
// not right before the eye.
double pictureValue(const OpenSpace& space, const Vec3d& eye, const Vec3d& gaze, double diagonal) {
    const Vec3d right = glm::normalize(glm::cross(gaze, Vec3d(1e-9, 0, 1)));
    const Vec3d up = glm::cross(right, gaze);
    const Vec3d rays[5] = {gaze, gaze + 0.25 * right, gaze - 0.25 * right, gaze + 0.15 * up,
                           gaze - 0.25 * up};
    double hits = 0, nearest = diagonal;
    for (const Vec3d& ray : rays) {
        const double free = space.freeLength(eye, glm::normalize(ray), 1.5 * diagonal);
        hits += free < 1.5 * diagonal ? 1 : 0;
        nearest = std::min(nearest, free);
    }
    return hits / 5 + 0.5 * std::min(1.0, nearest / (0.1 * diagonal));
}

// Ahead, and towards the middle of the model where little of it lies ahead.
std::vector<Vec3d> gazes(const PathScene& scene, const OpenSpace& space,
                         const std::vector<Vec3d>& eyes, double spacing) {
    const double diagonal = scene.diagonalModelUnits;
    const Vec3d centre = glm::mix(scene.box.min, scene.box.max, Vec3d(0.5, 0.5, 0.35));
    const size_t count = eyes.size();
    const auto ahead = static_cast<size_t>(std::max(1.0, 0.08 * diagonal / spacing));
    std::vector<Vec3d> result;
    for (size_t i = 0; i < count; ++i) {
        if (i % 4 != 0) {  // a cell; they are smoothed over several
            result.push_back(result.back());
            continue;
        }
        Vec3d way = glm::normalize(eyes[(i + ahead) % count] - eyes[i] + Vec3d(1e-12));
        way = glm::normalize(way * Vec3d(1, 1, 0.7) - Vec3d(0, 0, 0.1));  // rather down than up
        const Vec3d inward = glm::normalize(centre - eyes[i] + Vec3d(1e-12));
        Vec3d best = way;
        double bestValue = -INFINITY;
        for (int k = 0; k <= 5; ++k) {
            const Vec3d gaze = glm::normalize(glm::mix(way, inward, 0.2 * k) + Vec3d(1e-12));
            const double value = pictureValue(space, eyes[i], gaze, diagonal) - 0.12 * k;
            if (value <= bestValue) continue;
            bestValue = value;
            best = gaze;
        }
        result.push_back(best);
    }
    result = smoothed(result, kGazeSmoothing * diagonal / spacing, true);
    for (Vec3d& gaze : result) gaze = glm::normalize(gaze + Vec3d(1e-12));
    return result;
}

size_t framesAround(const std::vector<Pose>& samples, const Pace& pace) {
    return march(samples, pace, 1'000'000, false).size();
}

}  // namespace

std::vector<Pose> flightAround(const PathScene& scene, const OpenSpace& space, uint64_t seed) {
    Random random = Random(seed).fork(2);
    const std::vector<size_t> stops = waypoints(scene, space, random);
    scene.progress.beginStage("Flying", stops.size(), "legs");
    std::vector<Vec3d> points;
    for (size_t i = 0; i < stops.size(); ++i) {
        scene.progress.check();
        const std::vector<Vec3d> leg =
            space.way(stops[i], stops[(i + 1) % stops.size()], kNearCells);
        points.insert(points.end(), leg.begin(), leg.end() - 1);
        scene.progress.advance(1);
    }
    relax(points, space, 25);
    const double spacing = 0.25 * space.cellSize();
    points.push_back(points.front());
    points = resampled(points, spacing);
    points.pop_back();
    const std::vector<Vec3d> eyes = smoothed(points, 1.0 * space.cellSize() / spacing, true);
    const std::vector<Vec3d> looks = gazes(scene, space, eyes, spacing);
    std::vector<Pose> samples;
    for (size_t i = 0; i < eyes.size(); ++i) samples.push_back({eyes[i], looks[i]});
    return samples;
}

PathFrames makeFly(const PathScene& scene, const PathOptions& options) {
    const OpenSpace space(scene);
    std::vector<Pose> samples = flightAround(scene, space, options.seed);
    const double diagonal = scene.diagonalModelUnits;
    // The step with which the frames make one round, if it is a reasonable one.
    double low = 0.002 * diagonal, high = kMostMoveOfDiagonal * diagonal;
    const double turn = std::min(options.speed * kTurnDegrees, 45.0);
    for (int i = 0; i < 10; ++i) {
        const double middle = 0.5 * (low + high);
        const bool isTooSlow =
            framesAround(samples, paceOf(middle, kTurnDegrees, diagonal)) > options.frames;
        (isTooSlow ? low : high) = middle;
    }
    const Pace pace = paceOf(options.speed * high, turn, diagonal);
    PathFrames frames;
    const double fovy = options.fovyDegrees > 0 ? options.fovyDegrees : kFovyDegrees;
    for (const Pose& pose : march(samples, pace, options.frames, true)) {
        frames.push_back(cameraAt(scene, pose.eye, pose.gaze, 0.1 * diagonal, fovy));
    }
    return frames;
}

}  // namespace pagoda::tools
