#include "viewer/window/preview_scene.h"

#include "viewer/lighting_glsl.h"
#include "viewer/node_program.h"
#include "viewer/window/seen_point.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

namespace pagoda::viewer {
namespace {

// Positions are relative to the preview's origin, the eye as well: float is fine enough for what is
// coarse. Discs are points as large as they are there, and at least so large that neighbours that
// a pixel lies between still meet.
constexpr const char* kVertexShader = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normalIn;
layout(location = 2) in vec4 colourSrgb;

layout(location = 0) uniform vec3 eye;
layout(location = 1) uniform vec3 rowX;
layout(location = 2) uniform vec3 rowY;
layout(location = 3) uniform vec3 rowW;
layout(location = 4) uniform float near;
layout(location = 7) uniform float discPxAtUnit;  // a disc's diameter at distance 1

layout(location = 0) out vec3 fromEye;
layout(location = 1) out vec3 normal;
layout(location = 2) out vec3 albedo;

void main() {
    fromEye = position - eye;
    float along = dot(rowW, fromEye);
    gl_Position = vec4(dot(rowX, fromEye), dot(rowY, fromEye), near, along);
    gl_PointSize = max(discPxAtUnit / max(along, near), 1.5);
    normal = normalIn;
    vec3 c = colourSrgb.rgb;
    albedo = mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}
)";

constexpr const char* kFragmentShader = R"(
layout(location = 8) uniform bool isDisc;

layout(location = 0) in vec3 fromEye;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 albedo;

layout(location = 0) out vec4 colour;
layout(location = 1) out uint nodeOrdinal;
layout(location = 2) out uint triangle;

void main() {
    vec2 fromMiddle = gl_PointCoord - 0.5;
    if (isDisc && dot(fromMiddle, fromMiddle) > 0.25) discard;
    colour = vec4(albedo * lightOn(normal, -normalize(fromEye)), 1.0);
    nodeOrdinal = 0u;
    triangle = 0u;
}
)";

enum Location { kEye, kRowX, kRowY, kRowW, kNear, kTowardsLight, kWorldUp, kDiscPx, kIsDisc };

}  // namespace

PreviewScene::PreviewScene(std::string name)
    : name_(std::move(name)),
      program_(linkProgram(
          kVertexShader,
          (std::string("#version 450 core\n") + kLightingGlsl + kFragmentShader).c_str())),
      array_(makeVertexArray()),
      buffer_(makeBuffer()) {
    const GlId id = array_.id();
    glVertexArrayAttribFormat(id, 0, 3, GL_FLOAT, GL_FALSE, offsetof(PreviewVertex, position));
    glVertexArrayAttribFormat(id, 1, 3, GL_FLOAT, GL_FALSE, offsetof(PreviewVertex, normal));
    glVertexArrayAttribFormat(id, 2, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(PreviewVertex, colour));
    for (GLuint attribute = 0; attribute < 3; ++attribute) {
        glEnableVertexArrayAttrib(id, attribute);
        glVertexArrayAttribBinding(id, attribute, 0);
    }
    glVertexArrayVertexBuffer(id, 0, buffer_.id(), 0, sizeof(PreviewVertex));
}

void PreviewScene::show(const Preview& preview) {
    origin_ = preview.origin;
    box_ = preview.box;
    up_ = preview.up;
    discModelUnits_ = preview.discModelUnits;
    trianglesSeen_ = preview.trianglesSeen;
    isWhole_ = preview.isWhole;
    discs_ = preview.discs.size();
    corners_ = preview.corners.size();
    const auto bytes = [](size_t vertices) {
        return static_cast<GLsizeiptr>(vertices * sizeof(PreviewVertex));
    };
    glNamedBufferData(buffer_.id(), bytes(discs_ + corners_), nullptr, GL_STATIC_DRAW);
    glNamedBufferSubData(buffer_.id(), 0, bytes(discs_), preview.discs.data());
    glNamedBufferSubData(buffer_.id(), bytes(discs_), bytes(corners_), preview.corners.data());
}

void PreviewScene::setUniforms(const hlod::View& view) {
    const GlId id = program_.id();
    const auto set = [&](Location location, const Vec3d& v) {
        glProgramUniform3f(id, location, static_cast<float>(v.x), static_cast<float>(v.y),
                           static_cast<float>(v.z));
    };
    set(kEye, view.eye() - origin_);
    set(kRowX, view.right() / view.tanX());
    set(kRowY, view.up() / view.tanY());
    set(kRowW, view.forward());
    glProgramUniform1f(id, kNear, static_cast<float>(view.nearModelUnits()));
    set(kTowardsLight, towardsLightOf(view.up(), view.right()));
    set(kWorldUp, hlod::upVector(up_));
    const double discPx = discModelUnits_ * view.camera().heightPx / (2.0 * view.tanY());
    glProgramUniform1f(id, kDiscPx, static_cast<float>(discPx));
}

void PreviewScene::draw(const hlod::Camera& camera) {
    camera_ = camera;
    const hlod::View view(camera, box_);
    if (!target_ || target_->widthPx() != camera.widthPx ||
        target_->heightPx() != camera.heightPx) {
        target_.reset();
        target_ = std::make_unique<FrameTarget>(camera.widthPx, camera.heightPx);
    }
    setUniforms(view);
    target_->begin({});
    target_->beginOpaque();
    glEnable(GL_PROGRAM_POINT_SIZE);
    glUseProgram(program_.id());
    glBindVertexArray(array_.id());
    const auto discs = static_cast<GLsizei>(discs_), corners = static_cast<GLsizei>(corners_);
    glProgramUniform1i(program_.id(), kIsDisc, 0);
    glDrawArrays(GL_TRIANGLES, discs, corners);
    glProgramUniform1i(program_.id(), kIsDisc, 1);
    glDrawArrays(GL_POINTS, 0, discs);
    glDisable(GL_PROGRAM_POINT_SIZE);
    target_->paintBackground();
}

std::optional<Vec3d> PreviewScene::surfaceAt(glm::dvec2 px) const {
    if (!target_) return std::nullopt;
    const auto seen = seenPoint(*target_, hlod::View(camera_, box_), static_cast<int>(px.x),
                                static_cast<int>(px.y));
    if (!seen) return std::nullopt;
    return seen->pointModel;
}

double PreviewScene::distanceSeen() const {
    if (!target_) return std::numeric_limits<double>::infinity();
    return nearestSeen(*target_, hlod::View(camera_, box_));
}

Picture PreviewScene::read() const {
    return target_->read(hlod::View(camera_, box_).nearModelUnits());
}

}  // namespace pagoda::viewer
