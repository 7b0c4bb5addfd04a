#include "ooc/store/object_tree.h"

namespace pagoda::ooc {
namespace {

// Is each object from `first` on below `ancestor`, or that itself? Parents come before children.
std::vector<bool> familyOf(const ObjectTree& tree, uint32_t ancestor) {
    std::vector<bool> isMember(tree.size() - ancestor, false);
    isMember[0] = true;
    for (uint32_t object = ancestor + 1; object < tree.size(); ++object) {
        const uint32_t parent = tree.parent(object);
        isMember[object - ancestor] =
            parent != kNoObject && parent >= ancestor && isMember[parent - ancestor];
    }
    return isMember;
}

}  // namespace

void ObjectTree::append(std::span<const uint32_t> parents) {
    for (const uint32_t stated : parents) {
        const uint32_t parent = stated < size() ? stated : kNoObject;
        parents_.push_back(parent);
        isParent_.push_back(false);
        if (parent != kNoObject) isParent_[parent] = true;
    }
}

void ObjectTree::childrenOf(uint32_t object, uint32_t first,
                            std::vector<uint32_t>& children) const {
    for (uint32_t child = first; child < size(); ++child) {
        if (parents_[child] == object) children.push_back(child);
    }
}

uint64_t ObjectTree::memoryBytes() const noexcept {
    return parents_.capacity() * sizeof(uint32_t) + isParent_.capacity() / 8;
}

void ObjectSet::insert(uint32_t object) {
    if (object >= bits_.size() || bits_[object]) return;
    bits_[object] = true;
    ++count_;
}

void ObjectSet::erase(uint32_t object) {
    if (!contains(object)) return;
    bits_[object] = false;
    --count_;
}

void ObjectSet::clear() {
    bits_.assign(bits_.size(), false);
    count_ = 0;
}

void ObjectSet::insertFamily(const ObjectTree& tree, uint32_t object) {
    if (object >= tree.size()) return;
    const std::vector<bool> isMember = familyOf(tree, object);
    for (uint32_t i = 0; i < isMember.size(); ++i) {
        if (isMember[i]) insert(object + i);
    }
}

void ObjectSet::eraseFamily(const ObjectTree& tree, uint32_t object) {
    if (object >= tree.size()) return;
    const std::vector<bool> isMember = familyOf(tree, object);
    for (uint32_t i = 0; i < isMember.size(); ++i) {
        if (isMember[i]) erase(object + i);
    }
    for (uint32_t above = tree.parent(object); above != kNoObject; above = tree.parent(above)) {
        erase(above);
    }
}

void ObjectSet::insertAllBut(const ObjectTree& tree, uint32_t object) {
    for (uint32_t other = 0; other < objectCount(); ++other) insert(other);
    eraseFamily(tree, object);
}

}  // namespace pagoda::ooc
