// reader_extras.h: what some readers can do beside read(). Ask for it: a dynamic_cast of a Reader.
#pragma once

#include "ooc/readers/reader.h"

#include <functional>

namespace pagoda::ooc {

// Gives a first impression of a file long before read() could (binary PLY, binary STL).
class SampledReader {
public:
    virtual ~SampledReader() = default;
    // Delivers about `triangles` of the file's triangles from places all over it in a scattered
    // order, so that any part of what comes shows the whole coarsely: without scratch, in 2 MiB of
    // memory. Ends early once `isEnough` says so (asked every few hundred triangles). What is
    // broken is passed over: read() tells. False, and nothing is delivered, where triangles of this
    // file cannot be found by their number.
    [[nodiscard]] virtual bool sample(TriangleSink& sink, uint64_t triangles,
                                      const std::function<bool()>& isEnough) = 0;
};

// Are some files of the format read by a SampledReader?
[[nodiscard]] bool mayBeSampled(const ReaderFormat& format);

// What openReader() would open `path` as; throws Error as it does where the kind is not known.
[[nodiscard]] const ReaderFormat& readerFormatOf(const std::filesystem::path& path);

// Takes part of what it delivers from other files: materials, buffers, textures.
class CompanionReader {
public:
    virtual ~CompanionReader() = default;
    // Those files, whether they are there or not; known after the first read(). Sorted, none twice.
    [[nodiscard]] virtual std::vector<std::filesystem::path> companions() const = 0;
};

}  // namespace pagoda::ooc
