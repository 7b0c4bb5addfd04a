#include "ooc/base/number_text.h"
#include "viewer/window/panel_parts.h"
#include "viewer/window/panels.h"
#include "viewer/window/ui.h"

#include <fmt/format.h>

#include <algorithm>

namespace pagoda::viewer {
namespace {

std::string pointText(const Vec3d& p) {
    return fmt::format("{:.12g}  {:.12g}  {:.12g}", p.x, p.y, p.z);
}

std::string whyNotFiner(const Pick& pick, const Scene& scene) {
    const hlod::FrameRecord& record = scene.record();
    const hlod::NodeWatch& watch = scene.watched();
    if (pick.node.isLeaf()) return "a leaf: nothing is finer";
    if (pick.isStandIn) {
        return record.missingPages > 0 ? "stands in: finer pages are on their way"
                                       : "stood in when it was clicked";
    }
    const std::string raised = record.effectiveTauPx > 1.001 * record.tauPx
                                   ? fmt::format(", raised from {:.3g}", record.tauPx)
                                   : "";
    const double tauPx = record.effectiveTauPx;
    if (watch.refinedFrame == record.frameIndex) return "refined since it was clicked";
    if (pick.ssePx <= tauPx) {
        return fmt::format("its error is within tau ({:.3g} px{})", tauPx, raised);
    }
    if (watch.answeredFrame > 0 && watch.bias * pick.ssePx <= tauPx) {
        return fmt::format("little of it is seen: {:.3g} x {:.3g} px is within tau ({:.3g} px{})",
                           watch.bias, pick.ssePx, tauPx, raised);
    }
    if (watch.predictedFrame == 0) return "the next frame tells";
    return "kept, so that a still view does not change";
}

std::string unaskedText(const hlod::NodeWatch& watch) {
    return watch.isUnasked ? "all of it: it holds the eye" : "not asked: all of it counts";
}

std::string answerText(const hlod::NodeWatch& watch) {
    if (watch.answeredFrame == 0 || watch.isUnasked) return "none";
    return fmt::format("frame {}: {} of {} px of its box seen", watch.answeredFrame,
                       formatCount(watch.visiblePx),
                       formatCount(static_cast<uint64_t>(watch.outlinePx)));
}

const char* predictionText(hlod::NodeWatch::Prediction prediction) {
    switch (prediction) {
        case hlod::NodeWatch::Prediction::Refine:
            return "refine: not asked, its children are";
        case hlod::NodeWatch::Prediction::Stop:
            return "stop: drawn while it is asked";
        case hlod::NodeWatch::Prediction::Delay:
            return "delay: asked, then drawn";
        case hlod::NodeWatch::Prediction::None:
            break;
    }
    return "none";
}

void visibilityRows(const Pick& pick, const Scene& scene) {
    const hlod::NodeWatch& watch = scene.watched();
    const hlod::FrameRecord& record = scene.record();
    numberRow("SSE", fmt::format("{:.3g} px of {:.3g}, nearest of its box", pick.ssePx,
                                 record.effectiveTauPx));
    if (watch.answeredFrame > 0 && !watch.isUnasked) {
        numberRow("visible", fmt::format("{:.3g} of it (mu), bias {:.3g}", watch.relativeVisibility,
                                         watch.bias));
        numberRow("VMSSE", fmt::format("{:.3g} px of {:.3g}", watch.bias * pick.ssePx,
                                       record.effectiveTauPx));
    } else {
        numberRow("visible", unaskedText(watch));
    }
    numberRow("last query", answerText(watch));
    if (watch.predictedFrame > 0) numberRow("prediction", predictionText(watch.prediction));
    numberRow("not finer", whyNotFiner(pick, scene));
}

void pageRows(const Pick& pick, const Scene& scene) {
    const cache::PageStory* const story = scene.storyOf(pick.node.id);
    numberRow("page", formatBytes(pick.node.pageBytes));
    if (story == nullptr || story->readFrame == 0) {
        numberRow("read", "too long ago");
        return;
    }
    const double agoS = scene.clockS() - story->readS;
    numberRow("read", fmt::format("frame {}, {:.3g} s ago{}", story->readFrame, std::max(agoS, 0.0),
                                  story->reads > 1 ? fmt::format(", {} times", story->reads) : ""));
    numberRow("evicted", story->evictedFrame == 0
                             ? "never"
                             : fmt::format("frame {}, for node {:#x}", story->evictedFrame,
                                           story->evictedFor.node.value));
}

void nodeRows(const Pick& pick, const Scene& scene) {
    const ooc::NodeRecord& node = pick.node;
    numberRow("node", fmt::format("{:#x}, level {}{}", node.id.value, node.id.depth(),
                                  node.isLeaf() ? ", leaf" : ""));
    numberRow("triangles",
              fmt::format("{}, {} in the leaves below", formatCount(node.triangleCount),
                          formatCount(node.subtreeTriangles)));
    numberRow("error", fmt::format("{} units, {:.3g} px here", lengthText(node.errorModelUnits),
                                   pick.errorHerePx));
    visibilityRows(pick, scene);
    pageRows(pick, scene);
    if ((node.flags & ooc::kNodeSloppy) != 0) numberRow("clustered", "parts could not merge");
    if ((node.flags & ooc::kNodeStuck) != 0) numberRow("stuck", "locked borders keep it fine");
}

void exactRows(const ExactHit& exact) {
    numberRow("exactly", pointText(exact.hit.pointModel));
    numberRow("distance", lengthText(exact.distanceModelUnits));
    if (exact.fromLastModelUnits) {
        numberRow("from the last", fmt::format("{:.9g}", *exact.fromLastModelUnits));
    }
    numberRow("leaf", fmt::format("{:#x}, triangle {}, material {}{}", exact.hit.leaf.value,
                                  exact.hit.triangle, exact.hit.material,
                                  exact.hit.isTranslucent ? ", translucent" : ""));
}

void drawnRows(const Pick& pick) {
    numberRow("here", pointText(pick.pointModel));
    numberRow("distance", lengthText(pick.distanceModelUnits));
    if (pick.fromLastModelUnits) numberRow("from the last", lengthText(*pick.fromLastModelUnits));
}

// The object's own name, and what it lies in.
void objectText(const Inspection& inspection) {
    const auto& exact = inspection.exact();
    if (!exact) {
        ImGui::TextColored(kAccent, "%s",
                           inspection.isReadingLeaves() ? "reading the leaves ..."
                                                        : "nothing here at full resolution");
        const std::vector<std::string>& faults = inspection.faultsWithoutHit();
        if (!faults.empty()) {
            ImGui::TextColored(kAlarm, "not all could be read: %s", faults.front().c_str());
        }
        return;
    }
    const std::vector<std::string>& path = exact->path;
    ImGui::PushTextWrapPos(26.0f * ImGui::GetFontSize());
    ImGui::TextColored(kAccent, "%s", path.empty() ? "..." : path.back().c_str());
    std::string above;
    for (size_t i = 0; i + 1 < path.size(); ++i) above += (i > 0 ? " / " : "in ") + path[i];
    if (!above.empty()) ImGui::TextDisabled("%s", above.c_str());
    if (!exact->faults.empty()) {
        ImGui::TextColored(kAlarm, "not all could be read: %s", exact->faults.front().c_str());
    }
    ImGui::PopTextWrapPos();
}

}  // namespace

void showPick(const Scene& scene, const Inspection& inspection) {
    const float em = ImGui::GetFontSize();
    placePanel(1.0f, 1.0f, 0.7f * em, 2.6f * em);
    ImGui::Begin("pick", nullptr, kTellingPanel);
    objectText(inspection);
    if (ImGui::BeginTable("rows", 2)) {
        if (inspection.exact()) exactRows(*inspection.exact());
        if (inspection.pick()) {
            if (!inspection.exact()) drawnRows(*inspection.pick());
            nodeRows(*inspection.pick(), scene);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

}  // namespace pagoda::viewer
