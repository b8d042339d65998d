// The vertex fed by fixed-function attributes: the uc codec's fields, one attribute each.
#include "vertex_data.glsl"

layout(location = 0) in vec3 attributePosition;
layout(location = 1) in vec3 attributeNormal;
layout(location = 2) in vec2 attributeUv;
layout(location = 3) in uvec4 attributeJoints0;
layout(location = 4) in vec4 attributeWeights0;
#if INFLUENCES == 8
layout(location = 5) in uvec4 attributeJoints1;
layout(location = 6) in vec4 attributeWeights1;
#endif

Vertex loadAttributes() {
    Vertex vertex;
    vertex.position = attributePosition;
    vertex.normal = attributeNormal;
    vertex.uv = attributeUv;
    vertex.joints0 = attributeJoints0;
    vertex.weights0 = attributeWeights0;
#if INFLUENCES == 8
    vertex.joints1 = attributeJoints1;
    vertex.weights1 = attributeWeights1;
#endif
    return vertex;
}
