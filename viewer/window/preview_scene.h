// preview_scene.h: draws what has been read of a model that is still being opened: discs and
// triangles, into a target of its own. What Scene is for a database. Main thread only, context
// current.
#pragma once

#include "viewer/frame_target.h"
#include "viewer/gl_names.h"
#include "viewer/picture.h"
#include "viewer/window/model_opening.h"

#include <memory>
#include <optional>
#include <string>

namespace pagoda::viewer {

class PreviewScene {
public:
    explicit PreviewScene(std::string name);

    // Replaces what is drawn. Uploads; keeps no vertices in host memory.
    void show(const Preview& preview);
    // Draws a frame, whole: there is nothing to wait for. Throws Error where the driver has no
    // picture of the camera's size.
    void draw(const hlod::Camera& camera);

    [[nodiscard]] const std::string& name() const noexcept { return name_; }
    [[nodiscard]] const Box3d& box() const noexcept { return box_; }
    [[nodiscard]] hlod::UpAxis up() const noexcept { return up_; }
    [[nodiscard]] uint64_t trianglesSeen() const noexcept { return trianglesSeen_; }
    [[nodiscard]] bool isWhole() const noexcept { return isWhole_; }
    [[nodiscard]] size_t discCount() const noexcept { return discs_; }
    [[nodiscard]] size_t triangleCount() const noexcept { return corners_ / 3; }

    // Of the last frame; a pixel from the top left.
    [[nodiscard]] std::optional<Vec3d> surfaceAt(glm::dvec2 px) const;
    [[nodiscard]] double distanceSeen() const;
    [[nodiscard]] Picture read() const;
    [[nodiscard]] FrameTarget* target() noexcept { return target_.get(); }

private:
    void setUniforms(const hlod::View& view);

    std::string name_;
    Vec3d origin_{0.0};
    Box3d box_;
    hlod::UpAxis up_ = hlod::UpAxis::Z;
    double discModelUnits_ = 0.0;
    uint64_t trianglesSeen_ = 0;
    bool isWhole_ = false;
    size_t discs_ = 0, corners_ = 0;  // in the buffer, in this order

    GlProgram program_;
    GlVertexArray array_;
    GlBuffer buffer_;
    std::unique_ptr<FrameTarget> target_;
    hlod::Camera camera_;  // of the last frame
};

}  // namespace pagoda::viewer
