// inline_loads.h: loads at once, on the calling thread: what is sent has arrived.
#pragma once

#include "cache/thread_loads.h"

#include <utility>
#include <vector>

namespace pagoda::test {

class InlineLoads final : public cache::LoadQueue {
public:
    explicit InlineLoads(const cache::PageSource& source) : source_(source) {}
    void send(std::vector<cache::LoadItem> items) override {
        for (const cache::LoadItem& item : items) {
            std::vector<std::byte> bytes(item.range.bytes);
            std::string fault = source_.read(item.range.offset, bytes);
            arrived_.push_back(fault.empty()
                                   ? cache::decodeItem(source_, item, bytes)
                                   : cache::LoadResult{item.ticket, {}, {}, std::move(fault)});
        }
    }
    void collect(std::vector<cache::LoadResult>& arrived) override {
        for (cache::LoadResult& result : arrived_) arrived.push_back(std::move(result));
        arrived_.clear();
    }
    bool waitForArrival() override { return !arrived_.empty(); }
    size_t readsInFlight() const override { return 0; }

private:
    const cache::PageSource& source_;
    std::vector<cache::LoadResult> arrived_;
};

}  // namespace pagoda::test
