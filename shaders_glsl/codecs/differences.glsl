// Meshlet differences (Kimmersdorfer 2.2, common/codecs/differences.h): vertices of 14 bytes with 0 to 4 bytes of blend
// code behind, numbered by that width, and two words a meshlet.
#define CODEC_PER_MESHLET 1

layout(std430, binding = SLOT_MESHLET_EXTRA) readonly restrict buffer MeshletExtraBlock { uvec2 meshletExtra[]; };

// By width; modulo 2^32.
const uint sections[5] = SECTIONS;

uint vertexBytes(uint width) { return 14u + width; }
uint firstByteOf(uint number, uint width) { return sections[width] + number * vertexBytes(width); }

uvec2 loadMeshletBlend(uint meshletNumber, uint copyNumber) {
    return meshletExtra[copyNumber * uint(MESHLET_COUNT) + meshletNumber];
}

// The `width` bytes behind the base.
uint codeBytes(PackedVertex stored, uint width) {
    return bitfieldExtract(highHalf(stored.words[3]) | stored.words[4] << 16u, 0, int(8u * width));
}
