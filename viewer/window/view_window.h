// view_window.h: the window as a whole: opens it, draws while anything changes, and returns when it
// is closed. Main thread only.
#pragma once

#include "hlod/view/camera.h"
#include "viewer/window/view_settings.h"

#include <filesystem>
#include <functional>
#include <string>

namespace pagoda::viewer {

struct ViewOptions {
    std::filesystem::path database;  // empty: the window waits for one to be dropped
    ViewSettings settings;
    int widthPx = 1280, heightPx = 800;
    std::string cameraJson;              // empty: all of the model, from the front and above
    std::filesystem::path replay;        // a camera path to begin with
    std::filesystem::path outputFolder;  // of screenshots and recorded paths; empty: the current
    std::filesystem::path stateLog;      // StateLog; empty: none
};

// `check` is called often and may throw to end it all. Throws Error when there is no display or no
// OpenGL 4.5, or `database` cannot be opened; later ones are shown in the window.
void runViewWindow(const ViewOptions& options, const std::function<void()>& check);

}  // namespace pagoda::viewer
