#include "viewer/window/view_window.h"

#include "viewer/window/view_app.h"

namespace pagoda::viewer {

void runViewWindow(const ViewOptions& options, const std::function<void()>& check) {
    GlfwWindow window(options.widthPx, options.heightPx, "Pagoda");
    ViewApp app(window, options);
    window.setEvents(&app);
    while (!window.shouldClose()) {
        check();
        app.step();
    }
    window.setEvents(nullptr);
}

}  // namespace pagoda::viewer
