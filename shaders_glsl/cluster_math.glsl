// Whether a meshlet of a skinned mesh can be seen, from what bounds it in the bind pose (common/meshlets/cluster_bounds.h);
// docs/culling.md has the proofs. What is in doubt stays. Tests compile this text as C++ too, so swizzles are spelled out.
#include "joint_rows.glsl"
#include "rounding.glsl"

// Rows of the matrix that takes a place to clip space: of a copy, or of the bind pose before one joint moves it.
struct ClipRows {
    vec4 x;
    vec4 y;
    vec4 z;
    vec4 w;
};

ClipRows viewRows(mat4 m, vec3 offset) {
    ClipRows rows;
    rows.x = vec4(m[0][0], m[1][0], m[2][0], m[3][0]);
    rows.y = vec4(m[0][1], m[1][1], m[2][1], m[3][1]);
    rows.z = vec4(m[0][2], m[1][2], m[2][2], m[3][2]);
    rows.w = vec4(m[0][3], m[1][3], m[2][3], m[3][3]);
    rows.x.w += dot(vec3(rows.x), offset);
    rows.y.w += dot(vec3(rows.y), offset);
    rows.z.w += dot(vec3(rows.z), offset);
    rows.w.w += dot(vec3(rows.w), offset);
    return rows;
}

vec4 throughJoint(vec4 row, JointRows joint) {
    return row.x * joint.a + row.y * joint.b + row.z * joint.c + vec4(0.0, 0.0, 0.0, row.w);
}

ClipRows jointClipRows(ClipRows view, JointRows joint) {
    ClipRows rows;
    rows.x = throughJoint(view.x, joint);
    rows.y = throughJoint(view.y, joint);
    rows.z = throughJoint(view.z, joint);
    rows.w = throughJoint(view.w, joint);
    return rows;
}

// A sphere, or a box along the axes.
struct Solid {
    vec3 center;
    vec3 extent;
    float radius;
};

// The least value of the plane over the solid.
float leastOf(vec4 plane, Solid solid) {
    vec3 n = vec3(plane);
    return dot(n, solid.center) + plane.w - dot(abs(n), solid.extent) - solid.radius * length(n);
}

// How far rounding may move what leastOf() gives: skinning, the projection and this test compute in single precision, and
// weights sum to 1 but for WEIGHT_ERROR. `offset`: the copy's place.
float doubtOf(ClipRows view, JointRows joint, Solid solid, vec3 offset) {
    float norm = sqrt(dot(vec3(joint.a), vec3(joint.a)) + dot(vec3(joint.b), vec3(joint.b)) +
                      dot(vec3(joint.c), vec3(joint.c)));
    float reach = norm * (length(solid.center) + length(solid.extent) + solid.radius) +
                  length(vec3(joint.a.w, joint.b.w, joint.c.w)) + length(offset);
    float turn = length(vec3(view.w)) + max(max(length(vec3(view.x)), length(vec3(view.y))), length(vec3(view.z)));
    float shift = abs(view.w.w) + max(max(abs(view.x.w), abs(view.y.w)), abs(view.z.w));
    return (0.000004 + WEIGHT_ERROR) * (turn * (reach + length(offset)) + shift);
}

// A bit for each plane of the view volume that the whole solid lies beyond.
uint planesBeyond(ClipRows rows, Solid solid, float doubt) {
    uint beyond = 0u;
    if (leastOf(rows.x - rows.w, solid) > doubt) beyond |= 1u;
    if (leastOf(-rows.x - rows.w, solid) > doubt) beyond |= 2u;
    if (leastOf(rows.y - rows.w, solid) > doubt) beyond |= 4u;
    if (leastOf(-rows.y - rows.w, solid) > doubt) beyond |= 8u;
    if (leastOf(rows.z - rows.w, solid) > doubt) beyond |= 16u;
    if (leastOf(-rows.z, solid) > doubt) beyond |= 32u;
    return beyond;
}

// Of the bind pose, as ClusterCone; `axis` is as long as the cosine.
struct Cone {
    vec3 axis;
    float altitude;
    vec3 center;
    float radius;
};

// Every face turns away, and none so little that the rasteriser's rounding could turn it back. `rows` of the joint that
// moves them all.
bool allFaceAway(ClipRows rows, Cone cone) {
    vec3 x = vec3(rows.x), y = vec3(rows.y), w = vec3(rows.w);
    float det = dot(x, cross(y, w));
    float size = length(x) * length(y) * length(w);
    if (!(cone.altitude > 0.0) || !(abs(det) > 0.001 * size)) return false;
    vec3 eye = -(rows.x.w * cross(y, w) + rows.y.w * cross(w, x) + rows.w.w * cross(x, y)) / det;

    // The least n . (p - eye) of a normal n and a vertex p; a mirror turns the faces around.
    vec3 u = det > 0.0 ? cone.center - eye : eye - cone.center;
    float cosine = length(cone.axis);
    float along = dot(u, cone.axis) / cosine;
    float across = sqrt(max(dot(u, u) - along * along, 0.0));
    float rounding = 0.00001 * (size / abs(det)) * (length(eye) + length(cone.center) + cone.radius);
    float least = along * cosine - across * sqrt(max(1.0 - cosine * cosine, 0.0)) - cone.radius - rounding;
    float middle = dot(w, cone.center) + rows.w.w, spread = cone.radius * length(w);
    float nearest = middle - spread, farthest = middle + spread;
    if (!(least > 0.0) || !(nearest > 0.0)) return false;

    // In pixels: what a unit along an edge is at most, in x and y together, and the doubled area of a triangle whose edge
    // times altitude is 1, at least.
    float mostX = (abs(dot(x, cone.center) + rows.x.w) + cone.radius * length(x)) / nearest;
    float mostY = (abs(dot(y, cone.center) + rows.y.w) + cone.radius * length(y)) / nearest;
    if (!(max(mostX, mostY) < 8.0)) return false;
    float edge = (float(IMAGE_WIDTH) * (length(x) + mostX * length(w)) +
                  float(IMAGE_HEIGHT) * (length(y) + mostY * length(w))) * 0.5 / nearest;
    float area = abs(det) * least * (0.25 * float(IMAGE_WIDTH) * float(IMAGE_HEIGHT)) / (farthest * farthest * farthest);
    float moved = 2.0 * MOST_ROUNDING;
    return cone.altitude * area > moved * 2.0 * (edge + moved / cone.altitude);
}
