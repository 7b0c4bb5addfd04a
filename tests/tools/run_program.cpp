#include "tests/tools/run_program.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace pagoda::tests {
namespace {

std::string takeText(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(file), {}};
    file.close();
    std::filesystem::remove(path);
    return text;
}

}  // namespace

ProgramRun runPagoda(const std::string& arguments) {
    const std::string base = testing::TempDir() + "pagoda-run-" + std::to_string(getpid());
    // Redirections of the arguments come last, so they win over ours.
    const std::string command = "{ \"" PAGODA_BINARY "\" " + arguments + " ; } > " + base +
                                ".out 2> " + base + ".err < /dev/null";
    const int status = std::system(command.c_str());
    ProgramRun run;
    run.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    run.out = takeText(base + ".out");
    run.err = takeText(base + ".err");
    return run;
}

}  // namespace pagoda::tests
