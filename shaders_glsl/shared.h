// Read by C++ and by GLSL: binding slots, numbers and structs that cross between them. Slots are unique over all kinds
// of buffers, because OpenGL and Vulkan number them differently but agree as long as no number is used twice.
#ifndef SKINBENCH_SHARED_H
#define SKINBENCH_SHARED_H

// Uniform block.
#define SLOT_FRAME 0  // FrameConstants

// Storage blocks. No stage that is timed has more than eight, the number that OpenGL 4.5 guarantees a stage that has any:
// those that draw meshlets have no tangents.
#define SLOT_PALETTE 1  // rows of the joints (common/scene/palette_rows.h), joint after joint, copy after copy
#define SLOT_VERTEX 2   // encoded vertices of one codec, copy after copy
#define SLOT_MESHLET 3  // meshlet descriptors
#define SLOT_MESHLET_DATA 4   // vertex ids and packed local indices
#define SLOT_MESHLET_EXTRA 5  // what a codec or builder adds per meshlet
#define SLOT_TUPLE 6          // joint tuples
#define SLOT_SKINNED 7        // SkinnedVertex, written by one pass and read by the next
#define SLOT_CAPTURE 8        // SkinnedVertex, written by verifying plans only
#define SLOT_TANGENT 9        // a unit tangent for each vertex (vec4, w: 1 or -1, the side of the bitangent), or a word
                              // by packTangent (octahedral.glsl or byte_vectors.glsl)
#define SLOT_SKINNED_TANGENT 11  // such words, written by one pass and read by the next

#define SLOT_VISIBLE 12  // indices of the triangles that are left, copy after copy, which feed the draw
#define SLOT_COMMAND 13  // DrawCommand, copy after copy, or one for all of a batched draw; view after view

// A block in cull_triangles.glsl alone.
#define SLOT_INDEX 10  // 32-bit index buffer

// Culling of meshlets (common/meshlets/cluster_bounds.h).
#define SLOT_CLUSTER 14       // what a meshlet is tested by
#define SLOT_CLUSTER_PART 15  // bounds of what each of its joints moves
#define SLOT_CLUSTER_LIST 16  // numbers of the meshlets that are drawn, copy after copy
#define SLOT_INSTANCE 17      // center and extent (vec4 each) of a box around each posed copy
#define SLOT_VERDICT 18       // of verifying plans and the view `culled`: VERDICT_ of every meshlet, copy after copy;
                              // how many triangles compute-cull leaves out by each test; and where mesh stages cull,
                              // a word for every four triangles of a meshlet, a bit for each that is drawn

#define SLOT_COUNT 19

// Invocations of a work group.
#define COMPUTE_GROUP 64  // compute.glsl, a vertex each
#define COPY_GROUP 256    // copy.glsl, 16 bytes each
#define CULL_GROUP 128    // cull_triangles.glsl, a triangle each
#define LIST_GROUP 128    // list_clusters.glsl, a meshlet each, and bound_instances.glsl, a joint each
#define TASK_GROUP 32     // task.glsl, a meshlet each

// Values of the defines VIEW, CULL, JOINTS, METHOD, ZERO_WEIGHTS, CLUSTER_CULL and CLUSTER_BOUNDS, and of the enums View,
// Cull, JointSource, Method, ZeroWeights, ClusterCull and ClusterBounds.
#define VIEW_SHADED 0
#define VIEW_MESHLETS 1
#define VIEW_WEIGHTS 2
#define VIEW_TUPLES 3
#define VIEW_VELOCITY 4
#define VIEW_RESOLUTION 5
#define VIEW_NORMALS 6
#define VIEW_JOINTS 7
#define VIEW_CULLED 8
#define CULL_OFF 0
#define CULL_COMPACT 1
#define CULL_PRIMITIVE 2
#define CULL_TORABI 3
#define JOINTS_VERTEX 0
#define JOINTS_MESHLET 1
#define JOINTS_STAGED 2
#define METHOD_LBS 0
#define METHOD_DQS 1
#define TEST_FRUSTUM 1
#define TEST_BACK 2
#define TEST_SMALL 4
#define CLUSTER_OFF 0
#define CLUSTER_TASK 1
#define CLUSTER_LIST 2
#define CLUSTER_TEST_FRUSTUM 1
#define CLUSTER_TEST_CONE 2
#define BOUNDS_JOINT_SPHERES 0
#define BOUNDS_ONE_SPHERE 1
#define BOUNDS_JOINT_BOXES 2
#define BOUNDS_INSTANCE 3

// What tests say of meshlets and, from the fourth on, of triangles: the first test that leaves them out.
#define VERDICT_DRAWN 0
#define VERDICT_BEYOND 1  // outside the view volume
#define VERDICT_AWAY 2    // all faces turn away
#define VERDICT_TRIANGLE_BEYOND 3
#define VERDICT_TRIANGLE_AWAY 4
#define VERDICT_TRIANGLE_SMALL 5  // covers no centre of a pixel
#define VERDICT_COUNT 6
#define COUNTED_WORDS 3  // of the last three in SLOT_VERDICT

// Red, green and blue of each in the view `culled`: the colours of Okabe and Ito ("Color Universal Design", 2008),
// which people with any colour vision can keep apart.
#define COLOR_DRAWN 0.00, 0.62, 0.45
#define COLOR_BEYOND 0.00, 0.45, 0.70
#define COLOR_AWAY 0.84, 0.37, 0.00
#define COLOR_TRIANGLE_BEYOND 0.34, 0.71, 0.91
#define COLOR_TRIANGLE_AWAY 0.94, 0.89, 0.26
#define COLOR_TRIANGLE_SMALL 0.80, 0.47, 0.65

#define ZERO_WEIGHTS_LOAD 0
#define ZERO_WEIGHTS_SKIP 1
#define ZERO_WEIGHTS_COUNT 2

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
namespace skinbench {
using glm::mat4;
using glm::vec4;
#endif

#define MOST_VIEWS 8  // of one frame

// std140. Changes every frame.
struct FrameConstants {
    mat4 viewProjection;  // y already points down, depth 0..1: both APIs store row 0 at the top
    vec4 grid;            // x: columns, y: distance between columns, z: distance between rows, w: number of the frame
    mat4 otherViews[MOST_VIEWS - 1];  // like viewProjection, of the views that draw depth alone
    mat4 overview;                    // what the view `culled` is drawn from: every copy, from aside
};

#ifdef __cplusplus
static_assert(sizeof(FrameConstants) == 592);
}  // namespace skinbench
#endif

#endif
