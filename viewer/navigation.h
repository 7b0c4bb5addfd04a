// navigation.h: what a person's hands do to the camera: turn about, pan and zoom to what is under
// the cursor, fly, walk, go to a view. Pure: knows pixels, seconds and points, no window and no
// scene but its box; the same calls give the same cameras. Double precision: steady at 1e7 units
// from the origin. One thread. What is not finite changes nothing, nor does a camera whose eye is
// its target.
// Pixels are those of Camera::widthPx and heightPx, from the top left corner, fractions allowed.
#pragma once

#include "viewer/camera_transition.h"

#include <limits>
#include <optional>

namespace pagoda::viewer {

// Keys move the camera in Fly and Walk alone; drags and the wheel work in every mode.
enum class NavigationMode { Orbit, Fly, Walk };
enum class DragKind {
    Orbit,  // turns about what was grabbed, which keeps its pixel; the horizon stays level
    Pan,    // what was grabbed stays under the cursor
    Look,   // turns the head: the eye stays
    Zoom    // up: nearer to what was grabbed; the picture's height is a factor of 20
};
enum class AxisView { Front, Back, Left, Right, Top, Bottom, Isometric };

struct MoveKeys {
    bool forward = false, back = false, left = false, right = false;
    bool up = false, down = false;    // along the world's up
    bool fast = false, slow = false;  // four times, a quarter
    [[nodiscard]] bool operator==(const MoveKeys&) const = default;
};

class Navigation {
public:
    // `worldUp` need not have unit length. `home` must be a camera.
    Navigation(const hlod::Camera& home, const Box3d& sceneModel, const Vec3d& worldUp);

    [[nodiscard]] const hlod::Camera& camera() const { return camera_; }
    void setSize(int widthPx, int heightPx);  // at least 1 each
    void setMode(NavigationMode mode);
    [[nodiscard]] NavigationMode mode() const { return mode_; }
    // Distances, speeds and frameAll() go by it. May be empty or a point.
    void setScene(const Box3d& sceneModel);
    // Where goHome() leads from now on; must be a camera.
    void setHome(const hlod::Camera& home) { home_ = home; }
    // The camera stays; it levels with the next turn or frame().
    void setWorldUp(const Vec3d& worldUp);

    // `surface`: the point of the model under the cursor, if any. Without one the last grabbed
    // point's distance counts, or the scene's. A drag ends a transition.
    void beginDrag(DragKind kind, glm::dvec2 px, std::optional<Vec3d> surface);
    void dragTo(glm::dvec2 px);
    void endDrag();
    [[nodiscard]] bool isDragging() const { return drag_.has_value(); }
    // Each step (> 0: in) leaves 0.85 of the distance to what is under the cursor, which keeps its
    // pixel. Never through it; without a surface always on.
    void wheel(double steps, glm::dvec2 px, std::optional<Vec3d> surface);

    void setKeys(const MoveKeys& keys);
    void setSpeedFactor(double factor);  // within 1/1000 to 1000
    [[nodiscard]] double speedFactor() const { return speedFactor_; }
    // Of a move along one direction, with the keys for fast and slow.
    [[nodiscard]] double speedModelUnitsPerSecond() const;
    // Distance to what is seen (for the speed); infinite when nothing is.
    void setDistanceSeen(double modelUnits);

    // Advances moves and transitions; true while the camera changes (keep drawing), and once after
    // any other call that changed it.
    bool update(double seconds);

    // These take CameraTransition::kSeconds; a drag, the wheel or a key that moves ends them where
    // they are. frame() keeps the direction and levels the horizon; an axis view frames the scene.
    void frame(const Box3d& boxModel);
    void frameAll() { frame(scene_); }
    void goHome() { goTo(home_); }
    void axisView(AxisView view);
    // Ends at `camera` but for the picture's size, which stays.
    void goTo(const hlod::Camera& camera);
    [[nodiscard]] bool isInTransition() const { return transition_.has_value(); }
    // At once; in all but the picture's size camera() is then equal to `camera`, until it moves.
    void jumpTo(const hlod::Camera& camera);

private:
    struct Drag {
        DragKind kind;
        glm::dvec2 px;     // where it began, less what went beyond a pole
        CameraPose start;  // moved along by keys
        Vec3d pivot;       // what was grabbed
        double depth;      // of it, > 0
    };
    void adopt(const hlod::Camera& camera);
    void apply(const CameraPose& pose);
    void stopMoves();
    void dragPan(glm::dvec2 deltaPx);
    void dragTurn(glm::dvec2 px);
    void dragZoom(glm::dvec2 deltaPx);
    void transitTo(const CameraPose& pose, double aheadModelUnits, std::optional<hlod::Camera> end);
    void frameFrom(const Attitude& attitude, const Box3d& boxModel);
    bool advanceTransition(double seconds);
    bool advanceMove(double seconds);
    [[nodiscard]] Vec3d wishedVelocity() const;

    [[nodiscard]] double tanY() const;
    [[nodiscard]] Vec3d rayOf(glm::dvec2 px) const;  // depth 1
    [[nodiscard]] double depthOf(const Vec3d& point) const;
    [[nodiscard]] bool isInPicture(const Vec3d& point) const;
    [[nodiscard]] double leastDistance() const;
    [[nodiscard]] double depthWithoutSurface() const;
    [[nodiscard]] Vec3d pivotWithoutSurface() const;
    [[nodiscard]] Vec3d zoomed(const CameraPose& from, const Vec3d& point, double share) const;

    hlod::Camera camera_, home_;
    UpFrame frame_;
    CameraPose pose_;  // of camera_
    ViewAxes axes_;
    double targetModelUnits_ = 1;  // from the eye to camera_.target
    Box3d scene_;
    Vec3d centre_{0.0};    // of the scene
    double diagonal_ = 1;  // > 0
    NavigationMode mode_ = NavigationMode::Orbit;
    std::optional<Drag> drag_;
    std::optional<Vec3d> pivot_;  // last grabbed on a surface
    std::optional<CameraTransition> transition_;
    std::optional<hlod::Camera> transitionEnd_;
    MoveKeys keys_;
    Vec3d velocity_{0.0};
    double speedFactor_ = 1;
    double distanceSeen_ = std::numeric_limits<double>::infinity();
    bool hasChanged_ = true;
};

}  // namespace pagoda::viewer
