// The animations of a glTF asset.
#pragma once

#include <tiny_gltf.h>

#include "common/scene/gltf/gltf_data.h"
#include "common/scene/gltf/gltf_nodes.h"
#include "common/scene/gltf/gltf_notes.h"
#include "common/scene/gltf/gltf_tree.h"

namespace skinbench {

// A broken clip is left out with a warning; where none is left, it is an error. Matrices of animated nodes are split.
Result<void> addClips(const tinygltf::Model& model, const GltfFaults& faults, GltfData& data, const NodeOrder& order,
                      Scene& scene, GltfNotes& notes);

}  // namespace skinbench
