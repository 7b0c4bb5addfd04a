// How fast pages come from a cold disk through Pagoda's reading path, against plain preads of the
// same ranges, as many at a time. The file's pages are dropped from the page cache before every
// run; plain and Pagoda's runs take turns, so that a disk that gets slower does so for both.
//
//   pagoda_cold_reads DB.pagoda [PAIRS [DEPTH]]      (30 pairs, 2 reads at a time)
//
// DEPTH threads read, here and there: so many reads are the disk's at a time. Pagoda's queue in
// front of them holds as many as RequestQueue lets in flight.
//
// Prints Markdown: the median ratio of throughputs and its 95% interval (of order statistics, no
// distribution assumed), for pages alone in random order and for neighbours joined as RequestQueue
// joins them; read and verified, and decoded too.
#include "cache/page_source.h"
#include "cache/request_queue.h"
#include "cache/thread_loads.h"
#include "ooc/base/error.h"
#include "ooc/base/hash.h"
#include "ooc/store/database.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace pagoda::tools {
namespace {

using Read = std::vector<cache::LoadItem>;  // one pread, as LoadQueue::send() takes it

// Reads and verifies, and leaves the decoding out.
class UndecodedSource final : public cache::PageSource {
public:
    explicit UndecodedSource(const ooc::Database& database) : whole_(database) {}
    std::string read(uint64_t offset, std::span<std::byte> out) const override {
        return whole_.read(offset, out);
    }
    ooc::Loaded<ooc::Page> decodePage(const ooc::NodeRecord& node,
                                      std::span<const std::byte> bytes) const override {
        if (hash64(bytes) != node.pageChecksum) return {{}, "checksum differs"};
        return {ooc::Page{}, {}};
    }
    uint32_t blockCount() const override { return whole_.blockCount(); }
    cache::ByteRange blockRange(uint32_t block) const override { return whole_.blockRange(block); }
    ooc::Loaded<ooc::IndexBlock> decodeBlock(uint32_t block,
                                             std::span<const std::byte> bytes) const override {
        return whole_.decodeBlock(block, bytes);
    }

private:
    cache::DatabaseSource whole_;
};

double cpuSeconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

struct Run {
    double wallS = 0, cpuS = 0;
};
template <typename Work>
Run timed(Work&& work) {
    const double cpuS = cpuSeconds();
    const auto begin = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
    return {wall.count(), cpuSeconds() - cpuS};
}

// ---- What is read

uint64_t bytesOf(const Read& read) {
    return read.back().range.end() - read.front().range.offset;
}

std::vector<Read> pagesOf(const ooc::Database& database) {
    std::vector<Read> reads;
    ooc::forEachNode(
        database,
        [&](const ooc::NodeRecord& node, ooc::NodeRef) {
            cache::LoadItem item;
            item.ticket = reads.size() + 1;
            item.range = cache::pageRange(node);
            item.node = node;
            reads.push_back({item});
            return true;
        },
        [&](uint32_t block, const std::string& why) {
            throw Error(database.path(), fmt::format("index block {}", block), why, "build anew");
        });
    return reads;
}

std::vector<Read> joined(std::vector<Read> pages) {
    std::sort(pages.begin(), pages.end(), [](const Read& a, const Read& b) {
        return a.front().range.offset < b.front().range.offset;
    });
    const cache::RequestQueue::Limits limits;
    std::vector<Read> reads;
    for (Read& page : pages) {
        const cache::ByteRange& range = page.front().range;
        const bool joins = !reads.empty() &&
                           range.offset - reads.back().back().range.end() <= limits.joinGapBytes &&
                           range.end() - reads.back().front().range.offset <= limits.readBytes;
        if (!joins) reads.emplace_back();
        reads.back().push_back(page.front());
    }
    return reads;
}

// ---- Runs

// Drops the file from the page cache; the share of it that stayed.
double dropCaches(const ooc::Database& database) {
    const int descriptor = database.file().descriptor();
    fdatasync(descriptor);
    posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED);
    const size_t bytes = database.file().sizeBytes();
    void* map = mmap(nullptr, bytes, PROT_READ, MAP_SHARED, descriptor, 0);
    if (map == MAP_FAILED) return 1;
    std::vector<unsigned char> pages((bytes + 4095) / 4096);
    const bool isKnown = mincore(map, bytes, pages.data()) == 0;
    munmap(map, bytes);
    const auto kept = std::count_if(pages.begin(), pages.end(), [](auto page) { return page & 1; });
    return isKnown ? static_cast<double>(kept) / static_cast<double>(pages.size()) : 1;
}

void readPlainly(const ooc::Database& database, const std::vector<Read>& reads, size_t depth) {
    std::atomic<size_t> next = 0;
    std::atomic<bool> isGood = true;
    std::vector<std::thread> threads;
    for (size_t i = 0; i < depth; ++i) {
        threads.emplace_back([&] {
            std::vector<std::byte> buffer;
            for (size_t read = next++; read < reads.size(); read = next++) {
                buffer.resize(std::max<size_t>(buffer.size(), bytesOf(reads[read])));
                const auto offset = static_cast<off_t>(reads[read].front().range.offset);
                const size_t bytes = bytesOf(reads[read]);
                const ssize_t got =
                    pread(database.file().descriptor(), buffer.data(), bytes, offset);
                if (got != static_cast<ssize_t>(bytes)) isGood = false;
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    if (!isGood) throw Error(database.path(), "", "a plain read failed or was short", "try again");
}

// As RequestQueue does it: another read is sent for each that is done.
void readThrough(cache::LoadQueue& loads, std::vector<Read> reads, size_t depth) {
    const size_t inFlight = std::max(cache::RequestQueue::Limits{}.readsInFlight, 2 * depth);
    size_t sent = 0, items = 0, arrivedItems = 0;
    std::vector<cache::LoadResult> arrived;
    while (arrivedItems < items || sent < reads.size()) {
        while (sent < reads.size() && loads.readsInFlight() < inFlight) {
            items += reads[sent].size();
            loads.send(std::move(reads[sent++]));
        }
        static_cast<void>(loads.waitForArrival());
        arrived.clear();
        loads.collect(arrived);
        arrivedItems += arrived.size();
        for (const cache::LoadResult& result : arrived) {
            if (!result.page) throw Error("", "", "a page failed: " + result.fault, "verify");
        }
    }
}

// ---- Statistics

struct Interval {
    double median = 0, low = 0, high = 0;
};

// Ranks k and n+1-k with the largest k for which both tails of Binomial(n, 1/2) hold <= 5%.
Interval medianInterval(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const size_t n = values.size();
    double tail = 0, term = std::pow(0.5, static_cast<double>(n));
    size_t k = 0;
    while (k < n / 2 && tail + term <= 0.025) {
        tail += term;
        term *= static_cast<double>(n - k) / static_cast<double>(k + 1);
        ++k;
    }
    const size_t low = k > 0 ? k - 1 : 0;
    return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values[low], values[n - 1 - low]};
}

struct Way {
    std::string name;
    cache::PageSource* source;
    std::vector<double> ratios, walls, cpus;
};

// The greatest share of the file that stayed in memory before a run.
double measure(const ooc::Database& database, const std::string& what,
               const std::vector<Read>& reads, size_t pairs, size_t depth) {
    UndecodedSource undecoded(database);
    cache::DatabaseSource whole(database);
    std::vector<Way> ways{{"read and verify", &undecoded, {}, {}, {}},
                          {"read, verify, decode", &whole, {}, {}, {}}};
    std::vector<double> plainWalls, plainCpus;
    double bytes = 0, kept = 0;
    for (const Read& read : reads) bytes += static_cast<double>(bytesOf(read));
    for (size_t pair = 0; pair < pairs; ++pair) {
        for (Way& way : ways) {
            Run plain, through;
            const auto runPlain = [&] {
                kept = std::max(kept, dropCaches(database));
                plain = timed([&] { readPlainly(database, reads, depth); });
            };
            const auto runThrough = [&] {
                kept = std::max(kept, dropCaches(database));
                std::vector<Read> own = reads;
                through = timed([&] {
                    cache::ThreadLoads loads({way.source}, depth);
                    readThrough(loads, std::move(own), depth);
                });
            };
            if (pair % 2 == 0) runPlain();
            runThrough();
            if (pair % 2 != 0) runPlain();
            way.ratios.push_back(plain.wallS / through.wallS);
            way.walls.push_back(through.wallS);
            way.cpus.push_back(through.cpuS);
            plainWalls.push_back(plain.wallS);
            plainCpus.push_back(plain.cpuS);
        }
    }
    const auto row = [&](const std::string& name, const std::vector<double>& walls,
                         const std::vector<double>& cpus, const std::string& ratio) {
        fmt::print("| {} | {} | {:.0f} | {:.3f} | {} |\n", what, name,
                   bytes / 1e6 / medianInterval(walls).median, medianInterval(cpus).median, ratio);
    };
    row("plain preads", plainWalls, plainCpus, "1");
    for (const Way& way : ways) {
        const Interval ratio = medianInterval(way.ratios);
        row(way.name, way.walls, way.cpus,
            fmt::format("{:.2f} [{:.2f}, {:.2f}]", ratio.median, ratio.low, ratio.high));
    }
    return kept;
}

size_t numberAt(int argc, char** argv, int index, size_t fallback) {
    if (index >= argc) return fallback;
    size_t value = 0;
    const char* end = argv[index] + std::strlen(argv[index]);
    const auto [stop, error] = std::from_chars(argv[index], end, value);
    if (error != std::errc{} || stop != end || value == 0) {
        throw Error("", "", fmt::format("'{}' is no number above 0", argv[index]), "give one");
    }
    return value;
}

void run(int argc, char** argv) {
    if (argc < 2) throw Error("", "", "no database given", "pagoda_cold_reads DB [PAIRS [DEPTH]]");
    const ooc::Database database = ooc::Database::open(argv[1]);
    const size_t pairs = numberAt(argc, argv, 2, 30), depth = numberAt(argc, argv, 3, 2);
    std::vector<Read> pages = pagesOf(database);
    const std::vector<Read> runs = joined(pages);
    std::shuffle(pages.begin(), pages.end(), std::mt19937_64(1));
    fmt::print("{} pages in {} joined reads; {} pairs, {} reads at a time, {} cores\n\n",
               pages.size(), runs.size(), pairs, depth, std::thread::hardware_concurrency());
    fmt::print("| ranges | way | MB/s | CPU s | throughput against plain [95%] |\n");
    fmt::print("|---|---|---|---|---|\n");
    const double kept = std::max(measure(database, "pages alone, any order", pages, pairs, depth),
                                 measure(database, "joined, by offset", runs, pairs, depth));
    fmt::print("\nAt most {:.2f}% of the file was in memory before a run.\n", 100 * kept);
}

}  // namespace
}  // namespace pagoda::tools

int main(int argc, char** argv) {
    try {
        pagoda::tools::run(argc, argv);
        return 0;
    } catch (const pagoda::Error& error) {
        fmt::print(stderr, "pagoda_cold_reads: {}\n", error.what());
        return 1;
    }
}
