#include "hlod/view/camera_path.h"
#include "ooc/base/error.h"
#include "ooc/base/file.h"
#include "ooc/store/database.h"
#include "tools/paths/makers.h"
#include "tools/session.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace pagoda::tools {
namespace {

constexpr const char* kExamples = R"(Examples:
  pagoda path plant.pagoda --kind walk --frames 200 -o walk.json
  pagoda path plant.pagoda --kind orbit --frames 360 --zoom 2 -o round.json
  pagoda path scan.pagoda --kind fly --frames 300 --seed 7 -o fly.json
  pagoda path ship.pagoda --kind walk --eye-height 1700 -o inside.json
  pagoda path plant.pagoda --kind teleport --hold 60 --frames 600 -o jumps.json

orbit goes round the model; walk goes through its rooms on foot; fly passes close by its surface and
away again; teleport jumps from place to place and stands still between. The same database, options
and seed give the same file. From frame to frame the eye moves at least 0.2% of the model's diagonal
or the view turns at least 1 degree (teleport: at jumps). Lengths are in model units.)";

struct Arguments {
    std::string database, output, kind = "orbit", up;
    PathOptions options;
    std::vector<double> box;
    bool force = false;
};

hlod::UpAxis upAxis(const Arguments& arguments, const ooc::Database& database) {
    if (arguments.up.empty()) return hlod::upAxisOf(database.metadataJson());
    return arguments.up == "y" ? hlod::UpAxis::Y : hlod::UpAxis::Z;
}

void writeText(const std::string& text, const std::string& target, bool force) {
    namespace fs = std::filesystem;
    if (fs::exists(target)) {
        if (!force) throw Error(target, "", "exists already", "give --force to replace it");
        if (!fs::is_regular_file(target)) throw Error(target, "", "is no file", "choose another");
        fs::remove(target);
    }
    File file = File::create(target);
    file.append(std::as_bytes(std::span(text)));
    file.close();
}

std::string summary(const hlod::CameraPath& path) {
    double length = 0, degrees = 0;
    for (size_t i = 1; i < path.frames.size(); ++i) {
        const hlod::PathStep step = hlod::stepBetween(path.frames[i - 1], path.frames[i]);
        length += step.moveModelUnits;
        degrees += step.turnDegrees;
    }
    const double steps = std::max(1.0, static_cast<double>(path.frames.size()) - 1);
    return fmt::format(
        "{} frames, length {:.5g}; a step on average {:.2f} degrees and {:.2f}% of the diagonal",
        formatCount(path.frames.size()), length, degrees / steps,
        100 * length / steps / path.modelDiagonalModelUnits);
}

void makeFile(Arguments& arguments, Session& session) {
    const ooc::Database database = ooc::Database::open(arguments.database);
    if (!arguments.box.empty()) {
        const std::vector<double>& b = arguments.box;
        arguments.options.box = Box3d{{b[0], b[1], b[2]}, {b[3], b[4], b[5]}};
        if (arguments.options.box->isEmpty()) {
            throw Error("--box", "", "its second corner lies before the first",
                        "give x0,y0,z0,x1,y1,z1");
        }
    }
    const hlod::CameraPath path = makePath(database, upAxis(arguments, database), arguments.kind,
                                           arguments.options, *session.progress);
    writeText(hlod::cameraPathToJson(path), arguments.output, arguments.force);
    std::cout << fmt::format("{}: {}, {}\n", arguments.output, path.kind, summary(path));
}

void addWalkOptions(CLI::App& command, Arguments& arguments) {
    PathOptions& options = arguments.options;
    command
        .add_option("--eye-height", options.eyeHeight,
                    "walk, teleport: of the eye above the floor (default: 1.7 where the model "
                    "looks like metres)")
        ->check(CLI::PositiveNumber);
    command
        .add_option("--step", options.stepHeight,
                    "walk, teleport: what a person steps up (default: 0.15 of the eye height)")
        ->check(CLI::PositiveNumber);
    command.add_option("--box", arguments.box, "walk, teleport: stay in x0,y0,z0,x1,y1,z1")
        ->delimiter(',')
        ->expected(6);
    command.add_option("--hold", options.holdFrames, "teleport: frames at a place")
        ->check(CLI::Range(size_t{1}, hlod::kMaxPathFrames))
        ->capture_default_str();
}

}  // namespace

void addPathCommand(CLI::App& app, Session& session) {
    auto arguments = std::make_shared<Arguments>();
    PathOptions& options = arguments->options;
    CLI::App* command = app.add_subcommand("path", "Make a camera path for a database");
    command->footer(kExamples);
    command->add_option("database", arguments->database, "The database")->required();
    command->add_option("-o,--output", arguments->output, "The path, JSON")->required();
    std::vector<std::string> kinds;
    for (const PathKind& kind : pathKinds()) kinds.emplace_back(kind.name);
    command->add_option("--kind", arguments->kind, "What it does")
        ->check(CLI::IsMember(kinds))
        ->capture_default_str();
    command->add_option("--frames", options.frames, "How many cameras")
        ->check(CLI::Range(size_t{1}, hlod::kMaxPathFrames))
        ->capture_default_str();
    command->add_option("--seed", options.seed, "Another seed, another path of the kind")
        ->capture_default_str();
    command->add_option("--speed", options.speed, "Times the usual steps")
        ->check(CLI::Range(0.01, 100.0))
        ->capture_default_str();
    command
        ->add_option("--fov", options.fovyDegrees,
                     "Angle of view from top to bottom, degrees (default: orbit 45, fly 50, "
                     "others 60)")
        ->check(CLI::Range(0.1, 179.0));
    command->add_option("--zoom", options.zoom, "orbit: 1 sees all of the model, 2 half of it")
        ->check(CLI::Range(0.1, 1000.0))
        ->capture_default_str();
    addWalkOptions(*command, *arguments);
    command->add_option("--up", arguments->up, "Up axis (default: the database's)")
        ->check(CLI::IsMember({"y", "z"}));
    command->add_flag("--force", arguments->force, "Replace an existing file");
    command->callback([arguments, &session] { makeFile(*arguments, session); });
}

}  // namespace pagoda::tools
