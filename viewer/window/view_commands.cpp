#include "viewer/window/view_app.h"

#include "ooc/base/error.h"
#include "ooc/base/file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>

namespace pagoda::viewer {
namespace {

constexpr double kMessageSeconds = 4.0;
constexpr double kClickPx = 4.0;  // a hand shakes so much between press and release
constexpr double kTauStep = 1.4142135623730951;
constexpr double kLeastTauPx = 0.25, kGreatestTauPx = 64.0;
constexpr double kSpeedStep = 1.25;
// A frame of a replay that does not come to rest is left after so many tries.
constexpr int kMaxReplayWaits = 300;

double nowSeconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace

void ViewApp::onKey(int key, int modifiers, bool isDown, bool isRepeat) {
    if (!isDown) {
        heldKeys_.erase(key);
        return;
    }
    if (ui_.wantsKeys()) return;
    heldKeys_.insert(key);
    if (isMoveKey(key) && navigation_ && navigation_->mode() != NavigationMode::Orbit) {
        isCameraMoving_ = true;  // the next frame asks the navigation
    }
    const auto command = commandOf(key, modifiers);
    if (command && !isRepeat) guarded([&] { run(*command); });
}

void ViewApp::onButton(int button, int modifiers, bool isDown, glm::dvec2 px) {
    if (!navigation_ || !hasModel()) return;
    if (!isDown) {
        if (button != heldButton_) return;
        heldButton_ = -1;
        navigation_->endDrag();
        if (pressedPx_ && scene_ && isPickButton(button)) pickAt(*pressedPx_);
        pressedPx_.reset();
        return;
    }
    if (ui_.wantsMouse() || heldButton_ >= 0) return;
    const auto drag = dragOf(button, modifiers, navigation_->mode());
    if (!drag) return;
    heldButton_ = button;
    pressedPx_ = px;
    navigation_->beginDrag(*drag, px, surfaceAt(px));
}

void ViewApp::onCursor(glm::dvec2 px) {
    if (heldButton_ < 0 || !navigation_) return;
    if (pressedPx_ && glm::distance(*pressedPx_, px) > kClickPx) pressedPx_.reset();
    if (!pressedPx_) {
        replay_.reset();
        navigation_->dragTo(px);
        isCameraMoving_ = true;
    }
}

void ViewApp::onWheel(double steps, glm::dvec2 px) {
    if (!navigation_ || !hasModel() || ui_.wantsMouse()) return;
    if (navigation_->mode() == NavigationMode::Orbit) {
        replay_.reset();
        navigation_->wheel(steps, px, surfaceAt(px));
        isCameraMoving_ = true;
    } else {
        navigation_->setSpeedFactor(navigation_->speedFactor() * std::pow(kSpeedStep, steps));
    }
}

void ViewApp::onResize() {
    const glm::ivec2 size = window_.framebufferPx();
    if (!navigation_ || size.x < 1 || size.y < 1) return;
    navigation_->setSize(size.x, size.y);
    isSceneDirty_ = true;
    log_.write("resized", {{"width", size.x}, {"height", size.y}});
}

void ViewApp::onDrop(const std::vector<std::filesystem::path>& files) {
    if (files.empty()) return;
    guarded([&] { open(files.front()); });
}

void ViewApp::run(Command command) {
    if (command == Command::Quit) return window_.close();
    if (command == Command::ToggleHelp) settings_.showsHelp = !settings_.showsHelp;
    if (command == Command::Dismiss) dismiss();
    if (!hasModel() || !navigation_) return;
    if (runCamera(command)) {
        isCameraMoving_ = true;
        replay_.reset();
        return;
    }
    if (command == Command::Screenshot) return saveScreenshot();
    if (command == Command::CopyCamera) return copyCamera();
    if (command == Command::PasteCamera) return pasteCamera();
    if (!scene_) return;
    if (runLook(command)) {
        isSceneDirty_ = true;
        return;
    }
    if (runObjects(command)) return;
    switch (command) {
        case Command::RecordPath:
            return toggleRecording();
        case Command::ReplayPath:
            return startReplay(lastPath_);
        default:
            return;
    }
}

bool ViewApp::runCamera(Command command) {
    const auto axisView = [&](AxisView view) {
        navigation_->axisView(view);
        return true;
    };
    switch (command) {
        case Command::FrameAll:
            navigation_->frameAll();
            return true;
        case Command::FramePick:
            if (!inspection_ || !inspection_->pick()) return false;
            navigation_->frame(inspection_->pick()->boxModel);
            return true;
        case Command::Home:
            navigation_->goHome();
            return true;
        case Command::ViewFront:
            return axisView(AxisView::Front);
        case Command::ViewBack:
            return axisView(AxisView::Back);
        case Command::ViewLeft:
            return axisView(AxisView::Left);
        case Command::ViewRight:
            return axisView(AxisView::Right);
        case Command::ViewTop:
            return axisView(AxisView::Top);
        case Command::ViewBottom:
            return axisView(AxisView::Bottom);
        case Command::ViewIsometric:
            return axisView(AxisView::Isometric);
        case Command::ModeOrbit:
            navigation_->setMode(NavigationMode::Orbit);
            return true;
        case Command::ModeFly:
            navigation_->setMode(NavigationMode::Fly);
            return true;
        case Command::ModeWalk:
            navigation_->setMode(NavigationMode::Walk);
            return true;
        default:
            return false;
    }
}

bool ViewApp::runLook(Command command) {
    const auto scaleTau = [&](double factor) {
        settings_.tauPx = std::clamp(settings_.tauPx * factor, kLeastTauPx, kGreatestTauPx);
        say(fmt::format("tau {:.3g} pixels", settings_.tauPx));
    };
    switch (command) {
        case Command::NextStrategy:
            nextStrategy();
            return true;
        case Command::FinerTau:
            scaleTau(1.0 / kTauStep);
            return true;
        case Command::CoarserTau:
            scaleTau(kTauStep);
            return true;
        case Command::NextColouring:
            settings_.colouring = static_cast<Colouring>(
                (static_cast<size_t>(settings_.colouring) + 1) % kColouringNames.size());
            return true;
        case Command::ToggleWireframe:
            settings_.isWireframe = !settings_.isWireframe;
            return true;
        case Command::ToggleFreeze:
            toggleFreeze();
            return true;
        case Command::ToggleHud:
            settings_.showsHud = !settings_.showsHud;
            return false;
        case Command::ToggleSteering:
            settings_.showsSteering = !settings_.showsSteering;
            return false;
        case Command::ToggleLoading:
            settings_.showsLoading = !settings_.showsLoading;
            return false;
        case Command::ToggleSection:
            settings_.section.isOn = !settings_.section.isOn;
            return true;
        default:
            return false;
    }
}

void ViewApp::nextStrategy() {
    const auto rows = hlod::strategies();
    const auto at = std::find_if(rows.begin(), rows.end(), [&](const hlod::StrategyRow& row) {
        return row.name == settings_.strategy;
    });
    const auto next = at == rows.end() || at + 1 == rows.end() ? rows.begin() : at + 1;
    settings_.strategy = std::string(next->name);
    say(fmt::format("{}: {}", next->name, next->what));
}

void ViewApp::toggleFreeze() {
    if (scene_->frozen() != nullptr) {
        scene_->thaw();
        say("thawed");
    } else {
        scene_->freeze();
        say("frozen: fly away and look at what was drawn (pink) and what was hidden (yellow)");
    }
}

std::filesystem::path ViewApp::freeName(const std::string& ending) const {
    for (int number = 1;; ++number) {
        std::filesystem::path path =
            options_.outputFolder / fmt::format("{}-{}{}", modelName(), number, ending);
        std::error_code ignored;
        if (!std::filesystem::exists(path, ignored)) return path;
    }
}

void ViewApp::saveScreenshot() {
    if (target() == nullptr) return;  // nothing was drawn yet
    const std::filesystem::path path = freeName(".png");
    writePng(scene_ ? scene_->read() : preview_->read(), path);
    say("written: " + path.string());
    log_.write("screenshot", {{"file", path.string()}});
}

void ViewApp::copyCamera() {
    const std::string json = hlod::cameraToJson(navigation_->camera());
    window_.setClipboard(json);
    say("camera copied");
    log_.write("camera", {{"json", json}});
}

void ViewApp::pasteCamera() {
    const hlod::Camera camera =
        hlod::parseCamera(window_.clipboard(), navigation_->camera(), "clipboard");
    replay_.reset();
    navigation_->goTo(camera);
    isCameraMoving_ = true;
}

void ViewApp::toggleRecording() {
    isRecording_ = !isRecording_;
    if (isRecording_) {
        recorded_ = {navigation_->camera()};
        return;
    }
    hlod::CameraPath path;
    path.kind = "recorded";
    path.modelName = scene_->database().path();
    path.modelName = std::filesystem::path(path.modelName).filename().string();
    path.modelDiagonalModelUnits = glm::distance(scene_->box().min, scene_->box().max);
    path.widthPx = navigation_->camera().widthPx;
    path.heightPx = navigation_->camera().heightPx;
    path.frames = std::move(recorded_);
    recorded_.clear();
    lastPath_ = path;
    const std::filesystem::path file = freeName("-path.json");
    std::ofstream out(file);
    out << hlod::cameraPathToJson(path);
    out.close();
    if (!out) throw Error(file.string(), "", "cannot be written", "is the disk full?");
    say(fmt::format("written: {}, {} frames", file.string(), path.frames.size()));
    log_.write("path", {{"file", file.string()}, {"frames", path.frames.size()}});
}

void ViewApp::startReplay(std::optional<hlod::CameraPath> path) {
    if (!path) return say("no path has been recorded (R)");
    replay_ = std::move(path);
    lastPath_ = replay_;
    replayFrame_ = 0;
    replayWaits_ = 0;
    advanceReplay();
}

// Each frame is seen once nothing of it is missing.
void ViewApp::advanceReplay() {
    const bool isReady = replayFrame_ == 0 || scene_->isSettled();
    if (!isReady && ++replayWaits_ < kMaxReplayWaits) return;
    replayWaits_ = 0;
    if (replayFrame_ == replay_->frames.size()) {
        say("replayed");
        replay_.reset();
        return;
    }
    navigation_->jumpTo(replay_->frames[replayFrame_]);
    ++replayFrame_;
    isSceneDirty_ = true;
}

void ViewApp::dismiss() {
    if (settings_.showsHelp) {
        settings_.showsHelp = false;
    } else if (opening_) {
        cancelOpening();
    } else if (!messages_.empty()) {
        messages_.clear();
    } else if (inspection_ && inspection_->hasAsked()) {
        inspection_->dismissPick();
        isSceneDirty_ = true;
    } else {
        replay_.reset();
    }
}

void ViewApp::guarded(const std::function<void()>& work) {
    try {
        work();
    } catch (const Error& error) {
        say(error.what(), true);
    }
}

void ViewApp::say(const std::string& text, bool isError) {
    constexpr size_t kMaxMessages = 4;
    std::erase_if(messages_, [&](const Message& message) { return message.text == text; });
    if (messages_.size() == kMaxMessages) messages_.erase(messages_.begin());
    messages_.push_back({text, isError, nowSeconds() + kMessageSeconds});
    uiFrames_ = kUiFrames;
    log_.write("message", {{"text", text}, {"is_error", isError}});
}

}  // namespace pagoda::viewer
