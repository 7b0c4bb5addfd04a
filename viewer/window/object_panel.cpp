#include "viewer/window/object_panel.h"

#include "ooc/base/number_text.h"
#include "viewer/window/panel_parts.h"

#include <fmt/format.h>

#include <algorithm>

namespace pagoda::viewer {
namespace {

constexpr uint32_t kMaxIndent = 24;  // deeper ones stand below each other

}  // namespace

void ObjectPanel::select(uint32_t object) {
    selected_ = object;
    reveal_ = object;
}

ObjectPanel::Asked ObjectPanel::show(Inspection& inspection, float leftPx) {
    Asked asked;
    const float em = ImGui::GetFontSize();
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({leftPx, 0.7f * em});
    ImGui::SetNextWindowSize({20.0f * em, std::max(display.y - 3.3f * em, 10.0f * em)});
    constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                        ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                                        ImGuiWindowFlags_NoScrollbar;
    ImGui::Begin("objects", nullptr, kFlags);
    showSearch(inspection);
    showButtons(inspection, asked);
    ImGui::BeginChild("rows", {0.0f, 0.0f}, false, ImGuiWindowFlags_HorizontalScrollbar);
    if (searched_.empty()) {
        showTree(inspection);
    } else {
        showMatches(inspection);
    }
    ImGui::EndChild();
    ImGui::End();
    return asked;
}

void ObjectPanel::showSearch(Inspection& inspection) {
    ooc::ObjectReader& objects = inspection.objects();
    ImGui::TextColored(kAccent, "objects (B)");
    ImGui::SameLine();
    ImGui::TextDisabled("%s, %s hidden", formatCount(objects.objectCount()).c_str(),
                        formatCount(inspection.visibility().hiddenCount()).c_str());
    ImGui::SetNextItemWidth(-1.0f);
    ImGui::InputTextWithHint("##search", "find a name", text_.data(), text_.size());
    if (searched_ == text_.data()) return;
    searched_ = text_.data();
    objects.search(searched_);
    if (searched_.empty()) reveal_ = selected_;
}

void ObjectPanel::showButtons(Inspection& inspection, Asked& asked) {
    ObjectVisibility& visibility = inspection.visibility();
    ImGui::BeginDisabled(!selected_);
    ImGui::BeginDisabled(!visibility.canHide());
    if (ImGui::Button("hide")) visibility.hide(*selected_);
    ImGui::SameLine();
    if (ImGui::Button("alone")) visibility.isolate(*selected_);
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (ImGui::Button("look at")) asked.frame = selected_;
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (ImGui::Button("show all")) visibility.showAll();
    if (visibility.isWaiting()) ImGui::TextDisabled("the tree is still being read");
}

void ObjectPanel::showRow(Inspection& inspection, uint32_t object, const char* name) {
    ObjectVisibility& visibility = inspection.visibility();
    bool isShown = !visibility.isHidden(object);
    ImGui::PushID(static_cast<int>(object));
    ImGui::BeginDisabled(!visibility.canHide());
    if (ImGui::Checkbox("##shown", &isShown)) {
        if (isShown) {
            visibility.show(object);
        } else {
            visibility.hide(object);
        }
    }
    ImGui::EndDisabled();
    ImGui::SameLine();
    const ImGuiCol colour = isShown ? ImGuiCol_Text : ImGuiCol_TextDisabled;
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(colour));
    if (ImGui::Selectable(name, selected_ == object)) selected_ = object;
    ImGui::PopStyleColor();
    ImGui::PopID();
}

void ObjectPanel::showTree(Inspection& inspection) {
    ooc::ObjectReader& objects = inspection.objects();
    if (objects.hasTooManyForTree()) {
        ImGui::TextDisabled("too many for a tree or to hide: find a name");
        return;
    }
    objects.wantTree();
    const ooc::ObjectTree& tree = objects.tree();
    if (reveal_) rows_.reveal(tree, *reveal_);
    rows_.update(tree);
    const std::vector<ObjectRow>& rows = rows_.rows();
    const float rowHeight = ImGui::GetFrameHeightWithSpacing();
    if (reveal_ && *reveal_ < tree.size()) {
        ImGui::SetScrollY(
            std::max(0.0f, (static_cast<float>(rows_.rowOf(*reveal_)) - 3.0f) * rowHeight));
        reveal_.reset();
    }
    std::optional<uint32_t> toggled;
    shownRows_ = 0;
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(rows.size()), rowHeight);
    while (clipper.Step()) {
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
            const auto [object, depth] = rows[static_cast<size_t>(i)];
            ++shownRows_;
            ImGui::SetCursorPosX(ImGui::GetCursorPosX() +
                                 0.9f * ImGui::GetFontSize() *
                                     static_cast<float>(std::min(depth, kMaxIndent)));
            ImGui::PushID(static_cast<int>(object));
            if (tree.hasChildren(object)) {
                const ImGuiDir arrow = rows_.isOpen(object) ? ImGuiDir_Down : ImGuiDir_Right;
                if (ImGui::ArrowButton("##open", arrow)) toggled = object;
            } else {
                ImGui::Dummy({ImGui::GetFrameHeight(), ImGui::GetFrameHeight()});
            }
            ImGui::PopID();
            ImGui::SameLine();
            const ooc::ObjectRecord* const record = objects.record(object);
            const bool isNameless = record != nullptr && record->name.empty();
            showRow(inspection, object,
                    record == nullptr ? "..."
                                      : (isNameless ? "(without a name)" : record->name.c_str()));
        }
    }
    if (toggled) rows_.toggle(*toggled);
}

void ObjectPanel::showMatches(Inspection& inspection) {
    const ooc::ObjectReader& objects = inspection.objects();
    const std::vector<ooc::ObjectMatch>& matches = objects.matches();
    const bool isCut = matches.size() == ooc::ObjectReader::kMaxMatches;
    ImGui::TextDisabled(
        "%s", fmt::format("{}{} found{}", isCut ? "the first " : "", formatCount(matches.size()),
                          objects.isSearching()
                              ? fmt::format(", {:.0f}% searched", 100.0 * objects.searchedShare())
                              : "")
                  .c_str());
    shownRows_ = 0;
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(matches.size()));
    while (clipper.Step()) {
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
            const ooc::ObjectMatch& match = matches[static_cast<size_t>(i)];
            ++shownRows_;
            showRow(inspection, match.object, match.name.c_str());
        }
    }
}

}  // namespace pagoda::viewer
