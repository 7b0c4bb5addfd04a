// progress.h: how long work says how far it is, and how it learns that it should stop.
#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>

namespace pagoda {

// Injected; called from any thread. The default says nothing and never stops.
class Progress {
public:
    virtual ~Progress() = default;

    // A new stage of `totalUnits` (0: not known) begins; units are named for the reader.
    virtual void beginStage(std::string_view name, uint64_t totalUnits, std::string_view unit);
    virtual void advance(uint64_t units);
    // One line for the user (a decision taken, something dropped).
    virtual void note(std::string_view line);
    virtual void warn(std::string_view line);

    // Asks the work to end at its next check(). Safe in a signal handler.
    void requestStop() noexcept { stop_.store(true, std::memory_order_relaxed); }
    // Throws Interrupted after requestStop(). Cheap: call it once a batch.
    void check() const;

private:
    std::atomic<bool> stop_{false};
};

}  // namespace pagoda
