// panels.h: what the window says and asks over the picture: numbers, steering, keys, what was
// clicked, messages. Immediate mode: each call draws one panel of this frame, between
// Ui::beginFrame() and endFrame().
#pragma once

#include "viewer/navigation.h"
#include "viewer/window/inspection.h"
#include "viewer/window/model_opening.h"
#include "viewer/window/scene.h"
#include "viewer/window/timeline.h"
#include "viewer/window/view_settings.h"

#include <optional>
#include <string>
#include <vector>

namespace pagoda::viewer {

struct Message {
    std::string text;
    bool isError = false;  // stays until it is dismissed
    double untilSeconds = 0.0;
};

// Numbers that no frame record holds.
struct Streaming {
    size_t inFlight = 0, waiting = 0;
    double bytesPerSecond = 0.0;
    uint64_t gpuBudgetBytes = 0, hostBudgetBytes = 0;
    double uiMs = 0.0;
};

struct Change {
    bool isLook = false;     // draw again
    bool isRuntime = false;  // budgets and the like: begin anew
    bool isDisk = false;     // the simulated disk: holds from now on
};

void showHud(const Scene& scene, const ViewSettings& settings, const Streaming& streaming,
             const Timeline& timeline);
[[nodiscard]] Change showSteering(ViewSettings& settings, const hlod::FrameRecord& record);
void showKeys();
// Below: pick_panel.cpp, section_panel.cpp, loading_panel.cpp.
void showPick(const Scene& scene, const Inspection& inspection);
// The plane of `settings.section`, which is on.
[[nodiscard]] Change showSection(Section& section, const Scene& scene,
                                 const Inspection& inspection);
// What was read, by codec, and the disk that is simulated.
[[nodiscard]] Change showLoading(Scene& scene, cache::DiskProfile& disk);
void showMessages(const std::vector<Message>& messages);
// One line at the bottom: how one moves, what is special, where help is.
void showFooter(const Navigation* navigation, const ViewSettings& settings,
                const std::vector<std::string>& states);
// What is being opened, how far it is, and how many triangles the picture so far is of. True when
// its button was pressed: it is to end.
[[nodiscard]] bool showOpening(const std::string& name, const OpeningProgress& progress,
                               uint64_t trianglesSeen);
// Where nothing is open.
void showWelcome();

}  // namespace pagoda::viewer
