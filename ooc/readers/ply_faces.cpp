#include "ooc/readers/ply_faces.h"

#include "ooc/readers/ply_values.h"

#include <algorithm>
#include <limits>

namespace pagoda::ooc {
namespace {

size_t bytesBetween(const PlyElement& element, size_t first, size_t last) {
    size_t sum = 0;
    for (size_t k = first; k < last; ++k) sum += element.properties[k].leastBytes();
    return sum;
}

}  // namespace

std::optional<PlyFaceLayout> findPlyFaces(const PlyElement& element) {
    auto list = element.find({"vertex_indices", "vertex_index"}, true);
    if (!list) {
        // Another name for them: taken where there is no doubt.
        const auto lists = std::ranges::count_if(element.properties,
                                                 [](const PlyProperty& p) { return p.isList(); });
        if (lists != 1) return std::nullopt;
        for (size_t k = 0; k < element.properties.size(); ++k) {
            if (element.properties[k].isList()) list = k;
        }
    }
    if (isFloating(element.properties[*list].type)) return std::nullopt;
    return PlyFaceLayout{*list, findPlyColour(element)};
}

template <typename Values>
void PlyFaceReader::readCorners(Values& values, const PlyProperty& list) {
    const uint64_t count = values.listLength(list);
    corners_.clear();
    if (count <= kMaxCutCorners) {
        for (uint64_t k = 0; k < count; ++k) {
            corners_.push_back(static_cast<uint64_t>(values.index(list.type)));
        }
        return;
    }
    ++fannedPolygons_;  // as it streams: no memory for hostile lengths
    const auto first = static_cast<uint64_t>(values.index(list.type));
    auto last = static_cast<uint64_t>(values.index(list.type));
    for (uint64_t k = 2; k < count; ++k) {
        const auto corner = static_cast<uint64_t>(values.index(list.type));
        faces_.triangle(first, last, corner);
        last = corner;
    }
}

template <typename Values>
void PlyFaceReader::readFaces(Values& values, const PlyElement& element,
                              const PlyFaceLayout& layout) {
    std::array<size_t, 4> channelOf;
    std::array<uint32_t, 4> channels = {255, 255, 255, 255};
    for (size_t k = 0; k < 4; ++k) {
        channelOf[k] = layout.colour.property[k].value_or(SIZE_MAX);
    }
    // The colour may come behind the corners, so a long polygon that streams gets the one before;
    // short ones wait in corners_.
    for (uint64_t item = 0; item < element.count; ++item) {
        bool isWaiting = false;
        for (size_t k = 0; k < element.properties.size(); ++k) {
            const PlyProperty& property = element.properties[k];
            if (k == layout.cornerList) {
                const uint64_t fannedBefore = fannedPolygons_;
                readCorners(values, property);
                isWaiting = fannedPolygons_ == fannedBefore;
            } else if (property.isList()) {
                values.skipList(property);
            } else {
                const double value = values.number(property.type);
                for (size_t c = 0; c < 4; ++c) {
                    if (channelOf[c] == k) channels[c] = plyColourChannel(value, property.type);
                }
            }
        }
        values.endItem();
        if (usesFaceColours_) {
            faces_.setFaceColour(channels[0] | channels[1] << 8 | channels[2] << 16 |
                                 channels[3] << 24);
        }
        if (isWaiting) faces_.face(corners_);
    }
}
template void PlyFaceReader::readFaces(PlyBinaryValues&, const PlyElement&, const PlyFaceLayout&);
template void PlyFaceReader::readFaces(PlyAsciiValues&, const PlyElement&, const PlyFaceLayout&);

bool PlyFaceReader::isPlain(PlyFormat format, const PlyElement& element) const {
    return format != PlyFormat::Ascii && !usesFaceColours_ &&
           std::ranges::count_if(element.properties,
                                 [](const PlyProperty& p) { return p.isList(); }) == 1;
}

void PlyFaceReader::readPlainFaces(InputStream& stream, PlyFormat format, const PlyElement& element,
                                   const PlyFaceLayout& layout) {
    const bool swaps = format == PlyFormat::BinaryBigEndian;
    switch (element.properties[layout.cornerList].type) {
        case PlyScalar::Int8:
            return readPlain<int8_t>(stream, swaps, element, layout);
        case PlyScalar::UInt8:
            return readPlain<uint8_t>(stream, swaps, element, layout);
        case PlyScalar::Int16:
            return readPlain<int16_t>(stream, swaps, element, layout);
        case PlyScalar::UInt16:
            return readPlain<uint16_t>(stream, swaps, element, layout);
        case PlyScalar::Int32:
            return readPlain<int32_t>(stream, swaps, element, layout);
        case PlyScalar::UInt32:
            return readPlain<uint32_t>(stream, swaps, element, layout);
        case PlyScalar::Float32:
        case PlyScalar::Float64:
            break;  // findPlyFaces() takes no such list
    }
}

template <typename Index>
void PlyFaceReader::readPlain(InputStream& stream, bool swapsBytes, const PlyElement& element,
                              const PlyFaceLayout& layout) {
    PlyBinaryValues values(stream,
                           swapsBytes ? PlyFormat::BinaryBigEndian : PlyFormat::BinaryLittleEndian);
    PlyElement one = element;
    one.count = 1;
    for (uint64_t left = element.count; left > 0;) {
        std::span<const std::byte> block = stream.ahead(InputStream::kBlockBytes / 4);
        const size_t before = block.size();
        left -= readBlock<Index>(block, swapsBytes, element, layout, left);
        stream.take(before - block.size());
        if (left == 0) break;
        // A face that the block does not hold whole, or longer than fits: the general way.
        readFaces(values, one, layout);
        --left;
    }
}

// Takes whole faces off the front of the block; returns how many.
template <typename Index>
uint64_t PlyFaceReader::readBlock(std::span<const std::byte>& block, bool swapsBytes,
                                  const PlyElement& element, const PlyFaceLayout& layout,
                                  uint64_t facesLeft) {
    const PlyProperty& list = element.properties[layout.cornerList];
    const size_t head = bytesBetween(element, 0, layout.cornerList);
    const size_t tail = bytesBetween(element, layout.cornerList + 1, element.properties.size());
    const size_t countBytes = plyScalarBytes(*list.countType);
    const std::byte* at = block.data();
    const std::byte* const end = at + block.size();
    const auto index = [&](const std::byte* from, size_t k) {
        return static_cast<uint64_t>(loadScalar<Index>(from + k * sizeof(Index), swapsBytes));
    };
    uint64_t faces = 0;
    for (; faces < facesLeft; ++faces) {
        if (static_cast<size_t>(end - at) < head + countBytes) break;
        const double length = countBytes == 1 && *list.countType == PlyScalar::UInt8
                                  ? std::to_integer<uint8_t>(at[head])
                                  : loadPlyScalar(at + head, *list.countType, swapsBytes);
        if (!(length >= 0 && length <= static_cast<double>(kMaxCutCorners))) break;
        const auto count = static_cast<size_t>(length);
        const std::byte* const indices = at + head + countBytes;
        if (static_cast<size_t>(end - indices) < count * sizeof(Index) + tail) break;
        if (count == 3) {
            faces_.triangle(index(indices, 0), index(indices, 1), index(indices, 2));
        } else {
            corners_.clear();
            for (size_t k = 0; k < count; ++k) corners_.push_back(index(indices, k));
            faces_.face(corners_);
        }
        at = indices + count * sizeof(Index) + tail;
    }
    block = block.subspan(static_cast<size_t>(at - block.data()));
    return faces;
}

template <typename Values>
void PlyFaceReader::readStrips(Values& values, const PlyElement& element, size_t cornerList) {
    for (uint64_t item = 0; item < element.count; ++item) {
        for (size_t k = 0; k < element.properties.size(); ++k) {
            const PlyProperty& property = element.properties[k];
            if (k != cornerList) {
                if (property.isList()) {
                    values.skipList(property);
                } else {
                    (void)values.number(property.type);
                }
                continue;
            }
            uint64_t last[2] = {0, 0};
            uint64_t corners = 0;  // of the strip so far
            for (uint64_t left = values.listLength(property); left > 0; --left) {
                const int64_t corner = values.index(property.type);
                if (corner == -1 || (property.type == PlyScalar::UInt32 &&
                                     corner == std::numeric_limits<uint32_t>::max())) {
                    corners = 0;
                    continue;
                }
                const auto next = static_cast<uint64_t>(corner);
                if (++corners >= 3) {  // every second triangle turns the other way
                    const bool isOdd = corners % 2 == 0;
                    faces_.triangle(last[isOdd ? 1 : 0], last[isOdd ? 0 : 1], next);
                }
                last[0] = last[1];
                last[1] = next;
            }
        }
        values.endItem();
    }
}
template void PlyFaceReader::readStrips(PlyBinaryValues&, const PlyElement&, size_t);
template void PlyFaceReader::readStrips(PlyAsciiValues&, const PlyElement&, size_t);

void PlyFaceReader::finish() {
    faces_.finish();
    if (fannedPolygons_ > 0) {
        sink_.ignored("concavity of a polygon of more than 1024 corners", fannedPolygons_);
    }
}

}  // namespace pagoda::ooc
