#include "tools/bench/truth.h"

#include <algorithm>
#include <cassert>
#include <cmath>
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
    WrongPixels counts;
    for (size_t i = 0; i < picture.pixelCount(); ++i) {
        if (isSameSurface(picture, truth, i)) continue;
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
