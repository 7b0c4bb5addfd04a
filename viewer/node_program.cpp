#include "viewer/node_program.h"

#include "ooc/base/error.h"
#include "viewer/lighting_glsl.h"

#include <epoxy/gl.h>

#include <cstddef>
#include <string>

namespace pagoda::viewer {
namespace {

constexpr const char* kVertexShader = R"(#version 450 core
layout(location = 0) in ivec3 positionSteps;   // from the page's origin
layout(location = 1) in vec4 colourSrgb;
layout(location = 2) in ivec2 normalOct;       // v = -128: none
layout(location = 3) in ivec3 offsetSteps;     // of the page's origin from the camera's cell
layout(location = 4) in uvec3 ordinalAndFirsts;
layout(location = 5) in vec4 tintSrgb;

layout(location = 0) uniform vec3 eye;         // from the camera's cell, in steps
layout(location = 1) uniform vec3 rowX;
layout(location = 2) uniform vec3 rowY;
layout(location = 3) uniform vec3 rowW;
layout(location = 4) uniform float nearSteps;
#ifdef SECTION
layout(location = 7) uniform vec4 section;     // normal, reach: LatticeView
#endif

invariant gl_Position;
layout(location = 0) out vec3 fromEye;
layout(location = 1) out vec3 normal;          // zero: none
layout(location = 2) out vec4 albedo;          // linear
layout(location = 3) flat out uvec3 ids;      // node ordinal, first triangle, first normal

vec3 decodeNormal(ivec2 oct) {
    if (oct.y == -128) return vec3(0.0);
    vec2 square = max(vec2(oct) / 127.0, vec2(-1.0));
    vec3 n = vec3(square, 1.0 - abs(square.x) - abs(square.y));
    if (n.z < 0.0) {
        vec2 signs = vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
        n.xy = (1.0 - abs(n.yx)) * signs;
    }
    return normalize(n);
}

vec3 linearFromSrgb(vec3 c) {
    return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}

void main() {
    // Integers until here, one conversion, then the same arithmetic for every node.
    precise vec3 relative = vec3(positionSteps + offsetSteps) - eye;
    precise vec4 clip = vec4(dot(rowX, relative), dot(rowY, relative), nearSteps, dot(rowW, relative));
    gl_Position = clip;
#ifdef SECTION
    gl_ClipDistance[0] = section.w - dot(section.xyz, relative);
#endif
    fromEye = relative;
    normal = decodeNormal(normalOct);
    albedo = vec4(linearFromSrgb(colourSrgb.rgb), colourSrgb.a);
    if (tintSrgb.a > 0.0) albedo.rgb = mix(albedo.rgb, linearFromSrgb(tintSrgb.rgb), tintSrgb.a);
    ids = ordinalAndFirsts;
}
)";

constexpr const char* kFragmentShader = R"(
layout(location = 0) in vec3 fromEye;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 albedo;
layout(location = 3) flat in uvec3 ids;

layout(location = 0) out vec4 colour;  // linear: the framebuffer encodes sRGB
layout(location = 1) out uint nodeOrdinal;
layout(location = 2) out uint triangle;

layout(binding = 0) uniform isamplerBuffer normals;  // octahedral, times 32767

vec3 flatNormal() {  // of any length
    // Translucent triangles are drawn in sorted order: theirs come from what the screen shows.
    if (ids.z == 0xFFFFFFFFu) return cross(dFdx(fromEye), dFdy(fromEye));
    vec2 square = vec2(texelFetch(normals, int(ids.z) + gl_PrimitiveID).xy);
    vec3 n = vec3(square, 32767.0 - abs(square.x) - abs(square.y));
    vec2 signs = vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
    if (n.z < 0.0) n.xy = (32767.0 - abs(n.yx)) * signs;
    return n;
}

void main() {
    vec3 towardsEye = -normalize(fromEye);
    vec3 n = normal;
    // A triangle with a corner that has no normal is flat as a whole: interpolation shortens the rest.
    if (dot(n, n) < 0.25) n = flatNormal();
    colour = vec4(albedo.rgb * lightOn(n, towardsEye), albedo.a);
    nodeOrdinal = ids.x;
    triangle = ids.y + uint(gl_PrimitiveID);
}
)";

enum Location { kEye, kRowX, kRowY, kRowW, kNearSteps, kTowardsLight, kWorldUp, kSection };

GlId compile(GLenum stage, const char* source) {
    const GlId shader = glCreateShader(stage);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    GLint isCompiled = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &isCompiled);
    if (isCompiled != 0) return shader;
    char log[2048] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    glDeleteShader(shader);
    throw Error("", "", std::string("the driver refuses a shader: ") + log, "please report it");
}

// Defines come behind the line with the version.
std::string vertexSource(bool hasSection) {
    std::string source = kVertexShader;
    if (hasSection) source.insert(source.find('\n') + 1, "#define SECTION\n");
    return source;
}

void attach(const GlProgram& program, GLenum stage, const char* source) {
    const GlId shader = compile(stage, source);
    glAttachShader(program.id(), shader);
    glDeleteShader(shader);  // freed with the program
}

void link(const GlProgram& program) {
    glLinkProgram(program.id());
    GLint isLinked = 0;
    glGetProgramiv(program.id(), GL_LINK_STATUS, &isLinked);
    if (isLinked == 0) {
        char log[2048] = "";
        glGetProgramInfoLog(program.id(), sizeof log, nullptr, log);
        throw Error("", "", std::string("the driver refuses a program: ") + log,
                    "please report it");
    }
}

void setVec3(GlId program, Location location, const Vec3f& value) {
    glProgramUniform3f(program, location, value.x, value.y, value.z);
}

}  // namespace

GlProgram linkProgram(const char* vertexSource, const char* fragmentSource,
                      std::span<const char* const> captured) {
    GlProgram program(glCreateProgram());
    attach(program, GL_VERTEX_SHADER, vertexSource);
    attach(program, GL_FRAGMENT_SHADER, fragmentSource);
    if (!captured.empty()) {
        glTransformFeedbackVaryings(program.id(), static_cast<GLsizei>(captured.size()),
                                    captured.data(), GL_INTERLEAVED_ATTRIBS);
    }
    link(program);
    return program;
}

GlProgram linkComputeProgram(const char* source) {
    GlProgram program(glCreateProgram());
    attach(program, GL_COMPUTE_SHADER, source);
    link(program);
    return program;
}

NodeProgram::NodeProgram(std::span<const char* const> captured, bool hasSection)
    : program_(linkProgram(
          vertexSource(hasSection).c_str(),
          (std::string("#version 450 core\n") + kLightingGlsl + kFragmentShader).c_str(),
          captured)),
      hasSection_(hasSection) {
}

void NodeProgram::setView(const LatticeView& view, const Vec3f& worldUp) {
    const GlId program = program_.id();
    setVec3(program, kEye, view.eye);
    setVec3(program, kRowX, view.rowX);
    setVec3(program, kRowY, view.rowY);
    setVec3(program, kRowW, view.rowW);
    glProgramUniform1f(program, kNearSteps, view.nearSteps);
    setVec3(program, kTowardsLight, towardsLightOf(view.up, view.right));
    setVec3(program, kWorldUp, worldUp);
    if (!hasSection_) return;
    const Vec3f& normal = view.sectionNormal;
    glProgramUniform4f(program, kSection, normal.x, normal.y, normal.z, view.sectionReachSteps);
}

GlVertexArray makeNodeVertexArray() {
    GlVertexArray array = makeVertexArray();
    const GlId id = array.id();
    glVertexArrayAttribIFormat(id, 0, 3, GL_INT, offsetof(GpuVertex, x));
    glVertexArrayAttribFormat(id, 1, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(GpuVertex, colour));
    glVertexArrayAttribIFormat(id, 2, 2, GL_BYTE, offsetof(GpuVertex, normalU));
    glVertexArrayAttribIFormat(id, 3, 3, GL_INT, offsetof(DrawInstance, offset));
    glVertexArrayAttribIFormat(id, 4, 3, GL_UNSIGNED_INT, offsetof(DrawInstance, nodeOrdinal));
    glVertexArrayAttribFormat(id, 5, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(DrawInstance, tint));
    for (GLuint attribute = 0; attribute < 6; ++attribute) {
        glEnableVertexArrayAttrib(id, attribute);
        glVertexArrayAttribBinding(id, attribute, attribute < 3 ? 0 : 1);
    }
    glVertexArrayBindingDivisor(id, 1, 1);
    return array;
}

}  // namespace pagoda::viewer
