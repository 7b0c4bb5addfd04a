#include "viewer/window/glfw_window.h"

#include "ooc/base/error.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <imgui.h>

#include <algorithm>

namespace pagoda::viewer {
namespace {

constexpr int kMinWidthPx = 320, kMinHeightPx = 240;

[[noreturn]] void refuse(const std::string& what, const std::string& remedy) {
    const char* text = nullptr;
    glfwGetError(&text);
    throw Error("", "", text != nullptr ? what + " (" + text + ")" : what,
                remedy + "; without a window: pagoda render, build, bench, info, verify, extract");
}

}  // namespace

struct GlfwWindow::Callbacks {
    static GlfwWindow& self(GLFWwindow* window) {
        return *static_cast<GlfwWindow*>(glfwGetWindowUserPointer(window));
    }
    template <typename Call>
    static void tell(GLFWwindow* window, Call&& call) {
        WindowEvents* const events = self(window).events_;
        if (events == nullptr) return;
        events->onAnything();
        call(*events);
    }
    static bool hasUi() { return ImGui::GetCurrentContext() != nullptr; }

    static void key(GLFWwindow* window, int key, int code, int action, int modifiers) {
        if (hasUi()) ImGui_ImplGlfw_KeyCallback(window, key, code, action, modifiers);
        tell(window, [&](WindowEvents& events) {
            events.onKey(key, modifiers, action != GLFW_RELEASE, action == GLFW_REPEAT);
        });
    }
    static void character(GLFWwindow* window, unsigned codepoint) {
        if (hasUi()) ImGui_ImplGlfw_CharCallback(window, codepoint);
        tell(window, [](WindowEvents&) {});
    }
    static void button(GLFWwindow* window, int button, int action, int modifiers) {
        if (hasUi()) ImGui_ImplGlfw_MouseButtonCallback(window, button, action, modifiers);
        tell(window, [&](WindowEvents& events) {
            events.onButton(button, modifiers, action == GLFW_PRESS, self(window).cursorPx());
        });
    }
    static void cursor(GLFWwindow* window, double x, double y) {
        self(window).cursor_ = glm::dvec2(x, y);
        tell(window, [&](WindowEvents& events) { events.onCursor(self(window).toPx(x, y)); });
    }
    static void wheel(GLFWwindow* window, double x, double y) {
        if (hasUi()) ImGui_ImplGlfw_ScrollCallback(window, x, y);
        tell(window, [&](WindowEvents& events) { events.onWheel(y, self(window).cursorPx()); });
    }
    static void focus(GLFWwindow* window, int isFocused) {
        if (hasUi()) ImGui_ImplGlfw_WindowFocusCallback(window, isFocused);
        tell(window, [](WindowEvents&) {});
    }
    static void enter(GLFWwindow* window, int hasEntered) {
        if (hasUi()) ImGui_ImplGlfw_CursorEnterCallback(window, hasEntered);
        tell(window, [](WindowEvents&) {});
    }
    static void resize(GLFWwindow* window, int, int) {
        tell(window, [](WindowEvents& events) { events.onResize(); });
    }
    static void refresh(GLFWwindow* window) {
        tell(window, [](WindowEvents&) {});
    }
    static void drop(GLFWwindow* window, int count, const char** paths) {
        const std::vector<std::filesystem::path> files(paths, paths + count);
        tell(window, [&](WindowEvents& events) { events.onDrop(files); });
    }
};

GlfwWindow::GlfwWindow(int widthPx, int heightPx, const std::string& title) {
    if (glfwInit() != GLFW_TRUE) {
        refuse("no display to open a window on", "start it from a graphical session (DISPLAY)");
    }
    glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_API);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0);  // pictures have a framebuffer of their own
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    glfwWindowHint(GLFW_ALPHA_BITS, 0);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    window_ = glfwCreateWindow(widthPx, heightPx, title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) {
        try {
            refuse("this driver cannot give a window with OpenGL 4.5 core", "update the driver");
        } catch (...) {
            glfwTerminate();
            throw;
        }
    }
    glfwSetWindowUserPointer(window_, this);
    glfwSetWindowSizeLimits(window_, kMinWidthPx, kMinHeightPx, GLFW_DONT_CARE, GLFW_DONT_CARE);
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    glfwSetKeyCallback(window_, Callbacks::key);
    glfwSetCharCallback(window_, Callbacks::character);
    glfwSetMouseButtonCallback(window_, Callbacks::button);
    glfwSetCursorPosCallback(window_, Callbacks::cursor);
    glfwSetScrollCallback(window_, Callbacks::wheel);
    glfwSetWindowFocusCallback(window_, Callbacks::focus);
    glfwSetCursorEnterCallback(window_, Callbacks::enter);
    glfwSetFramebufferSizeCallback(window_, Callbacks::resize);
    glfwSetWindowRefreshCallback(window_, Callbacks::refresh);
    glfwSetDropCallback(window_, Callbacks::drop);
}

GlfwWindow::~GlfwWindow() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

void GlfwWindow::setTitle(const std::string& title) {
    glfwSetWindowTitle(window_, title.c_str());
}

void GlfwWindow::close() {
    glfwSetWindowShouldClose(window_, GLFW_TRUE);
}

bool GlfwWindow::shouldClose() const {
    return glfwWindowShouldClose(window_) == GLFW_TRUE;
}

void GlfwWindow::handleEvents(double waitSeconds) {
    if (waitSeconds > 0.0) {
        glfwWaitEventsTimeout(waitSeconds);
    } else {
        glfwPollEvents();
    }
}

void GlfwWindow::wake() {
    glfwPostEmptyEvent();
}

void GlfwWindow::swap() {
    glfwSwapBuffers(window_);
}

glm::ivec2 GlfwWindow::framebufferPx() const {
    glm::ivec2 size(0);
    glfwGetFramebufferSize(window_, &size.x, &size.y);
    return size;
}

double GlfwWindow::contentScale() const {
    float x = 1.0f, y = 1.0f;
    glfwGetWindowContentScale(window_, &x, &y);
    return std::clamp(static_cast<double>(std::max(x, y)), 1.0, 4.0);
}

glm::dvec2 GlfwWindow::toPx(double x, double y) const {
    glm::ivec2 size(0);
    glfwGetWindowSize(window_, &size.x, &size.y);
    if (size.x < 1 || size.y < 1) return {x, y};
    return glm::dvec2(x, y) * glm::dvec2(framebufferPx()) / glm::dvec2(size);
}

glm::dvec2 GlfwWindow::cursorPx() const {
    if (cursor_) return toPx(cursor_->x, cursor_->y);
    double x = 0.0, y = 0.0;
    glfwGetCursorPos(window_, &x, &y);
    return toPx(x, y);
}

std::string GlfwWindow::clipboard() const {
    const char* text = glfwGetClipboardString(window_);
    return text != nullptr ? text : "";
}

void GlfwWindow::setClipboard(const std::string& text) {
    glfwSetClipboardString(window_, text.c_str());
}

}  // namespace pagoda::viewer
