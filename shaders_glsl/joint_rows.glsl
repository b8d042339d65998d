// A joint's matrix by its rows.
struct JointRows {
    vec4 a;
    vec4 b;
    vec4 c;
};
