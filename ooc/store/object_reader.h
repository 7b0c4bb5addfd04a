// object_reader.h: reads a database's object table away from who shows it: one thread of its own,
// one block of 4096 objects at a time, so that a million objects cost nothing at open and no call
// here ever waits for a disk. All calls come from one thread (the render thread), which takes what
// has arrived in update(). Most urgent first: records that are shown, then the search, then the box
// of what is visible, then the tree. A broken block costs its names (faults()).
#pragma once

#include "ooc/store/database.h"
#include "ooc/store/object_tree.h"

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace pagoda::ooc {

struct ObjectMatch {
    uint32_t object = 0;
    std::string name;
};

class ObjectReader {
public:
    static constexpr uint32_t kMaxMatches = 10'000;
    static constexpr uint32_t kMaxKeptRecords = 8192;  // about a megabyte
    static constexpr uint64_t kMaxTreeObjects = uint64_t{1} << 26;

    // `database` outlives it. `wake` is called from its thread when update() has something new.
    ObjectReader(const Database& database, std::function<void()> wake);
    ~ObjectReader();
    ObjectReader(const ObjectReader&) = delete;
    ObjectReader& operator=(const ObjectReader&) = delete;

    // Takes what has arrived. True when there was anything.
    bool update();

    // Begins to gather the tree, once; more than kMaxTreeObjects objects get none.
    void wantTree();
    [[nodiscard]] const ObjectTree& tree() const noexcept { return tree_; }
    [[nodiscard]] bool isTreeWhole() const noexcept { return tree_.size() == objectCount_; }
    [[nodiscard]] bool hasTooManyForTree() const noexcept { return objectCount_ > kMaxTreeObjects; }

    // Null until it has been read, which is begun; valid until the next update().
    [[nodiscard]] const ObjectRecord* record(uint32_t object);

    // Finds names that hold `text`, whatever the case of ASCII letters, in the order of the table;
    // forgets the search before. Empty: none.
    void search(const std::string& text);
    [[nodiscard]] const std::vector<ObjectMatch>& matches() const noexcept { return matches_; }
    [[nodiscard]] bool isSearching() const noexcept { return isSearching_; }
    [[nodiscard]] double searchedShare() const noexcept { return searchedShare_; }  // in [0, 1]

    // Asks for the box, model units, of all triangles of objects outside of `hidden`; forgets what
    // was asked before. An upper bound where blocks are broken: nothing is known then.
    void wantVisibleBox(std::shared_ptr<const ObjectSet> hidden);
    // Nothing until it is known.
    [[nodiscard]] const std::optional<Box3d>& visibleBox() const noexcept { return visibleBox_; }

    // Is the box that was asked for still on its way? Afterwards, without one, it cannot be known.
    [[nodiscard]] bool isBoxPending() const noexcept { return isBoxPending_; }

    [[nodiscard]] uint64_t objectCount() const noexcept { return objectCount_; }
    [[nodiscard]] const std::vector<std::string>& faults() const noexcept { return faults_; }

private:
    struct BoxTask {
        std::shared_ptr<const ObjectSet> hidden;
        uint32_t nextBlock = 0;
        Box3i box;
        bool isKnown = true;
    };
    struct SearchTask {
        std::string text;  // in small letters
        uint32_t nextBlock = 0, found = 0;
    };
    // What the thread hands over.
    struct Arrivals {
        std::unordered_map<uint32_t, ObjectRecord> records;
        std::vector<uint32_t> parents;  // of the next objects of the tree
        std::vector<ObjectMatch> matches;
        std::vector<std::string> faults;
        std::optional<double> searchedShare;
        std::optional<std::optional<Box3d>> box;
    };
    using Block = std::shared_ptr<const std::vector<ObjectRecord>>;  // null: broken

    void work();
    [[nodiscard]] bool hasWork() const;  // with the mutex held, as all below
    void step(std::unique_lock<std::mutex>& lock);
    void readRecords(std::unique_lock<std::mutex>& lock);
    void searchBlock(std::unique_lock<std::mutex>& lock);
    void boundBlock(std::unique_lock<std::mutex>& lock);
    void appendBlock(std::unique_lock<std::mutex>& lock);
    // Unlocks while it reads.
    [[nodiscard]] Block read(std::unique_lock<std::mutex>& lock, uint32_t block);

    const Database& database_;
    std::function<void()> wake_;
    uint64_t objectCount_;

    // The caller's.
    ObjectTree tree_;
    std::unordered_map<uint32_t, ObjectRecord> records_;
    std::vector<ObjectMatch> matches_;
    bool isSearching_ = false;
    double searchedShare_ = 0.0;
    std::optional<Box3d> visibleBox_;
    bool isBoxPending_ = false;
    std::vector<std::string> faults_;

    std::mutex workMutex_;  // guards the members below but the thread
    std::condition_variable hasWork_;
    bool isStopping_ = false;
    std::unordered_set<uint32_t> wanted_;
    std::optional<uint32_t> nextTreeBlock_;  // nothing: no tree is wanted
    std::optional<SearchTask> search_;
    std::optional<BoxTask> box_;
    uint64_t searchNumber_ = 0, boxNumber_ = 0;  // of the last one begun
    Arrivals arrivals_;
    std::vector<std::pair<uint32_t, Block>> lastBlocks_;  // read lately, the newest last
    std::vector<bool> isFaultTold_;
    std::thread thread_;
};

}  // namespace pagoda::ooc
