#include "tools/paths/poses.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace pagoda::tools {
namespace {

Pose between(const Pose& a, const Pose& b, double t) {
    const Vec3d gaze = glm::mix(a.gaze, b.gaze, t);
    const double length = glm::length(gaze);
    return {glm::mix(a.eye, b.eye, t), length > 0 ? gaze / length : b.gaze};
}

class Marcher {
public:
    Marcher(const std::vector<Pose>& samples, const Pace& pace, bool isClosed,
            const ClearTest& isClear)
        : samples_(samples), pace_(pace), isClosed_(isClosed), isClear_(isClear) {}

    std::vector<Pose> run(size_t frames) {
        std::vector<Pose> poses{samples_.front()};
        while (poses.size() < frames) {
            const std::optional<double> next = nextPlace(poses.back());
            if (!next) break;
            place_ = *next;
            poses.push_back(at(place_));
        }
        return poses;
    }

private:
    // The pose at a place, in samples from the first one.
    [[nodiscard]] Pose at(double place) const {
        const double sample = std::floor(place);
        const auto i = static_cast<size_t>(sample);
        return between(samples_[i % samples_.size()], samples_[(i + 1) % samples_.size()],
                       place - sample);
    }
    [[nodiscard]] double last() const {
        return isClosed_ ? INFINITY : static_cast<double>(samples_.size() - 1);
    }
    // Of the bounds, the share that a step uses up: 1 is a full step.
    [[nodiscard]] static double share(const Pose& a, const Pose& b, double move, double turn) {
        return std::max(glm::length(b.eye - a.eye) / move, degreesBetween(a.gaze, b.gaze) / turn);
    }
    [[nodiscard]] bool isFull(const Pose& from, double place) const {
        return share(from, at(place), pace_.moveModelUnits, pace_.turnDegrees) >= 1;
    }
    [[nodiscard]] bool isEnough(const Pose& from, const Pose& to) const {
        return share(from, to, pace_.leastMoveModelUnits, pace_.leastTurnDegrees) >= 1;
    }

    [[nodiscard]] std::optional<double> nextPlace(const Pose& from) const {
        // A closed way that never leaves a full step would not end.
        const double limit = std::min(last(), place_ + static_cast<double>(samples_.size()));
        double low = place_, high = std::min(std::floor(place_) + 1, limit);
        while (!isFull(from, high)) {
            if (high >= limit) return std::nullopt;
            low = high;
            high = std::min(high + 1, limit);
        }
        for (int i = 0; i < 40; ++i) {
            const double middle = 0.5 * (low + high);
            (isFull(from, middle) ? high : low) = middle;
        }
        return clearPlace(from, high);
    }

    [[nodiscard]] double clearPlace(const Pose& from, double place) const {
        if (!isClear_ || isClear_(from.eye, at(place).eye)) return place;
        constexpr int kTries = 16;
        for (int i = kTries - 1; i > 0; --i) {
            const double shorter = place_ + (place - place_) * i / kTries;
            const Pose to = at(shorter);
            if (isEnough(from, to) && isClear_(from.eye, to.eye)) return shorter;
        }
        return place;
    }

    const std::vector<Pose>& samples_;
    const Pace& pace_;
    bool isClosed_;
    const ClearTest& isClear_;
    double place_ = 0;
};

template <typename Value>
std::vector<Value> average(const std::vector<Value>& values, double sigma, bool isClosed) {
    const auto count = static_cast<int64_t>(values.size());
    const auto reach = std::min<int64_t>(static_cast<int64_t>(std::ceil(3 * sigma)), count - 1);
    if (reach < 1) return values;
    std::vector<double> weights;
    for (int64_t i = 0; i <= reach; ++i) {
        const double x = static_cast<double>(i) / sigma;
        weights.push_back(std::exp(-0.5 * x * x));
    }
    const auto place = [&](int64_t i) {
        if (isClosed) return static_cast<size_t>((i % count + count) % count);
        i = std::abs(i);
        return static_cast<size_t>(i < count ? i : 2 * (count - 1) - i);
    };
    std::vector<Value> result(values.size());
    for (int64_t i = 0; i < count; ++i) {
        Value sum = values[static_cast<size_t>(i)] * weights[0];
        double total = weights[0];
        for (int64_t k = 1; k <= reach; ++k) {
            const double weight = weights[static_cast<size_t>(k)];
            sum += (values[place(i - k)] + values[place(i + k)]) * weight;
            total += 2 * weight;
        }
        result[static_cast<size_t>(i)] = sum / total;
    }
    return result;
}

}  // namespace

Pace paceOf(double moveModelUnits, double turnDegrees, double diagonalModelUnits) {
    const double least = 0.002 * diagonalModelUnits * (1 + 1e-6);
    return {.moveModelUnits = std::max(moveModelUnits, least),
            .turnDegrees = std::max(turnDegrees, 1.0 + 1e-6),
            .leastMoveModelUnits = least,
            .leastTurnDegrees = 1.0 + 1e-6};
}

std::vector<Pose> march(const std::vector<Pose>& samples, const Pace& pace, size_t frames,
                        bool isClosed, const ClearTest& isClear) {
    return Marcher(samples, pace, isClosed, isClear).run(frames);
}

std::vector<Vec3d> smoothed(const std::vector<Vec3d>& values, double sigmaSamples, bool isClosed) {
    return average(values, sigmaSamples, isClosed);
}

std::vector<double> smoothed(const std::vector<double>& values, double sigmaSamples) {
    return average(values, sigmaSamples, false);
}

std::vector<Vec3d> resampled(const std::vector<Vec3d>& points, double spacing) {
    std::vector<Vec3d> result{points.front()};
    double ahead = spacing;  // to the next result, from the segment's start
    for (size_t i = 1; i < points.size(); ++i) {
        const double length = glm::length(points[i] - points[i - 1]);
        for (; ahead <= length; ahead += spacing) {
            result.push_back(glm::mix(points[i - 1], points[i], ahead / length));
        }
        ahead -= length;
    }
    if (glm::length(points.back() - result.back()) > 0.01 * spacing)
        result.push_back(points.back());
    return result;
}

double degreesBetween(const Vec3d& a, const Vec3d& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180.0 / std::numbers::pi;
}

Vec3d directionOf(double azimuthRadians, double elevationRadians) {
    return {std::cos(elevationRadians) * std::cos(azimuthRadians),
            std::cos(elevationRadians) * std::sin(azimuthRadians), std::sin(elevationRadians)};
}

}  // namespace pagoda::tools
