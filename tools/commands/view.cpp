#include "ooc/base/file.h"
#include "tools/opening/raw_opening.h"
#include "tools/runtime_options.h"
#include "tools/session.h"
#include "viewer/window/view_window.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

namespace pagoda::tools {
namespace {

constexpr const char* kExamples = R"(Examples:
  pagoda view plant.pagoda
  pagoda view scan.ply
  pagoda view hall.obj@up=z,unit=mm --memory 2GiB --cache /data/cache
  pagoda view plant.pagoda --strategy coh --tau 2 --gpu-budget 256MiB
  pagoda view plant.pagoda --replay walk.json

A raw model (PLY, OBJ, STL, OFF, glTF, GLB, Draco) is built first, as pagoda build does, while what
has been read is shown coarsely; the database is kept in the cache and found again by the model's
content. @up, unit, move, matrix: as in pagoda build.

F1 in the window shows every key. Without a display: pagoda build, pagoda render.)";

struct Arguments {
    viewer::ViewOptions view;
    std::string size, camera, cache, cacheSize = "16GiB", memory = "1GiB";
    uint32_t threads = 0;
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
    RawOpener opener(
        {.cache = {.folder = arguments.cache.empty() ? defaultCacheFolder()
                                                     : std::filesystem::path(arguments.cache),
                   .mostBytes = parseBytes(arguments.cacheSize),
                   .settings = "pagoda " PAGODA_VERSION},
         .memoryBytes = parseBytes(arguments.memory),
         .threads = arguments.threads});
    viewer::runViewWindow(options, opener, [&] { session.progress->check(); });
}

}  // namespace

void addViewCommand(CLI::App& app, Session& session) {
    auto arguments = std::make_shared<Arguments>();
    arguments->runtime.strategy = arguments->view.settings.strategy;
    CLI::App* command = app.add_subcommand("view", "Explore a database or a raw model in a window");
    command->footer(kExamples);
    command->add_option("model", arguments->view.model,
                        "A database (NAME.pagoda) or a raw model; without one, drop it on the "
                        "window");
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
    command->add_option("--cache", arguments->cache,
                        "Where databases made of raw models are kept (default: "
                        "$XDG_CACHE_HOME/pagoda, else ~/.cache/pagoda)");
    command
        ->add_option("--cache-size", arguments->cacheSize,
                     "Above it the least recently opened ones are removed")
        ->capture_default_str();
    command
        ->add_option("--memory", arguments->memory,
                     "Private memory for building a raw model, beside the budgets of the run time")
        ->capture_default_str();
    command->add_option("--threads", arguments->threads, "Workers that build (0: one a core)")
        ->capture_default_str();
    addRuntimeOptions(*command, arguments->runtime);
    command->callback([arguments, &session] { view(*arguments, session); });
}

}  // namespace pagoda::tools
