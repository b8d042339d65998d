#include "common/scene/gltf/gltf_data.h"

#include <algorithm>
#include <cstring>
#include <format>

#include <meshoptimizer.h>

namespace skinbench {
namespace {

constexpr uint64_t kMaxUnbackedElements = 1u << 22;  // an accessor without a bufferView costs the file nothing
constexpr uint64_t kMaxDecompressedBytes = 1u << 30;

uint64_t componentBytes(int component) {
    switch (component) {
        case kGltfI8:
        case kGltfU8:
            return 1;
        case kGltfI16:
        case kGltfU16:
            return 2;
        case kGltfU32:
        case kGltfF32:
            return 4;
        default:
            return 0;
    }
}

// A range of equal elements that is known to lie inside its view.
struct Elements {
    const uint8_t* first = nullptr;
    uint64_t stride = 0;
};

Result<Elements> locate(const GltfData& data, int view, uint64_t offset, uint64_t count, uint64_t elementBytes) {
    if (view < 0 || static_cast<size_t>(view) >= data.views.size())
        return inputError(std::format("bufferView {} does not exist", view));
    const GltfView& source = data.views[view];
    const uint64_t stride = source.stride ? source.stride : elementBytes;
    if (stride < elementBytes)
        return inputError(std::format("byteStride {} is smaller than an element of {} bytes", stride, elementBytes));
    const uint64_t size = source.bytes.size();
    // Elements are a byte at least and do not overlap, so count <= size, and the product below stays under 2^64.
    if (offset > size || count > size || offset + (count ? (count - 1) * stride + elementBytes : 0) > size)
        return inputError(
            std::format("{} elements at byte {} go past the {} bytes of bufferView {}", count, offset, size, view));
    return Elements{source.bytes.data() + offset, stride};
}

template <class T, class Out>
void convert(const Elements& source, uint64_t count, int components, float divisor, Out* out) {
    for (uint64_t i = 0; i < count; ++i) {
        const uint8_t* element = source.first + i * source.stride;
        for (int c = 0; c < components; ++c) {
            T value;
            std::memcpy(&value, element + c * sizeof(T), sizeof(T));
            if constexpr (std::is_same_v<Out, uint32_t>) {
                *out++ = static_cast<uint32_t>(value);
            } else {
                const float number = static_cast<float>(value);
                *out++ = divisor > 0 ? std::max(number / divisor, -1.0f) : number;
            }
        }
    }
}

template <class Out>
void convertAny(const Elements& source, uint64_t count, int component, int components, bool normalized, Out* out) {
    const auto divisor = [&](float range) { return normalized ? range : 0.0f; };
    switch (component) {
        case kGltfI8:
            return convert<int8_t>(source, count, components, divisor(127), out);
        case kGltfU8:
            return convert<uint8_t>(source, count, components, divisor(255), out);
        case kGltfI16:
            return convert<int16_t>(source, count, components, divisor(32767), out);
        case kGltfU16:
            return convert<uint16_t>(source, count, components, divisor(65535), out);
        case kGltfU32:
            return convert<uint32_t>(source, count, components, divisor(4294967295.0f), out);
        case kGltfF32:
            if constexpr (std::is_same_v<Out, float>) convert<float>(source, count, components, 0, out);
            return;
        default:
            SKINBENCH_ASSERT(!"component type was checked");
    }
}

template <class Out>
Result<void> applySparse(const GltfData& data, const GltfAccessor& accessor, bool normalized, std::vector<Out>& out) {
    const GltfSparse& sparse = *accessor.sparse;
    if (sparse.count == 0 || sparse.count > accessor.count)
        return inputError(std::format("sparse count {} is not between 1 and {}", sparse.count, accessor.count));
    const int type = sparse.indexComponent;
    if (type != kGltfU8 && type != kGltfU16 && type != kGltfU32)
        return inputError(std::format("sparse indices have component type {}", type));
    const auto indexSource = locate(data, sparse.indexView, sparse.indexOffset, sparse.count, componentBytes(type));
    if (!indexSource) return std::unexpected(indexSource.error());
    const uint64_t elementBytes = componentBytes(accessor.component) * accessor.components;
    const auto valueSource = locate(data, sparse.valueView, sparse.valueOffset, sparse.count, elementBytes);
    if (!valueSource) return std::unexpected(valueSource.error());
    std::vector<uint32_t> indices(sparse.count);
    convertAny(*indexSource, sparse.count, type, 1, false, indices.data());
    std::vector<Out> values(sparse.count * accessor.components);
    convertAny(*valueSource, sparse.count, accessor.component, accessor.components, normalized, values.data());
    for (uint64_t i = 0; i < sparse.count; ++i) {
        if (indices[i] >= accessor.count)
            return inputError(std::format("sparse index {} is not below {}", indices[i], accessor.count));
        std::copy_n(values.begin() + i * accessor.components, accessor.components,
                    out.begin() + uint64_t{indices[i]} * accessor.components);
    }
    return {};
}

template <class Out>
Result<std::vector<Out>> readElements(const GltfData& data, const GltfAccessor& accessor, int components,
                                      bool normalized) {
    if (accessor.components != components)
        return inputError(std::format("has {} components an element, {} are needed", accessor.components, components));
    const uint64_t elementBytes = componentBytes(accessor.component) * components;
    if (elementBytes == 0) return inputError(std::format("has the unknown component type {}", accessor.component));
    Elements source;
    if (accessor.view >= 0) {
        auto located = locate(data, accessor.view, accessor.offset, accessor.count, elementBytes);
        if (!located) return std::unexpected(located.error());
        source = *located;
    } else if (accessor.count > kMaxUnbackedElements) {
        return inputError(std::format("has {} elements but no bufferView", accessor.count));
    }
    std::vector<Out> out(accessor.count * components);
    if (accessor.view >= 0) convertAny(source, accessor.count, accessor.component, components, normalized, out.data());
    if (accessor.sparse)
        if (auto ok = applySparse(data, accessor, normalized, out); !ok) return std::unexpected(ok.error());
    return out;
}

template <class T>
Result<T> named(int accessor, Result<T> result) {
    if (!result) result.error().text = std::format("accessor {}: {}", accessor, result.error().text);
    return result;
}

Result<void> decodeBytes(const CompressedView& view, std::vector<uint8_t>& out) {
    int status = 0;
    if (view.mode == "ATTRIBUTES") {
        if (view.stride == 0 || view.stride % 4 != 0 || view.stride > 256)
            return inputError(std::format("byteStride {} must be a multiple of 4 up to 256", view.stride));
        status = meshopt_decodeVertexBuffer(out.data(), view.count, view.stride, view.bytes.data(), view.bytes.size());
    } else if (view.mode == "TRIANGLES" || view.mode == "INDICES") {
        if (view.stride != 2 && view.stride != 4)
            return inputError(std::format("byteStride {} of indices must be 2 or 4", view.stride));
        if (view.mode == "TRIANGLES" && view.count % 3 != 0)
            return inputError(std::format("{} indices are not whole triangles", view.count));
        using Decode = int (*)(void*, size_t, size_t, const unsigned char*, size_t);
        const Decode decode =
            view.mode == "TRIANGLES" ? Decode{meshopt_decodeIndexBuffer} : Decode{meshopt_decodeIndexSequence};
        status = decode(out.data(), view.count, view.stride, view.bytes.data(), view.bytes.size());
    } else {
        return inputError("has the unknown mode \"" + view.mode.substr(0, 40) + "\"");
    }
    if (status != 0) return inputError("its compressed bytes are broken");
    return {};
}

}  // namespace

Result<std::vector<float>> readFloats(const GltfData& data, int accessor, int components, bool alwaysNormalized) {
    if (accessor < 0 || static_cast<size_t>(accessor) >= data.accessors.size())
        return inputError(std::format("accessor {} does not exist", accessor));
    const GltfAccessor& source = data.accessors[accessor];
    return named(accessor, readElements<float>(data, source, components, source.normalized || alwaysNormalized));
}

Result<std::vector<uint32_t>> readUnsigned(const GltfData& data, int accessor, int components, int maxComponentBytes) {
    if (accessor < 0 || static_cast<size_t>(accessor) >= data.accessors.size())
        return inputError(std::format("accessor {} does not exist", accessor));
    const GltfAccessor& source = data.accessors[accessor];
    const bool isUnsigned = source.component == kGltfU8 || source.component == kGltfU16 || source.component == kGltfU32;
    if (!isUnsigned || componentBytes(source.component) > static_cast<uint64_t>(maxComponentBytes))
        return inputError(
            std::format("accessor {}: component type {} cannot hold indices", accessor, source.component));
    return named(accessor, readElements<uint32_t>(data, source, components, false));
}

Result<std::vector<uint8_t>> decompressView(const CompressedView& view) {
    if (view.stride > 256 || view.count > kMaxDecompressedBytes || view.count * view.stride > kMaxDecompressedBytes)
        return inputError(
            std::format("{} elements of {} bytes are more than can be decompressed", view.count, view.stride));
    std::vector<uint8_t> out(view.count * view.stride);
    if (auto ok = decodeBytes(view, out); !ok) return std::unexpected(ok.error());
    if (view.filter.empty() || view.filter == "NONE") return out;
    const uint64_t stride = view.stride;
    if (view.mode != "ATTRIBUTES") return inputError("filters apply to attributes only");
    if (view.filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
        meshopt_decodeFilterOct(out.data(), view.count, stride);
    else if (view.filter == "QUATERNION" && stride == 8)
        meshopt_decodeFilterQuat(out.data(), view.count, stride);
    else if (view.filter == "EXPONENTIAL")
        meshopt_decodeFilterExp(out.data(), view.count, stride);
    else
        return inputError(
            std::format("cannot apply the filter \"{}\" to elements of {} bytes", view.filter.substr(0, 40), stride));
    return out;
}

}  // namespace skinbench
