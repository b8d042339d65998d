// Read by C++ and by GLSL: binding slots and the structs that cross between them. Slots are unique over all kinds of
// buffers, because OpenGL and Vulkan number them differently but agree as long as no number is used twice.
#ifndef SKINBENCH_SHARED_H
#define SKINBENCH_SHARED_H

// Uniform block.
#define SLOT_FRAME 0  // FrameConstants

// Storage blocks: eight, the number that OpenGL 4.5 guarantees a stage that has any.
#define SLOT_PALETTE 1  // 3 rows (vec4) a joint, joint after joint, copy after copy
#define SLOT_VERTEX 2   // encoded vertices of one codec, copy after copy
#define SLOT_MESHLET 3  // meshlet descriptors
#define SLOT_TANGENT \
    3                         // the same number for the variant compute, which has no meshlets: a unit tangent a vertex
                              // (vec4, w: 1 or -1, the side of the bitangent)
#define SLOT_MESHLET_DATA 4   // vertex ids and packed local indices
#define SLOT_MESHLET_EXTRA 5  // what a codec or builder adds per meshlet
#define SLOT_TUPLE 6          // joint tuples
#define SLOT_SKINNED 7        // SkinnedVertex, written by one pass and read by the next
#define SLOT_CAPTURE 8        // SkinnedVertex, written by verifying plans only

// Not a block of any stage.
#define SLOT_INDEX 9  // 32-bit index buffer

#define SLOT_COUNT 10

// Values of the defines CULL and JOINTS: what the enums Cull and JointSource of common/plans/variant.h count.
#define CULL_OFF 0
#define CULL_COMPACT 1
#define CULL_PRIMITIVE 2
#define CULL_TORABI 3
#define JOINTS_VERTEX 0
#define JOINTS_MESHLET 1
#define JOINTS_STAGED 2

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
namespace skinbench {
using glm::mat4;
using glm::vec4;
#endif

// std140. Changes every frame.
struct FrameConstants {
    mat4 viewProjection;  // y already points down, depth 0..1: both APIs store row 0 at the top
    vec4 grid;            // x: columns, y: distance between columns, z: distance between rows, w: number of the frame
};

#ifdef __cplusplus
static_assert(sizeof(FrameConstants) == 80);
}  // namespace skinbench
#endif

#endif
