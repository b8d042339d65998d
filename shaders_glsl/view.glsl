// The colour of a vertex in the debug views of `render`; white, and never read, in the shaded one. The view of the
// resolution carries the place in the grid of positions instead (surface.glsl).
#include "surface.glsl"
#include "vertex_data.glsl"

#if VIEW == VIEW_WEIGHTS
vec3 blendColors(uvec4 joints, vec4 weights) {
    return weights.x * labelColor(joints.x) + weights.y * labelColor(joints.y) + weights.z * labelColor(joints.z) +
           weights.w * labelColor(joints.w);
}
#endif

// `remainder`: a meshlet that shares no joint list, beside those that do.
vec3 viewColor(Vertex vertex, uint meshlet, bool remainder) {
#if VIEW == VIEW_MESHLETS
    return remainder ? vec3(0.85, 0.08, 0.06) : labelColor(meshlet);
#elif VIEW == VIEW_WEIGHTS
    vec3 color = blendColors(vertex.joints0, vertex.weights0);
#if INFLUENCES == 8
    color += blendColors(vertex.joints1, vertex.weights1);
#endif
    return color;
#elif VIEW == VIEW_TUPLES
    uvec4 used = mix(uvec4(0xFFFFu), vertex.joints0, greaterThan(vertex.weights0, vec4(0.0)));
    uint label = used.x;
    label = label * 31u + used.y;
    label = label * 31u + used.z;
    label = label * 31u + used.w;
#if INFLUENCES == 8
    used = mix(uvec4(0xFFFFu), vertex.joints1, greaterThan(vertex.weights1, vec4(0.0)));
    label = (((label * 31u + used.x) * 31u + used.y) * 31u + used.z) * 31u + used.w;
#endif
    return labelColor(label);
#elif VIEW == VIEW_JOINTS
    uint joint = vertex.joints0.x;
    float most = vertex.weights0.x;
    for (int k = 1; k < 4; ++k)
        if (vertex.weights0[k] > most) {
            joint = vertex.joints0[k];
            most = vertex.weights0[k];
        }
#if INFLUENCES == 8
    for (int k = 0; k < 4; ++k)
        if (vertex.weights1[k] > most) {
            joint = vertex.joints1[k];
            most = vertex.weights1[k];
        }
#endif
    return labelColor(joint);
#elif VIEW == VIEW_RESOLUTION && defined(POSITION_EXTENT)
    // An axis without extent has one step only.
    return (vertex.position - POSITION_MIN) / max(POSITION_EXTENT, vec3(1e-30));
#else
    return vec3(1.0);
#endif
}
