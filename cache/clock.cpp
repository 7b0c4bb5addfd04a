#include "cache/clock.h"

#include <chrono>
#include <thread>

namespace pagoda::cache {

double WallClock::nowS() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

void WallClock::waitUntil(double timeS) {
    const double restS = timeS - nowS();
    if (restS > 0) std::this_thread::sleep_for(std::chrono::duration<double>(restS));
}

}  // namespace pagoda::cache
