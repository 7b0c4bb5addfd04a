#include "tools/generate/random.h"
#include "tools/paths/fly.h"
#include "tools/paths/poses.h"
#include "tools/paths/walk.h"

#include "ooc/base/error.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pagoda::tools {
namespace {

constexpr double kFovyDegrees = 60;

// Where most can be seen from the place, with a seeded preference among good directions.
Vec3d openDirection(const Occupancy& solid, const Vec3d& eye, double reach, Random& random) {
    Vec3d best(1, 0, 0);
    double bestScore = -1;
    const double start = random.range(0.0, 6.28);
    for (int i = 0; i < 16; ++i) {
        const Vec3d direction = directionOf(start + i * 0.3927, 0.0);
        const double open = solid.viewLength(eye, direction, reach) / reach;
        const double score = open + 0.2 * random.unit();
        if (score <= bestScore) continue;
        bestScore = score;
        best = direction;
    }
    return glm::normalize(best + Vec3d(0, 0, -0.05));
}

std::vector<Pose> placesInside(const PathScene& scene, const PathOptions& options) {
    Inside inside(scene, options);
    Random random = Random(options.seed).fork(4);
    std::vector<Pose> places;
    for (const uint32_t spot : inside.tour().places()) {
        const Vec3d eye = inside.tour().eyeAt(spot);
        places.push_back(
            {eye, openDirection(inside.solid(), eye, 8 * inside.scale().eyeHeight, random)});
    }
    return places;
}

std::vector<Pose> placesOutside(const PathScene& scene, const PathOptions& options) {
    const OpenSpace space(scene);
    const std::vector<Pose> flight = flightAround(scene, space, options.seed);
    constexpr size_t kPlaces = 48;
    std::vector<Pose> places;
    for (size_t i = 0; i < kPlaces; ++i) places.push_back(flight[i * flight.size() / kPlaces]);
    return places;
}

// Hands out all places in an order by lot, then again.
class Deck {
public:
    Deck(size_t places, Random random) : random_(random) {
        for (size_t i = 0; i < places; ++i) order_.push_back(i);
    }
    size_t next() {
        if (left_ == 0) left_ = order_.size();
        // Never the last place handed out, which lies just behind those left.
        const size_t choices = left_ == order_.size() && hasStarted_ ? left_ - 1 : left_;
        const size_t chosen = random_.next() % choices;
        --left_;
        std::swap(order_[chosen], order_[left_]);
        // A full round ends with order_[0] as the last one: it goes where the next one skips it.
        const size_t place = order_[left_];
        if (left_ == 0) std::swap(order_.front(), order_.back());
        hasStarted_ = true;
        return place;
    }

private:
    Random random_;
    std::vector<size_t> order_;
    size_t left_ = 0;
    bool hasStarted_ = false;
};

}  // namespace

PathFrames makeTeleport(const PathScene& scene, const PathOptions& options) {
    std::vector<Pose> places;
    try {
        places = placesInside(scene, options);
    } catch (const Error& error) {
        if (error.path() == "--box") throw;
        scene.progress.note(error.problem() + ": teleports along a flight around it");
        places = placesOutside(scene, options);
    }
    Deck deck(places.size(), Random(options.seed).fork(6));
    size_t place = deck.next();
    PathFrames frames;
    const double fovy = options.fovyDegrees > 0 ? options.fovyDegrees : kFovyDegrees;
    for (size_t i = 0; i < options.frames; ++i) {
        if (i > 0 && i % options.holdFrames == 0) place = deck.next();
        frames.push_back(cameraAt(scene, places[place].eye, places[place].gaze,
                                  0.01 * scene.diagonalModelUnits, fovy));
    }
    return frames;
}

}  // namespace pagoda::tools
