// stopwatch.h: wall time in laps.
#pragma once

#include <chrono>

namespace pagoda::viewer {

class Stopwatch {
public:
    // Milliseconds since the last call, or the beginning.
    double lapMs() {
        const auto now = std::chrono::steady_clock::now();
        const double ms = std::chrono::duration<double, std::milli>(now - begin_).count();
        begin_ = now;
        return ms;
    }

private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace pagoda::viewer
