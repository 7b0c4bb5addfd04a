#include "ooc/store/verify.h"

#include "ooc/base/error.h"
#include "ooc/store/database.h"
#include "tools/session.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include <fmt/format.h>

namespace pagoda::tools {
namespace {

constexpr const char* kExamples = R"(Examples:
  pagoda verify plant.pagoda
  pagoda verify plant.pagoda --threads 8 --json
Exits 0 only when all is sound.)";

constexpr size_t kShownFaults = 20;

struct Arguments {
    std::string path;
    bool json = false, deep = false;
    size_t threads = 0;
};

// Measures errors again and adds what it finds; runs only where the rest is sound.
using DeepStep = void (*)(const ooc::Database&, size_t threadCount, Progress&, ooc::VerifyReport&);
constexpr DeepStep kDeepStep = nullptr;  // none in this build yet

void print(const ooc::VerifyReport& report, const std::string& path) {
    for (size_t i = 0; i < std::min(kShownFaults, report.faults.size()); ++i) {
        std::cout << path << ":" << report.faults[i].place << ": " << report.faults[i].what << '\n';
    }
    if (report.faultCount > kShownFaults) {
        std::cout << fmt::format("and {} more\n", formatCount(report.faultCount - kShownFaults));
    }
    std::cout << fmt::format(
        "{}: {}; {} in {} nodes, {} triangles in the leaves looked at\n", path,
        report.isSound() ? "sound" : formatCount(report.faultCount) + " faults",
        formatBytes(report.bytesChecked), formatCount(report.nodesChecked),
        formatCount(report.trianglesChecked));
}

void printJson(const ooc::VerifyReport& report) {
    nlohmann::ordered_json json = {{"sound", report.isSound()},
                                   {"fault_count", report.faultCount},
                                   {"bytes", report.bytesChecked},
                                   {"nodes", report.nodesChecked},
                                   {"triangles", report.trianglesChecked}};
    json["faults"] = nlohmann::ordered_json::array();
    for (const ooc::VerifyFault& fault : report.faults) {
        json["faults"].push_back({{"place", fault.place}, {"what", fault.what}});
    }
    std::cout << json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
}

void verify(const Arguments& arguments, Session& session) {
    if (arguments.deep && kDeepStep == nullptr) {
        throw Error("", "", "this build cannot measure errors again", "leave out --deep");
    }
    const size_t threads = arguments.threads != 0
                               ? arguments.threads
                               : std::max<size_t>(std::thread::hardware_concurrency(), 1);
    ooc::VerifyReport report = ooc::verifyDatabase(arguments.path, threads, *session.progress);
    if (arguments.deep && report.isSound()) {
        kDeepStep(ooc::Database::open(arguments.path), threads, *session.progress, report);
    }
    if (arguments.json) {
        printJson(report);
    } else {
        print(report, arguments.path);
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
    command->add_flag("--deep", arguments->deep, "Measure the errors of all nodes again");
    command->add_option("--threads", arguments->threads, "Workers (0: one a core)")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str();
    command->callback([arguments, &session] { verify(*arguments, session); });
}

}  // namespace pagoda::tools
