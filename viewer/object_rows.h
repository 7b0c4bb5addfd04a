// object_rows.h: the rows of a tree of which some nodes are open: what a list shows, one place a
// row. 12 bytes for each row that can be scrolled to. Main thread only.
#pragma once

#include "ooc/store/object_tree.h"

#include <cstdint>
#include <map>
#include <vector>

namespace pagoda::viewer {

struct ObjectRow {
    uint32_t object = 0;
    uint32_t depth = 0;
};

class ObjectRows {
public:
    // Takes what the tree has grown by, or what was opened and closed since. O(rows) when anything
    // was, else free.
    void update(const ooc::ObjectTree& tree);
    void toggle(uint32_t object);
    // Opens all that is above it.
    void reveal(const ooc::ObjectTree& tree, uint32_t object);
    [[nodiscard]] bool isOpen(uint32_t object) const { return open_.contains(object); }
    [[nodiscard]] const std::vector<ObjectRow>& rows() const noexcept { return rows_; }
    // The row of an object, or rows().size(). O(rows).
    [[nodiscard]] size_t rowOf(uint32_t object) const;

private:
    struct Family {
        std::vector<uint32_t> children;
        uint32_t knownUntil = 0;  // objects that were looked at
    };
    void look(const ooc::ObjectTree& tree, uint32_t object, Family& family);

    std::map<uint32_t, Family> open_;  // by object
    Family roots_;
    std::vector<ObjectRow> rows_;
    bool hasChanged_ = true;
};

}  // namespace pagoda::viewer
