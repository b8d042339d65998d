// Permutation Coding, the decoding side of common/codecs/permutation.h (Peters, Kuth, Meyer, I3D 2022): a code is the
// number (quotient, entry, …, entry) in radix PC_VALUES. Entries differ; their order carries the rest of the payload,
// which is the tuple index and the PC_EXTRA choices of every entry.
#define PC_ENTRIES (INFLUENCES - 1)
#if INFLUENCES == 8
#define PC_ORDERS 5040u  // PC_ENTRIES!
#else
#define PC_ORDERS 6u
#endif

// A choice count for every entry, lightest first.
const uint pcExtra[PC_ENTRIES] = PC_EXTRA;

struct PermutationBlend {
    uint tuple;
    float weights[INFLUENCES];  // heaviest first
};

struct Division {
    uvec2 quotient;  // low, high
    uint remainder;
};

// By PC_VALUES, a constant below 2^16: no step needs more than 32 bits.
Division divideCode(uvec2 code) {
    uint values = uint(PC_VALUES);
#if PC_BITS > 32
    uint high = code.y / values;
    uint rest = code.y % values << 16u | code.x >> 16u;
    uint middle = rest / values;
    rest = rest % values << 16u | (code.x & 0xFFFFu);
    return Division(uvec2(middle << 16u | rest / values, high), rest % values);
#else
    return Division(uvec2(code.x / values, 0u), code.x % values);
#endif
}

PermutationBlend decodePermutation(uvec2 code) {
    uint entries[PC_ENTRIES];  // [19:4] entry  [3:0] its place
    for (int place = PC_ENTRIES - 1; place >= 0; --place) {
        Division division = divideCode(code);
        entries[place] = division.remainder << 4u | uint(place);
        code = division.quotient;
    }
    // Loops of constant length, which compilers unroll; the tests fold away.
    for (int end = PC_ENTRIES - 1; end > 0; --end)
        for (int i = 0; i < PC_ENTRIES - 1; ++i)
            if (i < end) {
                uint less = min(entries[i], entries[i + 1]);
                entries[i + 1] = max(entries[i], entries[i + 1]);
                entries[i] = less;
            }

    uint rank = 0u;  // lexicographic, of the places in the order of their entries
    for (int i = 0; i < PC_ENTRIES; ++i) {
        rank *= uint(PC_ENTRIES - i);
        for (int j = 0; j < PC_ENTRIES; ++j)
            if (j > i && (entries[j] & 15u) < (entries[i] & 15u)) ++rank;
    }
    uint payload = code.x * PC_ORDERS + rank;
    uint choices[PC_ENTRIES];
    for (int i = PC_ENTRIES - 1; i >= 0; --i) {
        choices[i] = payload % pcExtra[i];
        payload /= pcExtra[i];
    }

    PermutationBlend blend;
    blend.tuple = payload;
    float before = 0.0;
    for (int i = 0; i < PC_ENTRIES; ++i) {
        uint level = (entries[i] >> 4u) * pcExtra[i] + choices[i] - (uint(i + 1) * pcExtra[i] - 1u);
        float c = float(level) / float((uint(PC_VALUES) - uint(PC_ENTRIES)) * pcExtra[i]);
        float count = float(INFLUENCES - i);
        blend.weights[PC_ENTRIES - i] = c / count - before;
        before += c / (count * (count - 1.0));
    }
    blend.weights[0] = 1.0 - before;
    return blend;
}

Vertex withBlend(Vertex vertex, PermutationBlend blend) {
    vertex.weights0 = vec4(blend.weights[0], blend.weights[1], blend.weights[2], blend.weights[3]);
#if INFLUENCES == 8
    vertex.weights1 = vec4(blend.weights[4], blend.weights[5], blend.weights[6], blend.weights[7]);
#endif
    return vertex;
}
