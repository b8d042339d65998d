// The table of joint tuples: INFLUENCES u16 a tuple, heaviest influence first, copy after copy. Unused places hold
// joint 0, whose weight is 0.
#if INFLUENCES == 8
layout(std430, binding = SLOT_TUPLE) readonly restrict buffer TupleBlock { uvec4 tuples[]; };
#else
layout(std430, binding = SLOT_TUPLE) readonly restrict buffer TupleBlock { uvec2 tuples[]; };
#endif

uvec4 fourJoints(uint a, uint b) { return uvec4(lowHalf(a), highHalf(a), lowHalf(b), highHalf(b)); }

Vertex withTuple(Vertex vertex, uint tuple, uint copyNumber) {
#if INFLUENCES == 8
    uvec4 words = tuples[copyNumber * uint(TUPLE_COUNT) + tuple];
    vertex.joints1 = fourJoints(words.z, words.w);
#else
    uvec2 words = tuples[copyNumber * uint(TUPLE_COUNT) + tuple];
#endif
    vertex.joints0 = fourJoints(words.x, words.y);
    return vertex;
}
