// object_panel.h: the objects of a database as a tree, or as what a search found: looked at, hidden
// and shown. Only the rows in sight cost anything. Between Ui::beginFrame() and endFrame().
#pragma once

#include "viewer/object_rows.h"
#include "viewer/window/inspection.h"

#include <array>
#include <optional>
#include <string>

namespace pagoda::viewer {

class ObjectPanel {
public:
    struct Asked {
        std::optional<uint32_t> frame;  // look at this object
    };
    // `leftPx`: where it begins.
    [[nodiscard]] Asked show(Inspection& inspection, float leftPx);
    // Opens the tree down to the object, marks it and scrolls to it.
    void select(uint32_t object);
    [[nodiscard]] const std::optional<uint32_t>& selected() const noexcept { return selected_; }
    [[nodiscard]] size_t shownRows() const noexcept { return shownRows_; }

private:
    void showSearch(Inspection& inspection);
    void showButtons(Inspection& inspection, Asked& asked);
    void showTree(Inspection& inspection);
    void showMatches(Inspection& inspection);
    // The name, the eye and the mark of one row.
    void showRow(Inspection& inspection, uint32_t object, const char* name);

    ObjectRows rows_;
    std::array<char, 256> text_{};
    std::string searched_;
    std::optional<uint32_t> selected_, reveal_;
    size_t shownRows_ = 0;
};

}  // namespace pagoda::viewer
