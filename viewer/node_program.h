// node_program.h: the one program that draws nodes: opaque, translucent and zippers alike, so that
// equal lattice points run through identical arithmetic.
#pragma once

#include "viewer/gl_names.h"
#include "viewer/lattice_view.h"

#include <span>

namespace pagoda::viewer {

// A vertex as it lies in GPU memory: 20 bytes.
struct GpuVertex {
    int32_t x, y, z;          // lattice steps from the page's origin
    uint32_t colour;          // RGBA8 sRGB, red in the low byte
    int8_t normalU, normalV;  // ooc::OctNormal
    int16_t unused;
};
static_assert(sizeof(GpuVertex) == 20);

// What one draw adds to its vertices, as instanced attributes. 28 bytes.
struct DrawInstance {
    Vec3i offset;            // LatticeView::offsetOf()
    uint32_t nodeOrdinal;    // written to the item buffer; 0 is background
    uint32_t firstTriangle;  // added to the triangle's number within the draw
    uint32_t firstNormal;    // word of the draw's first triangle's normal; UINT32_MAX: none stored
    glm::u8vec4 tint{0};     // sRGB, painted over the vertices' colours as far as alpha says
};
static_assert(sizeof(DrawInstance) == 28);

// The texture unit of the normals: MeshStore::words() of the chunk. (As a storage buffer llvmpipe
// reads them pixel by pixel.)
inline constexpr uint32_t kNormalsUnit = 0;

class NodeProgram {
public:
    // With `captured` names (outputs of the vertex shader) for transform feedback, for tests. One
    // that `hasSection` writes gl_ClipDistance[0]: draw with GL_CLIP_DISTANCE0 enabled. The other
    // knows nothing of sections.
    explicit NodeProgram(std::span<const char* const> captured = {}, bool hasSection = false);

    void setView(const LatticeView& view, const Vec3f& worldUp);
    [[nodiscard]] GlId id() const noexcept { return program_.id(); }

private:
    GlProgram program_;
    bool hasSection_;
};

// Compiles and links; throws Error with the driver's log (a fault of ours).
[[nodiscard]] GlProgram linkProgram(const char* vertexSource, const char* fragmentSource,
                                    std::span<const char* const> captured = {});
[[nodiscard]] GlProgram linkComputeProgram(const char* source);

// A vertex array for GpuVertex and DrawInstance: vertices at binding 0, instances at binding 1.
[[nodiscard]] GlVertexArray makeNodeVertexArray();

}  // namespace pagoda::viewer
