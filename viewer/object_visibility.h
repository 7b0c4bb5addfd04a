// object_visibility.h: which objects of a database are hidden, and how many. Changes by families
// wait until the tree is known. Main thread only.
#pragma once

#include "hlod/view/clip.h"
#include "ooc/store/object_reader.h"

#include <memory>
#include <vector>

namespace pagoda::viewer {

class ObjectVisibility {
public:
    // `objects` outlives it.
    explicit ObjectVisibility(ooc::ObjectReader& objects) : objects_(objects) {}

    // False where there are too many objects for a tree: then the next three do nothing.
    [[nodiscard]] bool canHide() const noexcept { return !objects_.hasTooManyForTree(); }
    // An object and all below it.
    void hide(uint32_t object) { want({Kind::Hide, object}); }
    void show(uint32_t object) { want({Kind::Show, object}); }
    void isolate(uint32_t object) { want({Kind::Isolate, object}); }
    void showAll();

    // Once a step: carries out what waited. True when the set has changed, or more is known of it.
    bool update();
    [[nodiscard]] bool isWaiting() const noexcept { return !waiting_.empty(); }

    [[nodiscard]] bool isHidden(uint32_t object) const {
        return hidden_ && hidden_->contains(object);
    }
    [[nodiscard]] uint32_t hiddenCount() const noexcept { return hidden_ ? hidden_->count() : 0; }
    // What of a view's clip comes from here: the set, and the box of all that is not in it once
    // that is known.
    void addTo(hlod::Clip& clip) const;

private:
    enum class Kind { Hide, Show, Isolate };
    struct Wish {
        Kind kind;
        uint32_t object;
    };
    void want(Wish wish);

    ooc::ObjectReader& objects_;
    std::vector<Wish> waiting_;
    std::shared_ptr<const ooc::ObjectSet> hidden_;  // null: none
    bool isBoxKnown_ = true, hasChanged_ = false;
};

}  // namespace pagoda::viewer
