// random.h: our own small random numbers, the same on every machine (the distributions of the
// standard library are not). SplitMix64: https://prng.di.unimi.it/splitmix64.c
#pragma once

#include "ooc/base/box.h"

#include <cstdint>

namespace pagoda::tools {

[[nodiscard]] constexpr uint64_t scramble(uint64_t value) {
    value = (value ^ (value >> 30)) * 0xBF58476D1CE4E5B9ull;
    value = (value ^ (value >> 27)) * 0x94D049BB133111EBull;
    return value ^ (value >> 31);
}

class Random {
public:
    explicit constexpr Random(uint64_t seed) : state_(seed) {}

    constexpr uint64_t next() { return scramble(state_ += 0x9E3779B97F4A7C15ull); }
    // In [0, 1).
    constexpr double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
    constexpr double range(double low, double high) { return low + (high - low) * unit(); }
    // In [low, high].
    constexpr int integer(int low, int high) {
        const uint64_t count = static_cast<uint64_t>(high - low) + 1;
        return low + static_cast<int>(next() % count);  // the bias is below 2^-50
    }
    constexpr bool chance(double probability) { return unit() < probability; }
    // An independent stream: what is drawn from it does not move this one.
    [[nodiscard]] constexpr Random fork(uint64_t tag) const {
        return Random(scramble(state_ + scramble(tag + 0x632BE59BD9B4E019ull)));
    }

private:
    uint64_t state_;
};

// Smooth noise in [-1, 1] with features of about one unit, from hashed values at integer points.
[[nodiscard]] double valueNoise(const Vec3d& point, uint64_t seed);
// `octaves` of it, each twice as fine and half as high; in [-2, 2].
[[nodiscard]] double fractalNoise(const Vec3d& point, int octaves, uint64_t seed);

}  // namespace pagoda::tools
