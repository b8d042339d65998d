// Vertices without padding: 14 bytes of quantised attributes, then blend data (common/codecs/packed.h draws the bytes).
// They are read as aligned words and shifted so that byte 0 of the vertex comes to bit 0 of word 0:
//
//   word   [31:16]            [15:0]
//   0      position y         position x
//   1      octahedral u       position z
//   2      uv u               octahedral v
//   3      blend data         uv v
//   4 …    blend data
layout(std430, binding = SLOT_VERTEX) readonly restrict buffer VertexBlock { uint vertexWords[]; };

#define PACKED_WORDS ((VERTEX_BYTES + 3) / 4)
// Aligned words that a vertex touches where it lies worst.
#define TOUCHED_WORDS ((VERTEX_BYTES + 4 - VERTEX_ALIGNMENT + 3) / 4)

struct PackedVertex {
    uint words[PACKED_WORDS];  // bits behind the vertex are those of the next one
};

// `bytes` bytes (14 to VERTEX_BYTES) from byte `first` of a copy on. No word behind the last byte is read.
PackedVertex loadPacked(uint copyNumber, uint first, uint bytes) {
    uint word = copyNumber * uint(BUFFER_WORDS) + first / 4u;
    uint last = (first % 4u + bytes - 1u) / 4u;
    uint shift = first % 4u * 8u;
    PackedVertex stored;
    uint low = vertexWords[word];
    for (uint i = 0u; i < uint(PACKED_WORDS); ++i) {
        uint high = 0u;
        if (i + 1u < uint(TOUCHED_WORDS)) high = vertexWords[word + (i < 3u ? i + 1u : min(i + 1u, last))];
        stored.words[i] = low >> shift | high << 1u << (31u - shift);
        low = high;
    }
    return stored;
}

// Vertices of equal size.
PackedVertex loadPackedPlace(uint place, uint copyNumber) {
    return loadPacked(copyNumber, (place - copyNumber * uint(VERTEX_COUNT)) * uint(VERTEX_BYTES), uint(VERTEX_BYTES));
}

uint lowHalf(uint word) { return word & 0xFFFFu; }
uint highHalf(uint word) { return word >> 16u; }

float signNotZero(float x) { return x < 0.0 ? -1.0 : 1.0; }

vec3 octahedralNormal(uint u, uint v) {
    float x = float(u) / 65535.0 * 2.0 - 1.0;
    float y = float(v) / 65535.0 * 2.0 - 1.0;
    float z = 1.0 - abs(x) - abs(y);
    float t = max(-z, 0.0);
    return normalize(vec3(x - signNotZero(x) * t, y - signNotZero(y) * t, z));
}

// Position, normal and uv; the caller adds joints and weights.
Vertex baseVertex(PackedVertex stored) {
    uint a = stored.words[0];
    uint b = stored.words[1];
    uint c = stored.words[2];
    Vertex vertex;
    vertex.position = vec3(lowHalf(a), highHalf(a), lowHalf(b)) / 65535.0 * POSITION_EXTENT + POSITION_MIN;
    vertex.normal = octahedralNormal(highHalf(b), lowHalf(c));
    vertex.uv = vec2(highHalf(c), lowHalf(stored.words[3])) / 65535.0 * UV_EXTENT + UV_MIN;
    return vertex;
}
