#include "viewer/gpu_depth_tests.h"

#include "ooc/base/error.h"
#include "viewer/node_program.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace pagoda::viewer {
namespace {

// A work group of the test takes a face; a thread takes every 64th of its first texels.
constexpr int kFirstTexels = 128;
constexpr int kMaxLevels = 8;  // 4^8 pixels: more than any texture has
constexpr GLuint kMaxGroups = 65535;

enum Binding : GLuint { kLevels = 0, kPushes = 1, kFaces = 2, kResults = 3 };

// Pixels to level 1. What is pushed is kept as level 0.
constexpr const char* kTakeShader = R"(#version 450 core
layout(local_size_x = 8, local_size_y = 8) in;
layout(location = 0) uniform ivec2 size;
layout(location = 1) uniform bool doesPush;
layout(binding = 0) uniform sampler2D drawnDepths;
layout(binding = 1) uniform usampler2D nodeOrdinals;
layout(binding = 0, r32f) uniform writeonly image2D pushedDepths;
layout(std430, binding = 0) writeonly buffer Levels { vec2 levels[]; };
layout(std430, binding = 1) readonly buffer Pushes { float pushes[]; };

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 low = 4 * texel, high = min(low + 4, size);
    if (any(greaterThanEqual(low, size))) return;
    vec2 farthestNearest = vec2(1e30, 0.0);
    for (int y = low.y; y < high.y; ++y) {
        for (int x = low.x; x < high.x; ++x) {
            float depth = texelFetch(drawnDepths, ivec2(x, y), 0).r;
            if (doesPush) {
                float push = pushes[texelFetch(nodeOrdinals, ivec2(x, y), 0).r];
                // Rounded outwards by more than these operations err.
                if (push > 0.0) depth = depth / (1.0 + depth * push) * (1.0 - 1e-6);
                imageStore(pushedDepths, ivec2(x, y), vec4(depth));
            }
            farthestNearest = vec2(min(farthestNearest.x, depth), max(farthestNearest.y, depth));
        }
    }
    levels[texel.y * ((size.x + 3) / 4) + texel.x] = farthestNearest;
}
)";

constexpr const char* kReduceShader = R"(#version 450 core
layout(local_size_x = 8, local_size_y = 8) in;
layout(location = 0) uniform ivec2 fromSize;
layout(location = 1) uniform ivec2 offsets;  // of the level that is read, and of the one above
layout(std430, binding = 0) buffer Levels { vec2 levels[]; };

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 low = 4 * texel, high = min(low + 4, fromSize);
    if (any(greaterThanEqual(low, fromSize))) return;
    vec2 farthestNearest = vec2(1e30, 0.0);
    for (int y = low.y; y < high.y; ++y) {
        for (int x = low.x; x < high.x; ++x) {
            vec2 below = levels[offsets.x + y * fromSize.x + x];
            farthestNearest = vec2(min(farthestNearest.x, below.x), max(farthestNearest.y, below.y));
        }
    }
    levels[offsets.y + texel.y * ((fromSize.x + 3) / 4) + texel.x] = farthestNearest;
}
)";

// The walk needs no stack: a texel's place tells which of its 16 siblings come next. Sizes of
// levels are uniforms: llvmpipe 22.3 answers textureSize() wrongly where the level differs between
// lanes.
constexpr const char* kTestShader = R"(#version 450 core
layout(local_size_x = 64) in;
const int kMaxTests = 2048;  // of a thread; then what is left of its texels counts whole
layout(location = 0) uniform uint faceCount;
layout(location = 1) uniform ivec2 offsetsAndWidths[8];
struct Face { vec4 edges[4]; vec4 depth; ivec4 rect; uvec4 boxAndLevel; };
layout(binding = 0) uniform sampler2D depths;
layout(std430, binding = 0) readonly buffer Levels { vec2 levels[]; };
layout(std430, binding = 2) readonly buffer Faces { Face faces[]; };
layout(std430, binding = 3) buffer Results { uint visiblePx[]; };

float greatest(vec3 plane, vec2 low, vec2 high) {
    return dot(plane.xy, mix(low, high, greaterThan(plane.xy, vec2(0.0)))) + plane.z;
}
float least(vec3 plane, vec2 low, vec2 high) { return -greatest(-plane, low, high); }

const int kNothing = 0, kWhole = 1, kLookBelow = 2;
// Of the face in a texel's pixels from `low` to `high`.
int look(uint face, int level, ivec2 texel, ivec2 low, ivec2 high) {
    vec2 farthestNearest;
    if (level == 0) {
        farthestNearest = texelFetch(depths, texel, 0).rr;
    } else {
        ivec2 place = offsetsAndWidths[level];
        farthestNearest = levels[place.x + texel.y * place.y + texel.x];
    }
    vec2 a = vec2(low - faces[face].rect.xy), b = vec2(high - faces[face].rect.xy);
    vec3 depth = faces[face].depth.xyz;
    if (greatest(depth, a, b) < farthestNearest.x) return kNothing;
    bool isWhole = least(depth, a, b) >= farthestNearest.y;
    for (int i = 0; i < 4; ++i) {
        vec3 edge = faces[face].edges[i].xyz;
        if (greatest(edge, a, b) < 0.0) return kNothing;
        isWhole = isWhole && least(edge, a, b) >= 0.0;
    }
    return isWhole || level == 0 ? kWhole : kLookBelow;
}

uint visibleBelow(uint face, ivec2 texel, int firstLevel, inout int testsLeft) {
    ivec4 rect = faces[face].rect;
    uint pixels = 0u;
    for (int level = firstLevel;;) {
        ivec2 low = max(texel << (2 * level), rect.xy);
        ivec2 high = min(((texel + 1) << (2 * level)) - 1, rect.zw);
        int found = kNothing;
        if (all(lessThanEqual(low, high))) found = look(face, level, texel, low, high);
        --testsLeft;
        if (found == kLookBelow && testsLeft > 0) {
            --level;
            texel <<= 2;
            continue;
        }
        if (found != kNothing) pixels += uint(high.x - low.x + 1) * uint(high.y - low.y + 1);
        while (level < firstLevel && (texel & 3) == ivec2(3)) {
            ++level;
            texel >>= 2;
        }
        if (level == firstLevel) return pixels;
        texel = (texel.x & 3) < 3 ? texel + ivec2(1, 0) : texel + ivec2(-3, 1);
    }
}

void main() {
    uint face = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (face >= faceCount) return;
    int level = int(faces[face].boxAndLevel.y);
    ivec4 range = faces[face].rect >> (2 * level);
    int across = range.z - range.x + 1, count = across * (range.w - range.y + 1);
    uint pixels = 0u;
    int testsLeft = kMaxTests;
    for (int i = int(gl_LocalInvocationID.x); i < count; i += 64) {
        pixels += visibleBelow(face, range.xy + ivec2(i % across, i / across), level, testsLeft);
    }
    if (pixels > 0u) atomicAdd(visiblePx[faces[face].boxAndLevel.x], pixels);
}
)";

template <typename T>
void fill(const GlBuffer& buffer, const std::vector<T>& items) {
    glNamedBufferData(buffer.id(), static_cast<GLsizeiptr>(items.size() * sizeof(T)), items.data(),
                      GL_STREAM_DRAW);
}

// Rounded outwards: what float products and sums of `across` and `up` pixels lose is less than this
// share of their terms (a sixteenth of it: four roundings of 2^-24 at most).
constexpr double kSlack = 1.0 / (1 << 20);

void setPlane(const hlod::ScreenPlane& plane, double scale, const hlod::BoxFace::Rect& rect,
              float (&out)[4]) {
    const double a = scale * plane.a, b = scale * plane.b;
    const double c = scale * plane.at(rect.x0 + 0.5, rect.y0 + 0.5);
    const double terms = std::abs(a) * (rect.x1 - rect.x0) + std::abs(b) * (rect.y1 - rect.y0);
    out[0] = static_cast<float>(a);
    out[1] = static_cast<float>(b);
    out[2] = static_cast<float>(std::clamp(c + kSlack * (terms + std::abs(c)), -1e30, 1e30));
    out[3] = 0.0f;
}

}  // namespace

GpuDepthTests::GpuDepthTests(std::function<void()> flushDraws, std::function<void()> restoreState)
    : DepthTests(std::move(flushDraws)),
      restoreState_(std::move(restoreState)),
      takeProgram_(linkComputeProgram(kTakeShader)),
      reduceProgram_(linkComputeProgram(kReduceShader)),
      testProgram_(linkComputeProgram(kTestShader)),
      levelsBuffer_(makeBuffer()),
      pushesBuffer_(makeBuffer()),
      facesBuffer_(makeBuffer()),
      resultsBuffer_(makeBuffer()) {
}

// Levels from 1 on, up to one of few enough texels for any face.
void GpuDepthTests::layOut(int widthPx, int heightPx) {
    if (widthPx == widthPx_ && heightPx == heightPx_) return;
    levels_.clear();
    int64_t texels = 0;
    for (int width = widthPx, height = heightPx;
         levels_.empty() || width * height > kFirstTexels;) {
        width = (width + 3) / 4;
        height = (height + 3) / 4;
        levels_.push_back({width, height, static_cast<int32_t>(texels)});
        texels += int64_t{width} * height;
    }
    const auto bytes = texels * static_cast<int64_t>(2 * sizeof(float));
    GLint64 limit = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limit);
    if (bytes > limit) {
        throw Error("", "",
                    "a depth pyramid of " + std::to_string(bytes) +
                        " bytes is more than the GPU's shaders can address",
                    "use --pyramid cpu, or a smaller --size");
    }
    glNamedBufferData(levelsBuffer_.id(), bytes, nullptr, GL_DYNAMIC_COPY);
    std::array<GLint, 2 * kMaxLevels> places{};
    for (size_t i = 0; i < levels_.size(); ++i) {
        places[2 * (i + 1)] = levels_[i].offset;
        places[2 * (i + 1) + 1] = levels_[i].width;
    }
    glProgramUniform2iv(testProgram_.id(), 1, kMaxLevels, places.data());
    widthPx_ = widthPx;
    heightPx_ = heightPx;
}

void GpuDepthTests::takeDepths() {
    layOut(target().widthPx(), target().heightPx());
    boxFaces_.setView(view());
    const bool doesPush = pushes() != nullptr;
    if (doesPush && (pushedWidth_ != widthPx_ || pushedHeight_ != heightPx_)) {
        pushedDepths_ = makeTexture2d(GL_R32F, widthPx_, heightPx_);
        pushedWidth_ = widthPx_;
        pushedHeight_ = heightPx_;
    }
    const auto dispatch = [](const Level& level) {
        glDispatchCompute(static_cast<GLuint>((level.width + 7) / 8),
                          static_cast<GLuint>((level.height + 7) / 8), 1);
    };
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kLevels, levelsBuffer_.id());
    glBindTextureUnit(0, target().depthTexture());
    glUseProgram(takeProgram_.id());
    glProgramUniform2i(takeProgram_.id(), 0, widthPx_, heightPx_);
    glProgramUniform1i(takeProgram_.id(), 1, doesPush ? 1 : 0);
    if (doesPush) {
        fill(pushesBuffer_, *pushes());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kPushes, pushesBuffer_.id());
        glBindTextureUnit(1, target().nodeOrdinalTexture());
        glBindImageTexture(0, pushedDepths_.id(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    }
    dispatch(levels_.front());
    glUseProgram(reduceProgram_.id());
    for (size_t i = 1; i < levels_.size(); ++i) {
        const Level &from = levels_[i - 1], &to = levels_[i];
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
        glProgramUniform2i(reduceProgram_.id(), 0, from.width, from.height);
        glProgramUniform2i(reduceProgram_.id(), 1, from.offset, to.offset);
        dispatch(to);
    }
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
    glBindTextureUnit(0, 0);
    glBindTextureUnit(1, 0);
    restoreState_();
}

GpuDepthTests::Face GpuDepthTests::makeFace(const hlod::BoxFace& face, uint32_t box) const {
    Face result{};
    for (size_t i = 0; i < 4; ++i) {
        // To pixels, so that a float holds it. An edge without length is the same everywhere.
        const hlod::ScreenPlane& edge = face.edges[i];
        const double slope = std::max(std::abs(edge.a), std::abs(edge.b));
        setPlane(edge, slope > 0.0 ? 1.0 / slope : 1.0, face.rect, result.edges[i]);
    }
    setPlane(face.depth, 1.0, face.rect, result.depth);
    const int rect[4] = {face.rect.x0, face.rect.y0, face.rect.x1, face.rect.y1};
    std::copy(std::begin(rect), std::end(rect), result.rect);
    const auto texels = [&](uint32_t level) {
        const int shift = 2 * static_cast<int>(level);
        return ((rect[2] >> shift) - (rect[0] >> shift) + 1) *
               ((rect[3] >> shift) - (rect[1] >> shift) + 1);
    };
    while (texels(result.firstLevel) > kFirstTexels) ++result.firstLevel;
    result.box = box;
    return result;
}

void GpuDepthTests::test(std::span<const Box3d> boxesModel, std::span<uint64_t> pixels) {
    faces_.clear();
    results_.assign(boxesModel.size(), 0);
    for (size_t i = 0; i < boxesModel.size(); ++i) {
        std::array<hlod::BoxFace, 3> faces;
        const std::span<const hlod::BoxFace> facing = boxFaces_.facing(boxesModel[i], faces);
        // The eye is in it.
        if (facing.empty()) {
            results_[i] = static_cast<uint32_t>(widthPx_) * static_cast<uint32_t>(heightPx_);
        }
        for (const hlod::BoxFace& face : facing) {
            if (!face.rect.isEmpty()) faces_.push_back(makeFace(face, static_cast<uint32_t>(i)));
        }
    }
    if (!faces_.empty()) {
        const auto count = static_cast<GLuint>(faces_.size());
        fill(facesBuffer_, faces_);
        fill(resultsBuffer_, results_);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kLevels, levelsBuffer_.id());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kFaces, facesBuffer_.id());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kResults, resultsBuffer_.id());
        glBindTextureUnit(0, pushes() != nullptr ? pushedDepths_.id() : target().depthTexture());
        glUseProgram(testProgram_.id());
        glProgramUniform1ui(testProgram_.id(), 0, count);
        glDispatchCompute(std::min(count, kMaxGroups), (count + kMaxGroups - 1) / kMaxGroups, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glGetNamedBufferSubData(resultsBuffer_.id(), 0,
                                static_cast<GLsizeiptr>(results_.size() * sizeof(uint32_t)),
                                results_.data());
        glBindTextureUnit(0, 0);
        restoreState_();
    }
    std::copy(results_.begin(), results_.end(), pixels.begin());
}

}  // namespace pagoda::viewer
