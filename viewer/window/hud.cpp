#include "ooc/base/number_text.h"
#include "viewer/window/panel_parts.h"
#include "viewer/window/panels.h"
#include "viewer/window/ui.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace pagoda::viewer {
namespace {

constexpr ImU32 kStreamColour = IM_COL32(94, 160, 210, 255);
constexpr ImU32 kTraverseColour = IM_COL32(232, 196, 84, 255);
constexpr ImU32 kQueryColour = IM_COL32(202, 110, 178, 255);
constexpr ImU32 kDrawColour = IM_COL32(112, 186, 118, 255);

// A height that holds the slowest bar and changes seldom.
float ceilingMs(const Timeline& timeline) {
    float greatest = 10.0f;
    for (size_t i = 0; i < Timeline::kFrames; ++i) {
        greatest = std::max(greatest, timeline.bar(i).totalMs());
    }
    const float decade = std::pow(10.0f, std::floor(std::log10(greatest)));
    for (const float step : {1.0f, 2.0f, 5.0f}) {
        if (greatest <= step * decade) return step * decade;
    }
    return 10.0f * decade;
}

void drawTimeline(const Timeline& timeline) {
    const float em = ImGui::GetFontSize();
    const ImVec2 origin = ImGui::GetCursorScreenPos();
    const ImVec2 size(ImGui::GetContentRegionAvail().x, 3.2f * em);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(origin, {origin.x + size.x, origin.y + size.y}, IM_COL32(0, 0, 0, 90), 3.0f);
    const float ceiling = ceilingMs(timeline);
    const float width = size.x / static_cast<float>(Timeline::kFrames);
    for (size_t i = 0; i < Timeline::kFrames; ++i) {
        const Timeline::Bar& bar = timeline.bar(i);
        const float left = origin.x + static_cast<float>(i) * width;
        float bottom = origin.y + size.y;
        const std::array<std::pair<float, ImU32>, 4> parts = {{{bar.drawMs, kDrawColour},
                                                               {bar.queryMs, kQueryColour},
                                                               {bar.traverseMs, kTraverseColour},
                                                               {bar.streamMs, kStreamColour}}};
        for (const auto& [ms, colour] : parts) {
            const float height = size.y * ms / ceiling;
            if (height < 0.3f) continue;
            list.AddRectFilled({left, bottom - height}, {left + width, bottom}, colour);
            bottom -= height;
        }
    }
    const std::string scale = fmt::format("{:.0f} ms", ceiling);
    list.AddText({origin.x + 0.3f * em, origin.y + 0.1f * em}, IM_COL32(255, 255, 255, 150),
                 scale.c_str());
    ImGui::Dummy(size);
    constexpr std::array<std::pair<const char*, ImU32>, 4> kLegend = {{{"draw", kDrawColour},
                                                                       {"query", kQueryColour},
                                                                       {"walk", kTraverseColour},
                                                                       {"load", kStreamColour}}};
    for (const auto& [name, colour] : kLegend) {
        ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(colour), "%s", name);
        ImGui::SameLine(0.0f, 0.9f * em);
    }
    ImGui::NewLine();
}

void frameRows(const Scene& scene, const ViewSettings& settings) {
    const hlod::FrameRecord& record = scene.record();
    numberRow("frame", fmt::format("{:.1f} ms   CPU {:.0f} ms", record.frameMs, record.cpuMs));
    const bool isRaised = record.effectiveTauPx > 1.001 * settings.tauPx;
    numberRow("tau",
              isRaised ? fmt::format("{:.3g} px, now {:.3g}", settings.tauPx, record.effectiveTauPx)
                       : fmt::format("{:.3g} px", settings.tauPx));
    numberRow("triangles", fmt::format("{} of {}", formatCount(record.drawnTriangles),
                                       formatCount(scene.triangles())));
    numberRow("nodes", fmt::format("{} drawn, {} hidden", formatCount(record.drawnNodes),
                                   formatCount(record.hiddenNodes)));
    numberRow("looked at", fmt::format("{}, {} outside", formatCount(record.visitedNodes),
                                       formatCount(record.culledNodes)));
    numberRow("queries", fmt::format("{}, {} waits", formatCount(record.queries), record.waits));
    if (record.standIns > 0) numberRow("stand-ins", formatCount(record.standIns));
}

void memoryRows(const hlod::FrameRecord& record, const Streaming& streaming) {
    const auto share = [](uint64_t used, uint64_t budget) {
        return fmt::format("{} of {}", formatBytes(used), formatBytes(budget));
    };
    numberRow("GPU", share(record.gpuBytes, streaming.gpuBudgetBytes));
    numberRow("host", share(record.hostBytes, streaming.hostBudgetBytes));
    numberRow("reads",
              fmt::format("{} in flight, {} waiting", streaming.inFlight, streaming.waiting));
    numberRow("rate", formatBytes(static_cast<uint64_t>(streaming.bytesPerSecond)) + "/s");
}

}  // namespace

void showHud(const Scene& scene, const ViewSettings& settings, const Streaming& streaming,
             const Timeline& timeline) {
    const float em = ImGui::GetFontSize();
    const hlod::FrameRecord& record = scene.record();
    ImGui::SetNextWindowPos({0.7f * em, 0.7f * em});
    ImGui::Begin("numbers", nullptr, kTellingPanel);
    ImGui::TextUnformatted(scene.name().c_str());
    ImGui::SameLine();
    ImGui::TextDisabled("%s", record.strategy.c_str());
    if (ImGui::BeginTable("rows", 2)) {
        ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, 5.2f * em);
        ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, 13.2f * em);
        frameRows(scene, settings);
        memoryRows(record, streaming);
        ImGui::EndTable();
    }
    drawTimeline(timeline);
    if (!record.choice.empty()) {
        ImGui::PushTextWrapPos(18.5f * em);
        ImGui::TextDisabled("%s", record.choice.c_str());
        ImGui::PopTextWrapPos();
    }
    const std::vector<std::string> faults = scene.faults();
    if (!faults.empty()) {
        ImGui::PushTextWrapPos(18.5f * em);
        ImGui::TextColored({1.0f, 0.5f, 0.42f, 1.0f}, "%zu faults; the first: %s", faults.size(),
                           faults.front().c_str());
        ImGui::PopTextWrapPos();
    }
    ImGui::End();
}

}  // namespace pagoda::viewer
