#include "cache/page_source.h"
#include "hlod/strategies/strategies.h"
#include "hlod/view/camera.h"
#include "ooc/base/error.h"
#include "ooc/store/database.h"
#include "tools/runtime_options.h"
#include "tools/session.h"
#include "viewer/gl_context.h"
#include "viewer/renderer.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <iostream>
#include <memory>
#include <string>

namespace pagoda::tools {
namespace {

constexpr const char* kExamples = R"(Examples:
  pagoda render scan.pagoda -o scan.png
  pagoda render plant.pagoda -o plant.png --view -x-y+z --size 1920x1080 --tau 2 --stats
  pagoda render hall.pagoda -o in.png --camera '{"eye":[2,1.7,9],"target":[8,1.5,0],"fovy":60}'
  pagoda render hall.pagoda -o exact.png --reference --depth exact.pfm --ids exact.ids

A camera is JSON, or a file of it: eye, target, up (three numbers each), fovy (degrees), width,
height (pixels), near (model units); keys left out come from --view, --size and --fov.
--depth writes a grey PFM: little-endian float32, rows from bottom to top, distance along the
direction of view in model units, infinite where no opaque surface is.
--ids writes two little-endian uint32 a pixel, rows from top to bottom: which node (0: none, else
1 + its place in "nodes" of FILE.json) and which of its page's triangles. Translucent triangles
write neither depth nor ids.
A picture with faults is written all the same; the faults are listed and the exit code is 1.)";

struct Arguments {
    std::string database, output;
    std::string camera, view = "iso", size, up;
    double fovyDegrees = 0;
    std::string depth, ids, background;
    RuntimeOptions runtime;
    bool isReference = false, wantsStats = false;
};

hlod::UpAxis upAxis(const Arguments& arguments, const ooc::Database& database) {
    if (arguments.up.empty()) return hlod::upAxisOf(database.metadataJson());
    return arguments.up == "y" ? hlod::UpAxis::Y : hlod::UpAxis::Z;
}

void parseSize(const std::string& text, hlod::Camera& camera) {
    int width = 0, height = 0;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%5dx%5d%c", &width, &height, &rest) != 2 || width < 1 ||
        height < 1) {
        throw CLI::ValidationError("--size", "'" + text + "' is no size; write 1024x768");
    }
    camera.widthPx = width;
    camera.heightPx = height;
}

// "#rrggbb", one colour from top to bottom.
viewer::Background parseBackground(const std::string& text) {
    if (text.empty()) return {};
    unsigned red = 0, green = 0, blue = 0;
    char rest = 0;
    if (text.size() != 7 ||
        std::sscanf(text.c_str(), "#%2x%2x%2x%c", &red, &green, &blue, &rest) != 3) {
        throw CLI::ValidationError("--background", "'" + text + "' is no colour; write #rrggbb");
    }
    const glm::u8vec3 colour(red, green, blue);
    return {colour, colour};
}

std::string readCameraFile(const std::string& path) {
    constexpr uint64_t kMaxCameraBytes = uint64_t{1} << 20;
    const std::vector<std::byte> bytes = readWholeFile(path, kMaxCameraBytes);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

hlod::Camera makeCamera(const Arguments& arguments, const Box3d& box, hlod::UpAxis up) {
    hlod::Camera camera;
    if (!arguments.size.empty()) parseSize(arguments.size, camera);
    if (arguments.fovyDegrees > 0) camera.fovyDegrees = arguments.fovyDegrees;
    camera = hlod::frameBox(camera, box, hlod::viewDirection(arguments.view, up), up);
    if (arguments.camera.empty()) return camera;
    const bool isJson = arguments.camera.front() == '{';
    return hlod::parseCamera(isJson ? arguments.camera : readCameraFile(arguments.camera), camera,
                             isJson ? "--camera" : arguments.camera);
}

hlod::FrameRecord draw(viewer::Renderer& renderer, const Arguments& arguments,
                       const hlod::Camera& camera, hlod::UpAxis up, Progress& progress) {
    viewer::RenderOptions options;
    options.tauPx = arguments.runtime.effectiveTauPx();
    options.background = parseBackground(arguments.background);
    options.worldUp = Vec3f(hlod::upVector(up));
    if (arguments.isReference) {
        return renderer.renderReference(camera, options, [&] { progress.check(); });
    }
    const auto strategy =
        hlod::makeStrategy(arguments.runtime.strategy, arguments.runtime.strategyOptions());
    hlod::FrameRecord record = renderer.render(camera, *strategy, options,
                                               [&](const hlod::FrameRecord&) { progress.check(); });
    record.strategy = arguments.runtime.strategy;
    return record;
}

void addDatabaseFaults(const ooc::Database& database, hlod::FrameRecord& record) {
    if (!database.headerFault().empty())
        record.faults.push_back("header: " + database.headerFault());
    if (!database.metadataFault().empty()) {
        record.faults.push_back("metadata: " + database.metadataFault());
    }
}

void render(const Arguments& arguments, Session& session) {
    arguments.runtime.checkStrategies(std::span(&arguments.runtime.strategy, 1));
    const ooc::Database database = ooc::Database::open(arguments.database);
    const viewer::GlContext context = viewer::GlContext::headless();
    cache::DatabaseSource source(database);
    viewer::Renderer renderer(database.header().lattice, source,
                              arguments.runtime.rendererOptions());
    const hlod::UpAxis up = upAxis(arguments, database);
    const hlod::Camera camera = makeCamera(arguments, renderer.sceneBox(), up);
    hlod::FrameRecord record = draw(renderer, arguments, camera, up, *session.progress);
    addDatabaseFaults(database, record);
    const viewer::Picture picture = renderer.read(record);

    viewer::writePng(picture, arguments.output);
    if (!arguments.depth.empty()) viewer::writeDepth(picture, arguments.depth);
    if (!arguments.ids.empty()) viewer::writeIds(picture, arguments.ids);
    if (record.effectiveTauPx > record.tauPx) {
        session.progress->warn(
            fmt::format("the cut at tau {:g} does not fit --gpu-budget {}: drawn at tau {:g}",
                        record.tauPx, arguments.runtime.gpuBudget, record.effectiveTauPx));
    }
    if (arguments.wantsStats) std::cout << hlod::frameRecordToJson(record) << '\n';
    for (const std::string& fault : record.faults) {
        std::cerr << "pagoda: " << arguments.database << ": " << fault << '\n';
    }
    if (record.faults.empty()) return;
    std::cerr << "pagoda: " << arguments.database << ": the picture was written in spite of "
              << record.faults.size()
              << " faults; coarser parts stand in where there are any; see `pagoda verify`\n";
    session.exitCode = 1;
}

void addCameraOptions(CLI::App& command, Arguments& arguments) {
    command.add_option("--camera", arguments.camera, "Camera as JSON, or a file of it");
    command
        .add_option("--view", arguments.view,
                    "Where the eye is: front, back, left, right, top, bottom, iso, or a corner "
                    "such as +x-y+z")
        ->capture_default_str();
    command.add_option("--size", arguments.size, "Picture in pixels, WxH (default: 1024x768)");
    command
        .add_option("--fov", arguments.fovyDegrees,
                    "Angle of view from top to bottom, degrees (default: 45)")
        ->check(CLI::Range(0.1, 179.0));
    command.add_option("--up", arguments.up, "Up axis (default: the database's)")
        ->check(CLI::IsMember({"y", "z"}));
}

void addDetailOptions(CLI::App& command, Arguments& arguments) {
    command
        .add_option("--tau", arguments.runtime.tauPx,
                    "Error allowed on the screen, pixels; 0: every leaf")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    addDetailOption(command, arguments.runtime);
    command.add_option("--strategy", arguments.runtime.strategy, "How the cut is found")
        ->check(CLI::IsMember(strategyNames()))
        ->capture_default_str();
    command.add_flag("--reference", arguments.isReference,
                     "Draw all leaves in the frustum, streamed within the budgets");
    addRuntimeOptions(command, arguments.runtime);
}

}  // namespace

void addRenderCommand(CLI::App& app, Session& session) {
    auto arguments = std::make_shared<Arguments>();
    CLI::App* command =
        app.add_subcommand("render", "Draw a picture of a database, without a window");
    command->footer(kExamples);
    command->add_option("database", arguments->database, "The database (NAME.pagoda)")->required();
    command->add_option("-o,--output", arguments->output, "The picture to write (PNG)")->required();
    addCameraOptions(*command, *arguments);
    addDetailOptions(*command, *arguments);
    command->add_option("--depth", arguments->depth, "Also write depths (PFM)");
    command->add_option("--ids", arguments->ids,
                        "Also write node and triangle ids (raw, and FILE.json)");
    command->add_option("--background", arguments->background,
                        "One colour behind the model, #rrggbb (default: a grey gradient)");
    command->add_flag("--stats", arguments->wantsStats, "Print the frame record as JSON");
    command->callback([arguments, &session] { render(*arguments, session); });
}

}  // namespace pagoda::tools
