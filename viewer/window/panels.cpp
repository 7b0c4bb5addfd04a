#include "viewer/window/panels.h"

#include "ooc/base/number_text.h"
#include "viewer/window/input_map.h"
#include "viewer/window/ui.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace pagoda::viewer {
namespace {

constexpr ImGuiWindowFlags kFixed =
    ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize |
    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
const ImVec4 kAccent(0.56f, 0.80f, 0.94f, 1.0f);
const ImVec4 kAlarm(1.0f, 0.50f, 0.42f, 1.0f);

ImVec2 displaySize() {
    return ImGui::GetIO().DisplaySize;
}

void place(float shareX, float shareY, float marginX, float marginY) {
    const ImVec2 size = displaySize();
    ImGui::SetNextWindowPos(
        {marginX + shareX * (size.x - 2 * marginX), marginY + shareY * (size.y - 2 * marginY)},
        ImGuiCond_Always, {shareX, shareY});
}

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

bool slider(const char* name, double& value, double least, double greatest, const char* format,
            ImGuiSliderFlags flags = 0) {
    ImGui::TextDisabled("%s", name);
    ImGui::SetNextItemWidth(-1.0f);
    const std::string id = std::string("##") + name;
    return ImGui::SliderScalar(id.c_str(), ImGuiDataType_Double, &value, &least, &greatest, format,
                               flags | ImGuiSliderFlags_AlwaysClamp);
}

// Megabytes, on a logarithmic scale; tells once the handle is let go.
bool budgetSlider(const char* name, uint64_t& bytes, double leastMb, double greatestMb) {
    double megabytes = static_cast<double>(bytes) / 1e6;
    if (slider(name, megabytes, leastMb, greatestMb, "%.0f MB", ImGuiSliderFlags_Logarithmic)) {
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

std::string whyNotFiner(const Pick& pick, const hlod::FrameRecord& record) {
    if (pick.node.isLeaf()) return "a leaf: nothing is finer";
    if (pick.isStandIn) return "stands in: finer pages are on their way";
    if (pick.ssePx <= record.effectiveTauPx) return "its error is within tau";
    return "little of it is seen, or a neighbour needs it";
}

}  // namespace

Change showSteering(ViewSettings& settings, const hlod::FrameRecord& record) {
    Change change;
    const float em = ImGui::GetFontSize();
    place(1.0f, 0.0f, 0.7f * em, 0.7f * em);
    ImGui::SetNextWindowSize({17.0f * em, 0.0f});
    ImGui::Begin("steering", nullptr, kFixed);
    change.isLook |= strategyCombo(settings);
    change.isLook |= slider("tau, pixels (, .)", settings.tauPx, 0.25, 64.0, "%.2f",
                            ImGuiSliderFlags_Logarithmic);
    if (record.effectiveTauPx > 1.001 * settings.tauPx) {
        ImGui::TextColored(kAccent, "now %.2f", record.effectiveTauPx);
    }
    ImGui::Separator();
    change.isLook |= ImGui::Checkbox("keep a frame rate while moving", &settings.holdsFrameRate);
    if (settings.holdsFrameRate) {
        change.isLook |= slider("frames a second", settings.targetFps, 2.0, 120.0, "%.0f",
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
    place(0.5f, 0.45f, em, em);
    ImGui::SetNextWindowBgAlpha(0.95f);
    ImGui::Begin("keys", nullptr, kFixed);
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

void showPick(const Pick& pick, const hlod::FrameRecord& record) {
    const float em = ImGui::GetFontSize();
    place(1.0f, 1.0f, 0.7f * em, 2.6f * em);
    ImGui::Begin("pick", nullptr, kFixed);
    ImGui::TextColored(kAccent, "node 0x%llx", static_cast<unsigned long long>(pick.node.id.value));
    if (ImGui::BeginTable("rows", 2)) {
        const Vec3d& p = pick.pointModel;
        numberRow("level",
                  fmt::format("{}{}", pick.node.id.depth(), pick.node.isLeaf() ? ", leaf" : ""));
        numberRow("triangles",
                  fmt::format("{}, {} in the leaves below", formatCount(pick.node.triangleCount),
                              formatCount(pick.node.subtreeTriangles)));
        numberRow("error", fmt::format("{} units, {:.3g} px here",
                                       lengthText(pick.node.errorModelUnits), pick.errorHerePx));
        numberRow("SSE", fmt::format("{:.3g} px of {:.3g}, nearest of its box", pick.ssePx,
                                     record.effectiveTauPx));
        numberRow("page", formatBytes(pick.node.pageBytes));
        numberRow("here", fmt::format("{:.10g}  {:.10g}  {:.10g}", p.x, p.y, p.z));
        numberRow("distance", lengthText(pick.distanceModelUnits));
        if (pick.fromLastModelUnits)
            numberRow("from the last", lengthText(*pick.fromLastModelUnits));
        numberRow("not finer", whyNotFiner(pick, record));
        if ((pick.node.flags & ooc::kNodeSloppy) != 0)
            numberRow("clustered", "parts could not merge");
        if ((pick.node.flags & ooc::kNodeStuck) != 0)
            numberRow("stuck", "locked borders keep it fine");
        ImGui::EndTable();
    }
    ImGui::End();
}

void showMessages(const std::vector<Message>& messages) {
    if (messages.empty()) return;
    const float em = ImGui::GetFontSize();
    place(0.5f, 1.0f, em, 3.2f * em);
    ImGui::Begin("messages", nullptr, kFixed);
    ImGui::PushTextWrapPos(std::min(40.0f * em, 0.8f * displaySize().x));
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
    place(0.0f, 1.0f, 0.7f * em, 0.5f * em);
    ImGui::SetNextWindowBgAlpha(0.5f);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0.6f * em, 0.25f * em});
    ImGui::Begin("footer", nullptr, kFixed | ImGuiWindowFlags_NoInputs);
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

void showWelcome() {
    place(0.5f, 0.5f, 0.0f, 0.0f);
    ImGui::Begin("welcome", nullptr, kFixed);
    ImGui::TextUnformatted("Drop a database (NAME.pagoda) here.");
    ImGui::TextDisabled("Make one from a mesh: pagoda build MESH -o NAME.pagoda");
    ImGui::End();
}

}  // namespace pagoda::viewer
