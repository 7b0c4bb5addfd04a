#include "ooc/base/file.h"
#include "tools/runtime_options.h"
#include "tools/session.h"
#include "viewer/window/view_window.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <memory>
#include <string>

namespace pagoda::tools {
namespace {

constexpr const char* kExamples = R"(Examples:
  pagoda view plant.pagoda
  pagoda view plant.pagoda --strategy coh --tau 2 --gpu-budget 256MiB
  pagoda view plant.pagoda --replay walk.json

F1 in the window shows every key. Without a display: pagoda render.)";

struct Arguments {
    viewer::ViewOptions view;
    std::string size, camera;
    double targetFps = viewer::ViewSettings{}.targetFps;
    RuntimeOptions runtime;
};

void parseSize(const std::string& text, viewer::ViewOptions& options) {
    int width = 0, height = 0;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%5dx%5d%c", &width, &height, &rest) != 2 || width < 320 ||
        height < 240) {
        throw CLI::ValidationError("--size", "'" + text + "' is no size; write 1280x800");
    }
    options.widthPx = width;
    options.heightPx = height;
}

std::string cameraText(const std::string& camera) {
    if (camera.empty() || camera.front() == '{') return camera;
    constexpr uint64_t kMaxCameraBytes = uint64_t{1} << 20;
    const std::vector<std::byte> bytes = readWholeFile(camera, kMaxCameraBytes);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void view(Arguments& arguments, Session& session) {
    arguments.runtime.checkStrategies(std::span(&arguments.runtime.strategy, 1));
    viewer::ViewOptions& options = arguments.view;
    if (!arguments.size.empty()) parseSize(arguments.size, options);
    options.cameraJson = cameraText(arguments.camera);
    viewer::ViewSettings& settings = options.settings;
    settings.strategy = arguments.runtime.strategy;
    settings.strategyOptions = arguments.runtime.strategyOptions();
    settings.tauPx = arguments.runtime.tauPx;
    settings.holdsFrameRate = arguments.targetFps > 0;
    if (settings.holdsFrameRate) settings.targetFps = arguments.targetFps;
    settings.runtime = arguments.runtime.rendererOptions();
    viewer::runViewWindow(options, [&] { session.progress->check(); });
}

}  // namespace

void addViewCommand(CLI::App& app, Session& session) {
    auto arguments = std::make_shared<Arguments>();
    arguments->runtime.strategy = arguments->view.settings.strategy;
    CLI::App* command = app.add_subcommand("view", "Explore a database in a window");
    command->footer(kExamples);
    command->add_option("database", arguments->view.database,
                        "The database (NAME.pagoda); without one, drop it on the window");
    command->add_option("--camera", arguments->camera, "Where to begin: JSON, or a file of it");
    command->add_option("--replay", arguments->view.replay,
                        "A camera path (pagoda path, or R in the window) to begin with");
    command->add_option("--size", arguments->size, "Window in pixels, WxH (default: 1280x800)");
    command->add_option("--tau", arguments->runtime.tauPx, "Error allowed on the screen, pixels")
        ->check(CLI::Range(0.25, 64.0))
        ->capture_default_str();
    command
        ->add_option("--fps", arguments->targetFps,
                     "Frames a second that tau keeps while the view moves; 0: it does not")
        ->check(CLI::Range(0.0, 1000.0))
        ->capture_default_str();
    command->add_option("--strategy", arguments->runtime.strategy, "How the cut is found")
        ->check(CLI::IsMember(strategyNames()))
        ->capture_default_str();
    command->add_option("--output-folder", arguments->view.outputFolder,
                        "Where screenshots and recorded paths go (default: here)");
    command->add_option("--log-state", arguments->view.stateLog,
                        "Write what the window does as JSON lines");
    addRuntimeOptions(*command, arguments->runtime);
    command->callback([arguments, &session] { view(*arguments, session); });
}

}  // namespace pagoda::tools
