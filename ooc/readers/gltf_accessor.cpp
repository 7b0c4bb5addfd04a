#include "ooc/readers/gltf_accessor.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

namespace pagoda::ooc::gltf {
namespace {

template <typename T>
T load(const std::byte* from) {
    T value;
    std::memcpy(&value, from, sizeof(T));
    return value;
}

template <typename Out, typename T>
Out convert(T value, bool isNormalised) {
    if constexpr (std::is_integral_v<T>) {
        if (isNormalised) {
            // KHR_mesh_quantization: c / max, and no less than -1.
            const Out scaled =
                static_cast<Out>(value) / static_cast<Out>(std::numeric_limits<T>::max());
            return std::max(scaled, Out{-1});
        }
    }
    return static_cast<Out>(value);
}

template <typename T, typename Out>
void gather(const std::byte* data, uint64_t stride, const Selection& selection, int components,
            bool isNormalised, Out* out) {
    for (uint64_t i = 0; i < selection.count; ++i) {
        const std::byte* element = data + selection.element(i) * stride;
        for (int c = 0; c < components; ++c) {
            *out++ =
                convert<Out>(load<T>(element + static_cast<size_t>(c) * sizeof(T)), isNormalised);
        }
    }
}

template <typename Out>
void gatherAny(int componentType, const std::byte* data, uint64_t stride,
               const Selection& selection, int components, bool isNormalised, Out* out) {
    const auto run = [&](auto example) {
        gather<decltype(example)>(data, stride, selection, components, isNormalised, out);
    };
    switch (componentType) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return run(int8_t{});
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return run(uint8_t{});
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return run(int16_t{});
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return run(uint16_t{});
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return run(uint32_t{});
        default:
            return run(float{});
    }
}

uint64_t loadIndex(int componentType, const std::byte* from) {
    switch (componentType) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return load<uint8_t>(from);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return load<uint16_t>(from);
        default:
            return load<uint32_t>(from);
    }
}

bool isUnsigned(int componentType) {
    return componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
           componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

}  // namespace

AccessorView::AccessorView(const SourceFile& source, const Document& document, Buffers& buffers,
                           int accessor) {
    const auto index = static_cast<size_t>(accessor);
    const tinygltf::Accessor& from = document.model.accessors[index];
    const std::string where = place("accessors", index);
    count_ = from.count;
    componentType_ = from.componentType;
    components_ = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(from.type));
    isNormalised_ = from.normalized;
    const auto componentBytes = static_cast<uint64_t>(
        tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(componentType_)));
    const uint64_t elementBytes = componentBytes * static_cast<uint64_t>(components_);
    if (from.bufferView >= 0) {
        const uint64_t stride = document.extras.strides[static_cast<size_t>(from.bufferView)];
        elements_ = locate(source, buffers, from.bufferView, from.byteOffset, count_, elementBytes,
                           stride == 0 ? elementBytes : stride, where);
    }
    if (!from.sparse.isSparse) return;
    sparseCount_ = static_cast<uint64_t>(from.sparse.count);
    sparseIndexType_ = from.sparse.indices.componentType;
    if (!isUnsigned(sparseIndexType_)) {
        source.fail(where + ".sparse.indices", "are not unsigned whole numbers", kValidate);
    }
    const auto indexBytes = static_cast<uint64_t>(
        tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(sparseIndexType_)));
    sparseIndices_ = locate(source, buffers, from.sparse.indices.bufferView,
                            static_cast<uint64_t>(from.sparse.indices.byteOffset), sparseCount_,
                            indexBytes, indexBytes, where + ".sparse.indices");
    sparseValues_ = locate(source, buffers, from.sparse.values.bufferView,
                           static_cast<uint64_t>(from.sparse.values.byteOffset), sparseCount_,
                           elementBytes, elementBytes, where + ".sparse.values");
    if (!buffers.isNewSparse(accessor)) return;
    for (uint64_t i = 0; i < sparseCount_; ++i) {
        if (sparseIndex(i) >= count_ || (i > 0 && sparseIndex(i) <= sparseIndex(i - 1))) {
            source.fail(
                where + ".sparse.indices",
                "do not rise, or name elements that do not exist (item " + std::to_string(i) + ")",
                kValidate);
        }
    }
}

AccessorView::Elements AccessorView::locate(const SourceFile& source, Buffers& buffers,
                                            int bufferView, uint64_t offset, uint64_t count,
                                            uint64_t elementBytes, uint64_t stride,
                                            const std::string& where) const {
    const std::span<const std::byte> bytes = buffers.view(bufferView);
    const bool fits =
        count == 0 || (offset <= bytes.size() && elementBytes <= bytes.size() - offset &&
                       (count - 1) <= (bytes.size() - offset - elementBytes) / stride);
    if (!fits) {
        source.fail(where,
                    "has " + std::to_string(count) + " elements, which reach beyond " +
                        place("bufferViews", static_cast<size_t>(bufferView)) + " of " +
                        std::to_string(bytes.size()) + " bytes",
                    "check that all files of the model were copied whole");
    }
    return {count == 0 ? nullptr : bytes.data() + offset, stride};
}

bool AccessorView::isFloat() const noexcept {
    return componentType_ == TINYGLTF_COMPONENT_TYPE_FLOAT;
}

uint64_t AccessorView::sparseIndex(uint64_t i) const {
    return loadIndex(sparseIndexType_, sparseIndices_.data + i * sparseIndices_.stride);
}

template <typename Out>
void AccessorView::readAll(const Selection& selection, int components, Out* out) const {
    const size_t numbers = selection.count * static_cast<uint64_t>(components);
    if (elements_.data == nullptr) {
        std::fill_n(out, numbers, Out{0});
    } else {
        gatherAny(componentType_, elements_.data, elements_.stride, selection, components,
                  isNormalised_, out);
    }
    if (sparseCount_ > 0) readSparse(selection, components, out);
}

// Both the selection and the sparse indices rise: for each selected element a binary search, or
// where a range is read, a walk over the sparse items in it.
template <typename Out>
void AccessorView::readSparse(const Selection& selection, int components, Out* out) const {
    const auto lowerBound = [&](uint64_t element) {
        uint64_t low = 0, high = sparseCount_;
        while (low < high) {
            const uint64_t middle = (low + high) / 2;
            if (sparseIndex(middle) < element) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        return low;
    };
    const auto replace = [&](uint64_t i, uint64_t item) {
        gatherAny(componentType_, sparseValues_.data, sparseValues_.stride, Selection{item, 1, {}},
                  components, isNormalised_, out + i * static_cast<uint64_t>(components));
    };
    if (selection.list.empty()) {
        for (uint64_t item = lowerBound(selection.first);
             item < sparseCount_ && sparseIndex(item) < selection.first + selection.count; ++item) {
            replace(sparseIndex(item) - selection.first, item);
        }
        return;
    }
    for (uint64_t i = 0; i < selection.count; ++i) {
        const uint64_t item = lowerBound(selection.list[i]);
        if (item < sparseCount_ && sparseIndex(item) == selection.list[i]) replace(i, item);
    }
}

void AccessorView::read(const Selection& selection, int components, double* out) const {
    readAll(selection, components, out);
}

void AccessorView::read(const Selection& selection, int components, float* out) const {
    readAll(selection, components, out);
}

void AccessorView::readIndices(uint32_t* out) const {
    for (uint64_t i = 0; i < count_; ++i) {
        out[i] = elements_.data == nullptr
                     ? 0
                     : static_cast<uint32_t>(
                           loadIndex(componentType_, elements_.data + i * elements_.stride));
    }
    for (uint64_t item = 0; item < sparseCount_; ++item) {
        out[sparseIndex(item)] = static_cast<uint32_t>(
            loadIndex(componentType_, sparseValues_.data + item * sparseValues_.stride));
    }
}

}  // namespace pagoda::ooc::gltf
