#include "tools/bench/truth.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pagoda::tools {
namespace {

ooc::NodeId nodeAt(const viewer::Picture& picture, size_t pixel) {
    const uint32_t ordinal = picture.nodeOrdinals[pixel];
    return ordinal == 0 ? ooc::NodeId{} : picture.nodes[ordinal - 1];
}

bool isSameSurface(const viewer::Picture& a, const viewer::Picture& b, size_t pixel) {
    return a.triangles[pixel] == b.triangles[pixel] && nodeAt(a, pixel) == nodeAt(b, pixel);
}

bool isSameColour(const viewer::Picture& a, const viewer::Picture& b, size_t pixel) {
    const auto at = static_cast<std::ptrdiff_t>(4 * pixel);
    return std::equal(a.colours.begin() + at, a.colours.begin() + at + 4, b.colours.begin() + at);
}

bool isCovered(const viewer::Picture& picture, size_t pixel) {
    return picture.nodeOrdinals[pixel] != 0 || picture.colours[4 * pixel + 3] != 0;
}

// Rows or columns of a picture.
struct Lines {
    size_t count, stride, length, strideInLine;
};

// Of each value the greatest within `reach` before and after it in its line.
std::vector<float> greatestAround(const std::vector<float>& values, const Lines& lines,
                                  size_t reach) {
    std::vector<float> greatest(values.size());
    for (size_t line = 0; line < lines.count; ++line) {
        for (size_t i = 0; i < lines.length; ++i) {
            const size_t begin = i - std::min(i, reach);
            const size_t end = std::min(i + reach + 1, lines.length);
            float best = -INFINITY;
            for (size_t k = begin; k < end; ++k) {
                best = std::max(best, values[line * lines.stride + k * lines.strideInLine]);
            }
            greatest[line * lines.stride + i * lines.strideInLine] = best;
        }
    }
    return greatest;
}

// Of the square that reaches `reach` pixels to all sides, as far as it lies in the picture.
std::vector<float> greatestInSquare(const std::vector<float>& values, size_t width, size_t height,
                                    size_t reach) {
    return greatestAround(greatestAround(values, {height, width, width, 1}, reach),
                          {width, 1, height, width}, reach);
}

bool isBelow(ooc::NodeId node, ooc::NodeId above) {
    while (node != above && node != ooc::NodeId::root()) node = node.parent();
    return node == above;
}

double toDb(double squares, size_t count) {
    if (squares <= 0.0) return kEqualDb;
    return std::min(kEqualDb,
                    10.0 * std::log10(255.0 * 255.0 * static_cast<double>(count) / squares));
}

}  // namespace

WrongPixels countWrongPixels(const viewer::Picture& picture, const viewer::Picture& truth,
                             const std::function<bool(ooc::NodeId)>& isOverdrawn) {
    assert(picture.pixelCount() == truth.pixelCount());
    std::vector<bool> isOverdrawnNode;
    for (const ooc::NodeId node : picture.nodes) isOverdrawnNode.push_back(isOverdrawn(node));
    const bool isAnyOverdrawn =
        std::find(isOverdrawnNode.begin(), isOverdrawnNode.end(), true) != isOverdrawnNode.end();
    WrongPixels counts;
    for (size_t i = 0; i < picture.pixelCount(); ++i) {
        if (isSameSurface(picture, truth, i)) {
            if (isSameColour(picture, truth, i)) continue;
            ++(isAnyOverdrawn ? counts.overdrawn : counts.wrong);
            continue;
        }
        const uint32_t ordinal = picture.nodeOrdinals[i];
        if (ordinal > 0 && isOverdrawnNode[ordinal - 1]) {
            ++counts.overdrawn;
        } else if (picture.depthsModelUnits[i] == truth.depthsModelUnits[i]) {
            ++counts.tied;
        } else {
            ++counts.wrong;
        }
    }
    return counts;
}

uint64_t countDifferentIds(const viewer::Picture& a, const viewer::Picture& b) {
    assert(a.pixelCount() == b.pixelCount());
    uint64_t count = 0;
    for (size_t i = 0; i < a.pixelCount(); ++i) count += !isSameSurface(a, b, i);
    return count;
}

uint64_t countHoles(const DrawnPicture& drawn, const viewer::Picture& leaves) {
    const viewer::Picture& picture = drawn.picture;
    assert(picture.widthPx == leaves.widthPx && picture.heightPx == leaves.heightPx);
    const auto width = static_cast<size_t>(leaves.widthPx);
    const auto height = static_cast<size_t>(leaves.heightPx);
    const auto reach = static_cast<size_t>(std::ceil(drawn.tauPx)) + 1;
    std::vector<float> isOpen(leaves.pixelCount());
    for (size_t i = 0; i < isOpen.size(); ++i) isOpen[i] = isCovered(leaves, i) ? 0.0f : 1.0f;
    const std::vector<float> isOpenAround = greatestInSquare(isOpen, width, height, reach);
    const std::vector<float> farthest =
        greatestInSquare(leaves.depthsModelUnits, width, height, reach);
    uint64_t holes = 0;
    for (size_t y = reach; y + reach < height; ++y) {
        for (size_t x = reach; x + reach < width; ++x) {
            const size_t i = y * width + x;
            if (isOpenAround[i] > 0.0f) continue;
            const uint32_t ordinal = picture.nodeOrdinals[i];
            const double error = ordinal == 0 ? 0.0 : drawn.errorsModelUnits[ordinal - 1];
            holes += !isCovered(picture, i) ||
                     double{picture.depthsModelUnits[i]} > double{farthest[i]} + error;
        }
    }
    return holes;
}

void CoarserPixels::add(const CoarserPixels& more) {
    byCut += more.byCut;
    byOthers += more.byOthers;
    byStandIns += more.byStandIns;
    byTau += more.byTau;
}

CoarserPixels countCoarser(const DrawnPicture& before, const DrawnPicture& now) {
    assert(before.picture.pixelCount() == now.picture.pixelCount());
    CoarserPixels counts;
    for (size_t i = 0; i < now.picture.pixelCount(); ++i) {
        const uint32_t was = before.picture.nodeOrdinals[i], is = now.picture.nodeOrdinals[i];
        if (was == 0 || is == 0) continue;
        if (now.errorsModelUnits[is - 1] <= before.errorsModelUnits[was - 1]) continue;
        if (now.tauPx > before.tauPx) {
            ++counts.byTau;
        } else if (before.isStandIn[was - 1] != 0 || now.isStandIn[is - 1] != 0) {
            ++counts.byStandIns;
        } else if (isBelow(nodeAt(before.picture, i), nodeAt(now.picture, i))) {
            ++counts.byCut;
        } else {
            ++counts.byOthers;
        }
    }
    return counts;
}

Psnr psnr(const viewer::Picture& picture, const viewer::Picture& reference) {
    assert(picture.pixelCount() == reference.pixelCount());
    double squares[3] = {0, 0, 0};
    for (size_t i = 0; i < picture.pixelCount(); ++i) {
        double d[3];
        for (size_t c = 0; c < 3; ++c) {
            d[c] = double{1} * picture.colours[4 * i + c] - reference.colours[4 * i + c];
        }
        const double luma = 0.299 * d[0] + 0.587 * d[1] + 0.114 * d[2];
        squares[0] += luma * luma;
        squares[1] += std::pow(0.5 / (1 - 0.114) * (d[2] - luma), 2);
        squares[2] += std::pow(0.5 / (1 - 0.299) * (d[0] - luma), 2);
    }
    const size_t count = picture.pixelCount();
    return {toDb(squares[0], count), toDb(squares[1], count), toDb(squares[2], count)};
}

}  // namespace pagoda::tools
