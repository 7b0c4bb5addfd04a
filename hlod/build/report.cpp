#include "hlod/build/report.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace pagoda::hlod {
namespace {

using Json = nlohmann::ordered_json;

std::string upName(ooc::UpAxis up) {
    return up == ooc::UpAxis::Y ? "y" : "z";
}

Json levelsJson(const std::vector<LevelReport>& levels) {
    Json list = Json::array();
    for (size_t i = 0; i < levels.size(); ++i) {
        const LevelReport& level = levels[i];
        list.push_back({{"level", i},
                        {"nodes", level.nodes},
                        {"triangles", level.triangles},
                        {"max_error", level.maxError},
                        {"median_error", level.medianError},
                        {"sloppy", level.sloppy},
                        {"stuck", level.stuck}});
    }
    return list;
}

Json sourceJson(const InputSet::Source& source) {
    Json json = {{"path", source.name},
                 {"format", source.format},
                 {"triangles_in", source.trianglesIn},
                 {"up", upName(source.up)},
                 {"unit", source.unit}};
    if (source.transform != glm::dmat4(1.0)) {
        Json rows = Json::array();
        for (int row = 0; row < 4; ++row) {
            for (int column = 0; column < 4; ++column)
                rows.push_back(source.transform[column][row]);
        }
        json["transform"] = rows;
    }
    if (!source.attribution.empty()) json["attribution"] = source.attribution;
    return json;
}

// JSON must be UTF-8; names in files need not be.
std::string dump(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

void summariseNodes(std::span<const ooc::NodeRecord> nodes, BuildReport& report) {
    std::vector<std::vector<double>> errors;
    for (const ooc::NodeRecord& node : nodes) {
        // An extra leaf hangs below its cell's node: one level down.
        const auto level = static_cast<size_t>(node.id.depth()) + (node.id.slot() != 0 ? 1 : 0);
        if (report.levels.size() <= level) {
            report.levels.resize(level + 1);
            errors.resize(level + 1);
        }
        LevelReport& entry = report.levels[level];
        ++entry.nodes;
        entry.triangles += node.triangleCount;
        entry.maxError = std::max(entry.maxError, node.errorModelUnits);
        errors[level].push_back(node.errorModelUnits);
        ++report.nodes;
        if (node.isLeaf()) ++report.leaves;
        if (node.flags & ooc::kNodeSloppy) ++entry.sloppy, ++report.sloppyNodes;
        if (node.flags & ooc::kNodeStuck) ++entry.stuck, ++report.stuckNodes;
    }
    for (size_t level = 0; level < errors.size(); ++level) {
        if (errors[level].empty()) continue;
        const auto middle =
            errors[level].begin() + static_cast<ptrdiff_t>(errors[level].size() / 2);
        std::nth_element(errors[level].begin(), middle, errors[level].end());
        report.levels[level].medianError = *middle;
    }
}

std::string makeMetadata(const BuildOptions& options, const ooc::Lattice& lattice,
                         const InputSet& inputs, const BuildReport& report) {
    Json sources = Json::array();
    for (const InputSet::Source& source : inputs.sources()) sources.push_back(sourceJson(source));
    const Json metadata = {{"sources", sources},
                           {"up", upName(inputs.databaseUp())},
                           {"triangles_in", report.trianglesIn},
                           {"dropped", report.dropped},
                           {"ignored", report.ignored},
                           {"settings",
                            {{"codec", ooc::codecName(options.codec)},
                             {"node_triangles", options.nodeTriangles},
                             {"lattice_step", lattice.step()},
                             {"precision", options.precisionModelUnits.value_or(0.0)},
                             {"errors", "sampled"},
                             {"borders", "locked"}}},
                           {"sloppy_nodes", report.sloppyNodes},
                           {"stuck_nodes", report.stuckNodes},
                           {"bent_wedges", report.bentWedges},
                           {"levels", levelsJson(report.levels)}};
    return dump(metadata, -1);
}

std::string toJson(const BuildReport& report) {
    Json stages = Json::array();
    for (const StageReport& stage : report.stages) {
        stages.push_back({{"name", stage.name},
                          {"wall_seconds", stage.wallSeconds},
                          {"cpu_seconds", stage.cpuSeconds}});
    }
    const Json json = {{"triangles_in", report.trianglesIn},
                       {"triangles", report.triangles},
                       {"dropped", report.dropped},
                       {"ignored", report.ignored},
                       {"objects", report.objects},
                       {"materials", report.materials},
                       {"nodes", report.nodes},
                       {"leaves", report.leaves},
                       {"sloppy_nodes", report.sloppyNodes},
                       {"stuck_nodes", report.stuckNodes},
                       {"bent_wedges", report.bentWedges},
                       {"kept_vertices", report.keptVertices},
                       {"lattice_step", report.latticeStep},
                       {"levels", levelsJson(report.levels)},
                       {"input_bytes", report.inputBytes},
                       {"file_bytes", report.fileBytes},
                       {"page_bytes", report.pageBytes},
                       {"scratch_peak_bytes", report.scratchPeakBytes},
                       {"private_peak_bytes", report.privatePeakBytes},
                       {"stages", stages}};
    return dump(json, 2);
}

}  // namespace pagoda::hlod
