// gl_context.h: an OpenGL 4.5 core context without a window, a display or an X server (EGL,
// surfaceless). Everything that draws takes one by reference; it must be current on the calling
// thread, and is, from its construction on. Own framebuffers only (FrameTarget): there is no
// default one.
#pragma once

#include <string>

namespace pagoda::viewer {

class GlContext {
public:
    // Throws Error, naming the commands that need no GL, when there is no driver or it is too old.
    [[nodiscard]] static GlContext headless();
    ~GlContext();
    GlContext(GlContext&& other) noexcept;
    GlContext& operator=(GlContext&&) = delete;
    GlContext(const GlContext&) = delete;
    GlContext& operator=(const GlContext&) = delete;

    // "llvmpipe (LLVM 15.0.6, 256 bits), 4.5 (Core Profile) Mesa 22.3.6"
    [[nodiscard]] const std::string& rendererName() const noexcept { return rendererName_; }

private:
    GlContext(void* display, void* context);

    void* display_ = nullptr;  // EGLDisplay, EGLContext: EGL headers stay out of ours
    void* context_ = nullptr;
    std::string rendererName_;
};

// Does the current context draw on the CPU? There an answer that is polled for makes it begin work
// that it would rather gather, and depth is read as fast as memory.
[[nodiscard]] bool isSoftwareRenderer();

// Throws Error for what GL has to complain about since the last call; `where` says what was done.
void throwOnGlError(const char* where);

}  // namespace pagoda::viewer
