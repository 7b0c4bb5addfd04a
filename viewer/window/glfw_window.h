// glfw_window.h: a window with an OpenGL 4.5 core context, and what happens to it. Main thread
// only, one at a time; the context is current from construction on. Positions are framebuffer
// pixels from the top left (on HiDPI screens a window's own units are larger).
#pragma once

#include <glm/glm.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

struct GLFWwindow;

namespace pagoda::viewer {

// What the window tells. Buttons and keys are numbered as by GLFW, `modifiers` are its bits.
class WindowEvents {
public:
    virtual ~WindowEvents() = default;
    virtual void onAnything() {}  // before each of the others: something is to be drawn
    virtual void onKey(int key, int modifiers, bool isDown, bool isRepeat) = 0;
    virtual void onButton(int button, int modifiers, bool isDown, glm::dvec2 px) = 0;
    virtual void onCursor(glm::dvec2 px) = 0;
    virtual void onWheel(double steps, glm::dvec2 px) = 0;
    virtual void onResize() = 0;
    virtual void onDrop(const std::vector<std::filesystem::path>& files) = 0;
};

class GlfwWindow {
public:
    // Throws Error, naming the commands that need no window, when there is no display or the driver
    // has no OpenGL 4.5.
    GlfwWindow(int widthPx, int heightPx, const std::string& title);
    ~GlfwWindow();
    GlfwWindow(const GlfwWindow&) = delete;
    GlfwWindow& operator=(const GlfwWindow&) = delete;

    void setEvents(WindowEvents* events) noexcept { events_ = events; }
    void setTitle(const std::string& title);
    void close();
    [[nodiscard]] bool shouldClose() const;

    // Hands over what has happened; waits for it at most so long (0: not at all).
    void handleEvents(double waitSeconds);
    // Ends the wait. From any thread, as long as a window is there.
    static void wake();
    void swap();

    [[nodiscard]] glm::ivec2 framebufferPx() const;
    // How many framebuffer pixels a point of text is larger than on an ordinary screen.
    [[nodiscard]] double contentScale() const;
    // As of the last event: the pointer may be elsewhere while a slow frame holds events up.
    [[nodiscard]] glm::dvec2 cursorPx() const;
    [[nodiscard]] std::string clipboard() const;
    void setClipboard(const std::string& text);
    [[nodiscard]] GLFWwindow* handle() const noexcept { return window_; }

private:
    struct Callbacks;
    [[nodiscard]] glm::dvec2 toPx(double x, double y) const;

    GLFWwindow* window_ = nullptr;
    WindowEvents* events_ = nullptr;
    std::optional<glm::dvec2> cursor_;  // of the last event, in the window system's units
};

}  // namespace pagoda::viewer
