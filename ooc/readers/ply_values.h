// ply_values.h: the values of a PLY file's data in order, from binary or from text, behind one
// interface (no virtual calls: the readers are templates over the two).
#pragma once

#include "ooc/readers/ply_header.h"
#include "ooc/readers/source_file.h"
#include "ooc/readers/text_scan.h"
#include "ooc/readers/text_stream.h"

#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <string>

namespace pagoda::ooc {

template <typename Scalar>
[[nodiscard]] inline Scalar loadScalar(const std::byte* from, bool swapsBytes) {
    std::byte raw[sizeof(Scalar)];
    for (size_t k = 0; k < sizeof(Scalar); ++k) {
        raw[k] = from[swapsBytes ? sizeof(Scalar) - 1 - k : k];
    }
    Scalar value;
    std::memcpy(&value, raw, sizeof value);
    return value;
}

// Every scalar of PLY is exact in double.
[[nodiscard]] inline double loadPlyScalar(const std::byte* from, PlyScalar type, bool swapsBytes) {
    switch (type) {
        case PlyScalar::Int8:
            return loadScalar<int8_t>(from, swapsBytes);
        case PlyScalar::UInt8:
            return loadScalar<uint8_t>(from, swapsBytes);
        case PlyScalar::Int16:
            return loadScalar<int16_t>(from, swapsBytes);
        case PlyScalar::UInt16:
            return loadScalar<uint16_t>(from, swapsBytes);
        case PlyScalar::Int32:
            return loadScalar<int32_t>(from, swapsBytes);
        case PlyScalar::UInt32:
            return loadScalar<uint32_t>(from, swapsBytes);
        case PlyScalar::Float32:
            return static_cast<double>(loadScalar<float>(from, swapsBytes));
        case PlyScalar::Float64:
            break;
    }
    return loadScalar<double>(from, swapsBytes);
}

class PlyBinaryValues {
public:
    static constexpr bool kIsBinary = true;

    PlyBinaryValues(InputStream& stream, PlyFormat format)
        : stream_(stream), swapsBytes_(format == PlyFormat::BinaryBigEndian) {}

    void endItem() {}
    [[nodiscard]] double number(PlyScalar type) {
        return loadPlyScalar(take(plyScalarBytes(type)), type, swapsBytes_);
    }
    // The next bytes, as they lie. Valid until the next call.
    [[nodiscard]] const std::byte* take(size_t bytes) {
        const std::span<const std::byte> ahead = stream_.ahead(bytes);
        if (ahead.size() < bytes) failCutShort();
        stream_.take(bytes);
        return ahead.data();
    }
    [[nodiscard]] bool swapsBytes() const { return swapsBytes_; }
    // Length of the list that follows, checked against what is left of the file.
    [[nodiscard]] uint64_t listLength(const PlyProperty& list) {
        const double length = number(*list.countType);
        if (length < 0) {
            stream_.source().failAtByte(stream_.offset(), "a list has a negative length");
        }
        const auto count = static_cast<uint64_t>(length);
        if (count > stream_.remainingBytes() / plyScalarBytes(list.type)) failCutShort();
        return count;
    }
    [[nodiscard]] int64_t index(PlyScalar type) { return static_cast<int64_t>(number(type)); }
    void skipList(const PlyProperty& list) {
        stream_.skip(listLength(list) * plyScalarBytes(list.type));
    }
    [[nodiscard]] uint64_t ignoredValues() const { return 0; }

private:
    [[noreturn]] void failCutShort() const {
        stream_.source().failCutShort("byte " + std::to_string(stream_.source().sizeBytes()),
                                      "the data ends in the middle of an element");
    }

    InputStream& stream_;
    bool swapsBytes_;
};

// One item a line, as the format says; an item may also run over several lines. What a line holds
// beyond the announced properties is ignored and counted.
class PlyAsciiValues {
public:
    static constexpr bool kIsBinary = false;

    explicit PlyAsciiValues(TextStream& stream) : stream_(stream) {}

    void endItem() {
        if (!cursor_.atEnd()) ++ignoredValues_;
        cursor_ = TextCursor();
    }
    [[nodiscard]] double number(PlyScalar type) {
        beginValue();
        double value = 0;
        if (!cursor_.number(value)) failAtWord("is not a number");
        // So that text gives the same bits as the binary file of the same model.
        return type == PlyScalar::Float32 ? static_cast<double>(static_cast<float>(value)) : value;
    }
    [[nodiscard]] int64_t index(PlyScalar) {
        beginValue();
        int64_t value = 0;
        if (!cursor_.integer(value)) failAtWord("is not a whole number");
        return value;
    }
    [[nodiscard]] uint64_t listLength(const PlyProperty& list) {
        const int64_t length = index(list.type);
        if (length < 0) source().failAtLine(stream_.lineNumber(), "a list has a negative length");
        const uint64_t left =
            stream_.remainingBytes() + static_cast<uint64_t>(cursor_.end - cursor_.at);
        if (static_cast<uint64_t>(length) > left / 2 + 1) failCutShort();  // digit and separator
        return static_cast<uint64_t>(length);
    }
    void skipList(const PlyProperty& list) {
        for (uint64_t left = listLength(list); left > 0; --left) (void)number(PlyScalar::Float64);
    }
    [[nodiscard]] uint64_t ignoredValues() const { return ignoredValues_; }

private:
    void beginValue() {
        while (cursor_.atEnd()) {
            std::string_view line;
            if (!stream_.next(line)) failCutShort();
            cursor_ = TextCursor(line);
        }
    }
    [[nodiscard]] const SourceFile& source() const { return stream_.source(); }
    [[noreturn]] void failCutShort() const {
        source().failCutShort("line " + std::to_string(stream_.lineNumber()),
                              "the data ends in the middle of an element");
    }
    [[noreturn]] void failAtWord(const char* problem) {
        source().failAtLine(stream_.lineNumber(),
                            "\"" + printable(cursor_.word()) + "\" " + problem);
    }

    TextStream& stream_;
    TextCursor cursor_;
    uint64_t ignoredValues_ = 0;
};

// Moves over one item.
template <typename Values>
void skipItem(Values& values, const PlyElement& element) {
    for (const PlyProperty& property : element.properties) {
        if (property.isList()) {
            values.skipList(property);
        } else {
            (void)values.number(property.type);
        }
    }
    values.endItem();
}

}  // namespace pagoda::ooc
