// What ViewApp opens: databases at once, raw models by way of an Opening and its previews.
#include "viewer/window/view_app.h"

#include "ooc/base/error.h"
#include "ooc/base/file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <utility>

namespace pagoda::viewer {
namespace {

constexpr double kProgressSeconds = 0.25;

double nowSeconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace

void ViewApp::open(const std::filesystem::path& model) {
    std::unique_ptr<Opening> opening = opener_.open(model);
    if (opening) {
        beginOpening(model, std::move(opening));
        return;
    }
    openDatabase(model, model.stem().string(), false);
}

void ViewApp::openDatabase(const std::filesystem::path& path, const std::string& name,
                           bool isOpening) {
    auto scene = std::make_unique<Scene>(path, name, settings_.runtime);
    // Another model; of its preview the camera stays.
    if (!isOpening || !isPreviewOfOpening_) navigation_.reset();
    isPreviewOfOpening_ = false;
    forgetScene();
    scene_ = std::move(scene);  // only now: what cannot be opened leaves the old one
    inspection_ = std::make_unique<Inspection>(*scene_, [] { GlfwWindow::wake(); });
    objectPanel_.emplace();
    preview_.reset();
    abandonOpening();
    readRate_.clear();
    lookAt(scene_->box(), scene_->up());
    openedS_ = nowSeconds();
    window_.setTitle(name + " - Pagoda");
    log_.write("opened", {{"file", path.string()}});
    if (options_.replay.empty()) return;
    const std::filesystem::path replay = std::exchange(options_.replay, {});  // of the first alone
    const std::vector<std::byte> text = readWholeFile(replay, hlod::kMaxPathBytes);
    startReplay(hlod::parseCameraPath({reinterpret_cast<const char*>(text.data()), text.size()},
                                      navigation_->camera(), replay.string()));
}

void ViewApp::forgetScene() {
    inspection_.reset();
    objectPanel_.reset();
    objectToFrame_.reset();
    settings_.section = {};
    replay_.reset();
    scene_.reset();
}

// All of the box, unless someone has moved the camera since it was framed last.
void ViewApp::lookAt(const Box3d& box, hlod::UpAxis up) {
    const glm::ivec2 size = glm::max(window_.framebufferPx(), glm::ivec2(1));
    hlod::Camera camera;
    camera.widthPx = size.x;
    camera.heightPx = size.y;
    camera = hlod::frameBox(camera, box, hlod::viewDirection("iso", up), up);
    isSceneDirty_ = true;
    if (!navigation_) {
        navigation_.emplace(camera, box, hlod::upVector(up));
        framed_ = camera;
        if (options_.cameraJson.empty()) return;
        // Of the first model alone.
        navigation_->jumpTo(hlod::parseCamera(std::exchange(options_.cameraJson, {}), camera));
        return;
    }
    navigation_->setScene(box);
    navigation_->setHome(camera);
    framed_->widthPx = navigation_->camera().widthPx;  // the window's size moves nothing
    framed_->heightPx = navigation_->camera().heightPx;
    if (framed_ != navigation_->camera() || navigation_->isDragging()) return;
    navigation_->jumpTo(camera);
    framed_ = navigation_->camera();
}

void ViewApp::beginOpening(const std::filesystem::path& model, std::unique_ptr<Opening> opening) {
    abandonOpening();
    opening_ = std::move(opening);
    isPreviewOfOpening_ = false;
    openingModel_ = model;
    openingStage_.clear();
    nextProgressS_ = 0.0;
    window_.setTitle(opening_->name() + " (opening) - Pagoda");
    log_.write("opening", {{"file", model.string()}});
}

// Its work ends by itself; the window does not wait for it.
void ViewApp::abandonOpening() {
    if (!opening_) return;
    opening_->cancel();
    abandoned_.push_back(std::move(opening_));
}

void ViewApp::followOpening() {
    std::erase_if(abandoned_, [](const std::unique_ptr<Opening>& opening) {
        return opening->state() != Opening::State::Working;
    });
    if (!opening_) return;
    const bool hasEnded = opening_->state() != Opening::State::Working;  // before what it left
    for (const std::string& note : opening_->takeNotes()) say(note);
    if (const auto preview = opening_->takePreview()) guarded([&] { showPreview(*preview); });
    if (hasEnded) return endOpening();
    const double now = nowSeconds();
    if (now < nextProgressS_) return;
    nextProgressS_ = now + kProgressSeconds;
    uiFrames_ = std::max(uiFrames_, 1);
    const OpeningProgress progress = opening_->progress();
    if (progress.stage == openingStage_) return;
    openingStage_ = progress.stage;
    log_.write("stage", {{"stage", progress.stage}});
}

void ViewApp::endOpening() {
    const std::unique_ptr<Opening> opening = std::move(opening_);
    const std::string name = opening->name();
    uiFrames_ = kUiFrames;
    window_.setTitle((hasModel() ? modelName() : name) + " - Pagoda");
    switch (opening->state()) {
        case Opening::State::Working:
            return;  // not called then
        case Opening::State::Cancelled:
            log_.write("cancelled", {{"file", openingModel_.string()}});
            return say("cancelled: nothing was kept. Drop the file again to open it");
        case Opening::State::Failed:
            return say(opening->error(), true);
        case Opening::State::Done:
            log_.write("made", {{"file", openingModel_.string()},
                                {"database", opening->database().string()},
                                {"is_built", opening->isBuilt()}});
            return guarded([&] { openDatabase(opening->database(), name, true); });
    }
}

void ViewApp::showPreview(const Preview& preview) {
    if (!isPreviewOfOpening_) {
        auto scene = std::make_unique<PreviewScene>(opening_->name());  // may throw
        isPreviewOfOpening_ = true;
        navigation_.reset();  // another model
        forgetScene();
        preview_ = std::move(scene);
    }
    preview_->show(preview);
    lookAt(preview.box, preview.up);
}

void ViewApp::drawPreview() {
    preview_->draw(navigation_->camera());
    ++frames_;
    uiFrames_ = std::max(uiFrames_, 1);
}

void ViewApp::showOpeningPanel() {
    if (showOpening(opening_->name(), opening_->progress(),
                    isPreviewOfOpening_ ? preview_->trianglesSeen() : 0)) {
        cancelOpening();
    }
}

void ViewApp::cancelOpening() {
    opening_->cancel();
    say("cancelling");
}

void ViewApp::logPreview() {
    const hlod::Camera& camera = navigation_->camera();
    log_.write("preview", {{"frame", frames_},
                           {"width", camera.widthPx},
                           {"height", camera.heightPx},
                           {"eye", {camera.eye.x, camera.eye.y, camera.eye.z}},
                           {"target", {camera.target.x, camera.target.y, camera.target.z}},
                           {"triangles_seen", preview_->trianglesSeen()},
                           {"is_whole", preview_->isWhole()},
                           {"discs", preview_->discCount()},
                           {"triangles", preview_->triangleCount()}});
}

std::string ViewApp::modelName() const {
    return scene_ ? scene_->name() : preview_->name();
}

FrameTarget* ViewApp::target() const {
    if (scene_) return scene_->renderer().device().target();
    return preview_ ? preview_->target() : nullptr;
}

std::optional<Vec3d> ViewApp::surfaceAt(glm::dvec2 px) const {
    return scene_ ? scene_->surfaceAt(px) : preview_->surfaceAt(px);
}

}  // namespace pagoda::viewer
