// run_program.h: runs the program `pagoda` through a shell and keeps what it said.
#pragma once

#include <string>

namespace pagoda::tests {

struct ProgramRun {
    int exitCode = -1;  // 128 + signal when a signal ended it, as in a shell
    std::string out, err;
};

// `arguments` as one would type them behind `pagoda`, redirections included.
[[nodiscard]] ProgramRun runPagoda(const std::string& arguments);

}  // namespace pagoda::tests
