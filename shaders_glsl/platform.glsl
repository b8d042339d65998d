// The only place that knows which API compiles the text.
#ifdef VULKAN
layout(push_constant) uniform DrawBlock { uvec4 drawConstants; };
#define VERTEX_INDEX uint(gl_VertexIndex)
#else
layout(location = 0) uniform uvec4 drawConstants;
#define VERTEX_INDEX uint(gl_VertexID)
#endif
