// Plays the corpus of one target again, without libFuzzer: what once broke stays mended, in every
// build and under every sanitizer.
//   pagoda_fuzz_replay TARGET FILE_OR_FOLDER...
#include "tests/fuzz/targets.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

namespace {

std::vector<std::filesystem::path> filesIn(const std::filesystem::path& path) {
    if (std::filesystem::is_regular_file(path)) return {path};
    std::vector<std::filesystem::path> files;
    if (!std::filesystem::is_directory(path)) return files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
        if (entry.is_regular_file()) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace

int main(int argc, char** argv) {
    const auto* const target = argc > 2 ? pagoda::fuzz::findTarget(argv[1]) : nullptr;
    if (target == nullptr) {
        std::fputs("usage: pagoda_fuzz_replay TARGET FILE_OR_FOLDER...\n", stderr);
        return 2;
    }
    size_t count = 0;
    for (int i = 2; i < argc; ++i) {
        for (const auto& path : filesIn(argv[i])) {
            // Said before it runs, so that the last line names the one that broke it.
            std::printf("%s\n", path.c_str());
            std::fflush(stdout);
            std::ifstream file(path, std::ios::binary);
            const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
            target->run(std::as_bytes(std::span(bytes)));
            ++count;
        }
    }
    std::printf("%zu inputs\n", count);
    return count > 0 ? 0 : 1;  // an empty corpus tests nothing
}
