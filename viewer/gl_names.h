// gl_names.h: GL objects by RAII. They die while their context is current.
#pragma once

#include <cstdint>
#include <utility>

namespace pagoda::viewer {

using GlId = uint32_t;  // GLuint; GL headers stay in the .cpp files

template <void (*Delete)(GlId)>
class GlName {
public:
    GlName() = default;
    explicit GlName(GlId id) : id_(id) {}
    ~GlName() { reset(); }
    GlName(GlName&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
    GlName& operator=(GlName&& other) noexcept {
        if (this != &other) {
            reset();
            id_ = std::exchange(other.id_, 0);
        }
        return *this;
    }
    GlName(const GlName&) = delete;
    GlName& operator=(const GlName&) = delete;

    [[nodiscard]] GlId id() const noexcept { return id_; }

private:
    void reset() {
        if (id_ != 0) Delete(id_);
        id_ = 0;
    }
    GlId id_ = 0;
};

void deleteBuffer(GlId id);
void deleteTexture(GlId id);
void deleteFramebuffer(GlId id);
void deleteVertexArray(GlId id);
void deleteProgram(GlId id);

using GlBuffer = GlName<deleteBuffer>;
using GlTexture = GlName<deleteTexture>;
using GlFramebuffer = GlName<deleteFramebuffer>;
using GlVertexArray = GlName<deleteVertexArray>;
using GlProgram = GlName<deleteProgram>;

[[nodiscard]] GlBuffer makeBuffer();
[[nodiscard]] GlTexture makeTexture2d(uint32_t internalFormat, int widthPx, int heightPx);
// All of `buffer`, of `texels` texels, for texelFetch(). Throws Error when that is more than the
// driver reads (GL promises 65,536; drivers of GL 4.5 read 2^27 and more).
[[nodiscard]] GlTexture makeBufferTexture(uint32_t internalFormat, GlId buffer, uint64_t texels);
[[nodiscard]] GlFramebuffer makeFramebuffer();
[[nodiscard]] GlVertexArray makeVertexArray();

}  // namespace pagoda::viewer
