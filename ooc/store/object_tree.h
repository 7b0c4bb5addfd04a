// object_tree.h: which object of a database lies below which, and sets of objects. Gathered block
// by block, so that nothing has to be known at once: 4 bytes and a bit an object, no names (who
// shows an object asks the table for its record). One thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace pagoda::ooc {

inline constexpr uint32_t kNoObject = UINT32_MAX;

class ObjectTree {
public:
    // The parents of the next objects in order; kNoObject, or no smaller number than the object's
    // own: none.
    void append(std::span<const uint32_t> parents);

    // Objects 0 .. size() - 1 are known so far.
    [[nodiscard]] uint32_t size() const noexcept { return static_cast<uint32_t>(parents_.size()); }
    [[nodiscard]] uint32_t parent(uint32_t object) const { return parents_[object]; }
    // Among the objects known so far.
    [[nodiscard]] bool hasChildren(uint32_t object) const { return isParent_[object]; }
    // In rising order, from `first` on; of kNoObject: those without a parent. O(size()).
    void childrenOf(uint32_t object, uint32_t first, std::vector<uint32_t>& children) const;
    [[nodiscard]] uint64_t memoryBytes() const noexcept;

private:
    std::vector<uint32_t> parents_;
    std::vector<bool> isParent_;
};

// A bit an object.
class ObjectSet {
public:
    ObjectSet() = default;
    explicit ObjectSet(uint32_t objectCount) : bits_(objectCount, false) {}

    [[nodiscard]] bool contains(uint32_t object) const {
        return object < bits_.size() && bits_[object];
    }
    [[nodiscard]] uint32_t count() const noexcept { return count_; }
    [[nodiscard]] bool isEmpty() const noexcept { return count_ == 0; }
    [[nodiscard]] uint32_t objectCount() const noexcept {
        return static_cast<uint32_t>(bits_.size());
    }
    void insert(uint32_t object);
    void erase(uint32_t object);
    void clear();

    // The object and all below it. O(tree.size() - object).
    void insertFamily(const ObjectTree& tree, uint32_t object);
    // The same taken out, with all above it: what is below a member is one too.
    void eraseFamily(const ObjectTree& tree, uint32_t object);
    // All but the object, what is below and what is above it.
    void insertAllBut(const ObjectTree& tree, uint32_t object);

    [[nodiscard]] bool operator==(const ObjectSet&) const = default;

private:
    std::vector<bool> bits_;
    uint32_t count_ = 0;
};

}  // namespace pagoda::ooc
