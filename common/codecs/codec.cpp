#include "common/codecs/codec.h"

namespace skinbench {

const std::vector<Codec>& codecs() {
    static const std::vector<Codec> rows = {
        {"uc", "uncompressed floats, 64 bytes a vertex", "codecs/uc.glsl", false, encodeUncompressed},
        {"uc16", "quantised, 16-bit joints and weights, 30 bytes", "codecs/uc16.glsl", false, encodeUc16},
        {"oss", "optimal simplex sampling in 16 bits, 18 bytes", "codecs/oss.glsl", false, encodeOss16},
        {"oss22", "the same in 22 bits, at most 1024 tuples, 18 bytes", "codecs/oss.glsl", false, encodeOss22},
        {"pc", "permutation coding, 18 bytes (8 influences: 22)", "codecs/pc.glsl", false, encodePc},
        {"pdc8", "pc as meshlet differences of whole bytes", "codecs/pdc.glsl", true, encodePdc8},
        {"pdc16", "pc as meshlet differences of 0, 2 or 4 bytes", "codecs/pdc.glsl", true, encodePdc16},
        {"pdc32", "pc, or one blend for a whole meshlet", "codecs/pdc32.glsl", true, encodePdc32},
        {"dpdc16", "pdc16 with sorted and merged tuples", "codecs/dpdc16.glsl", true, encodeDpdc16},
    };
    return rows;
}

// Not in codecs(): seven bit budgets of one codec would crowd every table, and `ids` codes no mesh.
static const std::vector<Codec>& otherCodecs() {
    constexpr const char* what = "permutation coding fitted to the mesh's number of tuples";
    static const std::vector<Codec> rows = {
        {"pc16", what, "codecs/pc.glsl", false, encodePcBits<16>},
        {"pc24", what, "codecs/pc.glsl", false, encodePcBits<24>},
        {"pc32", what, "codecs/pc.glsl", false, encodePcBits<32>},
        {"pc40", what, "codecs/pc.glsl", false, encodePcBits<40>},
        {"pc48", what, "codecs/pc.glsl", false, encodePcBits<48>},
        {"pc56", what, "codecs/pc.glsl", false, encodePcBits<56>},
        {"pc64", what, "codecs/pc.glsl", false, encodePcBits<64>},
        {"ids", "no bytes: positions that follow from vertex numbers", "codecs/ids.glsl", false, encodeIds},
    };
    return rows;
}

const Codec* findCodec(const std::string& name) {
    for (const auto* rows : {&codecs(), &otherCodecs()})
        for (const Codec& codec : *rows)
            if (name == codec.name) return &codec;
    return nullptr;
}

bool feedsAttributes(const Codec& codec) { return codec.encode == encodeUncompressed; }

Mesh decodeOnCpu(const Mesh& mesh, const EncodedMesh& encoded) {
    if (encoded.decode) return encoded.decode();
    Mesh decoded = mesh;
    decoded.indices.clear();
    return decoded;
}

}  // namespace skinbench
