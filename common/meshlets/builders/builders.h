// The builders behind the rows of builders(); one function a file.
#pragma once

#include "common/meshlets/meshlets.h"

namespace skinbench {

// Takes triangles in index order and closes a meshlet when the next one no longer fits (Kimmersdorfer 3.2,
// AVK-Default; Torabi listing A.1, with vertices reused inside a meshlet). Depends strongly on the index order.
MeshletMesh buildScan(const Mesh& mesh, const MeshletLimits& limits);

// meshopt_buildMeshlets with cone weight 0, vertices of each meshlet in order of their first use.
MeshletMesh buildMeshopt(const Mesh& mesh, const MeshletLimits& limits);

}  // namespace skinbench
