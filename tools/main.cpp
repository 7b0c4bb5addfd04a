// main.cpp: the program `pagoda`. Each command is a file in commands/; here are what all share: the
// command line, the exit codes and the one line an error gets.
#include "ooc/base/error.h"
#include "tools/console_progress.h"
#include "tools/session.h"

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pagoda::tools {
namespace {

constexpr const char* kCannotPrint = "standard output: cannot be written; is the disk full?";

enum ExitCode { kDone = 0, kFailed = 1, kWrongUsage = 2, kInterrupted = 130 };

// A signal handler has no arguments of ours, so this one pointer is global; SignalStop owns it.
std::atomic<Progress*> signalledProgress{nullptr};
static_assert(std::atomic<Progress*>::is_always_lock_free);

void requestStop(int) {
    if (Progress* const progress = signalledProgress.load()) progress->requestStop();
}

// While it lives, the first SIGINT or SIGTERM asks the work to end; SA_RESETHAND lets the second
// one kill.
class SignalStop {
public:
    explicit SignalStop(Progress& progress) {
        signalledProgress.store(&progress);
        struct sigaction action {};
        action.sa_handler = requestStop;
        action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
        sigemptyset(&action.sa_mask);
        sigaction(SIGINT, &action, nullptr);
        sigaction(SIGTERM, &action, nullptr);
    }
    ~SignalStop() { signalledProgress.store(nullptr); }
    SignalStop(const SignalStop&) = delete;
    SignalStop& operator=(const SignalStop&) = delete;
};

void addCommands(CLI::App& app, Session& session) {
    addBuildCommand(app, session);
    addInfoCommand(app, session);
    addVerifyCommand(app, session);
    addExtractCommand(app, session);
#ifdef PAGODA_HAS_VIEWER
    addRenderCommand(app, session);
#ifdef PAGODA_HAS_WINDOW
    addViewCommand(app, session);
#endif
    addBenchCommand(app, session);
    addStressCommand(app, session);
#endif
    addGenerateCommand(app, session);
    addPathCommand(app, session);
}

int wrongUsage(const CLI::App& app, const CLI::ParseError& error) {
    std::string what = error.what(), command;
    for (const CLI::App* sub : app.get_subcommands()) command += " " + sub->get_name();
    const std::vector<std::string> unknown = app.remaining();
    if (command.empty()) {
        what = unknown.empty() ? "no command given"
                               : "there is no command or option " + unknown.front();
    }
    std::cerr << "pagoda: " << what << "; see pagoda" << command << " --help\n";
    return kWrongUsage;
}

// Output that never reached its file (a full disk, a closed pipe) is a failure too.
bool flushResults() {
    std::cout.flush();
    return std::cout && std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
}

int run(int argc, char** argv) {
    Session session;
    ConsoleProgress* console = nullptr;
    std::optional<SignalStop> signalStop;  // ends before session.progress does
    const auto fail = [&](const std::string& line, int code) {
        signalStop.reset();
        session.progress.reset();  // takes the bar off the line
        std::cerr << "pagoda: " << line << '\n';
        return code;
    };

    CLI::App app{"Pagoda: out-of-core viewer for massive models", "pagoda"};
    app.set_version_flag("--version", std::string("pagoda " PAGODA_VERSION));
    bool quiet = false;
    app.add_flag("-q,--quiet", quiet, "No progress, notes or warnings on stderr; errors only");
    app.require_subcommand(1);
    app.fallthrough();  // --quiet may follow the command
    app.footer(
        "Each command has its own --help with examples.\n"
        "Exit codes: 0 done, 1 failed, 2 wrong usage, 130 interrupted.");
    addCommands(app, session);
    app.parse_complete_callback([&] {
        auto progress = makeStderrProgress(quiet);
        console = progress.get();
        session.progress = std::move(progress);
        signalStop.emplace(*session.progress);
    });

    try {
        app.parse(argc, argv);
        if (console != nullptr) console->finish();
        if (!flushResults()) return fail(kCannotPrint, kFailed);
        return session.exitCode;
    } catch (const CLI::Success& success) {  // --help, --version
        app.exit(success);
        return flushResults() ? kDone : fail(kCannotPrint, kFailed);
    } catch (const CLI::ParseError& error) {
        return wrongUsage(app, error);
    } catch (const Interrupted&) {
        return fail("interrupted", kInterrupted);
    } catch (const Error& error) {
        return fail(error.what(), kFailed);
    } catch (const std::bad_alloc&) {
        return fail("out of memory; give a smaller --memory, or close other programs", kFailed);
    } catch (const std::filesystem::filesystem_error& error) {
        return fail(error.path1().string() + ": " + error.code().message() +
                        "; check that it exists and may be used",
                    kFailed);
    } catch (const std::exception& error) {
        return fail(std::string(error.what()) + "; this is a mistake in pagoda, please report it",
                    kFailed);
    }
}

}  // namespace
}  // namespace pagoda::tools

int main(int argc, char** argv) {
    return pagoda::tools::run(argc, argv);
}
