#include "viewer/frame_target.h"

#include "ooc/base/error.h"
#include "viewer/gl_context.h"
#include "viewer/node_program.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <limits>
#include <string>

namespace pagoda::viewer {
namespace {

constexpr const char* kBackgroundVertex = R"(#version 450 core
layout(location = 0) out float height;
void main() {
    vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    height = 0.5 + 0.5 * corner.y;
    gl_Position = vec4(corner, 0.0, 1.0);
}
)";
constexpr const char* kBackgroundFragment = R"(#version 450 core
layout(location = 0) uniform vec3 top;
layout(location = 1) uniform vec3 bottom;
layout(location = 0) in float height;
layout(location = 0) out vec4 colour;
void main() {
    vec3 c = mix(bottom, top, height);
    colour = vec4(mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045))), 0.0);
}
)";

template <typename T>
void flipRows(std::vector<T>& pixels, int widthPx, int heightPx, int channels) {
    const auto row = static_cast<ptrdiff_t>(widthPx) * channels;
    for (ptrdiff_t top = 0, bottom = heightPx - 1; top < bottom; ++top, --bottom) {
        std::swap_ranges(pixels.begin() + top * row, pixels.begin() + (top + 1) * row,
                         pixels.begin() + bottom * row);
    }
}

}  // namespace

FrameTarget::FrameTarget(int widthPx, int heightPx) : widthPx_(widthPx), heightPx_(heightPx) {
    GLint limit = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
    if (widthPx < 1 || heightPx < 1 || widthPx > limit || heightPx > limit) {
        throw Error(
            "", "",
            "a picture of " + std::to_string(widthPx) + "x" + std::to_string(heightPx) +
                " pixels cannot be drawn",
            "use --size from 1x1 to " + std::to_string(limit) + "x" + std::to_string(limit));
    }
    colour_ = makeTexture2d(GL_SRGB8_ALPHA8, widthPx, heightPx);
    nodeOrdinals_ = makeTexture2d(GL_R32UI, widthPx, heightPx);
    triangles_ = makeTexture2d(GL_R32UI, widthPx, heightPx);
    depth_ = makeTexture2d(GL_DEPTH_COMPONENT32F, widthPx, heightPx);
    // Integers are not interpolated: a shader that fetches them gets nothing else.
    glTextureParameteri(nodeOrdinals_.id(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(nodeOrdinals_.id(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    throwOnGlError("the picture");
    framebuffer_ = makeFramebuffer();
    const GlId id = framebuffer_.id();
    glNamedFramebufferTexture(id, GL_COLOR_ATTACHMENT0, colour_.id(), 0);
    glNamedFramebufferTexture(id, GL_COLOR_ATTACHMENT1, nodeOrdinals_.id(), 0);
    glNamedFramebufferTexture(id, GL_COLOR_ATTACHMENT2, triangles_.id(), 0);
    glNamedFramebufferTexture(id, GL_DEPTH_ATTACHMENT, depth_.id(), 0);
    const GLenum outputs[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
    glNamedFramebufferDrawBuffers(id, 3, outputs);
    if (glCheckNamedFramebufferStatus(id, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        throw Error("", "", "this driver cannot draw colour, ids and depth at once",
                    "OpenGL 4.5 asks for it: please report the driver");
    }
    backgroundProgram_ = linkProgram(kBackgroundVertex, kBackgroundFragment);
    emptyArray_ = makeVertexArray();
}

void FrameTarget::begin(const Background& background) {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
    glViewport(0, 0, widthPx_, heightPx_);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_FRAMEBUFFER_SRGB);
    glDisable(GL_CULL_FACE);
    glDisable(GL_DITHER);
    glDisable(GL_MULTISAMPLE);
    glDisable(GL_DEPTH_TEST);
    glDisablei(GL_BLEND, 0);
    for (GLuint output = 0; output < 3; ++output) {
        glColorMaski(output, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    }
    glDepthMask(GL_TRUE);
    const GLfloat transparent[4] = {0, 0, 0, 0};
    const GLuint none[4] = {0, 0, 0, 0};
    const GLfloat farthest = 0.0f;
    glClearBufferfv(GL_COLOR, 0, transparent);
    glClearBufferuiv(GL_COLOR, 1, none);
    glClearBufferuiv(GL_COLOR, 2, none);
    glClearBufferfv(GL_DEPTH, 0, &farthest);

    const auto setColour = [&](GLint location, const glm::u8vec3& c) {
        glProgramUniform3f(backgroundProgram_.id(), location, static_cast<float>(c.x) / 255.0f,
                           static_cast<float>(c.y) / 255.0f, static_cast<float>(c.z) / 255.0f);
    };
    setColour(0, background.top);
    setColour(1, background.bottom);
}

void FrameTarget::paintBackground() {
    glColorMaski(1, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glColorMaski(2, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDepthFunc(GL_EQUAL);  // the farthest depth, as it was cleared
    glDepthMask(GL_FALSE);
    glUseProgram(backgroundProgram_.id());
    glBindVertexArray(emptyArray_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

void FrameTarget::beginOpaque() {
    for (GLuint output = 0; output < 3; ++output) {
        glColorMaski(output, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    }
    glDisablei(GL_BLEND, 0);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);  // of equal depths the first drawn stays: the least node id
    glDepthMask(GL_TRUE);
}

void FrameTarget::beginTranslucent() {
    glColorMaski(1, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glColorMaski(2, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glEnablei(GL_BLEND, 0);
    glBlendFuncSeparatei(0, GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_FALSE);
}

void FrameTarget::readDepths(std::vector<float>& depths) const {
    depths.resize(static_cast<size_t>(widthPx_) * static_cast<size_t>(heightPx_));
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, widthPx_, heightPx_, GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
}

void FrameTarget::readNodeOrdinals(std::vector<uint32_t>& ordinals) const {
    ordinals.resize(static_cast<size_t>(widthPx_) * static_cast<size_t>(heightPx_));
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTextureImage(nodeOrdinals_.id(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT,
                      static_cast<GLsizei>(ordinals.size() * sizeof(uint32_t)), ordinals.data());
}

PixelSample FrameTarget::sample(int xPx, int yPx) const {
    PixelSample result;
    if (xPx < 0 || yPx < 0 || xPx >= widthPx_ || yPx >= heightPx_) return result;
    const GLint row = heightPx_ - 1 - yPx;
    const auto read = [&](const GlTexture& texture, GLenum format, GLenum type, auto& value) {
        glGetTextureSubImage(texture.id(), 0, xPx, row, 0, 1, 1, 1, format, type, sizeof value,
                             &value);
    };
    read(depth_, GL_DEPTH_COMPONENT, GL_FLOAT, result.reversedDepth);
    read(nodeOrdinals_, GL_RED_INTEGER, GL_UNSIGNED_INT, result.nodeOrdinal);
    read(triangles_, GL_RED_INTEGER, GL_UNSIGNED_INT, result.triangle);
    return result;
}

void FrameTarget::beginOverlay() {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
    glViewport(0, 0, widthPx_, heightPx_);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_FRAMEBUFFER_SRGB);
    beginTranslucent();
}

void FrameTarget::blitToWindow(int widthPx, int heightPx) const {
    // With conversion off, bytes that are sRGB already are copied as they are.
    glDisable(GL_FRAMEBUFFER_SRGB);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.id());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glColorMaski(0, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    const bool isSameSize = widthPx == widthPx_ && heightPx == heightPx_;
    glBlitFramebuffer(0, 0, widthPx_, heightPx_, 0, 0, widthPx, heightPx, GL_COLOR_BUFFER_BIT,
                      isSameSize ? GL_NEAREST : GL_LINEAR);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

Picture FrameTarget::read(double nearModelUnits) const {
    Picture picture;
    picture.widthPx = widthPx_;
    picture.heightPx = heightPx_;
    const size_t pixels = static_cast<size_t>(widthPx_) * static_cast<size_t>(heightPx_);
    picture.colours.resize(pixels * 4);
    picture.depthsModelUnits.resize(pixels);
    picture.nodeOrdinals.resize(pixels);
    picture.triangles.resize(pixels);
    const auto readTexture = [&](const GlTexture& texture, GLenum format, GLenum type, auto& out) {
        glGetTextureImage(texture.id(), 0, format, type,
                          static_cast<GLsizei>(out.size() * sizeof(out[0])), out.data());
    };
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    readTexture(colour_, GL_RGBA, GL_UNSIGNED_BYTE, picture.colours);
    readTexture(depth_, GL_DEPTH_COMPONENT, GL_FLOAT, picture.depthsModelUnits);
    readTexture(nodeOrdinals_, GL_RED_INTEGER, GL_UNSIGNED_INT, picture.nodeOrdinals);
    readTexture(triangles_, GL_RED_INTEGER, GL_UNSIGNED_INT, picture.triangles);
    throwOnGlError("reading the picture");
    flipRows(picture.colours, widthPx_, heightPx_, 4);
    flipRows(picture.depthsModelUnits, widthPx_, heightPx_, 1);
    flipRows(picture.nodeOrdinals, widthPx_, heightPx_, 1);
    flipRows(picture.triangles, widthPx_, heightPx_, 1);
    for (float& depth : picture.depthsModelUnits) {
        depth = depth > 0.0f ? static_cast<float>(nearModelUnits / static_cast<double>(depth))
                             : std::numeric_limits<float>::infinity();
    }
    return picture;
}

}  // namespace pagoda::viewer
