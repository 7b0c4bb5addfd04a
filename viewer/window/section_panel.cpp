#include "viewer/window/panel_parts.h"
#include "viewer/window/panels.h"

#include <array>
#include <utility>

namespace pagoda::viewer {
namespace {

// The side that faces the eye goes, so that one looks into what is left.
bool axisButtons(Section& section, const Scene& scene) {
    constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
    const Box3d box = scene.box();
    const Vec3d towardsEye = scene.camera().eye - 0.5 * (box.min + box.max);
    bool hasChanged = false;
    for (int axis = 0; axis < 3; ++axis) {
        if (axis > 0) ImGui::SameLine();
        if (!ImGui::Button(kNames[static_cast<size_t>(axis)])) continue;
        Vec3d normal(0.0);
        normal[axis] = towardsEye[axis] < 0.0 ? -1.0 : 1.0;
        section.setNormal(normal);
        section.share = 0.5;
        hasChanged = true;
    }
    ImGui::SameLine();
    if (ImGui::Button("view")) {
        section.setNormal(scene.camera().eye - scene.camera().target);
        hasChanged = true;
    }
    ImGui::SameLine();
    if (ImGui::Button("flip")) {
        section.flip();
        hasChanged = true;
    }
    return hasChanged;
}

// Along the triangle that was clicked.
bool clickedButton(Section& section, const Scene& scene, const Inspection& inspection) {
    if (!inspection.exact()) return false;
    const hlod::LeafHit& hit = inspection.exact()->hit;
    const Vec3d normal = glm::cross(hit.cornersModel[1] - hit.cornersModel[0],
                                    hit.cornersModel[2] - hit.cornersModel[0]);
    if (!(glm::length(normal) > 0.0) || !ImGui::Button("along what was clicked")) return false;
    const bool isTowardsEye = glm::dot(normal, scene.camera().eye - hit.pointModel) > 0.0;
    section.setPlane(isTowardsEye ? normal : -normal, hit.pointModel, scene.box());
    return true;
}

}  // namespace

Change showSection(Section& section, const Scene& scene, const Inspection& inspection) {
    Change change;
    const float em = ImGui::GetFontSize();
    placePanel(0.5f, 0.0f, 0.7f * em, 0.7f * em);
    ImGui::SetNextWindowSize({17.0f * em, 0.0f});
    ImGui::Begin("section", nullptr, kFixedPanel);
    ImGui::TextColored(kAccent, "section (N)");
    ImGui::SameLine();
    change.isLook |= axisButtons(section, scene);
    double percent = 100.0 * section.share;
    if (labelledSlider("place", percent, 0.0, 100.0, "%.1f %%")) {
        section.share = percent / 100.0;
        change.isLook = true;
    }
    change.isLook |=
        labelledSlider("turned", section.azimuthDegrees, -180.0, 180.0, "%.1f degrees");
    change.isLook |=
        labelledSlider("raised", section.elevationDegrees, -90.0, 90.0, "%.1f degrees");
    change.isLook |= clickedButton(section, scene, inspection);
    ImGui::End();
    return change;
}

}  // namespace pagoda::viewer
