#include "tools/bench/report_file.h"

#include "ooc/base/error.h"
#include "ooc/base/file.h"

#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <span>

namespace pagoda::tools {
namespace {

namespace fs = std::filesystem;

// A word as a shell reads it.
std::string shellWord(const std::string& text) {
    constexpr const char* kPlain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./,:=+@%-";
    if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted += "'";
}

bool isReport(const std::string& option) {
    return option == "--json" || option == "--csv" || option == "--html";
}

std::string csvCell(const Json& value) {
    if (!value.is_string()) return value.dump();
    auto text = value.get<std::string>();
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
    return quoted += '"';
}

void addCells(const std::string& name, const Json& value, std::vector<std::string>& names,
              std::vector<std::string>& cells) {
    if (value.is_array()) return;
    if (value.is_object()) {
        for (const auto& [key, inner] : value.items()) {
            std::string path = name;
            if (!path.empty()) path += '/';
            path += key;
            addCells(path, inner, names, cells);
        }
        return;
    }
    names.push_back(name);
    cells.push_back(csvCell(value));
}

}  // namespace

void checkReportFile(const std::string& path) {
    if (path.empty()) return;
    if (fs::exists(path) && !fs::is_regular_file(path)) {
        throw Error(path, "", "is no file that a report could replace", "choose another");
    }
    const fs::path folder = fs::absolute(path).parent_path();
    if (!fs::is_directory(folder)) {
        throw Error(path, "", "its folder is not there", "make the folder, or choose another");
    }
    if (::access(folder.c_str(), W_OK | X_OK) != 0) {
        throw Error(path, "", fmt::format("cannot be written: {}", std::strerror(errno)),
                    "choose a folder that can be written");
    }
}

void writeReportFile(const std::string& path, const std::string& text) {
    if (fs::is_regular_file(path)) fs::remove(path);
    File file = File::create(path);
    file.append(std::as_bytes(std::span(text)));
    file.close();
}

std::string commandText(const CLI::App& command, const std::vector<std::string>& fileOptions) {
    std::string text = "pagoda " + command.get_name();
    for (const CLI::Option* option : command.get_options()) {
        const std::string name = option->get_name();
        if (option->count() == 0 || isReport(name)) continue;
        std::vector<std::string> values = option->results();
        const bool isPositional = !name.starts_with("--");
        if (isPositional ||
            std::find(fileOptions.begin(), fileOptions.end(), name) != fileOptions.end()) {
            for (std::string& value : values) value = fs::path(value).filename().string();
        }
        if (!isPositional) text += " " + name;
        if (option->get_expected_max() == 0) continue;  // a flag
        text += " " + shellWord(fmt::format("{}", fmt::join(values, ",")));
    }
    return text;
}

PictureSize parsePictureSize(const std::string& text) {
    PictureSize size;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%5dx%5d%c", &size.widthPx, &size.heightPx, &rest) != 2 ||
        size.widthPx < 1 || size.heightPx < 1) {
        throw CLI::ValidationError("--size", "'" + text + "' is no size; write 640x480");
    }
    return size;
}

double shown(double value) {
    return std::stod(fmt::format("{:.6g}", value));
}

Json numbersJson(const Spread& spread) {
    return {{"median", shown(spread.median)},
            {"p95", shown(spread.p95)},
            {"p99", shown(spread.p99)},
            {"max", shown(spread.max)},
            {"mean", shown(spread.mean)}};
}

Json numbersJson(const std::vector<double>& values) {
    Json list = Json::array();
    for (const double value : values) list.push_back(shown(value));
    return list;
}

std::string csvOf(const std::vector<Json>& rows) {
    std::string csv;
    for (const Json& row : rows) {
        std::vector<std::string> names, cells;
        addCells("", row, names, cells);
        if (csv.empty()) csv = fmt::format("{}\n", fmt::join(names, ","));
        csv += fmt::format("{}\n", fmt::join(cells, ","));
    }
    return csv;
}

}  // namespace pagoda::tools
