// readers_benchmark: how fast each reader turns bytes into triangles, with a sink that only counts.
// Every workload is the same surface of about a million triangles, written in each format to a
// temporary folder. `read` opens and reads once (vertices to scratch included), `again` reads a
// second time (vertices reused). bytes_per_second is the file's size by process CPU time; anon_KiB
// is how much private memory (RssAnon) grew at most while reading, from a round that is not timed.
#include "ooc/readers/reader.h"

#include <benchmark/benchmark.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

namespace pagoda::ooc {
namespace {

constexpr int kColumns = 1000, kRows = 500;  // a million triangles

int64_t privateKibibytes() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with("RssAnon:")) return std::stoll(line.substr(8));
    }
    return 0;
}

struct CountingSink : TriangleSink {
    uint64_t triangles = 0, droppedTriangles = 0;
    uint32_t objects = 0, materials = 0;
    double checksum = 0;  // so that no position goes unread

    uint32_t addObject(const ObjectInfo&) override { return objects++; }
    uint32_t addMaterial(const MaterialInfo&) override { return materials++; }
    void addTriangles(const TriangleBatch& batch) override {
        triangles += batch.triangleCount();
        checksum += batch.positions.back().x;
    }
    void dropped(DropReason, uint64_t count) override { droppedTriangles += count; }
    void ignored(std::string_view, uint64_t) override {}
    void advance(uint64_t) override {}
};

// Looks at the memory with every block that the reader takes in.
struct WatchingSink : CountingSink {
    int64_t before = privateKibibytes(), grown = 0;
    void advance(uint64_t) override { grown = std::max(grown, privateKibibytes() - before); }
};

Vec3f vertexAt(int column, int row) {
    const float x = static_cast<float>(column) * 0.013f, y = static_cast<float>(row) * 0.017f;
    return {x, y, std::sin(x * 3.1f) * std::cos(y * 2.3f)};
}

template <typename Write>
void forEachVertex(Write write) {
    for (int row = 0; row <= kRows; ++row) {
        for (int column = 0; column <= kColumns; ++column) write(vertexAt(column, row));
    }
}

template <typename Write>
void forEachTriangle(Write write) {
    for (int row = 0; row < kRows; ++row) {
        for (int column = 0; column < kColumns; ++column) {
            const int a = row * (kColumns + 1) + column, b = a + 1, c = a + kColumns + 1;
            write(a, b, c + 1);
            write(a, c + 1, c);
        }
    }
}

template <typename Value>
void put(std::string& out, const Value& value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <typename... Values>
void print(std::string& out, const char* format, Values... values) {
    char line[256];
    out.append(line, static_cast<size_t>(std::snprintf(line, sizeof line, format, values...)));
}

std::string plyHeader(const char* format, const char* more) {
    std::string out;
    print(out, "ply\nformat %s 1.0\nelement vertex %d\n", format, (kColumns + 1) * (kRows + 1));
    print(out, "property float x\nproperty float y\nproperty float z\n%s", more);
    print(out, "element face %d\nproperty list uchar int vertex_indices\nend_header\n",
          2 * kColumns * kRows);
    return out;
}

std::string binaryPly(bool hasColours) {
    std::string out = plyHeader(
        "binary_little_endian",
        hasColours ? "property uchar red\nproperty uchar green\nproperty uchar blue\n" : "");
    forEachVertex([&](Vec3f v) {
        put(out, v);
        if (hasColours) out.append("abc");
    });
    forEachTriangle([&](int a, int b, int c) {
        out += '\3';
        for (const int corner : {a, b, c}) put(out, corner);
    });
    return out;
}

std::string textPly() {
    std::string out = plyHeader("ascii", "");
    forEachVertex([&](Vec3f v) { print(out, "%.6f %.6f %.6f\n", v.x, v.y, v.z); });
    forEachTriangle([&](int a, int b, int c) { print(out, "3 %d %d %d\n", a, b, c); });
    return out;
}

std::string obj(bool hasNormals) {
    std::string out;
    forEachVertex([&](Vec3f v) { print(out, "v %.6f %.6f %.6f\n", v.x, v.y, v.z); });
    if (!hasNormals) {
        forEachTriangle(
            [&](int a, int b, int c) { print(out, "f %d %d %d\n", a + 1, b + 1, c + 1); });
        return out;
    }
    forEachVertex([&](Vec3f v) { print(out, "vn %.4f %.4f 1.0000\n", v.z, v.z); });
    forEachTriangle([&](int a, int b, int c) {
        print(out, "f %d//%d %d//%d %d//%d\n", a + 1, a + 1, b + 1, b + 1, c + 1, c + 1);
    });
    return out;
}

Vec3f vertexOf(int index) {
    return vertexAt(index % (kColumns + 1), index / (kColumns + 1));
}

std::string binaryStl() {
    std::string out(80, ' ');
    put(out, static_cast<uint32_t>(2 * kColumns * kRows));
    forEachTriangle([&](int a, int b, int c) {
        put(out, Vec3f(0, 0, 1));
        for (const int corner : {a, b, c}) put(out, vertexOf(corner));
        put(out, uint16_t{0});
    });
    return out;
}

std::string textStl() {
    std::string out = "solid surface\n";
    forEachTriangle([&](int a, int b, int c) {
        out += "facet normal 0 0 1\n  outer loop\n";
        for (const int corner : {a, b, c}) {
            const Vec3f v = vertexOf(corner);
            print(out, "    vertex %.6f %.6f %.6f\n", v.x, v.y, v.z);
        }
        out += "  endloop\nendfacet\n";
    });
    return out + "endsolid surface\n";
}

std::string off() {
    std::string out;
    print(out, "OFF\n%d %d 0\n", (kColumns + 1) * (kRows + 1), 2 * kColumns * kRows);
    forEachVertex([&](Vec3f v) { print(out, "%.6f %.6f %.6f\n", v.x, v.y, v.z); });
    forEachTriangle([&](int a, int b, int c) { print(out, "3 %d %d %d\n", a, b, c); });
    return out;
}

struct Workload {
    const char *name, *extension;
    std::string (*make)();
};
constexpr Workload kWorkloads[] = {
    {"ply_binary", ".ply", [] { return binaryPly(false); }},
    {"ply_binary_colours", ".ply", [] { return binaryPly(true); }},
    {"ply_text", ".ply", textPly},
    {"obj", ".obj", [] { return obj(false); }},
    {"obj_normals", ".obj", [] { return obj(true); }},
    {"stl_binary", ".stl", binaryStl},
    {"stl_text", ".stl", textStl},
    {"off", ".off", off},
};

// The files, made when they are first wanted, gone with the program.
class Files {
public:
    Files() {
        std::string name =
            (std::filesystem::temp_directory_path() / "pagoda-benchmark-XXXXXX").string();
        if (mkdtemp(name.data()) != nullptr) folder_ = name;
    }
    ~Files() {
        std::error_code code;
        if (!folder_.empty()) std::filesystem::remove_all(folder_, code);
    }
    std::filesystem::path path(const Workload& workload) {
        const auto path = folder_ / (std::string(workload.name) + workload.extension);
        if (!std::filesystem::exists(path)) {
            std::ofstream(path, std::ios::binary) << workload.make();
        }
        return path;
    }

private:
    std::filesystem::path folder_;
};

void report(benchmark::State& state, const CountingSink& sink, uint64_t fileBytes,
            int64_t anonKiB) {
    if (sink.triangles != 2ull * kColumns * kRows) state.SkipWithError("triangles are missing");
    state.SetBytesProcessed(static_cast<int64_t>(fileBytes) * state.iterations());
    state.counters["Mtri/s"] = benchmark::Counter(static_cast<double>(sink.triangles) / 1e6,
                                                  benchmark::Counter::kIsIterationInvariantRate);
    state.counters["anon_KiB"] = static_cast<double>(anonKiB);
}

void read(benchmark::State& state, Files& files, const Workload& workload, bool isAgain) {
    const auto path = files.path(workload);
    malloc_trim(0);  // so that what making the files left does not hide the growth
    WatchingSink watching;
    const auto kept = openReader(path, {});
    kept->read(watching);
    CountingSink sink;
    for (auto _ : state) {
        sink = {};
        const auto fresh = isAgain ? nullptr : openReader(path, {});
        (isAgain ? *kept : *fresh).read(sink);
    }
    report(state, sink, std::filesystem::file_size(path), watching.grown);
}

const int kRegistered = [] {
    static Files files;
    for (const Workload& workload : kWorkloads) {
        for (const bool isAgain : {false, true}) {
            const std::string name = std::string(isAgain ? "again/" : "read/") + workload.name;
            benchmark::RegisterBenchmark(
                name.c_str(),
                [&, isAgain](benchmark::State& s) { read(s, files, workload, isAgain); })
                ->MeasureProcessCPUTime()
                ->Unit(benchmark::kMillisecond);
        }
    }
    return 0;
}();

}  // namespace
}  // namespace pagoda::ooc
