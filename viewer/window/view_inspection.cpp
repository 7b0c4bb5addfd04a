#include "viewer/window/view_app.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace pagoda::viewer {

void ViewApp::pickAt(glm::dvec2 px) {
    const bool hadPick = inspection_->pick().has_value();
    inspection_->pickAt(px);
    const std::optional<Pick>& pick = inspection_->pick();
    isSceneDirty_ |= hadPick || pick;  // the node's box
    if (!pick) return log_.write("pick", {{"node", nullptr}});
    const Vec3d& p = pick->pointModel;
    log_.write("pick", {{"node", fmt::format("0x{:x}", pick->node.id.value)},
                        {"level", pick->node.id.depth()},
                        {"triangles", pick->node.triangleCount},
                        {"triangle", pick->triangle},
                        {"error", pick->node.errorModelUnits},
                        {"sse", pick->ssePx},
                        {"page_bytes", pick->node.pageBytes},
                        {"point", {p.x, p.y, p.z}}});
}

void ViewApp::takeNews() {
    if (!inspection_) return;
    const Inspection::News news = inspection_->update();
    if (objectToFrame_) frameObject();
    if (!news.isAny) return;
    isSceneDirty_ |= news.isVisibility;
    if (settings_.showsObjects || inspection_->hasAsked()) uiFrames_ = kUiFrames;
    if (news.isExact) {
        if (inspection_->exact()) objectPanel_->select(inspection_->exact()->hit.object);
        logExact();
    }
    if (news.isVisibility) {
        log_.write("hidden", {{"objects", inspection_->visibility().hiddenCount()}});
    }
    if (!settings_.showsObjects) return;
    const ooc::ObjectReader& objects = inspection_->objects();
    log_.write("objects", {{"tree", objects.tree().size()},
                           {"rows", objectPanel_->shownRows()},
                           {"matches", objects.matches().size()},
                           {"searching", objects.isSearching()}});
}

void ViewApp::logExact() {
    const std::optional<ExactHit>& exact = inspection_->exact();
    if (!exact) {
        return log_.write("exact",
                          {{"point", nullptr}, {"faults", inspection_->faultsWithoutHit()}});
    }
    const Vec3d& p = exact->hit.pointModel;
    nlohmann::json line = {{"point", {p.x, p.y, p.z}},
                           {"leaf", fmt::format("0x{:x}", exact->hit.leaf.value)},
                           {"triangle", exact->hit.triangle},
                           {"object", exact->hit.object},
                           {"path", exact->path},
                           {"faults", exact->faults}};
    if (exact->fromLastModelUnits) line["from_last"] = *exact->fromLastModelUnits;
    log_.write("exact", std::move(line));
}

bool ViewApp::runObjects(Command command) {
    const std::optional<uint32_t>& selected = objectPanel_->selected();
    switch (command) {
        case Command::ToggleObjects:
            settings_.showsObjects = !settings_.showsObjects;
            return true;
        case Command::HideObject:
        case Command::IsolateObject:
            if (!inspection_->visibility().canHide()) {
                say("too many objects to hide any");
            } else if (!selected) {
                say("click an object first");
            } else if (command == Command::HideObject) {
                inspection_->visibility().hide(*selected);
            } else {
                inspection_->visibility().isolate(*selected);
            }
            return true;
        case Command::ShowAllObjects:
            inspection_->visibility().showAll();
            return true;
        default:
            return false;
    }
}

// Its own triangles' box; without any, all that is below it would have to be read.
void ViewApp::frameObject() {
    const ooc::ObjectRecord* const record = inspection_->objects().record(*objectToFrame_);
    if (record == nullptr) return;
    objectToFrame_.reset();
    if (record->triangleCount == 0) return say("it has no triangles of its own");
    navigation_->frame(scene_->database().header().lattice.toModel(record->box));
    isCameraMoving_ = true;
}

hlod::Clip ViewApp::clip() const {
    hlod::Clip clip;
    inspection_->visibility().addTo(clip);
    if (settings_.section.isOn) clip.section = settings_.section.plane(scene_->box());
    return clip;
}

}  // namespace pagoda::viewer
