// root_likeness DB [--pictures FOLDER] [--oracle]: how like the model its root alone looks. 14
// views (6 faces, 8 corners of the box, 512x512): intersection over union of the covered pixels of
// root and reference, and the share of the root's covered pixels within 32/255 in every channel of
// the mean of the reference's covered pixels in the same 8x8 block (a block that the reference
// leaves empty counts as a miss). Exit 1 when a view misses 0.85 or 0.90.
// --oracle adds what other colours could reach on the same triangles: the colour share if each
// triangle had the best constant colour in each view apart (`apart`) and one for all views (`one`),
// what the model's own picture would reach as it is (`sharp`) and averaged over the 8x8 pixels
// around each pixel (`smooth`: no drawing that does not know where the blocks begin can do much
// better), and the share of covered pixels of the reference whose block is itself more than 32/255
// off the mean of the 3x3 blocks around it (`rough`): what a mesh with cells of 24 pixels cannot
// show.
#include "cache/page_source.h"
#include "hlod/strategies/strategies.h"
#include "ooc/base/error.h"
#include "ooc/store/database.h"
#include "viewer/gl_context.h"
#include "viewer/renderer.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <unordered_map>
#include <vector>

namespace {

using namespace pagoda;

constexpr int kSizePx = 512, kBlockPx = 8, kBlocks = kSizePx / kBlockPx, kTolerance = 32;
constexpr double kLeastOverlap = 0.85, kLeastColour = 0.90;
constexpr std::array kViews = {"+x",     "-x",     "+y",     "-y",     "+z",
                               "-z",     "-x-y-z", "+x-y-z", "-x+y-z", "+x+y-z",
                               "-x-y+z", "+x-y+z", "-x+y+z", "+x+y+z"};

using Colour = std::array<double, 3>;

struct Block {
    Colour mean{};
    double coveredPx = 0;
};

struct View {
    const char* name;
    viewer::Picture root, reference;
    std::vector<Block> blocks;  // of the reference
};

bool covers(const viewer::Picture& picture, size_t pixel) {
    return picture.colours[4 * pixel + 3] > 127;
}

size_t blockOf(size_t pixel) {
    const size_t x = pixel % kSizePx, y = pixel / kSizePx;
    return y / kBlockPx * kBlocks + x / kBlockPx;
}

bool isAlike(const Colour& a, const Colour& b) {
    for (size_t c = 0; c < 3; ++c) {
        if (!(std::abs(a[c] - b[c]) <= kTolerance)) return false;
    }
    return true;
}

void add(Block& sum, const Colour& colour, double coveredPx) {
    for (size_t c = 0; c < 3; ++c) sum.mean[c] += colour[c] * coveredPx;
    sum.coveredPx += coveredPx;
}

void divide(Block& sum) {
    for (size_t c = 0; c < 3 && sum.coveredPx > 0; ++c) sum.mean[c] /= sum.coveredPx;
}

Colour colourAt(const viewer::Picture& picture, size_t pixel) {
    const uint8_t* rgba = &picture.colours[4 * pixel];
    return {double(rgba[0]), double(rgba[1]), double(rgba[2])};
}

std::vector<Block> blockMeans(const viewer::Picture& picture) {
    std::vector<Block> blocks(size_t{kBlocks} * kBlocks);
    for (size_t i = 0; i < picture.pixelCount(); ++i) {
        if (covers(picture, i)) add(blocks[blockOf(i)], colourAt(picture, i), 1);
    }
    std::for_each(blocks.begin(), blocks.end(), divide);
    return blocks;
}

struct Likeness {
    double overlap = 0, colour = 0, coveredPx = 0;
};

Likeness compare(const View& view) {
    double both = 0, either = 0, covered = 0, alike = 0;
    for (size_t i = 0; i < view.root.pixelCount(); ++i) {
        const bool a = covers(view.root, i), b = covers(view.reference, i);
        both += a && b;
        either += a || b;
        if (!a) continue;
        ++covered;
        const Block& block = view.blocks[blockOf(i)];
        alike += block.coveredPx > 0 && isAlike(colourAt(view.root, i), block.mean);
    }
    return {either > 0 ? both / either : 0, covered > 0 ? alike / covered : 0, covered};
}

// What a triangle covers: blocks of views, and how many of its pixels lie in each.
using Coverage = std::unordered_map<uint32_t, std::vector<Block>>;

void addCoverage(const View& view, Coverage& coverage) {
    std::unordered_map<uint64_t, uint32_t> pixels;  // by triangle and block
    for (size_t i = 0; i < view.root.pixelCount(); ++i) {
        const bool isOpaque = covers(view.root, i) && view.root.nodeOrdinals[i] != 0;
        if (!isOpaque || !(view.blocks[blockOf(i)].coveredPx > 0)) continue;
        ++pixels[(uint64_t{view.root.triangles[i]} << 32) | blockOf(i)];
    }
    for (const auto& [key, count] : pixels) {
        coverage[static_cast<uint32_t>(key >> 32)].push_back(
            {view.blocks[key & 0xFFFFFFFFu].mean, double(count)});
    }
}

double alikePx(const std::vector<Block>& places, const Colour& colour) {
    double alike = 0;
    for (const Block& place : places) alike += isAlike(place.mean, colour) ? place.coveredPx : 0;
    return alike;
}

// Most pixels that a constant colour a triangle can get right: the best of the mean and of each
// block's own.
double bestAlikePx(const Coverage& coverage) {
    double total = 0;
    for (const auto& [triangle, places] : coverage) {
        Block sum;
        for (const Block& place : places) add(sum, place.mean, place.coveredPx);
        divide(sum);
        double best = alikePx(places, sum.mean);
        for (const Block& place : places) best = std::max(best, alikePx(places, place.mean));
        total += best;
    }
    return total;
}

double roughShare(const std::vector<Block>& blocks) {
    double rough = 0, covered = 0;
    for (int y = 0; y < kBlocks; ++y) {
        for (int x = 0; x < kBlocks; ++x) {
            const Block& block = blocks[size_t(y) * kBlocks + size_t(x)];
            Block around;
            for (int j = std::max(0, y - 1); j <= std::min(kBlocks - 1, y + 1); ++j) {
                for (int i = std::max(0, x - 1); i <= std::min(kBlocks - 1, x + 1); ++i) {
                    const Block& other = blocks[size_t(j) * kBlocks + size_t(i)];
                    add(around, other.mean, other.coveredPx);
                }
            }
            divide(around);
            covered += block.coveredPx;
            rough += isAlike(block.mean, around.mean) ? 0 : block.coveredPx;
        }
    }
    return covered > 0 ? rough / covered : 0;
}

// The colour share of the reference itself, averaged over the square of 2 `reachPx` pixels around
// each pixel (0: as it is).
double ownShare(const View& view, int reachPx) {
    double covered = 0, alike = 0;
    for (size_t i = 0; i < view.reference.pixelCount(); ++i) {
        if (!covers(view.reference, i)) continue;
        const int x = static_cast<int>(i % kSizePx), y = static_cast<int>(i / kSizePx);
        const int last = std::max(reachPx - 1, 0);
        Block sum;
        for (int b = std::max(0, y - reachPx); b <= std::min(kSizePx - 1, y + last); ++b) {
            for (int a = std::max(0, x - reachPx); a <= std::min(kSizePx - 1, x + last); ++a) {
                const size_t pixel = size_t(b) * kSizePx + size_t(a);
                if (covers(view.reference, pixel)) add(sum, colourAt(view.reference, pixel), 1);
            }
        }
        divide(sum);
        ++covered;
        alike += isAlike(sum.mean, view.blocks[blockOf(i)].mean);
    }
    return covered > 0 ? alike / covered : 0;
}

std::vector<View> drawViews(const std::string& path) {
    const ooc::Database database = ooc::Database::open(path);
    const bool isYUp = database.metadataJson().find("\"up\":\"y\"") != std::string::npos;
    const hlod::UpAxis up = isYUp ? hlod::UpAxis::Y : hlod::UpAxis::Z;
    const viewer::GlContext context = viewer::GlContext::headless();
    cache::DatabaseSource source(database);
    viewer::Renderer renderer(database.header().lattice, source, {});
    viewer::RenderOptions options;
    options.worldUp = isYUp ? Vec3f(0, 1, 0) : Vec3f(0, 0, 1);
    options.tauPx = 1e12;
    const auto strategy = hlod::makeStrategy("frustum");
    std::vector<View> views;
    for (const char* name : kViews) {
        hlod::Camera camera;
        camera.widthPx = camera.heightPx = kSizePx;
        camera = hlod::frameBox(camera, renderer.sceneBox(), hlod::viewDirection(name, up), up);
        View view{.name = name, .root = {}, .reference = {}, .blocks = {}};
        hlod::FrameRecord record = renderer.renderReference(camera, options);
        view.reference = renderer.read(record);
        record = renderer.render(camera, *strategy, options);
        view.root = renderer.read(record);
        view.blocks = blockMeans(view.reference);
        views.push_back(std::move(view));
    }
    return views;
}

int run(const std::string& path, const std::string& folder, bool withOracle) {
    const std::vector<View> views = drawViews(path);
    bool isGood = true;
    Coverage all;
    double coveredPx = 0, overlaps = 0, colours = 0;
    for (const View& view : views) {
        const Likeness likeness = compare(view);
        std::printf("%-7s overlap %.3f colour %.3f", view.name, likeness.overlap, likeness.colour);
        if (withOracle) {
            Coverage apart;
            addCoverage(view, apart);
            addCoverage(view, all);
            std::printf(" apart %.3f rough %.3f sharp %.3f smooth %.3f",
                        bestAlikePx(apart) / likeness.coveredPx, roughShare(view.blocks),
                        ownShare(view, 0), ownShare(view, kBlockPx / 2));
        }
        std::printf("\n");
        isGood &= likeness.overlap >= kLeastOverlap && likeness.colour >= kLeastColour;
        coveredPx += likeness.coveredPx;
        overlaps += likeness.overlap;
        colours += likeness.colour;
        if (!folder.empty()) {
            viewer::writePng(view.reference, folder + "/" + view.name + "-reference.png");
            viewer::writePng(view.root, folder + "/" + view.name + "-root.png");
        }
    }
    const auto count = static_cast<double>(views.size());
    std::printf("mean    overlap %.3f colour %.3f", overlaps / count, colours / count);
    if (withOracle) std::printf(" one %.3f", bestAlikePx(all) / coveredPx);
    std::printf(isGood ? "\nall views within the bounds\n" : "\nsome views miss the bounds\n");
    return isGood ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
    std::string path, folder;
    bool withOracle = false;
    for (int i = 1; i < count; ++i) {
        const std::string argument = arguments[i];
        if (argument == "--oracle") {
            withOracle = true;
        } else if (argument == "--pictures" && i + 1 < count) {
            folder = arguments[++i];
        } else {
            path = argument;
        }
    }
    if (path.empty()) return 2;
    try {
        return run(path, folder, withOracle);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
