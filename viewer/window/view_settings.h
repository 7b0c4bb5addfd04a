// view_settings.h: all that keys and panels of the window steer. Plain data.
#pragma once

#include "hlod/strategies/strategies.h"
#include "viewer/renderer.h"
#include "viewer/section.h"

#include <array>
#include <string>

namespace pagoda::viewer {

enum class Colouring { Model, Level, Node, Error };
inline constexpr std::array<const char*, 4> kColouringNames = {"the model's", "by level", "by node",
                                                               "by error"};

struct ViewSettings {
    std::string strategy = "auto";
    hlod::StrategyOptions strategyOptions;
    double tauPx = 1.0;
    bool holdsFrameRate = true;  // tau follows while the view moves
    double targetFps = 20.0;
    RendererOptions runtime;

    Colouring colouring = Colouring::Model;
    bool isWireframe = false;
    bool showsDrawnBoxes = true, showsHiddenBoxes = true;  // while frozen

    Section section;

    bool showsHud = true, showsSteering = false, showsHelp = false;
    bool showsObjects = false, showsLoading = false;
};

}  // namespace pagoda::viewer
