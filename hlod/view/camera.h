// camera.h: where the eye is, in double, and what follows from it for one frame.
// Spaces: model units, right-handed; the picture's x points right and y down, pixel (0,0) is top
// left and a pixel's centre lies at +0.5. Depth is reversed (near 1, infinity 0) without a far
// plane. Plain data and pure functions: any thread.
#pragma once

#include "hlod/view/clip.h"
#include "ooc/base/box.h"

#include <array>
#include <string>
#include <string_view>

namespace pagoda::hlod {

struct Camera {
    Vec3d eye{0.0};
    Vec3d target{0.0, 0.0, -1.0};  // not the eye
    Vec3d up{0.0, 1.0, 0.0};  // need not be orthogonal; any when parallel to the direction of view
    double fovyDegrees = 45.0;  // whole angle, top to bottom; in (0, 180)
    int widthPx = 1024, heightPx = 768;
    double nearModelUnits = 0.0;  // 0: chosen from the scene's box, see View
    [[nodiscard]] bool operator==(const Camera&) const = default;
};

// {"eye":[x,y,z], "target":[x,y,z], "up":[x,y,z], "fovy":degrees, "width":px, "height":px,
// "near":units}. Keys that are absent keep the value they have in `camera`; unknown keys are an
// error. Throws Error
// ("--camera" as its path when `text` is JSON itself) when it is no such object or not a camera.
[[nodiscard]] Camera parseCamera(std::string_view text, const Camera& defaults,
                                 const std::string& source = "--camera");
[[nodiscard]] std::string cameraToJson(const Camera& camera);

enum class UpAxis { Y, Z };
[[nodiscard]] Vec3d upVector(UpAxis up);
// Of a database's metadata: z unless it says y. Whatever else stands there is no error.
[[nodiscard]] UpAxis upAxisOf(const std::string& metadataJson);

// Unit vector from the model to the eye. Names: front, back, left, right, top, bottom, iso (front,
// right and a little above), or signs and axes ("+x", "-y+z", "+x+y+z": the eye is on that side).
// Front is +z with y up (glTF) and -y with z up. Throws Error for any other name.
[[nodiscard]] Vec3d viewDirection(std::string_view name, UpAxis up);

// Looks at the box from `direction` so that all of it is inside the picture with a small margin.
// An empty box or one without extent is looked at from one unit away. Size and fovy are kept.
[[nodiscard]] Camera frameBox(const Camera& camera, const Box3d& box, const Vec3d& direction,
                              UpAxis up);
// The same with any vector as the picture's up.
[[nodiscard]] Camera frameBox(const Camera& camera, const Box3d& box, const Vec3d& direction,
                              const Vec3d& up);

// A camera fixed for a frame: orthonormal axes, frustum and pixel scale.
class View {
public:
    // Without camera.nearModelUnits the near plane is put before all of `sceneBox`, or at a
    // millionth of its diagonal when the eye is inside or close: reversed float depth makes that
    // free.
    View(const Camera& camera, const Box3d& sceneBox, const Clip& clip = {});

    [[nodiscard]] const Camera& camera() const noexcept { return camera_; }
    [[nodiscard]] const Vec3d& eye() const noexcept { return camera_.eye; }
    [[nodiscard]] const Vec3d& right() const noexcept { return right_; }
    [[nodiscard]] const Vec3d& up() const noexcept { return up_; }
    [[nodiscard]] const Vec3d& forward() const noexcept { return forward_; }
    [[nodiscard]] double tanX() const noexcept { return tanX_; }  // of half the angle of view
    [[nodiscard]] double tanY() const noexcept { return tanY_; }
    [[nodiscard]] double nearModelUnits() const noexcept { return near_; }
    [[nodiscard]] const Clip& clip() const noexcept { return clip_; }

    // False only when all of the box lies outside one plane of the frustum, before the near plane
    // or in what the clip leaves out: never for a box that reaches the picture.
    [[nodiscard]] bool intersectsFrustum(const Box3d& box) const;
    // Pixels that `errorModelUnits` can span at the box's nearest point: error * height /
    // (2 tan(fovy/2) * distance of eye to box). At most what it is at the near plane: nothing
    // nearer is drawn, and around the eye, too, some tau must be coarse enough.
    [[nodiscard]] double ssePx(double errorModelUnits, const Box3d& box) const;
    // Distance of the eye to the box's nearest point, 0 inside.
    [[nodiscard]] double distanceTo(const Box3d& box) const;

private:
    Camera camera_;
    Clip clip_;
    Vec3d right_, up_, forward_;
    double tanX_ = 1, tanY_ = 1, near_ = 1;
    std::array<Vec3d, 4> sideNormals_;  // inwards; the planes pass through the eye
};

[[nodiscard]] double distance(const Vec3d& point, const Box3d& box);  // 0 inside

}  // namespace pagoda::hlod
