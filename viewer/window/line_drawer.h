// line_drawer.h: thin lines over a picture: what lies behind surfaces is drawn faintly. Positions
// are taken relative to the eye in double, so that they are steady far from the origin. Render
// thread only, context current.
#pragma once

#include "hlod/view/camera.h"
#include "viewer/frame_target.h"
#include "viewer/gl_names.h"

#include <glm/glm.hpp>

#include <vector>

namespace pagoda::viewer {

class LineDrawer {
public:
    LineDrawer();

    void add(const Vec3d& from, const Vec3d& to, const glm::u8vec4& colour);
    void addBox(const Box3d& box, const glm::u8vec4& colour);
    // The pyramid that `camera` sees, as far as `distanceModelUnits`.
    void addFrustum(const hlod::Camera& camera, double distanceModelUnits,
                    const glm::u8vec4& colour);
    // Draws what was added into `target` as `view` sees it, and forgets it.
    void draw(const hlod::View& view, FrameTarget& target);

private:
    struct Line {
        Vec3d from, to;
        glm::u8vec4 colour;
    };
    std::vector<Line> lines_;
    GlProgram program_;
    GlVertexArray array_;
    GlBuffer buffer_;
};

}  // namespace pagoda::viewer
