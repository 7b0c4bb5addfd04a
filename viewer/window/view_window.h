// view_window.h: the window as a whole: opens it, draws while anything changes, and returns when it
// is closed. Main thread only.
#pragma once

#include "hlod/view/camera.h"
#include "viewer/window/model_opening.h"
#include "viewer/window/view_settings.h"

#include <filesystem>
#include <functional>
#include <string>

namespace pagoda::viewer {

struct ViewOptions {
    std::filesystem::path model;  // a database or a raw model; empty: the window waits for a drop
    ViewSettings settings;
    int widthPx = 1280, heightPx = 800;
    std::string cameraJson;              // empty: all of the model, from the front and above
    std::filesystem::path replay;        // a camera path to begin with
    std::filesystem::path outputFolder;  // of screenshots and recorded paths; empty: the current
    std::filesystem::path stateLog;      // StateLog; empty: none
};

// `opener` opens what is no database. `check` is called often and may throw to end it all. Throws
// Error when there is no display or no OpenGL 4.5, when `model` is a database that cannot be
// opened, or does not exist; what goes wrong later is shown in the window.
void runViewWindow(const ViewOptions& options, ModelOpener& opener,
                   const std::function<void()>& check);

}  // namespace pagoda::viewer
