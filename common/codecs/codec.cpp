#include "common/codecs/codec.h"

#include <format>

namespace skinbench {

const std::vector<Codec>& codecs() {
    static const std::vector<Codec> rows = {
        {.name = "uc",
         .what = "uncompressed floats, 64 bytes a vertex",
         .shader = "codecs/uc.glsl",
         .feedsAttributes = true,
         .takesSlots = true,
         .slim = "uc_slim",
         .encode = encodeUncompressed},
        {.name = "uc16",
         .what = "quantised, 16-bit joints and weights, 30 bytes",
         .shader = "codecs/uc16.glsl",
         .encode = encodeUc16},
        {.name = "oss",
         .what = "optimal simplex sampling in 16 bits, 18 bytes",
         .shader = "codecs/oss.glsl",
         .mostInfluences = 4,
         .encode = encodeOss16},
        {.name = "oss22",
         .what = "the same in 22 bits, at most 1024 tuples, 18 bytes",
         .shader = "codecs/oss.glsl",
         .mostInfluences = 4,
         .encode = encodeOss22},
        {.name = "pc",
         .what = "permutation coding, 18 bytes (8 influences: 22)",
         .shader = "codecs/pc.glsl",
         .encode = encodePc},
        {.name = "pdc8",
         .what = "pc as meshlet differences of whole bytes",
         .shader = "codecs/pdc.glsl",
         .needsMeshlets = true,
         .mostInfluences = 4,
         .encode = encodePdc8},
        {.name = "pdc16",
         .what = "pc as meshlet differences of 0, 2 or 4 bytes",
         .shader = "codecs/pdc.glsl",
         .needsMeshlets = true,
         .mostInfluences = 4,
         .encode = encodePdc16},
        {.name = "pdc32",
         .what = "pc, or one blend for a whole meshlet",
         .shader = "codecs/pdc32.glsl",
         .needsMeshlets = true,
         .mostInfluences = 4,
         .encode = encodePdc32},
        {.name = "dpdc16",
         .what = "pdc16 with sorted and merged tuples",
         .shader = "codecs/dpdc16.glsl",
         .needsMeshlets = true,
         .mostInfluences = 4,
         .encode = encodeDpdc16},
    };
    return rows;
}

// Not in codecs(): seven bit budgets of one codec would crowd every table, `wicked` is there to be compared with by the
// variant compute, `ids` codes no mesh, and `uc_slim` follows from where the joints are.
static const std::vector<Codec>& otherCodecs() {
    constexpr const char* what = "permutation coding fitted to the mesh's number of tuples";
    static const std::vector<Codec> rows = {
        {.name = "pc16", .what = what, .shader = "codecs/pc.glsl", .encode = encodePcBits<16>},
        {.name = "pc24", .what = what, .shader = "codecs/pc.glsl", .encode = encodePcBits<24>},
        {.name = "pc32", .what = what, .shader = "codecs/pc.glsl", .encode = encodePcBits<32>},
        {.name = "pc40", .what = what, .shader = "codecs/pc.glsl", .encode = encodePcBits<40>},
        {.name = "pc48", .what = what, .shader = "codecs/pc.glsl", .encode = encodePcBits<48>},
        {.name = "pc56", .what = what, .shader = "codecs/pc.glsl", .encode = encodePcBits<56>},
        {.name = "pc64", .what = what, .shader = "codecs/pc.glsl", .encode = encodePcBits<64>},
        {.name = "wicked",
         .what = "Wicked Engine's streams, 36 bytes",
         .shader = "codecs/wicked.glsl",
         .mostInfluences = 4,
         .encode = encodeWicked},
        {.name = "ids",
         .what = "no bytes: positions that follow from vertex numbers",
         .shader = "codecs/ids.glsl",
         .storesJoints = false,
         .encode = encodeIds},
        {.name = "uc_slim",
         .what = "uc, joint ids in the meshlets",
         .shader = "codecs/uc_slim.glsl",
         .needsMeshlets = true,
         .encode = encodeSlim},
    };
    return rows;
}

const Codec* findCodec(const std::string& name) {
    for (const auto* rows : {&codecs(), &otherCodecs()})
        for (const Codec& codec : *rows)
            if (name == codec.name) return &codec;
    return nullptr;
}

std::optional<std::string> cannotHold(const Codec& codec, int influences) {
    if (influences <= codec.mostInfluences) return std::nullopt;
    return std::format("codec {} holds {} influences a vertex; choose {} influences, uc, uc16 or pc", codec.name,
                       codec.mostInfluences, codec.mostInfluences);
}

Mesh decodeOnCpu(const Mesh& mesh, const EncodedMesh& encoded) {
    if (encoded.decode) return encoded.decode();
    Mesh decoded = mesh;
    decoded.indices.clear();
    return decoded;
}

}  // namespace skinbench
