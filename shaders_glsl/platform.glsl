// The only place that knows which API compiles the text.
#ifdef VULKAN
layout(push_constant) uniform DrawBlock { uvec4 drawConstants; };
#define VERTEX_INDEX uint(gl_VertexIndex)
// Arrays that a loop indexes stay in registers only where the loop is unrolled, and not every driver does that unasked.
#define UNROLL [[unroll]]
#define LOADS_AHEAD false
#else
layout(location = 0) uniform uvec4 drawConstants;
#define VERTEX_INDEX uint(gl_VertexID)
#define UNROLL
// NVIDIA's Vulkan compiler moves a load of a loop's next round in front of this round's work, its OpenGL compiler leaves
// it where it is written.
#define LOADS_AHEAD true
#endif
