#include "viewer/window/panel_parts.h"

#include <string>

namespace pagoda::viewer {

void placePanel(float shareX, float shareY, float marginX, float marginY) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(
        {marginX + shareX * (size.x - 2 * marginX), marginY + shareY * (size.y - 2 * marginY)},
        ImGuiCond_Always, {shareX, shareY});
}

bool labelledSlider(const char* name, double& value, double least, double greatest,
                    const char* format, ImGuiSliderFlags flags) {
    ImGui::TextDisabled("%s", name);
    ImGui::SetNextItemWidth(-1.0f);
    const std::string id = std::string("##") + name;
    return ImGui::SliderScalar(id.c_str(), ImGuiDataType_Double, &value, &least, &greatest, format,
                               flags | ImGuiSliderFlags_AlwaysClamp);
}

}  // namespace pagoda::viewer
