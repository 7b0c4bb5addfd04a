#include "viewer/object_rows.h"

#include <algorithm>
#include <utility>

namespace pagoda::viewer {

void ObjectRows::look(const ooc::ObjectTree& tree, uint32_t object, Family& family) {
    if (family.knownUntil == tree.size()) return;
    tree.childrenOf(object, family.knownUntil, family.children);
    family.knownUntil = tree.size();
    hasChanged_ = true;
}

void ObjectRows::update(const ooc::ObjectTree& tree) {
    look(tree, ooc::kNoObject, roots_);
    for (auto& [object, family] : open_) look(tree, object, family);
    if (!hasChanged_) return;
    hasChanged_ = false;
    rows_.clear();
    struct Place {
        const Family* family;
        size_t next;
    };
    std::vector<Place> above = {{&roots_, 0}};
    while (!above.empty()) {
        Place& place = above.back();
        if (place.next == place.family->children.size()) {
            above.pop_back();
            continue;
        }
        const uint32_t object = place.family->children[place.next++];
        rows_.push_back({object, static_cast<uint32_t>(above.size() - 1)});
        if (const auto found = open_.find(object); found != open_.end()) {
            above.push_back({&found->second, 0});
        }
    }
}

void ObjectRows::toggle(uint32_t object) {
    if (open_.erase(object) == 0) open_[object] = {};
    hasChanged_ = true;
}

void ObjectRows::reveal(const ooc::ObjectTree& tree, uint32_t object) {
    if (object >= tree.size()) return;
    for (uint32_t above = tree.parent(object); above != ooc::kNoObject;
         above = tree.parent(above)) {
        if (open_.try_emplace(above).second) hasChanged_ = true;
    }
}

size_t ObjectRows::rowOf(uint32_t object) const {
    const auto found = std::find_if(rows_.begin(), rows_.end(),
                                    [&](const ObjectRow& row) { return row.object == object; });
    return static_cast<size_t>(found - rows_.begin());
}

}  // namespace pagoda::viewer
