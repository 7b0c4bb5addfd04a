// report_file.h: what commands that write reports share: files that are refused before the work
// begins, the command that makes the numbers again, sizes of pictures, numbers as JSON and CSV.
#pragma once

#include "tools/bench/statistics.h"
#include "tools/runtime_options.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <thread>
#include <vector>

namespace CLI {
class App;
}

namespace pagoda::tools {

// Throws Error when a report could not be written there; nothing is made. "" is no report.
void checkReportFile(const std::string& path);
// A report takes the place of an older one.
void writeReportFile(const std::string& path, const std::string& text);

// The command that makes these numbers again, without the reports it writes (--json, --csv,
// --html). It travels with them, so the positional words and `fileOptions` lose their folders.
[[nodiscard]] std::string commandText(const CLI::App& command,
                                      const std::vector<std::string>& fileOptions);

struct PictureSize {
    int widthPx = 0, heightPx = 0;
};
// "640x480". Throws CLI::ValidationError for anything else.
[[nodiscard]] PictureSize parsePictureSize(const std::string& text);

using Json = nlohmann::ordered_json;
// What every report begins with, from a plan of its own kind: what was measured, by which command,
// where, and how visibility was weighed ("settings", to which more may be added).
template <typename Plan>
[[nodiscard]] Json headJson(const Plan& plan, const std::string& device) {
    const hlod::StrategyOptions options = plan.runtime.strategyOptions();
    return {{"database", std::filesystem::path(plan.database).filename().string()},
            {"model",
             {{"triangles", plan.modelTriangles},
              {"nodes", plan.modelNodes},
              {"bytes", plan.modelBytes}}},
            {"command", plan.command},
            {"machine", {{"cores", std::thread::hardware_concurrency()}, {"device", device}}},
            {"settings",
             {{"bias", {options.biasS, options.biasT, options.biasFloor}},
              {"as_published", options.isAsPublished},
              {"caution", options.caution},
              {"retest", options.retestEvery},
              {"batch_hidden", options.hiddenBatch},
              {"hysteresis", options.hysteresis}}}};
}
// Rounded to six digits: more is noise, and reports get committed.
[[nodiscard]] double shown(double value);
[[nodiscard]] Json numbersJson(const Spread& spread);
[[nodiscard]] Json numbersJson(const std::vector<double>& values);
// A line with the names of values, then one for each row; a value within an object is NAME/KEY.
// Lists are left out.
[[nodiscard]] std::string csvOf(const std::vector<Json>& rows);

}  // namespace pagoda::tools
