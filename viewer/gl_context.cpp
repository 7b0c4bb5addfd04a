#include "viewer/gl_context.h"

#include "ooc/base/error.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <cstdio>
#include <utility>

namespace pagoda::viewer {
namespace {

[[noreturn]] void refuse(const std::string& what) {
    throw Error("", "", what,
                "install a driver with EGL and OpenGL 4.5 (Mesa: libegl1 libgl1-mesa-dri); the "
                "commands build, "
                "info, verify and extract need none");
}

EGLDisplay openDisplay() {
    // EGL_PLATFORM_SURFACELESS_MESA needs no X server and no GPU; the default display is the second
    // try, for drivers without that platform.
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
        const EGLDisplay display =
            eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
        if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE) {
            return display;
        }
    }
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") &&
        epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device")) {
        EGLDeviceEXT device = nullptr;
        EGLint count = 0;
        if (eglQueryDevicesEXT(1, &device, &count) == EGL_TRUE && count > 0) {
            const EGLDisplay display =
                eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
            if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE) {
                return display;
            }
        }
    }
    refuse("no EGL display that works without a window");
}

}  // namespace

GlContext GlContext::headless() {
    const EGLDisplay display = openDisplay();
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) refuse("this EGL has no desktop OpenGL");
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE};
    const EGLContext context =
        eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (context == EGL_NO_CONTEXT) {
        eglTerminate(display);
        refuse("this driver cannot give OpenGL 4.5 core");
    }
    GlContext result(display, context);
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) != EGL_TRUE) {
        refuse("this driver cannot draw without a surface");
    }
    const auto text = [](GLenum name) {
        const GLubyte* value = glGetString(name);
        return value == nullptr ? std::string("?")
                                : std::string(reinterpret_cast<const char*>(value));
    };
    result.rendererName_ = text(GL_RENDERER) + ", " + text(GL_VERSION);
    return result;
}

GlContext::GlContext(void* display, void* context) : display_(display), context_(context) {
}

GlContext::GlContext(GlContext&& other) noexcept
    : display_(std::exchange(other.display_, nullptr)),
      context_(std::exchange(other.context_, nullptr)),
      rendererName_(std::move(other.rendererName_)) {
}

GlContext::~GlContext() {
    if (context_ == nullptr) return;
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    // No eglTerminate: the display is shared with any other context of this process.
}

bool isSoftwareRenderer() {
    const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    const std::string_view renderer = name != nullptr ? name : "";
    return renderer.starts_with("llvmpipe") || renderer.starts_with("softpipe");
}

void throwOnGlError(const char* where) {
    const GLenum code = glGetError();
    if (code == GL_NO_ERROR) return;
    while (glGetError() != GL_NO_ERROR) {
    }
    if (code == GL_OUT_OF_MEMORY) {
        throw Error("", "", std::string("OpenGL has no memory left for ") + where,
                    "use a smaller --gpu-budget or picture");
    }
    char number[16];
    std::snprintf(number, sizeof number, "0x%04x", code);
    throw Error("", "", std::string("OpenGL error ") + number + " at " + where,
                "this is a fault of Pagoda or of the driver: please report it");
}

}  // namespace pagoda::viewer
