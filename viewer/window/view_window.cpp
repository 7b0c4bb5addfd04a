#include "viewer/window/view_window.h"

#include "viewer/window/view_app.h"

#include <utility>

namespace pagoda::viewer {

void runViewWindow(const ViewOptions& options, ModelOpener& opener,
                   const std::function<void()>& check) {
    // A raw model is looked at while the window is made.
    std::unique_ptr<Opening> opening = options.model.empty() ? nullptr : opener.open(options.model);
    GlfwWindow window(options.widthPx, options.heightPx, "Pagoda");
    ViewApp app(window, options, opener, std::move(opening));
    window.setEvents(&app);
    while (!window.shouldClose()) {
        check();
        app.step();
    }
    window.setEvents(nullptr);
}

}  // namespace pagoda::viewer
