// ui.h: Dear ImGui in our window: font, colours, one call before panels and one after. Main thread
// only, the window's context current.
#pragma once

#include "viewer/window/glfw_window.h"

#include <string>

namespace pagoda::viewer {

class Ui {
public:
    explicit Ui(GlfwWindow& window);
    ~Ui();
    Ui(const Ui&) = delete;
    Ui& operator=(const Ui&) = delete;

    void beginFrame();
    void endFrame();  // draws into the bound framebuffer

    // Is the mouse over a panel, or the keyboard in one of its fields?
    [[nodiscard]] bool wantsMouse() const;
    [[nodiscard]] bool wantsKeys() const;
    // Pixels of text against those of an ordinary screen, in the units of panels.
    [[nodiscard]] float textScale() const noexcept { return textScale_; }
    // Milliseconds of CPU from beginFrame() to draw lists, GL excluded; and of GL.
    [[nodiscard]] double buildMs() const noexcept { return buildMs_; }
    [[nodiscard]] double drawMs() const noexcept { return drawMs_; }

private:
    double buildMs_ = 0.0, drawMs_ = 0.0;
    double beganS_ = 0.0;
    float textScale_ = 1.0f;
};

// A row of a table of two columns: a name, faint, and what it is.
void numberRow(const char* name, const std::string& value);
// Four significant digits.
[[nodiscard]] std::string lengthText(double modelUnits);

}  // namespace pagoda::viewer
