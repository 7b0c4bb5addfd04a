// gltf_accessor.h: an accessor's elements as numbers, checked against the bytes they lie in.
#pragma once

#include "ooc/readers/gltf_buffers.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace pagoda::ooc::gltf {

// Which elements of an accessor to read: a range, or a list of indices in rising order.
struct Selection {
    uint64_t first = 0, count = 0;
    std::span<const uint32_t> list;  // empty: the range

    [[nodiscard]] uint64_t element(uint64_t i) const { return list.empty() ? first + i : list[i]; }
};

// A view on one accessor: borrows the buffers. The constructor checks in 64 bits that every
// element lies in the buffer view (throws Error); sparse indices are checked to rise and to exist.
class AccessorView {
public:
    AccessorView(const SourceFile& source, const Document& document, Buffers& buffers,
                 int accessor);

    [[nodiscard]] uint64_t count() const noexcept { return count_; }
    [[nodiscard]] int components() const noexcept { return components_; }
    [[nodiscard]] int componentType() const noexcept { return componentType_; }
    [[nodiscard]] bool isFloat() const noexcept;

    // Reads `components` (at most components()) numbers of each selected element into `out`,
    // normalised integers as [0, 1] or [-1, 1]. All selected elements must exist.
    void read(const Selection& selection, int components, double* out) const;
    void read(const Selection& selection, int components, float* out) const;
    // All elements of an accessor of whole numbers that is SCALAR.
    void readIndices(uint32_t* out) const;

private:
    struct Elements {
        const std::byte* data = nullptr;  // null: zeros
        uint64_t stride = 0;
    };
    template <typename Out>
    void readAll(const Selection& selection, int components, Out* out) const;
    template <typename Out>
    void readSparse(const Selection& selection, int components, Out* out) const;
    [[nodiscard]] uint64_t sparseIndex(uint64_t i) const;
    [[nodiscard]] Elements locate(const SourceFile& source, Buffers& buffers, int bufferView,
                                  uint64_t offset, uint64_t count, uint64_t elementBytes,
                                  uint64_t stride, const std::string& where) const;

    uint64_t count_ = 0;
    int components_ = 0;
    int componentType_ = 0;
    bool isNormalised_ = false;
    Elements elements_;
    uint64_t sparseCount_ = 0;
    int sparseIndexType_ = 0;
    Elements sparseIndices_, sparseValues_;
};

}  // namespace pagoda::ooc::gltf
