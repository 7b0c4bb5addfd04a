#include "ooc/base/error.h"
#include "ooc/store/database.h"
#include "tools/session.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include <fmt/format.h>

namespace pagoda::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kExamples = R"(Examples:
  pagoda info plant.pagoda
  pagoda info plant.pagoda --json | python3 -m json.tool)";

struct Arguments {
    std::string path;
    bool json = false;
};

// What the index says, summed over all nodes.
struct IndexSummary {
    ooc::NodeRecord root;
    uint64_t pageBytes = 0;
    uint64_t withColours = 0, withNormals = 0, withTranslucent = 0, withZippers = 0;
    uint64_t withWideIndices = 0, sloppy = 0, stuck = 0;
    std::vector<std::string> faults;
};

IndexSummary summarise(const ooc::Database& database, Progress& progress) {
    IndexSummary summary;
    progress.beginStage("Reading the index", database.header().nodeCount, "nodes");
    ooc::forEachNode(
        database,
        [&](const ooc::NodeRecord& node, ooc::NodeRef) {
            if (node.id == ooc::NodeId::root()) summary.root = node;
            const auto counts = [&](uint16_t flag) { return (node.flags & flag) != 0 ? 1u : 0u; };
            summary.pageBytes += node.pageBytes;
            summary.withColours += counts(ooc::kNodeHasColours);
            summary.withNormals += counts(ooc::kNodeHasNormals);
            summary.withTranslucent += counts(ooc::kNodeHasTranslucent);
            summary.withZippers += counts(ooc::kNodeHasZippers);
            summary.sloppy += counts(ooc::kNodeSloppy);
            summary.stuck += counts(ooc::kNodeStuck);
            summary.withWideIndices += node.vertexCount > 65536 ? 1u : 0u;
            progress.check();
            progress.advance(1);
            return true;
        },
        [&](uint32_t block, const std::string& why) {
            summary.faults.push_back(fmt::format("index block {}: {}", block, why));
        });
    return summary;
}

// The metadata is data from a file: what is missing or of another kind is left empty.
Json member(const Json& object, const char* key, Json otherwise) {
    if (!object.is_object() || !object.contains(key)) return otherwise;
    const Json& value = object[key];
    const bool isOfTheKind = otherwise.is_null() || value.type() == otherwise.type();
    return isOfTheKind ? value : otherwise;
}

Json leftOut(const IndexSummary& summary, const ooc::Header& header) {
    Json list = Json::array();
    const auto add = [&](const char* what, uint64_t pages, const char* why) {
        if (pages != 0) list.push_back({{"what", what}, {"pages", pages}, {"why", why}});
    };
    const uint64_t nodes = header.nodeCount;
    add("colours at vertices", nodes - summary.withColours, "one colour for the page");
    add("normals", nodes - summary.withNormals, "none in the input, or flat: shaded by triangle");
    add("translucent parts", nodes - summary.withTranslucent, "no translucent triangles");
    add("zippers", nodes - summary.withZippers, "borders agree with all neighbours");
    add("32-bit indices", nodes - summary.withWideIndices, "at most 65,536 vertices");
    return list;
}

Json vector(const Vec3d& value) {
    return {value.x, value.y, value.z};
}

Json describe(const ooc::Database& database, const IndexSummary& summary) {
    const ooc::Header& header = database.header();
    const Json metadata = Json::parse(database.metadataJson(), nullptr, false);
    const Box3d box = header.lattice.toModel(summary.root.box);
    const auto triangles = static_cast<double>(header.triangleCount);
    Json faults = Json::array();
    if (!database.headerFault().empty()) faults.push_back("header: " + database.headerFault());
    if (!database.metadataFault().empty()) {
        faults.push_back("metadata: " + database.metadataFault());
    }
    for (const std::string& fault : summary.faults) faults.push_back(fault);

    Json json;
    json["triangles_in"] = member(metadata, "triangles_in", nullptr);
    json["triangles"] = header.triangleCount;
    json["dropped"] = member(metadata, "dropped", Json::object());
    json["ignored"] = member(metadata, "ignored", Json::object());
    json["nodes"] = header.nodeCount;
    json["leaves"] = header.leafCount;
    json["levels"] = header.levelCount;
    json["node_triangles"] = header.nodeTriangles;
    json["objects"] = header.objectCount;
    json["materials"] = header.materialCount;
    json["bytes"] = header.fileBytes;
    json["page_bytes"] = summary.pageBytes;
    json["bytes_per_triangle"] = static_cast<double>(header.fileBytes) / std::max(triangles, 1.0);
    json["codec"] = ooc::codecName(header.codec);
    json["lattice"] = {{"origin", vector(header.lattice.origin)},
                       {"step", header.lattice.step()},
                       {"bits", header.lattice.extentBits}};
    json["box"] = {{"min", vector(box.min)}, {"max", vector(box.max)}};
    json["diagonal"] = glm::length(box.max - box.min);
    json["up"] = member(metadata, "up", "");
    json["root"] = {{"triangles", summary.root.triangleCount},
                    {"error", summary.root.errorModelUnits},
                    {"bytes", summary.root.pageBytes}};
    json["sloppy_nodes"] = summary.sloppy;
    json["stuck_nodes"] = summary.stuck;
    json["left_out"] = leftOut(summary, header);
    json["level_list"] = member(metadata, "levels", Json::array());
    json["sources"] = member(metadata, "sources", Json::array());
    json["settings"] = member(metadata, "settings", Json::object());
    json["faults"] = faults;
    return json;
}

// Of text from a file: nothing that would move a terminal's cursor.
std::string printable(const Json& value) {
    std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    for (char& c : text) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
    }
    return text;
}

void row(const char* name, const std::string& value) {
    std::cout << fmt::format("{:<14}{}\n", name, value);
}

std::string count(const Json& value) {
    return value.is_number_unsigned() ? formatCount(value.get<uint64_t>()) : "unknown";
}

std::string point(const Json& value) {
    return fmt::format("({:g} {:g} {:g})", value[0].get<double>(), value[1].get<double>(),
                       value[2].get<double>());
}

void printCounted(const char* name, const Json& reasons) {
    for (const auto& [reason, number] : reasons.items()) {
        row(name, count(number) + " (" + printable(reason) + ")");
    }
}

void printLevels(const Json& levels) {
    if (levels.empty()) return;
    std::cout << "\nlevel     nodes     triangles      max error   median error   clustered\n";
    for (const Json& level : levels) {
        const auto error = [&](const char* key) {
            const Json value = member(level, key, nullptr);
            return value.is_number() ? value.get<double>() : 0.0;
        };
        std::cout << fmt::format(
            "{:>5}{:>10}{:>14}{:>15.6g}{:>15.6g}{:>12}\n", count(member(level, "level", nullptr)),
            count(member(level, "nodes", nullptr)), count(member(level, "triangles", nullptr)),
            error("max_error"), error("median_error"), count(member(level, "sloppy", nullptr)));
    }
}

void printSources(const Json& sources) {
    for (const Json& source : sources) {
        std::string line = printable(member(source, "path", ""));
        const Json in = member(source, "triangles_in", nullptr);
        if (in.is_number()) line += ", " + count(in) + " triangles";
        const std::string by = printable(member(source, "attribution", ""));
        if (!by.empty()) line += ", by " + by;
        row("source", line);
    }
}

void print(const Json& json) {
    const auto number = [](const Json& value) { return value.get<double>(); };
    row("triangles", count(json["triangles"]) + " of " + count(json["triangles_in"]) + " read");
    printCounted("dropped", json["dropped"]);
    printCounted("ignored", json["ignored"]);
    row("nodes", count(json["nodes"]) + ", " + count(json["leaves"]) + " of them leaves, in " +
                     count(json["levels"]) + " levels");
    row("objects", count(json["objects"]) + ", " + count(json["materials"]) + " materials");
    row("bytes",
        fmt::format("{}, {:.2f} a triangle, pages {}", formatBytes(json["bytes"].get<uint64_t>()),
                    number(json["bytes_per_triangle"]),
                    formatBytes(json["page_bytes"].get<uint64_t>())));
    row("codec", json["codec"].get<std::string>());
    row("step", fmt::format("{:g} model units", number(json["lattice"]["step"])));
    row("box", point(json["box"]["min"]) + " to " + point(json["box"]["max"]));
    row("diagonal", fmt::format("{:g}", number(json["diagonal"])));
    if (!json["up"].get<std::string>().empty()) row("up", printable(json["up"]));
    row("root", fmt::format("{} triangles, error {:g} ({:.3g}% of the diagonal), {}",
                            count(json["root"]["triangles"]), number(json["root"]["error"]),
                            100 * number(json["root"]["error"]) /
                                std::max(number(json["diagonal"]), 1e-300),
                            formatBytes(json["root"]["bytes"].get<uint64_t>())));
    if (json["sloppy_nodes"] != 0) row("clustered", count(json["sloppy_nodes"]) + " nodes");
    if (json["stuck_nodes"] != 0) row("above target", count(json["stuck_nodes"]) + " nodes");
    for (const Json& entry : json["left_out"]) {
        row("left out", entry["what"].get<std::string>() + " in " + count(entry["pages"]) +
                            " pages (" + entry["why"].get<std::string>() + ")");
    }
    printSources(json["sources"]);
    printLevels(json["level_list"]);
}

void showInfo(const Arguments& arguments, Session& session) {
    const ooc::Database database = ooc::Database::open(arguments.path);
    const IndexSummary summary = summarise(database, *session.progress);
    const Json json = describe(database, summary);
    for (const Json& fault : json["faults"]) session.progress->warn(printable(fault));
    if (!json["faults"].empty()) session.exitCode = 1;
    if (arguments.json) {
        std::cout << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
    } else {
        print(json);
    }
}

}  // namespace

void addInfoCommand(CLI::App& app, Session& session) {
    auto arguments = std::make_shared<Arguments>();
    CLI::App* command = app.add_subcommand("info", "Show what is in a database");
    command->footer(kExamples);
    command->add_option("database", arguments->path, "The database (NAME.pagoda)")->required();
    command->add_flag("--json", arguments->json, "Print JSON");
    command->callback([arguments, &session] { showInfo(*arguments, session); });
}

}  // namespace pagoda::tools
