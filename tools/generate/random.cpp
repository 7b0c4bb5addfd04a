#include "tools/generate/random.h"

#include <cmath>

namespace pagoda::tools {
namespace {

double cornerValue(int64_t x, int64_t y, int64_t z, uint64_t seed) {
    uint64_t hash = scramble(seed ^ static_cast<uint64_t>(x) * 0x9E3779B97F4A7C15ull);
    hash = scramble(hash ^ static_cast<uint64_t>(y) * 0xC2B2AE3D27D4EB4Full);
    hash = scramble(hash ^ static_cast<uint64_t>(z) * 0x165667B19E3779F9ull);
    return static_cast<double>(hash >> 11) * 0x1p-52 - 1.0;
}

double fade(double t) {
    return t * t * t * (t * (t * 6 - 15) + 10);
}

}  // namespace

double valueNoise(const Vec3d& point, uint64_t seed) {
    const Vec3d cell = glm::floor(point);
    const Vec3d t = point - cell;
    const int64_t x = static_cast<int64_t>(cell.x), y = static_cast<int64_t>(cell.y),
                  z = static_cast<int64_t>(cell.z);
    const double u = fade(t.x), v = fade(t.y), w = fade(t.z);
    double planes[2];
    for (int k = 0; k < 2; ++k) {
        double rows[2];
        for (int j = 0; j < 2; ++j) {
            rows[j] = std::lerp(cornerValue(x, y + j, z + k, seed),
                                cornerValue(x + 1, y + j, z + k, seed), u);
        }
        planes[k] = std::lerp(rows[0], rows[1], v);
    }
    return std::lerp(planes[0], planes[1], w);
}

double fractalNoise(const Vec3d& point, int octaves, uint64_t seed) {
    double sum = 0, height = 1;
    Vec3d at = point;
    for (int octave = 0; octave < octaves; ++octave) {
        sum += height * valueNoise(at, seed + static_cast<uint64_t>(octave));
        at *= 2.0;
        height *= 0.5;
    }
    return sum;
}

}  // namespace pagoda::tools
