#include "ooc/store/object_reader.h"

#include "ooc/store/layout.h"

#include <algorithm>
#include <utility>

namespace pagoda::ooc {
namespace {

constexpr size_t kKeptBlocks = 4;

std::string inSmallLetters(std::string text) {
    for (char& c : text) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return text;
}

}  // namespace

ObjectReader::ObjectReader(const Database& database, std::function<void()> wake)
    : database_(database),
      wake_(std::move(wake)),
      objectCount_(database.header().objectCount),
      isFaultTold_(database.objectBlockCount(), false),
      thread_([this] { work(); }) {
}

ObjectReader::~ObjectReader() {
    {
        const std::lock_guard lock(workMutex_);
        isStopping_ = true;
    }
    hasWork_.notify_all();
    thread_.join();
}

bool ObjectReader::update() {
    Arrivals arrived;
    {
        const std::lock_guard lock(workMutex_);
        std::swap(arrived, arrivals_);
    }
    tree_.append(arrived.parents);
    if (records_.size() + arrived.records.size() > kMaxKeptRecords) records_.clear();
    for (auto& [object, record] : arrived.records) records_[object] = std::move(record);
    std::move(arrived.matches.begin(), arrived.matches.end(), std::back_inserter(matches_));
    std::move(arrived.faults.begin(), arrived.faults.end(), std::back_inserter(faults_));
    if (arrived.searchedShare) {
        searchedShare_ = *arrived.searchedShare;
        isSearching_ = searchedShare_ < 1.0;
    }
    if (arrived.box) {
        visibleBox_ = *arrived.box;
        isBoxPending_ = false;
    }
    return !arrived.parents.empty() || !arrived.records.empty() || arrived.searchedShare ||
           arrived.box || !arrived.faults.empty();
}

void ObjectReader::wantTree() {
    if (hasTooManyForTree()) return;
    {
        const std::lock_guard lock(workMutex_);
        if (nextTreeBlock_) return;
        nextTreeBlock_ = 0;
    }
    hasWork_.notify_one();
}

const ObjectRecord* ObjectReader::record(uint32_t object) {
    if (const auto found = records_.find(object); found != records_.end()) return &found->second;
    if (object >= objectCount_) return nullptr;
    {
        const std::lock_guard lock(workMutex_);
        wanted_.insert(object);
    }
    hasWork_.notify_one();
    return nullptr;
}

void ObjectReader::search(const std::string& text) {
    matches_.clear();
    isSearching_ = !text.empty() && objectCount_ > 0;
    searchedShare_ = 0.0;
    {
        const std::lock_guard lock(workMutex_);
        ++searchNumber_;
        arrivals_.matches.clear();
        arrivals_.searchedShare.reset();
        search_.reset();
        if (isSearching_) {
            SearchTask task;
            task.text = inSmallLetters(text);
            search_ = std::move(task);
        }
    }
    hasWork_.notify_one();
}

void ObjectReader::wantVisibleBox(std::shared_ptr<const ObjectSet> hidden) {
    visibleBox_.reset();
    isBoxPending_ = hidden && !hidden->isEmpty();
    {
        const std::lock_guard lock(workMutex_);
        ++boxNumber_;
        arrivals_.box.reset();
        box_.reset();
        if (hidden && !hidden->isEmpty()) {
            BoxTask task;
            task.hidden = std::move(hidden);
            box_ = std::move(task);
        }
    }
    hasWork_.notify_one();
}

bool ObjectReader::hasWork() const {
    const bool isTreeMissing = nextTreeBlock_ && *nextTreeBlock_ < database_.objectBlockCount();
    return isStopping_ || !wanted_.empty() || search_ || box_ || isTreeMissing;
}

void ObjectReader::work() {
    std::unique_lock lock(workMutex_);
    while (true) {
        hasWork_.wait(lock, [this] { return hasWork(); });
        if (isStopping_) return;
        step(lock);
        lock.unlock();
        wake_();
        lock.lock();
    }
}

void ObjectReader::step(std::unique_lock<std::mutex>& lock) {
    if (!wanted_.empty()) return readRecords(lock);
    if (search_) return searchBlock(lock);
    if (box_) return boundBlock(lock);
    appendBlock(lock);
}

ObjectReader::Block ObjectReader::read(std::unique_lock<std::mutex>& lock, uint32_t block) {
    const auto kept = std::find_if(lastBlocks_.begin(), lastBlocks_.end(),
                                   [&](const auto& item) { return item.first == block; });
    if (kept != lastBlocks_.end()) {
        std::rotate(kept, kept + 1, lastBlocks_.end());
        return lastBlocks_.back().second;
    }
    lock.unlock();
    Block records;
    std::string fault;
    try {
        auto loaded = database_.readObjectBlock(block);
        fault = loaded.fault;
        if (loaded.value) {
            records = std::make_shared<const std::vector<ObjectRecord>>(std::move(*loaded.value));
        }
    } catch (const std::exception& error) {  // memory may be short
        fault = error.what();
    }
    lock.lock();
    if (!records && !isFaultTold_[block]) {
        isFaultTold_[block] = true;
        arrivals_.faults.push_back("object block " + std::to_string(block) + ": " + fault);
    }
    if (lastBlocks_.size() == kKeptBlocks) lastBlocks_.erase(lastBlocks_.begin());
    lastBlocks_.emplace_back(block, records);
    return records;
}

void ObjectReader::readRecords(std::unique_lock<std::mutex>& lock) {
    const uint32_t block = *wanted_.begin() / kObjectsPerBlock;
    const Block records = read(lock, block);
    for (auto object = wanted_.begin(); object != wanted_.end();) {
        if (*object / kObjectsPerBlock != block) {
            ++object;
            continue;
        }
        ObjectRecord broken;
        broken.name = "(its name cannot be read)";
        arrivals_.records[*object] = records ? (*records)[*object % kObjectsPerBlock] : broken;
        object = wanted_.erase(object);
    }
}

void ObjectReader::searchBlock(std::unique_lock<std::mutex>& lock) {
    const uint64_t number = searchNumber_;
    const uint32_t block = search_->nextBlock;
    const std::string text = search_->text;
    uint32_t found = search_->found;
    const Block records = read(lock, block);
    lock.unlock();
    std::vector<ObjectMatch> matches;
    for (uint32_t i = 0; records && i < records->size() && found < kMaxMatches; ++i) {
        const std::string& name = (*records)[i].name;
        if (inSmallLetters(name).find(text) == std::string::npos) continue;
        matches.push_back({block * kObjectsPerBlock + i, name});
        ++found;
    }
    lock.lock();
    if (number != searchNumber_) return;  // another one was begun meanwhile
    std::move(matches.begin(), matches.end(), std::back_inserter(arrivals_.matches));
    search_->found = found;
    const uint32_t blocks = database_.objectBlockCount();
    const bool isDone = ++search_->nextBlock == blocks || found == kMaxMatches;
    arrivals_.searchedShare = isDone ? 1.0 : static_cast<double>(search_->nextBlock) / blocks;
    if (isDone) search_.reset();
}

// Blocks of hidden objects alone are not read.
void ObjectReader::boundBlock(std::unique_lock<std::mutex>& lock) {
    const uint64_t number = boxNumber_;
    const uint32_t blocks = database_.objectBlockCount();
    const auto hidden = box_->hidden;
    const auto isShown = [&](uint64_t object) {
        return !hidden->contains(static_cast<uint32_t>(object));
    };
    const uint32_t block = box_->nextBlock;
    const uint64_t first = uint64_t{block} * kObjectsPerBlock;
    const uint64_t end = std::min<uint64_t>(first + kObjectsPerBlock, objectCount_);
    bool isAnyShown = false;
    for (uint64_t object = first; object < end && !isAnyShown; ++object) {
        isAnyShown = isShown(object);
    }
    Box3i box;
    bool isKnown = true;
    if (isAnyShown) {
        const Block records = read(lock, block);
        isKnown = records != nullptr;
        for (size_t i = 0; records && i < records->size(); ++i) {
            const ObjectRecord& record = (*records)[i];
            if (record.triangleCount > 0 && isShown(first + i)) box.extend(record.box);
        }
    }
    if (number != boxNumber_) return;
    box_->box.extend(box);
    box_->isKnown = box_->isKnown && isKnown;
    if (++box_->nextBlock < blocks) return;
    const Box3i& whole = box_->box;
    if (box_->isKnown) {
        // Without a triangle: a box that meets nothing.
        arrivals_.box = whole.isEmpty() ? Box3d() : database_.header().lattice.toModel(whole);
    } else {
        arrivals_.box = std::optional<Box3d>();
    }
    box_.reset();
}

void ObjectReader::appendBlock(std::unique_lock<std::mutex>& lock) {
    const uint32_t block = *nextTreeBlock_;
    const Block records = read(lock, block);
    const uint64_t first = uint64_t{block} * kObjectsPerBlock;
    const auto count =
        static_cast<uint32_t>(std::min<uint64_t>(objectCount_ - first, kObjectsPerBlock));
    for (uint32_t i = 0; i < count; ++i) {
        arrivals_.parents.push_back(records ? (*records)[i].parent : kNoObject);
    }
    nextTreeBlock_ = block + 1;
}

}  // namespace pagoda::ooc
