#include "common/scene/gltf/gltf_extensions.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <format>

#include "common/core/text.h"
#include "common/core/utf8.h"

namespace skinbench {
namespace {

using enum ExtensionRole;

constexpr auto kExtensions = std::to_array<GltfExtension>({
    {"EXT_meshopt_compression", supported, "buffers are decompressed; fallback buffers are not loaded"},
    {"KHR_mesh_quantization", supported, "positions, normals, texture coordinates of 8 and 16 bits"},
    {"KHR_meshopt_compression", supported, "as EXT_meshopt_compression, with version 1 of the attribute codec"},
    {"KHR_node_visibility", supported, "hidden nodes and what hangs on them are left out, with a warning"},

    {"ADOBE_materials_*", harmless, "materials are not read"},
    {"AGI_stk_metadata", harmless, "metadata"},
    {"CESIUM_primitive_outline", harmless, "outlines are not drawn"},
    {"CESIUM_tile_edges", harmless, "outlines are not drawn"},
    {"EXT_instance_features", harmless, "metadata"},
    {"EXT_lights_*", harmless, "lights are not read"},
    {"EXT_materials_*", harmless, "materials are not read"},
    {"EXT_mesh_features", harmless, "metadata"},
    {"EXT_manifold", harmless, "the primitives draw the same triangles"},
    {"EXT_mesh_lod", harmless, "the finest level is drawn"},
    {"EXT_mesh_manifold", harmless, "the primitives draw the same triangles"},
    {"EXT_mesh_opacity_micromap", harmless, "materials are not read"},
    {"EXT_mesh_polygon", harmless, "its polygons are drawn as their triangles"},
    {"EXT_mesh_primitive_edge_visibility", harmless, "edges are not drawn"},
    {"EXT_node_lod", harmless, "the finest level is drawn"},
    {"EXT_structural_metadata", harmless, "metadata"},
    {"EXT_texture_*", harmless, "images are not read"},
    {"FB_geometry_metadata", harmless, "metadata"},
    {"FB_material*", harmless, "materials are not read"},
    {"FB_ngon_encoding", harmless, "its polygons are drawn as their triangles"},
    {"GEO_LOD", harmless, "the finest level is drawn"},
    {"GODOT_single_root", harmless, "a promise about the scene's root"},
    {"GRIFFEL_bim_data", harmless, "metadata"},
    {"KHR_audio_*", harmless, "sound is not played"},
    {"KHR_lights_*", harmless, "lights are not read"},
    {"KHR_materials_*", harmless, "neither materials nor their variants are read"},
    {"KHR_node_hoverability", harmless, "nothing is pointed at"},
    {"KHR_node_selectability", harmless, "nothing is selected"},
    {"KHR_techniques_webgl", harmless, "materials are not read"},
    {"KHR_texture_*", harmless, "images are not read"},
    {"KHR_xmp", harmless, "metadata"},
    {"KHR_xmp_json_ld", harmless, "metadata"},
    {"MSFT_lod", harmless, "the finest level is drawn"},
    {"MSFT_packing_*", harmless, "materials are not read"},
    {"MSFT_texture_*", harmless, "images are not read"},
    {"NV_materials_mdl", harmless, "materials are not read"},
    {"VRMC_materials_*", harmless, "materials are not read"},

    {"ADOBE_render_order", ignored, "parts are drawn in the file's order"},
    {"AGI_articulations", ignored, "its nodes stay where they are"},
    {"BENTLEY_primitive_restart", ignored, "strips and fans are read as one"},
    {"EXT_mesh_gpu_instancing", ignored, "each of its nodes is drawn once"},
    {"EXT_mesh_primitive_restart", ignored, "strips and fans are read as one"},
    {"KHR_animation_pointer", ignored, "its channels move nothing"},
    {"KHR_billboard", ignored, "its nodes do not turn to the viewer"},
    {"KHR_character*", ignored, "expressions and mappings do not move anything"},
    {"KHR_gaussian_splatting*", ignored, "splats are points, which are not drawn"},
    {"KHR_interactivity", ignored, "its graphs do not run"},
    {"KHR_mesh_primitive_restart", ignored, "strips and fans are read as one"},
    {"KHR_physics_rigid_bodies", ignored, "nothing falls or collides"},
    {"MAXAR_mesh_variants", ignored, "the mesh that the node names is drawn"},
    {"MPEG_*", ignored, "timed media are not played"},
    {"VRM", ignored, "springs, constraints and expressions do not move anything"},
    {"VRMC_node_constraint", ignored, "its nodes are not constrained"},
    {"VRMC_springBone", ignored, "its joints do not swing"},
    {"VRMC_vrm", ignored, "expressions and gaze do not move anything"},
    {"VRMC_vrm_animation", ignored, "its clip moves only the nodes that it names"},

    {"DRACO_animation_compression", refused, "keys that cannot be decoded"},
    {"EXT_implicit_*", refused, "shapes without triangles"},
    {"EXT_primitive_voxels", refused, "shapes without triangles"},
    {"KHR_accessor_float16", refused, "numbers of a type that glTF 2.0 lacks"},
    {"KHR_accessor_float64", refused, "numbers of a type that glTF 2.0 lacks"},
    {"KHR_draco_mesh_compression", refused, "unless the file also holds uncompressed data"},
    {"KHR_implicit_shapes", refused, "shapes without triangles"},
});

bool fits(const GltfExtension& row, std::string_view name) {
    const std::string_view pattern = row.name;
    return pattern.ends_with('*') ? name.starts_with(pattern.substr(0, pattern.size() - 1)) : name == pattern;
}

}  // namespace

std::span<const GltfExtension> gltfExtensions() { return kExtensions; }

const GltfExtension* findGltfExtension(std::string_view name) {
    const auto row = std::ranges::find_if(kExtensions, [&](const GltfExtension& one) { return fits(one, name); });
    return row == kExtensions.end() ? nullptr : &*row;
}

std::vector<std::string> describe(const FoundExtensions& found) {
    constexpr size_t kNamed = 3;
    std::vector<std::string> texts;
    std::string unknown;
    size_t unknownCount = 0;
    for (const auto& [name, count] : found.counts) {
        const GltfExtension* row = findGltfExtension(name);
        if (row && row->role == ignored)
            texts.push_back(
                std::format("{} is ignored in {}: {}", shortText(name, 80), counted(count, "place"), row->effect));
        if (!row && ++unknownCount <= kNamed) unknown += (unknown.empty() ? "" : ", ") + shortText(name, 80);
    }
    if (unknownCount > kNamed) unknown += std::format(" and {} more", unknownCount - kNamed);
    if (unknownCount > 0) texts.push_back("extensions that are not known are ignored: " + unknown);
    return texts;
}

Result<void> checkRequired(std::string_view name) {
    const GltfExtension* row = findGltfExtension(name);
    if (row && (row->role == supported || row->role == harmless)) return {};
    return inputError("needs the extension " + shortText(name, 80) +
                      ", which is not supported; export the file without it");
}

}  // namespace skinbench
