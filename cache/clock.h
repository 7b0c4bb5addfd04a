// clock.h: the time that waiting and retrying go by. Injected, so that tests and simulated disks
// play any order of events, and a scenario of minutes runs in seconds, identically each time.
#pragma once

namespace pagoda::cache {

class Clock {
public:
    virtual ~Clock() = default;
    // Seconds since some beginning; never goes back. Any thread.
    [[nodiscard]] virtual double nowS() const = 0;
    // Returns when nowS() >= `timeS`: sleeps, or moves a clock that is driven by hand.
    virtual void waitUntil(double timeS) = 0;
    // Does time stand still between calls? Then whoever waits may finish other work first.
    [[nodiscard]] virtual bool isManual() const = 0;
};

class WallClock final : public Clock {
public:
    [[nodiscard]] double nowS() const override;
    void waitUntil(double timeS) override;
    [[nodiscard]] bool isManual() const override { return false; }
};

// Moves only when told to. One thread.
class ManualClock final : public Clock {
public:
    [[nodiscard]] double nowS() const override { return nowS_; }
    void waitUntil(double timeS) override {
        if (timeS > nowS_) nowS_ = timeS;
    }
    [[nodiscard]] bool isManual() const override { return true; }
    void advance(double seconds) { nowS_ += seconds; }

private:
    double nowS_ = 0.0;
};

}  // namespace pagoda::cache
