// Linear blend skinning: three rows a joint, of the matrix.
struct Blend {
    vec4 row0;
    vec4 row1;
    vec4 row2;
};

Blend startBlend(Vertex vertex, uint copyNumber) { return Blend(vec4(0.0), vec4(0.0), vec4(0.0)); }

void addJoint(inout Blend blend, uint firstRow, float weight) {
    JointRows joint = SKIN_JOINT(firstRow);
    blend.row0 += weight * joint.a;
    blend.row1 += weight * joint.b;
    blend.row2 += weight * joint.c;
}

vec3 turned(Blend blend, vec3 n) {
    return normalize(vec3(dot(blend.row0.xyz, n), dot(blend.row1.xyz, n), dot(blend.row2.xyz, n)));
}

Skinned transformVertex(Blend blend, Vertex vertex) {
    vec4 p = vec4(vertex.position, 1.0);
    Skinned skinned;
    skinned.position = vec3(dot(blend.row0, p), dot(blend.row1, p), dot(blend.row2, p));
    skinned.normal = turned(blend, vertex.normal);
    return skinned;
}
