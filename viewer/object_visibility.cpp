#include "viewer/object_visibility.h"

namespace pagoda::viewer {

void ObjectVisibility::want(Wish wish) {
    if (!canHide()) return;                            // would wait for ever
    if (wish.kind == Kind::Isolate) waiting_.clear();  // whatever was hidden before
    waiting_.push_back(wish);
    objects_.wantTree();
}

void ObjectVisibility::showAll() {
    waiting_.clear();
    hasChanged_ = hasChanged_ || hidden_ != nullptr;
    hidden_.reset();
    objects_.wantVisibleBox(nullptr);
    isBoxKnown_ = true;
}

bool ObjectVisibility::update() {
    bool hasChanged = hasChanged_;
    hasChanged_ = false;
    if (!isBoxKnown_ && objects_.visibleBox()) isBoxKnown_ = hasChanged = true;
    if (waiting_.empty() || !objects_.isTreeWhole()) return hasChanged;
    const ooc::ObjectTree& tree = objects_.tree();
    auto hidden = hidden_ ? std::make_shared<ooc::ObjectSet>(*hidden_)
                          : std::make_shared<ooc::ObjectSet>(tree.size());
    for (const Wish& wish : waiting_) {
        if (wish.kind == Kind::Hide) hidden->insertFamily(tree, wish.object);
        if (wish.kind == Kind::Show) hidden->eraseFamily(tree, wish.object);
        if (wish.kind == Kind::Isolate) hidden->insertAllBut(tree, wish.object);
    }
    waiting_.clear();
    hidden_ = hidden->isEmpty() ? nullptr : std::move(hidden);
    isBoxKnown_ = hidden_ == nullptr;
    objects_.wantVisibleBox(hidden_);
    return true;
}

void ObjectVisibility::addTo(hlod::Clip& clip) const {
    clip.hidden = hidden_;
    if (hidden_ && isBoxKnown_) clip.box = objects_.visibleBox();
}

}  // namespace pagoda::viewer
