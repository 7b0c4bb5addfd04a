// view_app.h: the window's state and what every command does to it. view_window.cpp holds the loop.
// Main thread only, the window's context current.
#pragma once

#include "hlod/view/camera_path.h"
#include "viewer/navigation.h"
#include "viewer/window/glfw_window.h"
#include "viewer/window/input_map.h"
#include "viewer/window/inspection.h"
#include "viewer/window/line_drawer.h"
#include "viewer/window/model_opening.h"
#include "viewer/window/object_panel.h"
#include "viewer/window/panels.h"
#include "viewer/window/preview_scene.h"
#include "viewer/window/rate_meter.h"
#include "viewer/window/scene.h"
#include "viewer/window/state_log.h"
#include "viewer/window/timeline.h"
#include "viewer/window/ui.h"
#include "viewer/window/view_window.h"

#include <functional>
#include <memory>
#include <optional>
#include <set>

namespace pagoda::viewer {

class ViewApp final : public WindowEvents {
public:
    // `opening`: of options.model, which is a database where there is none. `opener` outlives it.
    ViewApp(GlfwWindow& window, const ViewOptions& options, ModelOpener& opener,
            std::unique_ptr<Opening> opening);
    ~ViewApp() override;

    // Takes what has happened, waiting as long as nothing has to be drawn; draws what there is.
    void step();

    void onAnything() override { uiFrames_ = kUiFrames; }
    void onKey(int key, int modifiers, bool isDown, bool isRepeat) override;
    void onButton(int button, int modifiers, bool isDown, glm::dvec2 px) override;
    void onCursor(glm::dvec2 px) override;
    void onWheel(double steps, glm::dvec2 px) override;
    void onResize() override;
    void onDrop(const std::vector<std::filesystem::path>& files) override;

private:
    // A panel may need a second look at its own size, and a third at what the mouse is over.
    static constexpr int kUiFrames = 3;

    // view_app.cpp
    void restart();
    [[nodiscard]] double waitSeconds() const;
    void advance(double seconds);
    [[nodiscard]] bool drawScene();
    void drawLines();
    void addFrozenLines(const FrozenCut& frozen);
    void present();
    void showPanels();
    void showScenePanels();
    void showToolPanels();
    void take(const Change& change);
    void logFrame();
    [[nodiscard]] bool isMoving() const { return isCameraMoving_; }

    // view_opening.cpp
    void open(const std::filesystem::path& model);
    // `isOpening`: what the opening has made, whose preview may be on the screen.
    void openDatabase(const std::filesystem::path& path, const std::string& name, bool isOpening);
    void beginOpening(const std::filesystem::path& model, std::unique_ptr<Opening> opening);
    void abandonOpening();
    void followOpening();
    void endOpening();
    void showPreview(const Preview& preview);
    void forgetScene();
    void lookAt(const Box3d& box, hlod::UpAxis up);
    void drawPreview();
    void showOpeningPanel();
    void cancelOpening();
    void logPreview();
    [[nodiscard]] bool hasModel() const { return scene_ || preview_; }
    [[nodiscard]] std::string modelName() const;
    [[nodiscard]] FrameTarget* target() const;
    [[nodiscard]] std::optional<Vec3d> surfaceAt(glm::dvec2 px) const;

    // view_commands.cpp
    void run(Command command);
    [[nodiscard]] bool runLook(Command command);
    [[nodiscard]] bool runCamera(Command command);
    void nextStrategy();
    void toggleFreeze();
    void saveScreenshot();
    void copyCamera();
    void pasteCamera();
    void toggleRecording();
    void startReplay(std::optional<hlod::CameraPath> path);
    void advanceReplay();
    void dismiss();
    void say(const std::string& text, bool isError = false);
    [[nodiscard]] std::filesystem::path freeName(const std::string& ending) const;

    // view_inspection.cpp
    void pickAt(glm::dvec2 px);
    void takeNews();
    void logExact();
    [[nodiscard]] bool runObjects(Command command);
    void frameObject();
    [[nodiscard]] hlod::Clip clip() const;

    // What throws Error within `work` is shown.
    void guarded(const std::function<void()>& work);

    GlfwWindow& window_;
    ViewOptions options_;
    ViewSettings settings_;
    StateLog log_;
    Ui ui_;
    LineDrawer lines_;
    ModelOpener& opener_;
    std::unique_ptr<Scene> scene_;
    std::unique_ptr<Inspection> inspection_;  // of `scene_`
    std::optional<ObjectPanel> objectPanel_;  // of `inspection_`
    std::optional<uint32_t> objectToFrame_;   // once its box has been read
    std::unique_ptr<PreviewScene> preview_;   // in place of scene_: never both
    std::optional<Navigation> navigation_;
    std::optional<hlod::Camera> framed_;  // where lookAt() put the camera: equal until it is moved
    Timeline timeline_;
    RateMeter readRate_;
    std::vector<Message> messages_;

    std::set<int> heldKeys_;
    std::optional<glm::dvec2> pressedPx_;  // where a click may still be one
    int heldButton_ = -1;

    std::vector<hlod::Camera> recorded_;
    bool isRecording_ = false;
    std::optional<hlod::CameraPath> replay_, lastPath_;
    size_t replayFrame_ = 0;
    int replayWaits_ = 0;

    std::unique_ptr<Opening> opening_;
    std::vector<std::unique_ptr<Opening>> abandoned_;  // cancelled, and not at their end yet
    std::filesystem::path openingModel_;
    std::string openingStage_;
    bool isPreviewOfOpening_ = false;  // preview_ shows openingModel_, not one opened before
    double nextProgressS_ = 0.0;

    bool isSceneDirty_ = true, isCameraMoving_ = false, hasPresented_ = false;
    bool isRestartWanted_ = false;
    int uiFrames_ = kUiFrames;
    int restlessFrames_ = 0;  // still view, nothing comes, and it is not settled
    double lastStepS_ = 0.0, openedS_ = 0.0;
    uint64_t frames_ = 0;
};

}  // namespace pagoda::viewer
