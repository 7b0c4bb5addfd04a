// panel_parts.h: what panels are made of: flags, colours, places, sliders with a name. Between
// Ui::beginFrame() and endFrame().
#pragma once

#include <imgui.h>

namespace pagoda::viewer {

inline constexpr ImGuiWindowFlags kFixedPanel =
    ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize |
    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
// Of a panel that only tells something: the mouse goes on to the model behind it.
inline constexpr ImGuiWindowFlags kTellingPanel = kFixedPanel | ImGuiWindowFlags_NoInputs;
inline const ImVec4 kAccent(0.56f, 0.80f, 0.94f, 1.0f);
inline const ImVec4 kAlarm(1.0f, 0.50f, 0.42f, 1.0f);

// Places the next panel: its point at these shares of its size lies at the same shares of the
// window, margins in pixels left out.
void placePanel(float shareX, float shareY, float marginX, float marginY);

// A faint name, and below it a slider as wide as the panel. True while it changes `value`.
[[nodiscard]] bool labelledSlider(const char* name, double& value, double least, double greatest,
                                  const char* format, ImGuiSliderFlags flags = 0);

}  // namespace pagoda::viewer
