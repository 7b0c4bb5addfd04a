// build.h: from mesh files to one database. A page on it: docs/build.md.
// The result depends on inputs and settings alone: same bytes for any thread count and memory
// budget.
#pragma once

#include "hlod/build/inputs.h"
#include "hlod/build/survey.h"
#include "ooc/base/progress.h"
#include "ooc/codecs/page_codec.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace pagoda::hlod {

struct BuildOptions {
    std::vector<InputSpec> inputs;  // sorted by path (expandInputs() does)
    std::filesystem::path target;
    bool force = false;
    uint64_t memoryBytes = uint64_t{1} << 30;   // private memory aimed at; 256 MiB is the least
    uint32_t threads = 0;                       // 0: as many as the machine has
    std::filesystem::path scratchFolder;        // empty: beside the target
    std::optional<double> precisionModelUnits;  // lattice step, rounded down to a power of two
    ooc::Codec codec = ooc::Codec::Meshopt;
    uint32_t nodeTriangles = 4096;  // N: the most a node holds
    uint64_t maxTriangles = uint64_t{1} << 33;
    ooc::UpAxis upAxis =
        ooc::UpAxis::Unknown;          // of the database; Unknown: the first input's, else z
    SurveyWatcher* watcher = nullptr;  // sees the first reading; outlives the build
};

inline constexpr uint64_t kMinMemoryBytes = uint64_t{256} << 20;

struct StageReport {
    std::string name;
    double wallSeconds = 0, cpuSeconds = 0;
};

struct LevelReport {
    uint64_t nodes = 0, triangles = 0, sloppy = 0, stuck = 0;
    double maxError = 0, medianError = 0;
};

struct BuildReport {
    uint64_t trianglesIn = 0;  // accepted and dropped
    uint64_t triangles = 0;    // in the leaves
    std::map<std::string, uint64_t> dropped, ignored;
    uint64_t objects = 0, materials = 0, nodes = 0, leaves = 0, sloppyNodes = 0, stuckNodes = 0;
    uint64_t bentWedges = 0;    // corners of coarse triangles whose normal is over 60 degrees off
    uint64_t keptVertices = 0;  // of coarse nodes, left off their level's lattice: level_lattice.h
    std::vector<LevelReport> levels;
    std::vector<StageReport> stages;
    // scratchPeakBytes is an upper bound: it does not take off what was given back in between.
    uint64_t inputBytes = 0, fileBytes = 0, pageBytes = 0, scratchPeakBytes = 0,
             privatePeakBytes = 0;
    double latticeStep = 0;
    // Other files than the inputs that the result depends on: CompanionReader::companions().
    std::vector<std::filesystem::path> companions;
};

// Throws Error; nothing exists under `target` then.
[[nodiscard]] BuildReport buildDatabase(const BuildOptions& options, Progress& progress);

// The report as `build --report` writes it.
[[nodiscard]] std::string toJson(const BuildReport& report);

}  // namespace pagoda::hlod
