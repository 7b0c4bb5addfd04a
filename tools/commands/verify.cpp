#include "ooc/store/verify.h"

#include "hlod/build/deep_verify.h"
#include "ooc/store/database.h"
#include "tools/session.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include <fmt/format.h>

namespace pagoda::tools {
namespace {

constexpr const char* kExamples = R"(Examples:
  pagoda verify plant.pagoda
  pagoda verify plant.pagoda --threads 8 --json
  pagoda verify plant.pagoda --deep
Exits 0 only when all is sound. --deep runs where the rest is sound. It measures as the builder does,
at 4096 samples a direction and node: it shows that the stated errors are what was measured, and is
no bound on the distance of every point.)";

constexpr size_t kShownFaults = 20;

struct Arguments {
    std::string path;
    bool json = false, deep = false;
    size_t threads = 0;
};

using Deep = std::optional<hlod::DeepReport>;  // none: not asked for, or not reached

void print(const ooc::VerifyReport& report, const Deep& deep, const std::string& path) {
    for (size_t i = 0; i < std::min(kShownFaults, report.faults.size()); ++i) {
        std::cout << path << ":" << report.faults[i].place << ": " << report.faults[i].what << '\n';
    }
    if (report.faultCount > kShownFaults) {
        std::cout << fmt::format("and {} more\n", formatCount(report.faultCount - kShownFaults));
    }
    if (deep) {
        std::cout << fmt::format(
            "errors measured again (sampled): {} inner nodes, {} leaves; {} too small; measured / "
            "stated at most {:.6g}\n",
            formatCount(deep->innerNodes), formatCount(deep->leaves), formatCount(deep->tooSmall),
            deep->largestRatio);
    }
    std::cout << fmt::format(
        "{}: {}; {} in {} nodes, {} triangles in the leaves looked at\n", path,
        report.isSound() ? "sound" : formatCount(report.faultCount) + " faults",
        formatBytes(report.bytesChecked), formatCount(report.nodesChecked),
        formatCount(report.trianglesChecked));
}

void printJson(const ooc::VerifyReport& report, const Deep& deep) {
    nlohmann::ordered_json json = {{"sound", report.isSound()},
                                   {"fault_count", report.faultCount},
                                   {"bytes", report.bytesChecked},
                                   {"nodes", report.nodesChecked},
                                   {"triangles", report.trianglesChecked}};
    if (deep) {
        json["deep"] = {{"inner_nodes", deep->innerNodes},
                        {"leaves", deep->leaves},
                        {"too_small", deep->tooSmall},
                        {"largest_ratio", deep->largestRatio}};
    }
    json["faults"] = nlohmann::ordered_json::array();
    for (const ooc::VerifyFault& fault : report.faults) {
        json["faults"].push_back({{"place", fault.place}, {"what", fault.what}});
    }
    std::cout << json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
}

void verify(const Arguments& arguments, Session& session) {
    const size_t threads = arguments.threads != 0
                               ? arguments.threads
                               : std::max<size_t>(std::thread::hardware_concurrency(), 1);
    ooc::VerifyReport report = ooc::verifyDatabase(arguments.path, threads, *session.progress);
    Deep deep;
    if (arguments.deep && report.isSound()) {
        deep = hlod::verifyErrors(ooc::Database::open(arguments.path), threads, *session.progress,
                                  report);
    }
    if (arguments.json) {
        printJson(report, deep);
    } else {
        print(report, deep, arguments.path);
    }
    if (!report.isSound()) session.exitCode = 1;
}

}  // namespace

void addVerifyCommand(CLI::App& app, Session& session) {
    auto arguments = std::make_shared<Arguments>();
    CLI::App* command = app.add_subcommand("verify", "Check every byte and the structure");
    command->footer(kExamples);
    command->add_option("database", arguments->path, "The database (NAME.pagoda)")->required();
    command->add_flag("--json", arguments->json, "Print JSON");
    command->add_flag("--deep", arguments->deep, "Measure the errors of all nodes again (sampled)");
    command->add_option("--threads", arguments->threads, "Workers (0: one a core)")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str();
    command->callback([arguments, &session] { verify(*arguments, session); });
}

}  // namespace pagoda::tools
