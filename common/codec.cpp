#include "common/codec.h"

namespace skinbench {

const std::vector<Codec>& codecs() {
    static const std::vector<Codec> rows = {
        {"uc", "uncompressed floats, 64 bytes a vertex", "codecs/uc.glsl", false, encodeUncompressed},
    };
    return rows;
}

const Codec* findCodec(const std::string& name) {
    for (const Codec& codec : codecs())
        if (name == codec.name) return &codec;
    return nullptr;
}

}  // namespace skinbench
