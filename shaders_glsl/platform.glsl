// The only place that knows which API compiles the text.
#ifdef VULKAN
layout(push_constant) uniform DrawBlock { uvec4 drawConstants; };
#define VERTEX_INDEX uint(gl_VertexIndex)
// Arrays that a loop indexes stay in registers only where the loop is unrolled, and not every driver does that unasked.
#define UNROLL [[unroll]]
#else
layout(location = 0) uniform uvec4 drawConstants;
#define VERTEX_INDEX uint(gl_VertexID)
#define UNROLL
#endif
