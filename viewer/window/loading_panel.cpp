#include "ooc/base/number_text.h"
#include "viewer/window/panel_parts.h"
#include "viewer/window/panels.h"
#include "viewer/window/ui.h"

#include <fmt/format.h>

#include <string>

namespace pagoda::viewer {
namespace {

constexpr double kGreatestMBPerS = 2000.0;  // above it, the disk is as it is

void cell(const std::string& text) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(text.c_str());
}

void codecRow(ooc::Codec codec, const cache::CodecSums& sums) {
    if (sums.pages == 0) return;
    const auto encoded = static_cast<double>(sums.encodedBytes);
    const auto decoded = static_cast<double>(sums.decodedBytes);
    ImGui::TableNextRow();
    cell(std::string(ooc::codecName(codec)));
    cell(formatCount(sums.pages));
    cell(formatBytes(sums.encodedBytes));
    cell(fmt::format("{:.3g}", 8.0 * encoded / static_cast<double>(sums.triangles)));
    cell(fmt::format("{:.3g}", decoded / encoded));
    cell(sums.decodeS > 0.0 ? formatBytes(static_cast<uint64_t>(decoded / sums.decodeS)) + "/s"
                            : "");
}

void codecTable(const cache::CodecStatistics& codecs) {
    if (!ImGui::BeginTable("codecs", 6)) return;
    for (const char* name : {"codec", "pages", "encoded", "bits/tri.", "ratio", "decoded"}) {
        ImGui::TableNextColumn();
        ImGui::TextDisabled("%s", name);
    }
    for (size_t i = 0; i < codecs.size(); ++i) codecRow(static_cast<ooc::Codec>(i), codecs[i]);
    ImGui::EndTable();
}

void requestRows(Scene& scene) {
    cache::Streaming& streaming = scene.renderer().runner().streaming();
    const cache::RequestQueue::Counters& requests = streaming.requests().counters();
    const cache::Residency::Counters& pages = streaming.residency().counters();
    const cache::LineEstimate& line = streaming.requests().line();
    if (!ImGui::BeginTable("requests", 2)) return;
    numberRow("reads",
              fmt::format("{}, {}", formatCount(requests.reads), formatBytes(requests.bytesRead)));
    numberRow("the line", line.bytesPerS() > 0.0
                              ? fmt::format("{}/s, {:.3g} ms",
                                            formatBytes(static_cast<uint64_t>(line.bytesPerS())),
                                            1e3 * std::max(line.latencyS(), 0.0))
                              : "not measured yet");
    numberRow("again", fmt::format("{} pages, {}", formatCount(pages.reloadedPages),
                                   formatBytes(pages.bytesReloaded)));
    numberRow("evicted", fmt::format("{} pages", formatCount(pages.evictedPages)));
    numberRow("failed", fmt::format("{} tried again, {} given up", formatCount(requests.retried),
                                    formatCount(requests.failed)));
    numberRow("cancelled", formatCount(requests.cancelled));
    ImGui::EndTable();
}

bool diskSliders(cache::DiskProfile& disk) {
    double megabytesPerS = disk.bytesPerS > 0.0 ? disk.bytesPerS / 1e6 : kGreatestMBPerS;
    bool hasChanged = labelledSlider("simulated disk", megabytesPerS, 0.1, kGreatestMBPerS,
                                     megabytesPerS < kGreatestMBPerS ? "%.3g MB/s" : "as it is",
                                     ImGuiSliderFlags_Logarithmic);
    double latencyMs = 1e3 * disk.latencyS, failPercent = 100.0 * disk.failShare;
    hasChanged |= labelledSlider("its latency", latencyMs, 0.0, 500.0, "%.0f ms");
    hasChanged |= labelledSlider("reads that fail", failPercent, 0.0, 50.0, "%.0f %%");
    if (!hasChanged) return false;
    disk.bytesPerS = megabytesPerS < kGreatestMBPerS ? 1e6 * megabytesPerS : 0.0;
    disk.latencyS = 1e-3 * latencyMs;
    disk.failShare = failPercent / 100.0;
    return true;
}

}  // namespace

Change showLoading(Scene& scene, cache::DiskProfile& disk) {
    Change change;
    const float em = ImGui::GetFontSize();
    placePanel(0.5f, 1.0f, 0.7f * em, 2.6f * em);
    ImGui::SetNextWindowSize({25.0f * em, 0.0f});
    ImGui::Begin("loading", nullptr, kFixedPanel);
    ImGui::TextColored(kAccent, "loading (M)");
    codecTable(scene.renderer().runner().streaming().residency().codecs());
    ImGui::Separator();
    requestRows(scene);
    ImGui::Separator();
    change.isDisk = diskSliders(disk);
    ImGui::TextDisabled("Holds for what is read from now on.");
    ImGui::End();
    return change;
}

}  // namespace pagoda::viewer
