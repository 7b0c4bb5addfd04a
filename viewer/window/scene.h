// scene.h: an open database and what draws it, live: one frame a call, into the device's own
// target. Main thread only, context current.
#pragma once

#include "cache/page_source.h"
#include "hlod/view/frame_rate_control.h"
#include "hlod/view/leaf_ray.h"
#include "ooc/store/database.h"
#include "viewer/renderer.h"
#include "viewer/window/frozen_cut.h"
#include "viewer/window/view_settings.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pagoda::viewer {

// What lies under one pixel.
struct Pick {
    Vec3d pointModel{0.0};
    double distanceModelUnits = 0.0;  // along the direction of view
    ooc::NodeRecord node;
    Box3d boxModel;
    uint32_t triangle = 0;
    double ssePx = 0.0;        // of the nearest place of its box: what the traversal goes by
    double errorHerePx = 0.0;  // the same error at the point
    bool isStandIn = false;
    std::optional<double> fromLastModelUnits;  // between this point and the one picked before
};

class Scene {
public:
    // `name`: what people call the model. Throws Error when there is no sound database at `path`,
    // or its root cannot be read.
    Scene(const std::filesystem::path& path, std::string name, const RendererOptions& options);
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    // Begins anew with other budgets: nothing is resident afterwards. When it throws Error there is
    // nothing left to draw with: the scene must go.
    void restart(const RendererOptions& options);

    // What is left out of the frames that follow.
    void setClip(const hlod::Clip& clip) { clip_ = clip; }
    [[nodiscard]] const hlod::Clip& clip() const noexcept { return clip_; }

    // Draws a frame. `isMoving`: the view will not stay as it is.
    const hlod::FrameRecord& draw(const hlod::Camera& camera, const ViewSettings& settings,
                                  bool isMoving);
    [[nodiscard]] const hlod::FrameRecord& record() const noexcept { return record_; }
    // Did the last frame draw what will be drawn until something changes?
    [[nodiscard]] bool isSettled() const noexcept { return record_.isSettled && !isCoarsened_; }
    [[nodiscard]] bool hasDrawn() const noexcept { return hasDrawn_; }  // anything yet
    [[nodiscard]] bool isWaitingForPages() const noexcept { return record_.missingPages > 0; }

    // The visible set of the last frame stays, wherever the eye goes.
    void freeze();
    void thaw();
    [[nodiscard]] const FrozenCut* frozen() const noexcept { return frozen_.get(); }

    // Of the last frame; a pixel from the top left.
    [[nodiscard]] std::optional<Vec3d> surfaceAt(glm::dvec2 px);
    [[nodiscard]] std::optional<Pick> pick(glm::dvec2 px);
    // From the eye through a pixel's centre, 1 long along the direction of view, with the clip.
    [[nodiscard]] hlod::LeafRay rayThrough(glm::dvec2 px) const;
    // Frames note what becomes of this node; nothing: of none.
    void watch(std::optional<ooc::NodeId> node);
    [[nodiscard]] const hlod::NodeWatch& watched() const noexcept { return watch_; }
    // Null when nothing is known of its page (any more).
    [[nodiscard]] const cache::PageStory* storyOf(ooc::NodeId node) const;
    // To the nearest of some places in the picture; infinite where nothing is.
    [[nodiscard]] double distanceSeen();
    [[nodiscard]] Picture read();

    [[nodiscard]] Renderer& renderer() noexcept { return *renderer_; }
    [[nodiscard]] const ooc::Database& database() const noexcept { return database_; }
    [[nodiscard]] const cache::PageSource& source() const noexcept { return source_; }
    [[nodiscard]] Box3d box() const { return renderer_->sceneBox(); }
    [[nodiscard]] hlod::UpAxis up() const noexcept { return up_; }
    [[nodiscard]] const hlod::Camera& camera() const noexcept { return camera_; }  // last frame's
    [[nodiscard]] double clockS() const { return renderer_->runner().streaming().clock().nowS(); }
    [[nodiscard]] const std::string& name() const noexcept { return name_; }
    [[nodiscard]] uint64_t triangles() const noexcept { return triangles_; }  // of all leaves
    // Of the database as a whole and of the last frame.
    [[nodiscard]] std::vector<std::string> faults() const;

private:
    [[nodiscard]] hlod::Strategy& strategyFor(const ViewSettings& settings);
    [[nodiscard]] double tauFor(const ViewSettings& settings, bool isMoving);
    void setTint(const ViewSettings& settings);

    std::string name_;
    ooc::Database database_;
    cache::DatabaseSource source_;
    std::unique_ptr<Renderer> renderer_;
    hlod::UpAxis up_ = hlod::UpAxis::Z;
    uint64_t triangles_ = 0;

    std::unique_ptr<hlod::Strategy> strategy_;
    std::string strategyName_;
    std::unique_ptr<FrozenCut> frozen_;
    std::optional<hlod::FrameRateControl> rateControl_;
    double rateTargetFps_ = 0.0;
    bool isCoarsened_ = false;  // the last frame's tau was raised for the sake of time
    bool hasDrawn_ = false, isWireframe_ = false;
    uint64_t framesSinceStart_ = 0;
    hlod::Camera camera_;  // of the last frame
    hlod::Clip clip_;
    hlod::NodeWatch watch_;
    bool isWatching_ = false;
    hlod::FrameRecord record_;
};

}  // namespace pagoda::viewer
