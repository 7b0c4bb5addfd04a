#include "cache/disk_loads.h"

#include "ooc/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace pagoda::cache {
namespace {

constexpr const char* kRemedy = "write as-is, or parts such as 100MB/s,10ms,fail=1%,short=5%";

// Splits "100MB/s" into 100 and "MB/s".
double numberOf(std::string_view part, std::string_view& unit) {
    double value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc{} || !std::isfinite(value) || value < 0) {
        throw Error("--disk", "", fmt::format("'{}' is no number with a unit", part), kRemedy);
    }
    unit = part.substr(static_cast<size_t>(end - part.data()));
    return value;
}

void parseShare(std::string_view part, double& share) {
    std::string_view unit;
    const double percent = numberOf(part.substr(part.find('=') + 1), unit);
    if (unit != "%" || percent > 100) {
        throw Error("--disk", "", fmt::format("'{}' is no share in per cent", part), kRemedy);
    }
    share = percent / 100;
}

void parsePart(std::string_view part, DiskProfile& profile) {
    if (part.starts_with("fail=")) return parseShare(part, profile.failShare);
    if (part.starts_with("short=")) return parseShare(part, profile.shortShare);
    std::string_view unit;
    const double value = numberOf(part, unit);
    if (value <= 0 && (unit == "MB/s" || unit == "Mbit/s")) {
        throw Error("--disk", "", fmt::format("'{}': nothing would ever arrive", part), kRemedy);
    }
    if (unit == "MB/s") {
        profile.bytesPerS = value * 1e6;
    } else if (unit == "Mbit/s") {
        profile.bytesPerS = value * 1e6 / 8;
    } else if (unit == "ms") {
        profile.latencyS = value * 1e-3;
    } else {
        throw Error("--disk", "", fmt::format("'{}' has no known unit", part), kRemedy);
    }
}

}  // namespace

DiskProfile parseDiskProfile(std::string_view text) {
    DiskProfile profile;
    if (text == "as-is") return profile;
    while (true) {
        const size_t comma = text.find(',');
        parsePart(text.substr(0, comma), profile);
        if (comma == std::string_view::npos) return profile;
        text.remove_prefix(comma + 1);
    }
}

DiskLoads::DiskLoads(std::unique_ptr<LoadQueue> inner, const DiskProfile& profile, Clock& clock)
    : inner_(std::move(inner)), profile_(profile), clock_(clock) {
}

void DiskLoads::setProfile(const DiskProfile& profile) {
    profile_ = profile;
    lineFreeS_ = std::min(lineFreeS_, clock_.nowS());
}

// SplitMix64 of a counter: the same sequence on every machine.
double DiskLoads::chance() {
    uint64_t z = (profile_.seed + ++draws_) * 0x9E3779B97F4A7C15ull;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

void DiskLoads::send(std::vector<LoadItem> items) {
    const uint64_t bytes = items.back().range.end() - items.front().range.offset;
    Read read;
    read.isFailed = chance() < profile_.failShare;
    const bool isShort = chance() < profile_.shortShare;
    const double transferS =
        profile_.bytesPerS > 0 ? static_cast<double>(bytes) / profile_.bytesPerS : 0;
    const double arrivalS = clock_.nowS() + profile_.latencyS * (isShort ? 2 : 1);
    read.doneS = std::max(arrivalS, lineFreeS_) + (read.isFailed ? 0 : transferS);
    if (!read.isFailed) lineFreeS_ = read.doneS;
    for (const LoadItem& item : items) read.tickets.push_back(item.ticket);

    ++counters_.reads;
    counters_.failedReads += read.isFailed;
    counters_.shortReads += isShort;
    if (!read.isFailed) {
        counters_.bytes += bytes;
        inner_->send(std::move(items));
    }
    const auto later = std::find_if(reads_.begin(), reads_.end(),
                                    [&](const Read& other) { return other.doneS > read.doneS; });
    reads_.insert(later, std::move(read));
}

bool DiskLoads::isHere(const Read& read) {
    if (read.isFailed) return true;
    scratch_.clear();
    inner_->collect(scratch_);
    for (LoadResult& result : scratch_) {
        const uint64_t ticket = result.ticket;
        ready_.emplace(ticket, std::move(result));
    }
    return std::all_of(read.tickets.begin(), read.tickets.end(),
                       [&](uint64_t ticket) { return ready_.contains(ticket); });
}

void DiskLoads::take(const Read& read, std::vector<LoadResult>& arrived) {
    for (const uint64_t ticket : read.tickets) {
        if (read.isFailed) {
            arrived.push_back({ticket, {}, {}, "simulated read failure"});
        } else {
            arrived.push_back(std::move(ready_.extract(ticket).mapped()));
        }
    }
}

void DiskLoads::collect(std::vector<LoadResult>& arrived) {
    while (!reads_.empty() && reads_.front().doneS <= clock_.nowS()) {
        const Read& read = reads_.front();
        while (!isHere(read)) {
            // While time stands still, decoding is waited for; real time goes on instead.
            if (!clock_.isManual() || !inner_->waitForArrival()) return;
        }
        take(read, arrived);
        reads_.pop_front();
    }
}

bool DiskLoads::waitForArrival() {
    if (reads_.empty()) return false;
    clock_.waitUntil(reads_.front().doneS);
    while (!isHere(reads_.front())) {
        if (!inner_->waitForArrival()) return false;
    }
    return true;
}

}  // namespace pagoda::cache
