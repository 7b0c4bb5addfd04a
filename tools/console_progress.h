// console_progress.h: progress for a person at a terminal or a log file.
// Bar: one line that is drawn again at most ten times a second, with rate and time left. Lines: one
// line when a stage ends and every ten seconds of a long one, for logs. Silent: nothing at all.
// Notes and warnings go through an spdlog logger to the same stream, above the bar.
// Any thread may call; an advance() that draws nothing costs two atomic operations and the clock.
#pragma once

#include "ooc/base/progress.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

namespace spdlog {
class logger;
}

namespace pagoda::tools {

enum class ProgressStyle : uint8_t { Silent, Lines, Bar };

class ConsoleProgress : public Progress {
public:
    // `out` outlives this; `nowSeconds` never runs backwards and is called from any thread.
    ConsoleProgress(std::ostream& out, ProgressStyle style, std::function<double()> nowSeconds);
    // Takes an unfinished bar off the screen: the stage did not end.
    ~ConsoleProgress() override;

    void beginStage(std::string_view name, uint64_t totalUnits, std::string_view unit) override;
    void advance(uint64_t units) override;
    void note(std::string_view line) override;
    void warn(std::string_view line) override;

    // The work is done: says so for the last stage.
    void finish();

private:
    void endStage();  // with outputMutex_ held, as all below
    void drawBar(double nowSeconds);
    void eraseBar();
    void log(std::string_view prefix, std::string_view line);

    const ProgressStyle style_;
    const std::function<double()> nowSeconds_;
    std::atomic<uint64_t> doneUnits_{0};
    std::atomic<double> nextDrawSeconds_{0};

    std::mutex outputMutex_;  // guards all below
    std::ostream& out_;
    std::shared_ptr<spdlog::logger> logger_;
    std::string stage_, unit_;
    uint64_t totalUnits_ = 0;
    double beginSeconds_ = 0;
    bool isBarShown_ = false;
};

// "read 45% [#########           ] 12.3 MB of 27.1 MB, 4.1 MB/s, 4 s left": what the bar shows.
// `seconds` since the stage began; without `totalUnits` there is no bar, only what is done.
[[nodiscard]] std::string progressLine(std::string_view stage, uint64_t doneUnits,
                                       uint64_t totalUnits, std::string_view unit, double seconds);
// "12.3 MB of 27.1 MB, 4.1 MB/s, 4 s left": its numbers alone.
[[nodiscard]] std::string progressDetail(uint64_t doneUnits, uint64_t totalUnits,
                                         std::string_view unit, double seconds);
// 75.2 -> "1 min 15 s"; 3.14 -> "3.1 s".
[[nodiscard]] std::string formatDuration(double seconds);

// Bar on stderr where that is a terminal, lines elsewhere; nothing when `quiet`.
[[nodiscard]] std::unique_ptr<ConsoleProgress> makeStderrProgress(bool quiet);

}  // namespace pagoda::tools
