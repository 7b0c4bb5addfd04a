#include "cache/thread_loads.h"

#include "ooc/codecs/mesh_codec.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <exception>
#include <iterator>
#include <string>
#include <utility>

namespace pagoda::cache {

LoadResult decodeItem(const PageSource& source, const LoadItem& item,
                      std::span<const std::byte> bytes) {
    LoadResult result;
    result.ticket = item.ticket;
    if (item.isBlock) {
        auto loaded = source.decodeBlock(item.block, bytes);
        result.block = std::move(loaded.value);
        result.fault = std::move(loaded.fault);
    } else {
        const auto begin = std::chrono::steady_clock::now();
        auto loaded = source.decodePage(item.node, bytes);
        result.decodeS =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        result.codec = ooc::meshCodecOf(bytes).value_or(ooc::Codec::Raw);
        result.page = std::move(loaded.value);
        result.fault = std::move(loaded.fault);
    }
    return result;
}

namespace {

// A sleeper is woken for what has arrived at once after so long; sooner only when work runs out.
constexpr std::chrono::microseconds kLongestBatch{500};

// Empty when done, else why not. Sizes come from a file: one that lies must not end the program.
// The buffer never shrinks: growing it again would fill it with zeros for each read.
std::string readInto(std::vector<std::byte>& buffer, const PageSource& source, uint64_t offset,
                     uint64_t bytes) {
    try {
        if (buffer.size() < bytes) buffer.resize(bytes);
        return source.read(offset, std::span(buffer).first(bytes));
    } catch (const std::exception&) {
        buffer.clear();
        return "not enough memory to read it";
    }
}

LoadResult decodeSafely(const PageSource& source, const LoadItem& item,
                        std::span<const std::byte> bytes) {
    try {
        return decodeItem(source, item, bytes);
    } catch (const std::exception&) {
        return {item.ticket, {}, {}, "not enough memory to decode it"};
    }
}

}  // namespace

ThreadLoads::ThreadLoads(std::vector<const PageSource*> sources, size_t threadCount)
    : sources_(std::move(sources)), threadCount_(std::max<size_t>(threadCount, 1)) {
    for (size_t i = 0; i < threadCount_; ++i) {
        threads_.emplace_back([this] { work(); });
    }
}

ThreadLoads::~ThreadLoads() {
    {
        const std::lock_guard lock(queueMutex_);
        isStopping_ = true;
        queue_.clear();
    }
    hasWork_.notify_all();
    for (std::thread& thread : threads_) thread.join();
}

void ThreadLoads::send(std::vector<LoadItem> items) {
    assert(!items.empty());
    {
        const std::lock_guard lock(queueMutex_);
        queue_.push_back(std::move(items));
    }
    hasWork_.notify_one();
}

void ThreadLoads::collect(std::vector<LoadResult>& arrived) {
    const std::lock_guard lock(queueMutex_);
    std::move(arrived_.begin(), arrived_.end(), std::back_inserter(arrived));
    arrived_.clear();
}

bool ThreadLoads::waitForArrival() {
    std::unique_lock lock(queueMutex_);
    waitingSince_ = Time::now();
    hasArrivals_.wait(lock,
                      [this] { return !arrived_.empty() || (queue_.empty() && reading_ == 0); });
    waitingSince_.reset();
    return !arrived_.empty();
}

// While enough reads are queued, more is about to arrive: who sleeps is woken for all of it.
bool ThreadLoads::isWorthWaking() const {
    if (!waitingSince_) return false;
    return queue_.size() <= threadCount_ / 2 || Time::now() - *waitingSince_ >= kLongestBatch;
}

size_t ThreadLoads::readsInFlight() const {
    const std::lock_guard lock(queueMutex_);
    return queue_.size() + reading_;
}

void ThreadLoads::work() {
    std::vector<std::byte> buffer;
    while (true) {
        std::vector<LoadItem> items;
        {
            std::unique_lock lock(queueMutex_);
            hasWork_.wait(lock, [this] { return isStopping_ || !queue_.empty(); });
            if (isStopping_) return;
            items = std::move(queue_.front());
            queue_.pop_front();
            ++reading_;
        }
        load(items, buffer);
    }
}

void ThreadLoads::load(const std::vector<LoadItem>& items, std::vector<std::byte>& buffer) {
    const PageSource& source = *sources_[items.front().database];
    const uint64_t begin = items.front().range.offset;
    const std::string fault = readInto(buffer, source, begin, items.back().range.end() - begin);
    for (const LoadItem& item : items) {
        LoadResult result;
        if (fault.empty()) {
            const std::span<const std::byte> whole(buffer);
            result = decodeSafely(source, item,
                                  whole.subspan(item.range.offset - begin, item.range.bytes));
        } else {
            std::vector<std::byte> alone;
            std::string own = items.size() == 1
                                  ? fault
                                  : readInto(alone, source, item.range.offset, item.range.bytes);
            result = own.empty() ? decodeSafely(source, item, alone)
                                 : LoadResult{item.ticket, {}, {}, std::move(own)};
        }
        bool doesWake = false;
        {
            const std::lock_guard lock(queueMutex_);
            arrived_.push_back(std::move(result));
            if (&item == &items.back()) --reading_;
            doesWake = isWorthWaking();
        }
        if (doesWake) hasArrivals_.notify_one();
    }
}

}  // namespace pagoda::cache
