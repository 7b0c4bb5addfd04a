// scattered_order.h: in which order a sample looks at a file.
// ScatteredOrder visits 0 ... count-1 once each, in an order that looks random and is the same
// every time: after any part of it what was visited lies all over the range. An even stride would
// meet the rows of a grid of vertices in step.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace pagoda::ooc {

class ScatteredOrder {
public:
    explicit ScatteredOrder(uint64_t count)  // at most 2^62
        : count_(count), bits_(static_cast<int>(std::bit_width(count | 1))) {}

    // False: all were visited.
    [[nodiscard]] bool next(uint64_t& index) {
        const uint64_t end = uint64_t{1} << bits_;
        while (step_ < end) {
            index = scattered(step_++);
            if (index < count_) return true;
        }
        return false;
    }

private:
    // Odd factors and shifted exclusive-ors can be undone within `bits_`: a permutation.
    [[nodiscard]] uint64_t scattered(uint64_t step) const {
        const uint64_t mask = (uint64_t{1} << bits_) - 1;
        const int half = bits_ / 2 + 1;
        uint64_t x = (step + 1) & mask;
        for (const uint64_t factor : {0x9E3779B97F4A7C15ull, 0xD6E8FEB86659FD93ull}) {
            x = x * factor & mask;
            x ^= x >> half;
        }
        return x;
    }

    uint64_t count_, step_ = 0;
    int bits_;
};

// Rows of a file, by blocks that one read fetches: a few rows of every block in a scattered order,
// then a few others of every block, until each row was taken once. Rows beside each other show the
// same place: far apart in their block, they are worth the read.
class BlockSample {
public:
    static constexpr uint64_t kBlockBytes = 4096;

    // The rows that a visit takes: phase, phase + stride, ... below `rows`, of those from
    // `firstRow`.
    struct Visit {
        uint64_t firstRow = 0, rows = 0, phase = 0, stride = 1;
    };

    BlockSample(uint64_t rowCount, uint64_t rowBytes)
        : rowCount_(rowCount),
          inBlock_(std::max<uint64_t>(1, kBlockBytes / rowBytes)),
          stride_(std::clamp<uint64_t>(rowCount / kRowsInPass, 1,
                                       std::max<uint64_t>(1, inBlock_ / kLeastTaken))),
          phases_(stride_),
          blocks_(blockCount()) {
        hasPhase_ = phases_.next(phase_);
    }

    // False: every row was taken.
    [[nodiscard]] bool next(Visit& visit) {
        uint64_t block = 0;
        while (hasPhase_ && !blocks_.next(block)) {
            blocks_ = ScatteredOrder(blockCount());
            hasPhase_ = rowCount_ > 0 && phases_.next(phase_);
        }
        if (!hasPhase_) return false;
        visit.firstRow = block * inBlock_;
        visit.rows = std::min(inBlock_, rowCount_ - visit.firstRow);
        visit.phase = (phase_ + block) % stride_;  // the rows of a regular mesh are not met in step
        visit.stride = stride_;
        return true;
    }

private:
    // What shows a whole model coarsely; and what makes a block of 4 KiB worth its read.
    static constexpr uint64_t kRowsInPass = 250'000, kLeastTaken = 8;

    [[nodiscard]] uint64_t blockCount() const { return (rowCount_ + inBlock_ - 1) / inBlock_; }

    uint64_t rowCount_, inBlock_, stride_;
    ScatteredOrder phases_, blocks_;
    uint64_t phase_ = 0;
    bool hasPhase_ = false;
};

}  // namespace pagoda::ooc
