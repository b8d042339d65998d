// The places that chosen invocations of a work group have among each other, in their order. PLACES_GROUP is how many
// invocations it has. All of them call each function, and again behind a barrier only.
shared uint chosenBits[PLACES_GROUP / 32];

void startChoice() {
    if (gl_LocalInvocationID.x < uint(PLACES_GROUP / 32)) chosenBits[gl_LocalInvocationID.x] = 0u;
    memoryBarrierShared();
    barrier();
}

// How many of those before this one are chosen, and how many in all.
uint placeOfChosen(bool chosen, out uint total) {
    uint lane = gl_LocalInvocationID.x;
    if (chosen) atomicOr(chosenBits[lane / 32u], 1u << (lane % 32u));
    memoryBarrierShared();
    barrier();
    uint before = uint(bitCount(chosenBits[lane / 32u] & ((1u << (lane % 32u)) - 1u)));
    total = 0u;
    for (uint word = 0u; word < uint(PLACES_GROUP / 32); ++word) {
        uint count = uint(bitCount(chosenBits[word]));
        if (word < lane / 32u) before += count;
        total += count;
    }
    return before;
}
