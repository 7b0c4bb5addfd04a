// test_meshes.h: small meshes written as files, for tests that build databases.
#pragma once

#include "ooc/base/box.h"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

namespace pagoda::test {

struct Mesh {
    std::vector<Vec3d> positions;
    std::vector<std::array<uint32_t, 3>> triangles;
};

// A closed torus about the origin (R 1, r 0.4), rough along its normal, of 2 * around * across
// triangles.
inline Mesh roughTorus(uint32_t around, uint32_t across, double roughness = 0.01) {
    Mesh mesh;
    std::mt19937 random(7);
    for (uint32_t i = 0; i < around; ++i) {
        for (uint32_t j = 0; j < across; ++j) {
            const double u = 2 * M_PI * i / around, v = 2 * M_PI * j / across;
            const double r = 0.4 + roughness * (std::sin(9 * u) * std::cos(7 * v) +
                                                static_cast<double>(random()) / 4294967296.0 * 0.2);
            mesh.positions.emplace_back((1 + r * std::cos(v)) * std::cos(u),
                                        (1 + r * std::cos(v)) * std::sin(u), r * std::sin(v));
        }
    }
    const auto at = [&](uint32_t i, uint32_t j) { return (i % around) * across + j % across; };
    for (uint32_t i = 0; i < around; ++i) {
        for (uint32_t j = 0; j < across; ++j) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return mesh;
}

inline void writePly(const Mesh& mesh, const std::filesystem::path& path) {
    std::ofstream out(path, std::ios::binary);
    out << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.positions.size()
        << "\nproperty double x\nproperty double y\nproperty double z\nelement face "
        << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
    out.write(reinterpret_cast<const char*>(mesh.positions.data()),
              static_cast<std::streamsize>(mesh.positions.size() * sizeof(Vec3d)));
    for (const auto& triangle : mesh.triangles) {
        out.put(3);
        out.write(reinterpret_cast<const char*>(triangle.data()), 12);
    }
}

// A folder of its own, removed at the end.
class TemporaryFolder {
public:
    TemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "pagoda-test-XXXXXX").string();
        path_ = ::mkdtemp(name.data());
    }
    ~TemporaryFolder() { std::filesystem::remove_all(path_); }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
        return path_ / name;
    }

private:
    std::filesystem::path path_;
};

}  // namespace pagoda::test
