#include "ooc/base/progress.h"

#include "ooc/base/error.h"

namespace pagoda {

void Progress::beginStage(std::string_view, uint64_t, std::string_view) {
}
void Progress::advance(uint64_t) {
}
void Progress::note(std::string_view) {
}
void Progress::warn(std::string_view) {
}

void Progress::check() const {
    if (stop_.load(std::memory_order_relaxed)) throw Interrupted();
}

}  // namespace pagoda
