#include "tools/bench/gnuplot.h"

#include "ooc/base/error.h"
#include "ooc/base/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <regex>
#include <span>
#include <system_error>

namespace pagoda::tools {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxSvgBytes = uint64_t{64} << 20;

// Points and filters have the same ids in every drawing of gnuplot.
constexpr const char* kIds[] = {"gpDot", "gpPt", "textbox", "greybox", "gnuplot_canvas"};

std::string readText(const fs::path& path) {
    const std::vector<std::byte> bytes = readWholeFile(path, kMaxSvgBytes);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void writeText(const fs::path& path, const std::string& text) {
    if (fs::exists(path)) fs::remove(path);
    File file = File::create(path);
    file.append(std::as_bytes(std::span(text)));
    file.close();
}

fs::path makeFolder() {
    std::string name = (fs::temp_directory_path() / "pagoda-plots-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
        throw Error(name, "", fmt::format("cannot be made: {}", std::strerror(errno)),
                    "set TMPDIR to a folder that can be written");
    }
    return name;
}

void replaceAll(std::string& text, std::string_view from, const std::string& to) {
    for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at)) {
        text.replace(at, from.size(), to);
        at += to.size();
    }
}

// What gnuplot says of every stroke, and is SVG's default anyway: half of the bytes.
constexpr const char* kDefaults[] = {" stroke-linecap=\"butt\"", " stroke-linejoin=\"miter\"",
                                     " stroke-width=\"1.00\"", "\t"};

// Names that gnuplot gives twice in drawings of two panels, tooltips of them, and empty groups.
constexpr const char* kNoise[] = {" id=\"gnuplot_plot_[^\"]*\"", "<title>[^<]*</title>",
                                  "<g [^>]*>\\s*</g>\n"};

// The exit status as waitpid() gives it; throws Error when gnuplot cannot be started.
int runGnuplot(const fs::path& script, const fs::path& messages) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, messages.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
    // -d: what somebody's ~/.gnuplot sets does not reach our drawings.
    std::string words[] = {"gnuplot", "-d", script.string()};
    char* arguments[] = {words[0].data(), words[1].data(), words[2].data(), nullptr};
    pid_t child = 0;
    const int failure = ::posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failure == ENOENT) {
        throw Error("", "", "the program gnuplot is not here", "install gnuplot-nox");
    }
    if (failure != 0) throw Error("gnuplot", "", std::strerror(failure), "");
    int status = 0;
    while (::waitpid(child, &status, 0) < 0) {
        if (errno != EINTR) throw Error("gnuplot", "", std::strerror(errno), "");
    }
    return status;
}

// gnuplot shows the place of a mistake in lines of its own before it names it.
std::string lastLine(const std::string& text) {
    const size_t end = text.find_last_not_of(" \n");
    if (end == std::string::npos) return "it says nothing";
    const size_t newline = text.rfind('\n', end);
    const size_t begin = newline == std::string::npos ? 0 : newline + 1;
    return text.substr(begin, end + 1 - begin);
}

}  // namespace

Gnuplot::~Gnuplot() {
    std::error_code ignored;  // what stays behind lies among the temporary files
    if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

void Gnuplot::run(const std::string& commands, Size size) {
    if (folder_.empty()) folder_ = makeFolder();
    const fs::path script = folder_ / "commands", svg = folder_ / "svg", said = folder_ / "said";
    fs::remove(svg);
    writeText(script, fmt::format("set encoding utf8\n"
                                  "set terminal svg size {},{} dynamic font 'Helvetica,13' "
                                  "background '#ffffff' noenhanced\n"
                                  "set output {}\n{}",
                                  size.width, size.height, gnuplotQuoted(svg.string()), commands));
    const int status = runGnuplot(script, said);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || !fs::exists(svg)) {
        throw Error("gnuplot", "", lastLine(readText(said)), "install gnuplot-nox 5 or newer");
    }
}

std::string Gnuplot::svg(const std::string& commands, Size size, const std::string& id) {
    if (!problem_.empty()) return {};
    try {
        run(commands, size);
        std::string text = readText(folder_ / "svg");
        text.erase(0, text.find("<svg"));
        for (const char* name : kIds) replaceAll(text, name, id + name);
        for (const char* name : kDefaults) replaceAll(text, name, "");
        for (const char* pattern : kNoise) text = std::regex_replace(text, std::regex(pattern), "");
        return text;
    } catch (const std::exception& error) {
        problem_ = error.what();
        return {};
    }
}

std::string gnuplotQuoted(std::string_view text) {
    std::string quoted = "'";
    for (const char c : text) {
        if (c == '\'') quoted += '\'';
        quoted += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return quoted + "'";
}

}  // namespace pagoda::tools
