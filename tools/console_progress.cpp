#include "tools/console_progress.h"

#include "tools/session.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <utility>

#include <fmt/format.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/ostream_sink.h>

namespace pagoda::tools {
namespace {

constexpr double kBarPeriodSeconds = 0.1;    // quick enough to look alive, too slow to cost
constexpr double kLinePeriodSeconds = 10.0;  // a night's log stays readable
constexpr int kBarWidth = 24;                // with numbers about it the line fits 100 columns

std::string formatUnits(double amount, std::string_view unit) {
    const auto whole = static_cast<uint64_t>(std::llround(std::max(amount, 0.0)));
    if (unit == "bytes" || unit == "B") return formatBytes(whole);
    if (amount >= 1e9) return fmt::format("{:.2f} G {}", amount / 1e9, unit);
    if (amount >= 1e6) return fmt::format("{:.2f} M {}", amount / 1e6, unit);
    return fmt::format("{} {}", formatCount(whole), unit);
}

std::string formatRate(double units, std::string_view unit, double seconds) {
    return seconds > 0 ? ", " + formatUnits(units / seconds, unit) + "/s" : std::string();
}

double steadySeconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace

std::string formatDuration(double seconds) {
    if (seconds < 59.95) return fmt::format("{:.1f} s", std::max(seconds, 0.0));
    const auto whole = static_cast<uint64_t>(std::llround(seconds));
    if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
    return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

std::string progressDetail(uint64_t doneUnits, uint64_t totalUnits, std::string_view unit,
                           double seconds) {
    const auto done = static_cast<double>(doneUnits);
    const std::string rate = formatRate(done, unit, seconds);
    if (totalUnits == 0) return formatUnits(done, unit) + rate;
    const auto total = static_cast<double>(totalUnits);
    std::string text = formatUnits(done, unit) + " of " + formatUnits(total, unit) + rate;
    if (doneUnits > 0 && doneUnits < totalUnits && seconds > 0) {
        text += fmt::format(", {} left", formatDuration(seconds * (total - done) / done));
    }
    return text;
}

std::string progressLine(std::string_view stage, uint64_t doneUnits, uint64_t totalUnits,
                         std::string_view unit, double seconds) {
    const std::string detail = progressDetail(doneUnits, totalUnits, unit, seconds);
    if (totalUnits == 0) return fmt::format("{} {}", stage, detail);
    const double part =
        std::clamp(static_cast<double>(doneUnits) / static_cast<double>(totalUnits), 0.0, 1.0);
    const int filled = static_cast<int>(part * kBarWidth);
    return fmt::format("{} {:3.0f}% [{:#<{}}{:{}}] {}", stage, std::floor(part * 100.0), "", filled,
                       "", kBarWidth - filled, detail);
}

ConsoleProgress::ConsoleProgress(std::ostream& out, ProgressStyle style,
                                 std::function<double()> nowSeconds)
    : style_(style), nowSeconds_(std::move(nowSeconds)), out_(out) {
    auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(out, true);
    logger_ = std::make_shared<spdlog::logger>("pagoda", std::move(sink));
    logger_->set_pattern("%v");
}

ConsoleProgress::~ConsoleProgress() {
    const std::scoped_lock lock(outputMutex_);
    eraseBar();
}

void ConsoleProgress::beginStage(std::string_view name, uint64_t totalUnits,
                                 std::string_view unit) {
    if (style_ == ProgressStyle::Silent) return;
    const std::scoped_lock lock(outputMutex_);
    endStage();
    stage_ = name;
    unit_ = unit;
    totalUnits_ = totalUnits;
    beginSeconds_ = nowSeconds_();
    doneUnits_.store(0, std::memory_order_relaxed);
    const double period = style_ == ProgressStyle::Bar ? kBarPeriodSeconds : kLinePeriodSeconds;
    nextDrawSeconds_.store(beginSeconds_ + period, std::memory_order_relaxed);
    if (style_ == ProgressStyle::Bar) drawBar(beginSeconds_);
}

void ConsoleProgress::advance(uint64_t units) {
    if (style_ == ProgressStyle::Silent) return;
    doneUnits_.fetch_add(units, std::memory_order_relaxed);
    const double now = nowSeconds_();
    if (now < nextDrawSeconds_.load(std::memory_order_relaxed)) return;
    const std::unique_lock lock(outputMutex_, std::try_to_lock);
    if (!lock.owns_lock() || stage_.empty()) return;  // someone else is drawing
    if (style_ == ProgressStyle::Bar) {
        drawBar(now);
        nextDrawSeconds_.store(now + kBarPeriodSeconds, std::memory_order_relaxed);
    } else {
        logger_->info(progressLine(stage_, doneUnits_.load(std::memory_order_relaxed), totalUnits_,
                                   unit_, now - beginSeconds_));
        nextDrawSeconds_.store(now + kLinePeriodSeconds, std::memory_order_relaxed);
    }
}

void ConsoleProgress::note(std::string_view line) {
    log("", line);
}
void ConsoleProgress::warn(std::string_view line) {
    log("warning: ", line);
}

void ConsoleProgress::finish() {
    const std::scoped_lock lock(outputMutex_);
    endStage();
}

void ConsoleProgress::log(std::string_view prefix, std::string_view line) {
    if (style_ == ProgressStyle::Silent) return;
    const std::scoped_lock lock(outputMutex_);
    const bool wasBarShown = isBarShown_;
    eraseBar();
    logger_->info("{}{}", prefix, line);
    if (wasBarShown) drawBar(nowSeconds_());
}

void ConsoleProgress::endStage() {
    if (stage_.empty()) return;
    const double seconds = nowSeconds_() - beginSeconds_;
    const auto done = static_cast<double>(doneUnits_.load(std::memory_order_relaxed));
    eraseBar();
    if (done > 0) {
        logger_->info("{}: {} in {}{}", stage_, formatUnits(done, unit_), formatDuration(seconds),
                      formatRate(done, unit_, seconds));
    } else {
        logger_->info("{}: {}", stage_, formatDuration(seconds));
    }
    stage_.clear();
}

void ConsoleProgress::drawBar(double nowSeconds) {
    // Carriage return, the line, and what an earlier, longer line left behind cleared.
    out_ << '\r'
         << progressLine(stage_, doneUnits_.load(std::memory_order_relaxed), totalUnits_, unit_,
                         nowSeconds - beginSeconds_)
         << "\x1b[K" << std::flush;
    isBarShown_ = true;
}

void ConsoleProgress::eraseBar() {
    if (!isBarShown_) return;
    out_ << "\r\x1b[K" << std::flush;
    isBarShown_ = false;
}

std::unique_ptr<ConsoleProgress> makeStderrProgress(bool quiet) {
    ProgressStyle style = ProgressStyle::Silent;
    if (!quiet) style = isatty(STDERR_FILENO) ? ProgressStyle::Bar : ProgressStyle::Lines;
    return std::make_unique<ConsoleProgress>(std::cerr, style, steadySeconds);
}

}  // namespace pagoda::tools
