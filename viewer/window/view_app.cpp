#include "viewer/window/view_app.h"

#include "ooc/base/error.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

namespace pagoda::viewer {
namespace {

// An idle window looks up so often, so that Ctrl-C in the terminal is heard; it draws nothing.
constexpr double kIdleSeconds = 0.5;
// While pages are on their way, a frame is tried so often at least.
constexpr double kLoadSeconds = 0.01;
// A still view that nothing comes for, and that yet does not come to rest, is tried less often.
constexpr int kRestlessFrames = 60;
constexpr double kRestlessSeconds = 0.25;
constexpr double kFirstSeconds = 0.002;   // the same, before anything has come
constexpr double kOpeningSeconds = 0.02;  // a new picture of what is being opened waits no longer
constexpr double kBlankSeconds = 0.3;    // an empty picture is shown when nothing comes for so long
constexpr float kHudWidthPx = 322.0f;    // of the numbers, with their margin
constexpr double kMaxStepSeconds = 0.1;  // a slow frame must not throw the eye through a wall

constexpr glm::u8vec4 kDrawnColour{255, 105, 180, 190};  // pink
constexpr glm::u8vec4 kHiddenColour{250, 214, 70, 190};  // yellow
constexpr glm::u8vec4 kPickColour{142, 204, 240, 230};   // light blue
constexpr glm::u8vec4 kFrustumColour{240, 244, 248, 255};

double nowSeconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

nlohmann::json jsonOf(const Vec3d& v) {
    return {v.x, v.y, v.z};
}

}  // namespace

ViewApp::ViewApp(GlfwWindow& window, const ViewOptions& options, ModelOpener& opener,
                 std::unique_ptr<Opening> opening)
    : window_(window),
      options_(options),
      settings_(options.settings),
      log_(options.stateLog),
      ui_(window),
      opener_(opener) {
    lastStepS_ = nowSeconds();
    if (opening) {
        beginOpening(options.model, std::move(opening));
    } else if (!options.model.empty()) {
        openDatabase(options.model, options.model.stem().string(), false);
    }
}

ViewApp::~ViewApp() {
    log_.write("closed", {{"frames", frames_}});
}

void ViewApp::restart() {
    isRestartWanted_ = false;
    inspection_->dismissPick();
    readRate_.clear();
    try {
        scene_->restart(settings_.runtime);
    } catch (const Error& error) {
        inspection_.reset();
        scene_.reset();
        navigation_.reset();
        replay_.reset();
        say(error.what(), true);
    }
}

double ViewApp::waitSeconds() const {
    const glm::ivec2 size = window_.framebufferPx();
    if (size.x < 1 || size.y < 1) return kIdleSeconds;  // minimised
    if (scene_ && !scene_->hasDrawn()) return kFirstSeconds;
    if (!hasPresented_ || isSceneDirty_ || isCameraMoving_ || uiFrames_ > 0) return 0.0;
    if (!scene_ || scene_->isSettled()) {
        if (replay_) return 0.0;
        return opening_ ? kOpeningSeconds : kIdleSeconds;
    }
    if (restlessFrames_ > kRestlessFrames) return kRestlessSeconds;
    return scene_->isWaitingForPages() ? kLoadSeconds : 0.0;
}

void ViewApp::step() {
    const double wait = waitSeconds();
    window_.handleEvents(wait);
    const double now = nowSeconds();
    // What was waited for is not time in which anything moved.
    const double passed = wait > 0.0 ? 0.0 : now - lastStepS_;
    lastStepS_ = now;
    const size_t messages = messages_.size();
    std::erase_if(messages_, [&](const Message& m) { return !m.isError && m.untilSeconds < now; });
    if (messages_.size() != messages) uiFrames_ = kUiFrames;

    if (isRestartWanted_) restart();
    takeNews();
    followOpening();
    advance(std::min(passed, kMaxStepSeconds));
    bool hasDrawn = false;
    guarded([&] { hasDrawn = drawScene(); });
    if (!hasDrawn && uiFrames_ == 0) return;
    // What opens shows the model, if that comes soon.
    if (scene_ && !scene_->hasDrawn() && now < openedS_ + kBlankSeconds) return;
    present();
    if (hasDrawn) preview_ ? logPreview() : logFrame();
}

void ViewApp::advance(double seconds) {
    if (!navigation_) return;
    if (replay_ && !isSceneDirty_) advanceReplay();
    navigation_->setKeys(moveKeysOf(heldKeys_));
    if (navigation_->mode() != NavigationMode::Orbit && hasPresented_) {
        navigation_->setDistanceSeen(scene_ ? scene_->distanceSeen() : preview_->distanceSeen());
    }
    const bool wasMoving = isCameraMoving_;
    isCameraMoving_ = navigation_->update(seconds) && !replay_;
    // The first still frame after a move is drawn at the tau that was asked for.
    if (isCameraMoving_ || wasMoving) isSceneDirty_ = true;
}

bool ViewApp::drawScene() {
    if (!hasModel() || !navigation_) return false;
    const glm::ivec2 size = window_.framebufferPx();
    if (size.x < 1 || size.y < 1) return false;  // minimised
    if (preview_) {
        const bool isDirty = std::exchange(isSceneDirty_, false);  // also when it cannot be drawn
        if (isDirty) drawPreview();
        return isDirty;
    }
    if (!isSceneDirty_ && scene_->isSettled()) return false;
    const bool isRestless = !isSceneDirty_ && !scene_->isWaitingForPages();
    restlessFrames_ = isRestless ? restlessFrames_ + 1 : 0;
    isSceneDirty_ = false;
    scene_->setClip(clip());
    const hlod::FrameRecord& record = scene_->draw(navigation_->camera(), settings_, isMoving());
    if (record.bytesRead > 0) restlessFrames_ = 0;
    timeline_.add(record);
    readRate_.add(nowSeconds(),
                  scene_->renderer().runner().streaming().requests().counters().bytesRead);
    drawLines();
    if (isRecording_ && (recorded_.empty() || !(recorded_.back() == navigation_->camera()))) {
        recorded_.push_back(navigation_->camera());
    }
    ++frames_;
    uiFrames_ = std::max(uiFrames_, 1);
    return true;
}

void ViewApp::drawLines() {
    if (inspection_->pick()) lines_.addBox(inspection_->pick()->boxModel, kPickColour);
    if (scene_->frozen() != nullptr) addFrozenLines(*scene_->frozen());
    lines_.draw(hlod::View(navigation_->camera(), scene_->box()),
                *scene_->renderer().device().target());
}

void ViewApp::addFrozenLines(const FrozenCut& frozen) {
    if (settings_.showsHiddenBoxes) {
        for (const Box3d& box : frozen.hiddenBoxes()) lines_.addBox(box, kHiddenColour);
    }
    if (settings_.showsDrawnBoxes) {
        for (const Box3d& box : frozen.drawnBoxes()) lines_.addBox(box, kDrawnColour);
    }
    const Box3d box = scene_->box();
    const double reach =
        1.2 * hlod::distance(frozen.camera().eye, box) + 0.6 * glm::distance(box.min, box.max);
    lines_.addFrustum(frozen.camera(), reach, kFrustumColour);
}

void ViewApp::present() {
    const glm::ivec2 size = window_.framebufferPx();
    if (FrameTarget* const target = this->target()) {
        target->blitToWindow(size.x, size.y);
    } else {
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        glClearColor(0.23f, 0.25f, 0.27f, 1.0f);
        glClear(GL_COLOR_BUFFER_BIT);
    }
    ui_.beginFrame();
    showPanels();
    ui_.endFrame();
    window_.swap();
    hasPresented_ = true;
    if (uiFrames_ > 0) --uiFrames_;
}

void ViewApp::showPanels() {
    if (scene_) {
        showScenePanels();
        showToolPanels();
    } else if (!preview_ && !opening_) {
        showWelcome();
    }
    if (opening_) showOpeningPanel();
    std::vector<std::string> states;
    if (scene_ && scene_->frozen() != nullptr) states.emplace_back("frozen");
    if (settings_.section.isOn) states.emplace_back("cut");
    if (inspection_ && inspection_->visibility().hiddenCount() > 0) {
        states.push_back(fmt::format("{} objects hidden", inspection_->visibility().hiddenCount()));
    }
    if (isRecording_) states.push_back(fmt::format("recording, {} frames", recorded_.size()));
    if (replay_) {
        states.push_back(fmt::format("replaying {}/{}", replayFrame_, replay_->frames.size()));
    }
    showFooter(navigation_ ? &*navigation_ : nullptr, settings_, states);
    showMessages(messages_);
    if (settings_.showsHelp) showKeys();
}

void ViewApp::showScenePanels() {
    if (settings_.showsHud) {
        const cache::RequestQueue& requests = scene_->renderer().runner().streaming().requests();
        const Streaming numbers{.inFlight = requests.sentCount(),
                                .waiting = requests.waitingCount(),
                                .bytesPerSecond = scene_->isSettled() ? 0.0 : readRate_.perSecond(),
                                .gpuBudgetBytes = settings_.runtime.gpuBytes,
                                .hostBudgetBytes = settings_.runtime.hostBytes,
                                .uiMs = ui_.buildMs()};
        showHud(*scene_, settings_, numbers, timeline_);
    }
    if (inspection_->hasAsked()) showPick(*scene_, *inspection_);
    if (settings_.showsSteering) take(showSteering(settings_, scene_->record()));
}

void ViewApp::showToolPanels() {
    if (settings_.section.isOn) take(showSection(settings_.section, *scene_, *inspection_));
    if (settings_.showsLoading) take(showLoading(*scene_, settings_.runtime.disk));
    if (!settings_.showsObjects) return;
    const float leftPx = settings_.showsHud ? kHudWidthPx * ui_.textScale() : 0.0f;
    const ObjectPanel::Asked asked = objectPanel_->show(*inspection_, leftPx);
    if (asked.frame) objectToFrame_ = asked.frame;
}

void ViewApp::take(const Change& change) {
    isRestartWanted_ |= change.isRuntime;  // not while panels show the scene
    if (change.isDisk && !scene_->renderer().setDisk(settings_.runtime.disk)) {
        isRestartWanted_ = true;
    }
    isSceneDirty_ |= change.isLook || change.isRuntime || isRestartWanted_;
}

void ViewApp::logFrame() {
    if (!log_.isOn()) return;
    constexpr std::array kModes = {"orbit", "fly", "walk"};
    const hlod::FrameRecord& record = scene_->record();
    const hlod::Camera& camera = navigation_->camera();
    log_.write("frame", {{"frame", frames_},
                         {"width", record.widthPx},
                         {"height", record.heightPx},
                         {"eye", jsonOf(camera.eye)},
                         {"target", jsonOf(camera.target)},
                         {"mode", kModes[static_cast<size_t>(navigation_->mode())]},
                         {"strategy", record.strategy},
                         {"tau", settings_.tauPx},
                         {"effective_tau", record.effectiveTauPx},
                         {"drawn_nodes", record.drawnNodes},
                         {"hidden_nodes", record.hiddenNodes},
                         {"drawn_triangles", record.drawnTriangles},
                         {"missing_pages", record.missingPages},
                         {"settled", scene_->isSettled() && !isMoving() && !isSceneDirty_},
                         {"frozen", scene_->frozen() != nullptr},
                         {"replaying", replay_.has_value()},
                         {"colours", kColouringNames[static_cast<size_t>(settings_.colouring)]},
                         {"wireframe", settings_.isWireframe},
                         {"section", settings_.section.isOn},
                         {"hidden_objects", inspection_->visibility().hiddenCount()},
                         {"frame_ms", record.frameMs},
                         {"ui_ms", ui_.buildMs()},
                         {"ui_gl_ms", ui_.drawMs()}});
}

}  // namespace pagoda::viewer
