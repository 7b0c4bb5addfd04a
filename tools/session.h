// session.h: what every command shares, and the list of commands.
// A command adds its subcommand to the CLI11 app, keeps its options in a shared_ptr captured by the
// callback, and does its work in that callback: results on stdout, all else through
// session.progress. Bad input throws pagoda::Error (exit 1); a run that ends with faults but wrote
// its result sets exitCode.
#pragma once

#include "ooc/base/number_text.h"
#include "ooc/base/progress.h"

#include <cstdint>
#include <memory>
#include <string>

namespace CLI {
class App;
}

namespace pagoda::tools {

struct Session {
    std::unique_ptr<Progress>
        progress;  // a bar with rate and time left on a terminal, lines elsewhere;
                   // silent with --quiet; Ctrl-C calls requestStop()
    int exitCode = 0;
};

// One row a command, in the order of --help.
void addBuildCommand(CLI::App& app, Session& session);
void addInfoCommand(CLI::App& app, Session& session);
void addVerifyCommand(CLI::App& app, Session& session);
void addExtractCommand(CLI::App& app, Session& session);
void addRenderCommand(CLI::App& app, Session& session);  // with PAGODA_HAS_VIEWER only
void addViewCommand(CLI::App& app, Session& session);    // with PAGODA_HAS_WINDOW only
void addBenchCommand(CLI::App& app, Session& session);   // as render
void addStressCommand(CLI::App& app, Session& session);  // the same
void addGenerateCommand(CLI::App& app, Session& session);
void addPathCommand(CLI::App& app, Session& session);

// "512MiB", "4GB", "1048576" -> bytes. Throws CLI::ValidationError on anything else.
[[nodiscard]] uint64_t parseBytes(const std::string& text);

}  // namespace pagoda::tools
