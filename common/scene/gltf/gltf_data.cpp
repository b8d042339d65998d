#include "common/scene/gltf/gltf_data.h"

#include <algorithm>
#include <cstring>
#include <format>

#include <meshoptimizer.h>

#include "common/scene/gltf/meshopt_decode.h"

#include "common/core/text.h"
#include "common/core/utf8.h"

namespace skinbench {
namespace {

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

Result<const GltfView*> openView(GltfData& data, int index) {
    if (index < 0 || static_cast<size_t>(index) >= data.views.size())
        return inputError(std::format("bufferView {} does not exist", index));
    GltfView& view = data.views[index];
    if (view.fault.empty() && view.packed) {
        auto bytes = decompressView(*view.packed, data.budget);
        if (bytes) {
            view.bytes = data.storage.emplace_back(std::move(*bytes));
            view.stride = view.packed->mode == "ATTRIBUTES" ? view.packed->stride : 0;
        } else {
            view.fault = std::format("bufferView {}: {}: {}", index, view.packed->extension, bytes.error().text);
        }
        view.packed.reset();
    }
    if (!view.fault.empty()) return inputError(view.fault);
    return &view;
}

Result<GltfElements> locate(GltfData& data, int index, uint64_t offset, uint64_t count, uint64_t elementBytes) {
    const auto view = openView(data, index);
    SKINBENCH_TRY(view);
    const uint64_t stride = (*view)->stride ? (*view)->stride : elementBytes;
    if (stride < elementBytes)
        return inputError(
            std::format("byteStride {} is smaller than an element of {}", stride, counted(elementBytes, "byte")));
    const uint64_t size = (*view)->bytes.size();
    // Elements are a byte at least and do not overlap, so count <= size, and the product below stays under 2^64.
    if (offset > size || count > size || offset + (count ? (count - 1) * stride + elementBytes : 0) > size)
        return inputError(std::format("{} at byte {} {} past the {} of bufferView {}", counted(count, "element"),
                                      offset, count == 1 ? "goes" : "go", counted(size, "byte"), index));
    return GltfElements{(*view)->bytes.data() + offset, stride};
}

template <class T, class Out>
void convert(const uint8_t* element, int components, float divisor, Out* out) {
    for (int c = 0; c < components; ++c) {
        T value;
        std::memcpy(&value, element + c * sizeof(T), sizeof(T));
        if constexpr (std::is_same_v<Out, uint32_t>) {
            out[c] = static_cast<uint32_t>(value);
        } else {
            const float number = static_cast<float>(value);
            out[c] = divisor > 0 ? std::max(number / divisor, -1.0f) : number;
        }
    }
}

template <class Out>
void convertAny(const uint8_t* element, int component, int components, bool normalized, Out* out) {
    const auto divisor = [&](float range) { return normalized ? range : 0.0f; };
    switch (component) {
        case kGltfI8:
            return convert<int8_t>(element, components, divisor(127), out);
        case kGltfU8:
            return convert<uint8_t>(element, components, divisor(255), out);
        case kGltfI16:
            return convert<int16_t>(element, components, divisor(32767), out);
        case kGltfU16:
            return convert<uint16_t>(element, components, divisor(65535), out);
        case kGltfU32:
            return convert<uint32_t>(element, components, divisor(4294967295.0f), out);
        case kGltfF32:
            if constexpr (std::is_same_v<Out, float>) return convert<float>(element, components, 0, out);
            [[fallthrough]];
        default:
            SKINBENCH_ASSERT(!"component type was checked");
    }
}

template <class Out>
void readAny(const GltfColumn& column, uint64_t element, bool normalized, Out* out) {
    SKINBENCH_ASSERT(element < column.count);
    const uint8_t* source = column.elements.first ? column.elements.first + element * column.elements.stride : nullptr;
    if (!column.sparse.empty()) {
        const auto place =
            std::ranges::lower_bound(column.sparse, element, {}, [](const auto& one) { return one.first; });
        if (place != column.sparse.end() && place->first == element)
            source = column.values.first + place->second * column.values.stride;
    }
    if (source)
        convertAny(source, column.component, column.components, normalized, out);
    else
        std::fill_n(out, column.components, Out{0});
}

Result<void> openSparse(GltfData& data, const GltfAccessor& accessor, GltfColumn& column) {
    const GltfSparse& sparse = *accessor.sparse;
    if (sparse.count == 0 || sparse.count > accessor.count)
        return inputError(std::format("sparse count {} is not between 1 and {}", sparse.count, accessor.count));
    const int type = sparse.indexComponent;
    if (type != kGltfU8 && type != kGltfU16 && type != kGltfU32)
        return inputError(std::format("sparse indices have component type {}", type));
    const auto indices = locate(data, sparse.indexView, sparse.indexOffset, sparse.count, componentBytes(type));
    SKINBENCH_TRY(indices);
    const uint64_t elementBytes = componentBytes(accessor.component) * accessor.components;
    const auto values = locate(data, sparse.valueView, sparse.valueOffset, sparse.count, elementBytes);
    SKINBENCH_TRY(values);
    if (auto ok = spend(data.budget, sparse.count, sizeof(column.sparse[0])); !ok) return ok;
    column.values = *values;
    column.sparse.reserve(sparse.count);
    for (uint64_t i = 0; i < sparse.count; ++i) {
        uint32_t index = 0;
        convertAny(indices->first + i * indices->stride, type, 1, false, &index);
        if (index >= accessor.count)
            return inputError(std::format("sparse index {} is not below {}", index, accessor.count));
        column.sparse.emplace_back(index, static_cast<uint32_t>(i));
    }
    // The specification asks for ascending indices; where one comes twice, the last value holds.
    std::ranges::sort(column.sparse, [](const auto& a, const auto& b) {
        return a.first != b.first ? a.first < b.first : a.second > b.second;
    });
    return {};
}

Result<GltfColumn> makeColumn(GltfData& data, const GltfAccessor& accessor) {
    GltfColumn column;
    column.count = accessor.count;
    column.component = accessor.component;
    column.components = accessor.components;
    column.normalized = accessor.normalized;
    const uint64_t bytes = componentBytes(accessor.component);
    SKINBENCH_ASSERT(bytes > 0);
    if (accessor.view >= 0) {
        const auto located = locate(data, accessor.view, accessor.offset, accessor.count, bytes * accessor.components);
        SKINBENCH_TRY(located);
        column.elements = *located;
        column.misaligned = accessor.offset % bytes != 0 || located->stride % bytes != 0;
    }
    if (accessor.sparse) SKINBENCH_TRY(openSparse(data, accessor, column));
    return column;
}

Result<void> decodeBytes(const CompressedView& view, std::vector<uint8_t>& out) {
    if (view.mode == "ATTRIBUTES") {
        if (view.stride == 0 || view.stride % 4 != 0 || view.stride > 256)
            return inputError(std::format("byteStride {} must be a multiple of 4 up to 256", view.stride));
        return decodeMeshoptAttributes(view.bytes, view.stride, out);
    }
    if (view.mode != "TRIANGLES" && view.mode != "INDICES")
        return inputError("has the unknown mode \"" + shortText(view.mode, 40) + "\"");
    if (view.stride != 2 && view.stride != 4)
        return inputError(std::format("byteStride {} of indices must be 2 or 4", view.stride));
    if (view.mode == "TRIANGLES" && view.count % 3 != 0)
        return inputError(counted(view.count, "index", "indices") + ", which is no multiple of 3");
    using Decode = int (*)(void*, size_t, size_t, const unsigned char*, size_t);
    const Decode decode =
        view.mode == "TRIANGLES" ? Decode{meshopt_decodeIndexBuffer} : Decode{meshopt_decodeIndexSequence};
    if (decode(out.data(), view.count, view.stride, view.bytes.data(), view.bytes.size()) != 0)
        return inputError("its compressed bytes are broken");
    return {};
}

Result<void> applyFilter(const CompressedView& view, std::vector<uint8_t>& bytes) {
    if (view.filter.empty() || view.filter == "NONE") return {};
    const uint64_t stride = view.stride;
    if (view.mode != "ATTRIBUTES") return inputError("filters apply to attributes only");
    if (view.filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
        decodeMeshoptOctahedral(bytes, stride);
    else if (view.filter == "QUATERNION" && stride == 8)
        decodeMeshoptQuaternion(bytes);
    else if (view.filter == "EXPONENTIAL")
        decodeMeshoptExponential(bytes);
    else if (view.filter == "COLOR" && (stride == 4 || stride == 8))
        decodeMeshoptColor(bytes, stride);
    else
        return inputError(
            std::format("cannot apply the filter \"{}\" to elements of {} bytes", shortText(view.filter, 40), stride));
    return {};
}

}  // namespace

Result<void> spend(GltfBudget& budget, uint64_t count, uint64_t bytes) {
    if (count > budget.left / bytes)
        return inputError(std::format("asks for more memory than a file of its size may: {} times its bytes and {} MiB",
                                      kGltfBudgetFactor, kGltfBudgetFloor >> 20));
    budget.left -= count * bytes;
    return {};
}

Result<const GltfColumn*> openColumn(GltfData& data, int accessor, int components) {
    if (accessor < 0 || static_cast<size_t>(accessor) >= data.accessors.size())
        return inputError(std::format("accessor {} does not exist", accessor));
    const GltfAccessor& source = data.accessors[accessor];
    if (!source.fault.empty()) return inputError(source.fault);
    const std::string where = std::format("accessor {}: ", accessor);
    if (source.components != components)
        return inputError(where + std::format("has {} an element, {} {} needed",
                                              counted(source.components, "component"), components,
                                              components == 1 ? "is" : "are"));
    std::unique_ptr<GltfColumn>& opened = data.columns[accessor];
    if (!opened) {
        auto made = makeColumn(data, source);
        if (!made) return inputError(where + made.error().text);
        opened = std::make_unique<GltfColumn>(std::move(*made));
    }
    return opened.get();
}

Result<const GltfColumn*> openIndexColumn(GltfData& data, int accessor, int components, int maxComponentBytes) {
    if (accessor >= 0 && static_cast<size_t>(accessor) < data.accessors.size()) {
        const int type = data.accessors[accessor].component;
        const bool isUnsigned = type == kGltfU8 || type == kGltfU16 || type == kGltfU32;
        if (!isUnsigned || componentBytes(type) > static_cast<uint64_t>(maxComponentBytes))
            return inputError(std::format("accessor {}: component type {} cannot hold indices", accessor, type));
    }
    return openColumn(data, accessor, components);
}

void readElement(const GltfColumn& column, uint64_t element, float* out, bool normalized) {
    readAny(column, element, column.normalized || normalized, out);
}

void readElement(const GltfColumn& column, uint64_t element, uint32_t* out) { readAny(column, element, false, out); }

void noteBounds(GltfData& data, int accessor, const GltfBounds& found, bool all, GltfNotes& notes) {
    const GltfAccessor& source = data.accessors[accessor];
    if (source.component != kGltfF32) return;
    bool good = source.bounds.min.size() == found.min.size() && source.bounds.max.size() == found.max.size();
    for (size_t c = 0; good && c < found.min.size(); ++c) {
        const float min = source.bounds.min[c], max = source.bounds.max[c];
        good = all ? min == found.min[c] && max == found.max[c] : min <= found.min[c] && max >= found.max[c];
    }
    if (!good && data.wrongBounds.insert(accessor).second) notes.add(GltfNote::wrongBounds);
}

Result<std::vector<float>> readFloats(GltfData& data, int accessor, int components, bool normalized, uint64_t count) {
    const auto column = openColumn(data, accessor, components);
    SKINBENCH_TRY(column);
    count = std::min(count, (*column)->count);
    SKINBENCH_TRY(spend(data.budget, count, components * sizeof(float)));
    std::vector<float> values(count * components);
    for (uint64_t i = 0; i < count; ++i) readElement(**column, i, &values[i * components], normalized);
    return values;
}

Result<std::vector<uint8_t>> decompressView(const CompressedView& view, GltfBudget& budget) {
    if (view.stride > 256)
        return inputError(std::format("byteStride {} must be a multiple of 4 up to 256", view.stride));
    SKINBENCH_TRY(spend(budget, view.count, std::max<uint64_t>(view.stride, 1)));
    std::vector<uint8_t> out(view.count * view.stride);
    SKINBENCH_TRY(decodeBytes(view, out));
    SKINBENCH_TRY(applyFilter(view, out));
    return out;
}

}  // namespace skinbench
