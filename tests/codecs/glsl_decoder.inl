// One decoder in the namespace DECODER, from DECODER_FILE with INFLUENCES, VERTEX_BYTES, VERTEX_ALIGNMENT and PC_BITS;
// CODEC is its row. Includes itself away: all of these are undefined behind it.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
namespace skinbench::glsl::DECODER {
#include DECODER_FILE

static Decoded load(uint place, uint copyNumber, uint meshletNumber, uint blendBytes) {
#ifdef CODEC_PER_MESHLET
    const Vertex v = loadMeshletVertex(firstByteOf(place - copyNumber * uint(VERTEX_COUNT), blendBytes), copyNumber,
                                       blendBytes, loadMeshletBlend(meshletNumber, copyNumber));
#else
    const Vertex v = loadVertex(place, copyNumber);
#endif
    Decoded result{v.position, v.normal, v.uv, {}, {}};
    for (int i = 0; i < 4; ++i) {
        result.joints[i] = v.joints0[i];
        result.weights[i] = v.weights0[i];
#if INFLUENCES == 8
        result.joints[4 + i] = v.joints1[i];
        result.weights[4 + i] = v.weights1[i];
#endif
    }
    return result;
}

static const Decoder decoder{CODEC, INFLUENCES, VERTEX_BYTES, VERTEX_ALIGNMENT, PC_BITS, load};
}  // namespace skinbench::glsl::DECODER
#pragma GCC diagnostic pop

#undef DECODER
#undef DECODER_FILE
#undef CODEC
#undef INFLUENCES
#undef VERTEX_BYTES
#undef VERTEX_ALIGNMENT
#undef PC_BITS
#undef PC_ORDERS
#undef UC_QUADS
#undef CODEC_PER_MESHLET
