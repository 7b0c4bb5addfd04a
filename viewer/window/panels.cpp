#include "viewer/window/panels.h"

#include "ooc/base/number_text.h"
#include "viewer/window/input_map.h"
#include "viewer/window/panel_parts.h"
#include "viewer/window/ui.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace pagoda::viewer {
namespace {

bool strategyCombo(ViewSettings& settings) {
    bool hasChanged = false;
    ImGui::TextDisabled("strategy (T)");
    ImGui::SetNextItemWidth(-1.0f);
    if (ImGui::BeginCombo("##strategy", settings.strategy.c_str())) {
        for (const hlod::StrategyRow& strategy : hlod::strategies()) {
            const std::string name(strategy.name);
            if (ImGui::Selectable(name.c_str(), name == settings.strategy)) {
                hasChanged = settings.strategy != name;
                settings.strategy = name;
            }
            ImGui::SameLine(5.0f * ImGui::GetFontSize());
            ImGui::TextDisabled("%s", std::string(strategy.what).c_str());
        }
        ImGui::EndCombo();
    }
    return hasChanged;
}

// Megabytes, on a logarithmic scale; tells once the handle is let go.
bool budgetSlider(const char* name, uint64_t& bytes, double leastMb, double greatestMb) {
    double megabytes = static_cast<double>(bytes) / 1e6;
    if (labelledSlider(name, megabytes, leastMb, greatestMb, "%.0f MB",
                       ImGuiSliderFlags_Logarithmic)) {
        bytes = static_cast<uint64_t>(megabytes * 1e6);
    }
    return ImGui::IsItemDeactivatedAfterEdit();
}

bool colouringCombo(ViewSettings& settings) {
    int colouring = static_cast<int>(settings.colouring);
    ImGui::TextDisabled("colours (C)");
    ImGui::SetNextItemWidth(-1.0f);
    if (!ImGui::Combo("##colours", &colouring, kColouringNames.data(),
                      static_cast<int>(kColouringNames.size()))) {
        return false;
    }
    settings.colouring = static_cast<Colouring>(colouring);
    return true;
}

bool runtimeSection(ViewSettings& settings) {
    RendererOptions& runtime = settings.runtime;
    bool hasChanged = budgetSlider("GPU budget", runtime.gpuBytes, 1.0, 8000.0);
    hasChanged |= budgetSlider("host budget", runtime.hostBytes, 4.0, 8000.0);
    int latency = static_cast<int>(runtime.queryLatencyFrames);
    ImGui::TextDisabled("answers of queries are late by");
    ImGui::SetNextItemWidth(-1.0f);
    if (ImGui::SliderInt("##latency", &latency, 0, 8, "%d frames", ImGuiSliderFlags_AlwaysClamp)) {
        runtime.queryLatencyFrames = static_cast<uint32_t>(latency);
    }
    hasChanged |= ImGui::IsItemDeactivatedAfterEdit();
    return hasChanged;
}

}  // namespace

Change showSteering(ViewSettings& settings, const hlod::FrameRecord& record) {
    Change change;
    const float em = ImGui::GetFontSize();
    placePanel(1.0f, 0.0f, 0.7f * em, 0.7f * em);
    ImGui::SetNextWindowSize({17.0f * em, 0.0f});
    ImGui::Begin("steering", nullptr, kFixedPanel);
    change.isLook |= strategyCombo(settings);
    change.isLook |= labelledSlider("tau, pixels (, .)", settings.tauPx, 0.25, 64.0, "%.2f",
                                    ImGuiSliderFlags_Logarithmic);
    if (record.effectiveTauPx > 1.001 * settings.tauPx) {
        ImGui::TextColored(kAccent, "now %.2f", record.effectiveTauPx);
    }
    ImGui::Separator();
    change.isLook |= ImGui::Checkbox("keep a frame rate while moving", &settings.holdsFrameRate);
    if (settings.holdsFrameRate) {
        change.isLook |= labelledSlider("frames a second", settings.targetFps, 2.0, 120.0, "%.0f",
                                        ImGuiSliderFlags_Logarithmic);
    }
    change.isLook |= ImGui::Checkbox("read ahead", &settings.runtime.doesPrefetch);
    if (!record.prefetchOff.empty()) ImGui::TextDisabled("off: %s", record.prefetchOff.c_str());
    ImGui::Separator();
    change.isRuntime |= runtimeSection(settings);
    ImGui::Separator();
    change.isLook |= colouringCombo(settings);
    change.isLook |= ImGui::Checkbox("wireframe (X)", &settings.isWireframe);
    ImGui::TextDisabled("while frozen (Z):");
    change.isLook |= ImGui::Checkbox("drawn boxes", &settings.showsDrawnBoxes);
    ImGui::SameLine();
    change.isLook |= ImGui::Checkbox("hidden ones", &settings.showsHiddenBoxes);
    ImGui::End();
    return change;
}

void showKeys() {
    const float em = ImGui::GetFontSize();
    placePanel(0.5f, 0.45f, em, em);
    ImGui::SetNextWindowBgAlpha(0.95f);
    ImGui::Begin("keys", nullptr, kFixedPanel);
    if (ImGui::BeginTable("keys", 2)) {
        ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, 12.0f * em);
        ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, 26.5f * em);
        for (const KeyLine& line : keyLines()) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            if (line.keys == nullptr) {
                ImGui::TextColored(kAccent, "%s", line.what);
                continue;
            }
            ImGui::TextUnformatted(line.keys);
            ImGui::TableNextColumn();
            ImGui::TextDisabled("%s", line.what);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

void showMessages(const std::vector<Message>& messages) {
    if (messages.empty()) return;
    const float em = ImGui::GetFontSize();
    placePanel(0.5f, 1.0f, em, 3.2f * em);
    ImGui::Begin("messages", nullptr, kFixedPanel);
    ImGui::PushTextWrapPos(std::min(40.0f * em, 0.8f * ImGui::GetIO().DisplaySize.x));
    for (const Message& message : messages) {
        if (message.isError) {
            ImGui::TextColored(kAlarm, "%s", message.text.c_str());
        } else {
            ImGui::TextUnformatted(message.text.c_str());
        }
    }
    ImGui::PopTextWrapPos();
    ImGui::End();
}

void showFooter(const Navigation* navigation, const ViewSettings& settings,
                const std::vector<std::string>& states) {
    const float em = ImGui::GetFontSize();
    placePanel(0.0f, 1.0f, 0.7f * em, 0.5f * em);
    ImGui::SetNextWindowBgAlpha(0.5f);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0.6f * em, 0.25f * em});
    ImGui::Begin("footer", nullptr, kFixedPanel | ImGuiWindowFlags_NoInputs);
    if (navigation != nullptr) {
        constexpr std::array kModes = {"orbit", "fly", "walk"};
        ImGui::TextColored(kAccent, "%s", kModes[static_cast<size_t>(navigation->mode())]);
        if (navigation->mode() != NavigationMode::Orbit) {
            ImGui::SameLine();
            ImGui::Text("%s units/s", lengthText(navigation->speedModelUnitsPerSecond()).c_str());
        }
        if (settings.colouring != Colouring::Model) {
            ImGui::SameLine();
            ImGui::Text("colours %s", kColouringNames[static_cast<size_t>(settings.colouring)]);
        }
    }
    for (const std::string& state : states) {
        ImGui::SameLine();
        ImGui::TextColored({1.0f, 0.62f, 0.80f, 1.0f}, "%s", state.c_str());
    }
    ImGui::SameLine();
    ImGui::TextDisabled("F1 keys   Tab steering");
    ImGui::End();
    ImGui::PopStyleVar();
}

bool showOpening(const std::string& name, const OpeningProgress& progress, uint64_t trianglesSeen) {
    const float em = ImGui::GetFontSize();
    placePanel(0.5f, 0.0f, em, 0.7f * em);
    ImGui::SetNextWindowSize({std::min(26.0f * em, 0.9f * ImGui::GetIO().DisplaySize.x), 0.0f});
    ImGui::Begin("opening", nullptr, kFixedPanel);
    ImGui::TextColored(kAccent, "%s", name.c_str());
    ImGui::SameLine();
    ImGui::TextUnformatted(progress.stage.c_str());
    if (progress.share >= 0.0) ImGui::ProgressBar(static_cast<float>(progress.share));
    ImGui::TextDisabled("%s", progress.detail.c_str());
    if (trianglesSeen > 0) {
        ImGui::TextDisabled("shown coarsely: of %s triangles", formatCount(trianglesSeen).c_str());
    }
    const bool isCancelled = ImGui::Button("cancel (Esc)");
    ImGui::End();
    return isCancelled;
}

void showWelcome() {
    placePanel(0.5f, 0.5f, 0.0f, 0.0f);
    ImGui::Begin("welcome", nullptr, kFixedPanel);
    ImGui::TextUnformatted("Drop a database or a model here.");
    ImGui::TextDisabled(
        "NAME.pagoda opens at once; PLY, OBJ, STL, OFF, glTF, GLB, Draco is built first");
    ImGui::End();
}

}  // namespace pagoda::viewer
