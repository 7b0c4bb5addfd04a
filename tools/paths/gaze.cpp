#include "tools/generate/random.h"
#include "tools/paths/poses.h"
#include "tools/paths/walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pagoda::tools {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
// Directions weighed at each place: so many on either side of ahead, 15 degrees apart.
constexpr int kSides = 5;
constexpr double kSideStep = 15 * kDegree;

double nearestTurn(double angle, double to) {
    return angle + 2 * kPi * std::round((to - angle) / (2 * kPi));
}

// Azimuths in which the way lies a few steps ahead, without jumps by full turns.
std::vector<double> headings(const std::vector<Vec3d>& eyes, double spacing, double unit) {
    const std::vector<Vec3d> calm = smoothed(eyes, 0.25 * unit / spacing, false);
    const auto ahead = static_cast<size_t>(std::max(1.0, 1.2 * unit / spacing));
    std::vector<double> result;
    for (size_t i = 0; i < calm.size(); ++i) {
        const size_t to = std::min(i + ahead, calm.size() - 1);
        const Vec3d way = calm[to] - calm[std::min(i, to - 1)];
        const double before = result.empty() ? 0.0 : result.back();
        const bool isStill = glm::length(Vec3d(way.x, way.y, 0)) < 0.1 * unit;
        result.push_back(isStill ? before : nearestTurn(std::atan2(way.y, way.x), before));
    }
    return result;
}

// How much of `reach` is free that way, over a good part of what the eye then sees.
double openness(const Occupancy& solid, const Vec3d& eye, double azimuth, double reach) {
    double sum = 0;
    for (const double off : {-18 * kDegree, 0.0, 18 * kDegree}) {
        sum += solid.viewLength(eye, directionOf(azimuth + off, 0.0), reach);
    }
    return sum / (3 * reach);
}

// `toward` plus full turns, so that turning there from `before` passes more open space: nobody
// turns about with the face to the wall.
double opener(double toward, double before, const Vec3d& eye, const Occupancy& solid,
              double reach) {
    const double near = nearestTurn(toward, before);
    if (std::abs(near - before) < 100 * kDegree) return near;
    const double other = near > before ? near - 2 * kPi : near + 2 * kPi;
    const auto openOnTheWay = [&](double to) {
        double sum = 0;
        for (int i = 1; i < 12; ++i) {
            const Vec3d direction = directionOf(before + (to - before) * i / 12.0, 0.0);
            sum += std::sqrt(solid.freeLength(eye, direction, reach));
        }
        return sum;
    };
    return openOnTheWay(other) > openOnTheWay(near) ? other : near;
}

// Where the person would like to look, aside from ahead: a glance now and then.
class Glances {
public:
    explicit Glances(uint64_t seed) : random_(Random(seed).fork(5)) { next(2.0); }

    // Radians to the left, at a place on the way; places come in rising order.
    double at(double place) {
        if (place > end_) next(place + random_.range(2.0, 5.0));
        return place < start_ ? 0.0 : side_;
    }

private:
    void next(double start) {
        start_ = start;
        end_ = start + random_.range(0.8, 1.6);
        side_ = random_.range(35, 70) * kDegree * (random_.chance(0.5) ? 1 : -1);
    }
    Random random_;
    double start_ = 0, end_ = 0, side_ = 0;  // in eye heights along the way
};

}  // namespace

std::vector<Vec3d> gazesAlong(const std::vector<Vec3d>& eyes, double spacing,
                              const Occupancy& solid, double eyeHeight, uint64_t seed) {
    const double reach = 5 * eyeHeight;
    const std::vector<double> heading = headings(eyes, spacing, eyeHeight);
    Glances glances(seed);
    std::vector<double> azimuth;
    const auto stride = static_cast<size_t>(std::max(1.0, 0.15 * eyeHeight / spacing));
    for (size_t i = 0; i < eyes.size(); ++i) {
        if (i % stride != 0) {
            azimuth.push_back(azimuth.back());
            continue;
        }
        const double glance = glances.at(static_cast<double>(i) * spacing / eyeHeight);
        const double before = azimuth.empty() ? heading[0] : azimuth.back();
        double best = heading[i], bestScore = -INFINITY;
        for (int side = -kSides; side <= kSides; ++side) {
            const double off = side * kSideStep, toward = heading[i] + off;
            const double open = openness(solid, eyes[i], toward, reach);
            const double wish = (off - glance) / (45 * kDegree);
            const double change = (nearestTurn(toward, before) - before) / (60 * kDegree);
            const double score = open - 0.35 * wish * wish - 0.35 * std::min(1.0, std::abs(change));
            if (score <= bestScore) continue;
            bestScore = score;
            best = toward;
        }
        azimuth.push_back(opener(best, before, eyes[i], solid, reach));
    }
    azimuth = smoothed(azimuth, 0.7 * eyeHeight / spacing);
    std::vector<Vec3d> gazes;
    for (size_t i = 0; i < eyes.size(); ++i) {
        const Vec3d at(static_cast<double>(i) * spacing / (3 * eyeHeight), 0.5, 0.5);
        const double nod = (-4 + 7 * valueNoise(at, seed)) * kDegree;
        gazes.push_back(directionOf(azimuth[i], nod));
    }
    return gazes;
}

}  // namespace pagoda::tools
