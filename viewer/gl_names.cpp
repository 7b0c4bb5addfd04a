#include "viewer/gl_names.h"

#include "ooc/base/error.h"

#include <epoxy/gl.h>

#include <string>

namespace pagoda::viewer {

void deleteBuffer(GlId id) {
    glDeleteBuffers(1, &id);
}
void deleteTexture(GlId id) {
    glDeleteTextures(1, &id);
}
void deleteFramebuffer(GlId id) {
    glDeleteFramebuffers(1, &id);
}
void deleteVertexArray(GlId id) {
    glDeleteVertexArrays(1, &id);
}
void deleteProgram(GlId id) {
    glDeleteProgram(id);
}

GlBuffer makeBuffer() {
    GlId id = 0;
    glCreateBuffers(1, &id);
    return GlBuffer(id);
}

GlTexture makeTexture2d(uint32_t internalFormat, int widthPx, int heightPx) {
    GlId id = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &id);
    glTextureStorage2D(id, 1, internalFormat, widthPx, heightPx);
    return GlTexture(id);
}

GlTexture makeBufferTexture(uint32_t internalFormat, GlId buffer, uint64_t texels) {
    GLint limit = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &limit);
    if (texels > static_cast<uint64_t>(limit)) {
        throw Error("", "",
                    "this driver reads buffer textures of " + std::to_string(limit) +
                        " texels, and pages need " + std::to_string(texels),
                    "please report the driver");
    }
    GlId id = 0;
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &id);
    glTextureBuffer(id, internalFormat, buffer);
    return GlTexture(id);
}

GlFramebuffer makeFramebuffer() {
    GlId id = 0;
    glCreateFramebuffers(1, &id);
    return GlFramebuffer(id);
}

GlVertexArray makeVertexArray() {
    GlId id = 0;
    glCreateVertexArrays(1, &id);
    return GlVertexArray(id);
}

}  // namespace pagoda::viewer
