#include "viewer/box_queries.h"

#include "viewer/node_program.h"
#include "viewer/stopwatch.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cassert>
#include <utility>

namespace pagoda::viewer {
namespace {

// Faces as two triangles each, counter-clockwise from outside; bits 0 to 2 of a corner choose
// between the box's least and greatest x, y and z.
constexpr const char* kBoxVertex = R"(#version 450 core
layout(location = 0) uniform vec3 least;      // from the eye, in steps
layout(location = 1) uniform vec3 size;
layout(location = 2) uniform vec3 rowX;
layout(location = 3) uniform vec3 rowY;
layout(location = 4) uniform vec3 rowW;
layout(location = 5) uniform float nearSteps;
const int corners[36] = int[36](0,4,6, 0,6,2, 1,3,7, 1,7,5, 0,1,5, 0,5,4,
                                2,6,7, 2,7,3, 0,2,3, 0,3,1, 4,5,7, 4,7,6);
void main() {
    int corner = corners[gl_VertexID];
    vec3 p = least + size * vec3(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
    gl_Position = vec4(dot(rowX, p), dot(rowY, p), nearSteps, dot(rowW, p));
}
)";
constexpr const char* kBoxFragment = R"(#version 450 core
layout(early_fragment_tests) in;
void main() {}
)";
constexpr GLsizei kBoxVertices = 36;

// What was measured to be needed: half a pixel, and 1e-5 of the coordinate (rounding of float).
constexpr double kGrowPx = 0.5, kGrowShare = 1e-5;

void setVec3(GlId program, GLint location, const Vec3f& value) {
    glProgramUniform3f(program, location, value.x, value.y, value.z);
}

}  // namespace

BoxQueries::BoxQueries(std::function<void()> flushDraws, std::function<void()> restoreState,
                       bool isPollFree)
    : flushDraws_(std::move(flushDraws)),
      restoreState_(std::move(restoreState)),
      isPollFree_(isPollFree),
      program_(linkProgram(kBoxVertex, kBoxFragment)),
      emptyArray_(makeVertexArray()) {
}

BoxQueries::~BoxQueries() {
    glDeleteQueries(static_cast<GLsizei>(names_.size()), names_.data());
}

void BoxQueries::beginFrame(const hlod::View& view, const LatticeView& latticeView,
                            const ooc::Lattice& lattice) {
    eyeModel_ = view.eye();
    stepModel_ = lattice.step();
    pixelPerDistance_ = kGrowPx * 2.0 * view.tanY() / view.camera().heightPx;
    const GlId program = program_.id();
    setVec3(program, 2, latticeView.rowX);
    setVec3(program, 3, latticeView.rowY);
    setVec3(program, 4, latticeView.rowW);
    glProgramUniform1f(program, 5, latticeView.nearSteps);
    queries_ = 0;
    ms_ = 0.0;
}

GlId BoxQueries::takeName() {
    if (freeNames_.empty()) {
        constexpr GLsizei kNamesAtOnce = 64;
        std::vector<GlId> names(kNamesAtOnce);
        glGenQueries(kNamesAtOnce, names.data());
        names_.insert(names_.end(), names.begin(), names.end());
        freeNames_ = std::move(names);
    }
    const GlId name = freeNames_.back();
    freeNames_.pop_back();
    return name;
}

void BoxQueries::drawBox(const Box3d& boxModel) {
    const Vec3d centre = 0.5 * (boxModel.min + boxModel.max) - eyeModel_;
    const double growModel = pixelPerDistance_ * glm::length(centre);
    const Vec3d least = boxModel.min - eyeModel_, most = boxModel.max - eyeModel_;
    const Vec3d grow =
        glm::max(Vec3d(growModel), kGrowShare * glm::max(glm::abs(least), glm::abs(most)));
    setVec3(program_.id(), 0, Vec3f((least - grow) / stepModel_));
    setVec3(program_.id(), 1, Vec3f((most - least + 2.0 * grow) / stepModel_));
    glDrawArrays(GL_TRIANGLES, 0, kBoxVertices);
}

hlod::QueryTicket BoxQueries::query(const hlod::QueryShape& shape) {
    flushDraws_();
    Stopwatch watch;
    const auto* const together = std::get_if<std::vector<Box3d>>(&shape);
    assert(together != nullptr || std::holds_alternative<Box3d>(shape));
    for (GLuint output = 0; output < 3; ++output) {
        glColorMaski(output, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    }
    glDepthMask(GL_FALSE);
    glDepthFunc(GL_GEQUAL);
    glEnable(GL_DEPTH_CLAMP);
    glEnable(GL_CULL_FACE);
    glUseProgram(program_.id());
    glBindVertexArray(emptyArray_.id());
    const GlId name = takeName();
    glBeginQuery(GL_SAMPLES_PASSED, name);
    if (together != nullptr) {
        for (const Box3d& box : *together) drawBox(box);
    } else {
        drawBox(std::get<Box3d>(shape));
    }
    glEndQuery(GL_SAMPLES_PASSED);
    glDisable(GL_CULL_FACE);
    glDisable(GL_DEPTH_CLAMP);
    restoreState_();
    ++queries_;
    ms_ += watch.lapMs();
    return {name};
}

std::optional<uint64_t> BoxQueries::poll(hlod::QueryTicket ticket) {
    GLuint isThere = 0;
    glGetQueryObjectuiv(static_cast<GlId>(ticket.value), GL_QUERY_RESULT_AVAILABLE, &isThere);
    if (isThere == 0) return std::nullopt;
    return wait(ticket);
}

uint64_t BoxQueries::wait(hlod::QueryTicket ticket) {
    Stopwatch watch;
    GLuint64 pixels = 0;
    const auto name = static_cast<GlId>(ticket.value);
    glGetQueryObjectui64v(name, GL_QUERY_RESULT, &pixels);
    freeNames_.push_back(name);
    ms_ += watch.lapMs();
    return pixels;
}

}  // namespace pagoda::viewer
