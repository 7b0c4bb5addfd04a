// root_likeness DB [--pictures FOLDER]: how like the model its root alone looks. 14 views (6 faces,
// 8 corners of the box, 512x512): intersection over union of the covered pixels of root and
// reference, and the share of the root's covered pixels within 32/255 in every channel of the mean
// of the reference's covered pixels in the same 8x8 block (a block that the reference leaves empty
// counts as a miss). Exit 1 when a view misses 0.85 or 0.90.
#include "cache/page_source.h"
#include "hlod/strategies/strategies.h"
#include "ooc/base/error.h"
#include "ooc/store/database.h"
#include "viewer/gl_context.h"
#include "viewer/renderer.h"

#include <array>
#include <cstdio>
#include <string>

namespace {

using namespace pagoda;

constexpr int kSizePx = 512, kBlockPx = 8, kTolerance = 32;
constexpr std::array kViews = {"+x",     "-x",     "+y",     "-y",     "+z",
                               "-z",     "-x-y-z", "+x-y-z", "-x+y-z", "+x+y-z",
                               "-x-y+z", "+x-y+z", "-x+y+z", "+x+y+z"};

struct Likeness {
    double overlap = 0, colour = 0;
};

bool covers(const viewer::Picture& picture, size_t pixel) {
    return picture.colours[4 * pixel + 3] > 127;
}

Likeness compare(const viewer::Picture& root, const viewer::Picture& reference) {
    constexpr int kBlocks = kSizePx / kBlockPx;
    std::vector<std::array<double, 4>> blocks(kBlocks * kBlocks);
    const auto blockOf = [](size_t pixel) {
        const size_t x = pixel % kSizePx, y = pixel / kSizePx;
        return y / kBlockPx * kBlocks + x / kBlockPx;
    };
    for (size_t i = 0; i < reference.pixelCount(); ++i) {
        if (!covers(reference, i)) continue;
        auto& block = blocks[blockOf(i)];
        for (size_t c = 0; c < 3; ++c) block[c] += reference.colours[4 * i + c];
        block[3] += 1;
    }
    double both = 0, either = 0, covered = 0, alike = 0;
    for (size_t i = 0; i < root.pixelCount(); ++i) {
        const bool a = covers(root, i), b = covers(reference, i);
        both += a && b;
        either += a || b;
        if (!a) continue;
        ++covered;
        const auto& block = blocks[blockOf(i)];
        bool isAlike = block[3] > 0;
        for (size_t c = 0; c < 3 && isAlike; ++c) {
            isAlike = std::abs(root.colours[4 * i + c] - block[c] / block[3]) <= kTolerance;
        }
        alike += isAlike;
    }
    return {either > 0 ? both / either : 0, covered > 0 ? alike / covered : 0};
}

int run(const std::string& path, const std::string& folder) {
    const ooc::Database database = ooc::Database::open(path);
    const bool isYUp = database.metadataJson().find("\"up\":\"y\"") != std::string::npos;
    const hlod::UpAxis up = isYUp ? hlod::UpAxis::Y : hlod::UpAxis::Z;
    const viewer::GlContext context = viewer::GlContext::headless();
    cache::DatabaseSource source(database);
    viewer::Renderer renderer(database.header().lattice, source, {});
    viewer::RenderOptions options;
    options.worldUp = isYUp ? Vec3f(0, 1, 0) : Vec3f(0, 0, 1);
    bool isGood = true;
    for (const char* name : kViews) {
        hlod::Camera camera;
        camera.widthPx = camera.heightPx = kSizePx;
        camera = hlod::frameBox(camera, renderer.sceneBox(), hlod::viewDirection(name, up), up);
        hlod::FrameRecord record = renderer.renderReference(camera, options);
        const viewer::Picture reference = renderer.read(record);
        options.tauPx = 1e12;
        const auto strategy = hlod::makeStrategy("frustum");
        record = renderer.render(camera, *strategy, options);
        const viewer::Picture root = renderer.read(record);
        const Likeness likeness = compare(root, reference);
        std::printf("%-7s overlap %.3f colour %.3f\n", name, likeness.overlap, likeness.colour);
        isGood &= likeness.overlap >= 0.85 && likeness.colour >= 0.90;
        if (!folder.empty()) {
            viewer::writePng(reference, folder + "/" + name + "-reference.png");
            viewer::writePng(root, folder + "/" + name + "-root.png");
        }
    }
    std::printf(isGood ? "all views within the bounds\n" : "some views miss the bounds\n");
    return isGood ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
    if (count < 2) return 2;
    try {
        return run(arguments[1], count > 3 ? arguments[3] : "");
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
