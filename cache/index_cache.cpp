#include "cache/index_cache.h"

#include <algorithm>
#include <utility>

namespace pagoda::cache {

const ooc::IndexBlock* IndexCache::block(uint32_t block) {
    auto found = blocks_.find(block);
    if (found == blocks_.end()) {
        ooc::Loaded<ooc::IndexBlock> loaded = source_.loadBlock(block);
        if (!loaded.value) reportFault(block, std::move(loaded.fault));
        if (loaded.value) usedBytes_ += loaded.value->nodes.size() * sizeof(ooc::NodeRecord);
        found = blocks_.emplace(block, std::move(loaded.value)).first;
    }
    return found->second ? &*found->second : nullptr;
}

void IndexCache::reportFault(uint32_t block, std::string what) {
    const bool isKnown = std::any_of(faults_.begin(), faults_.end(), [&](const BlockFault& fault) {
        return fault.block == block && fault.what == what;
    });
    if (!isKnown) faults_.push_back({block, std::move(what)});
}

}  // namespace pagoda::cache
