#include "viewer/window/line_drawer.h"

#include "viewer/node_program.h"

#include <epoxy/gl.h>

#include <array>
#include <cstddef>

namespace pagoda::viewer {
namespace {

constexpr const char* kVertexShader = R"(#version 450 core
layout(location = 0) in vec3 fromEye;
layout(location = 1) in vec4 colourSrgb;
layout(location = 0) uniform vec3 rowX;
layout(location = 1) uniform vec3 rowY;
layout(location = 2) uniform vec3 rowW;
layout(location = 3) uniform float near;
layout(location = 0) out vec4 colour;
void main() {
    gl_Position = vec4(dot(rowX, fromEye), dot(rowY, fromEye), near, dot(rowW, fromEye));
    vec3 c = colourSrgb.rgb;
    colour = vec4(mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045))),
                  colourSrgb.a);
}
)";
constexpr const char* kFragmentShader = R"(#version 450 core
layout(location = 4) uniform float opacity;
layout(location = 0) in vec4 colour;
layout(location = 0) out vec4 result;
void main() { result = vec4(colour.rgb, colour.a * opacity); }
)";

constexpr float kBehindOpacity = 0.22f;

struct Vertex {
    Vec3f fromEye;
    glm::u8vec4 colour;
};

}  // namespace

LineDrawer::LineDrawer()
    : program_(linkProgram(kVertexShader, kFragmentShader)),
      array_(makeVertexArray()),
      buffer_(makeBuffer()) {
    const GlId id = array_.id();
    glVertexArrayAttribFormat(id, 0, 3, GL_FLOAT, GL_FALSE, offsetof(Vertex, fromEye));
    glVertexArrayAttribFormat(id, 1, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Vertex, colour));
    for (GLuint attribute = 0; attribute < 2; ++attribute) {
        glEnableVertexArrayAttrib(id, attribute);
        glVertexArrayAttribBinding(id, attribute, 0);
    }
    glVertexArrayVertexBuffer(id, 0, buffer_.id(), 0, sizeof(Vertex));
}

void LineDrawer::add(const Vec3d& from, const Vec3d& to, const glm::u8vec4& colour) {
    lines_.push_back({from, to, colour});
}

void LineDrawer::addBox(const Box3d& box, const glm::u8vec4& colour) {
    const auto corner = [&](unsigned bits) {
        return Vec3d((bits & 1u) != 0 ? box.max.x : box.min.x,
                     (bits & 2u) != 0 ? box.max.y : box.min.y,
                     (bits & 4u) != 0 ? box.max.z : box.min.z);
    };
    for (unsigned from = 0; from < 8; ++from) {
        for (const unsigned axis : {1u, 2u, 4u}) {
            if ((from & axis) == 0) add(corner(from), corner(from | axis), colour);
        }
    }
}

void LineDrawer::addFrustum(const hlod::Camera& camera, double distanceModelUnits,
                            const glm::u8vec4& colour) {
    const hlod::View view(camera, Box3d{camera.eye, camera.eye});
    std::array<Vec3d, 4> corners;
    for (size_t i = 0; i < corners.size(); ++i) {
        const double x = i == 1 || i == 2 ? 1.0 : -1.0, y = i >= 2 ? 1.0 : -1.0;
        corners[i] =
            view.eye() + distanceModelUnits * (view.forward() + view.right() * (x * view.tanX()) +
                                               view.up() * (y * view.tanY()));
    }
    for (size_t i = 0; i < corners.size(); ++i) {
        add(view.eye(), corners[i], colour);
        add(corners[i], corners[(i + 1) % corners.size()], colour);
    }
}

void LineDrawer::draw(const hlod::View& view, FrameTarget& target) {
    if (lines_.empty()) return;
    std::vector<Vertex> vertices;
    vertices.reserve(2 * lines_.size());
    for (const Line& line : lines_) {
        vertices.push_back({Vec3f(line.from - view.eye()), line.colour});
        vertices.push_back({Vec3f(line.to - view.eye()), line.colour});
    }
    lines_.clear();
    glNamedBufferData(buffer_.id(), static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)),
                      vertices.data(), GL_STREAM_DRAW);
    const GlId id = program_.id();
    const auto set = [&](GLint location, const Vec3d& v) {
        glProgramUniform3f(id, location, static_cast<float>(v.x), static_cast<float>(v.y),
                           static_cast<float>(v.z));
    };
    set(0, view.right() / view.tanX());
    set(1, view.up() / view.tanY());
    set(2, view.forward());
    glProgramUniform1f(id, 3, static_cast<float>(view.nearModelUnits()));
    target.beginOverlay();
    glUseProgram(id);
    glBindVertexArray(array_.id());
    const auto count = static_cast<GLsizei>(vertices.size());
    glDisable(GL_DEPTH_TEST);
    glProgramUniform1f(id, 4, kBehindOpacity);
    glDrawArrays(GL_LINES, 0, count);
    glEnable(GL_DEPTH_TEST);
    glProgramUniform1f(id, 4, 1.0f);
    glDrawArrays(GL_LINES, 0, count);
}

}  // namespace pagoda::viewer
