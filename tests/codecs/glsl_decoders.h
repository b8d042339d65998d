// Every decoder that shader_decoders.cpp compiles as C++, each in a namespace of its own.
#pragma once

#include "tests/codecs/glsl_cpp.h"

// clang-format off
#define DECODER uc4
#define DECODER_FILE "codecs/uc.glsl"
#define CODEC "uc"
#define INFLUENCES 4
#define VERTEX_BYTES 0
#define VERTEX_ALIGNMENT 0
#define PC_BITS 0
#include "tests/codecs/glsl_decoder.inl"

#define DECODER uc8
#define DECODER_FILE "codecs/uc.glsl"
#define CODEC "uc"
#define INFLUENCES 8
#define VERTEX_BYTES 0
#define VERTEX_ALIGNMENT 0
#define PC_BITS 0
#include "tests/codecs/glsl_decoder.inl"

#define DECODER halves4
#define DECODER_FILE "codecs/uc16.glsl"
#define CODEC "uc16"
#define INFLUENCES 4
#define VERTEX_BYTES 30
#define VERTEX_ALIGNMENT 2
#define PC_BITS 0
#include "tests/codecs/glsl_decoder.inl"

#define DECODER halves8
#define DECODER_FILE "codecs/uc16.glsl"
#define CODEC "uc16"
#define INFLUENCES 8
#define VERTEX_BYTES 46
#define VERTEX_ALIGNMENT 2
#define PC_BITS 0
#include "tests/codecs/glsl_decoder.inl"

#define DECODER simplex16
#define DECODER_FILE "codecs/oss.glsl"
#define CODEC "oss"
#define INFLUENCES 4
#define VERTEX_BYTES 18
#define VERTEX_ALIGNMENT 2
#define PC_BITS 0
#include "tests/codecs/glsl_decoder.inl"

#define DECODER simplex22
#define DECODER_FILE "codecs/oss.glsl"
#define CODEC "oss22"
#define INFLUENCES 4
#define VERTEX_BYTES 18
#define VERTEX_ALIGNMENT 2
#define PC_BITS 0
#include "tests/codecs/glsl_decoder.inl"

#define DECODER pc4
#define DECODER_FILE "codecs/pc.glsl"
#define CODEC "pc"
#define INFLUENCES 4
#define VERTEX_BYTES 18
#define VERTEX_ALIGNMENT 2
#define PC_BITS 32
#include "tests/codecs/glsl_decoder.inl"

#define DECODER pc8
#define DECODER_FILE "codecs/pc.glsl"
#define CODEC "pc"
#define INFLUENCES 8
#define VERTEX_BYTES 22
#define VERTEX_ALIGNMENT 2
#define PC_BITS 64
#include "tests/codecs/glsl_decoder.inl"

#define DECODER pc16
#define DECODER_FILE "codecs/pc.glsl"
#define CODEC "pc16"
#define INFLUENCES 4
#define VERTEX_BYTES 16
#define VERTEX_ALIGNMENT 4
#define PC_BITS 16
#include "tests/codecs/glsl_decoder.inl"

#define DECODER pc24
#define DECODER_FILE "codecs/pc.glsl"
#define CODEC "pc24"
#define INFLUENCES 4
#define VERTEX_BYTES 17
#define VERTEX_ALIGNMENT 1
#define PC_BITS 24
#include "tests/codecs/glsl_decoder.inl"

#define DECODER pc40
#define DECODER_FILE "codecs/pc.glsl"
#define CODEC "pc40"
#define INFLUENCES 4
#define VERTEX_BYTES 19
#define VERTEX_ALIGNMENT 1
#define PC_BITS 40
#include "tests/codecs/glsl_decoder.inl"

#define DECODER pc48
#define DECODER_FILE "codecs/pc.glsl"
#define CODEC "pc48"
#define INFLUENCES 4
#define VERTEX_BYTES 20
#define VERTEX_ALIGNMENT 4
#define PC_BITS 48
#include "tests/codecs/glsl_decoder.inl"

#define DECODER pc56
#define DECODER_FILE "codecs/pc.glsl"
#define CODEC "pc56"
#define INFLUENCES 4
#define VERTEX_BYTES 21
#define VERTEX_ALIGNMENT 1
#define PC_BITS 56
#include "tests/codecs/glsl_decoder.inl"

#define DECODER pc64
#define DECODER_FILE "codecs/pc.glsl"
#define CODEC "pc64"
#define INFLUENCES 4
#define VERTEX_BYTES 22
#define VERTEX_ALIGNMENT 2
#define PC_BITS 64
#include "tests/codecs/glsl_decoder.inl"

#define DECODER pc32x8
#define DECODER_FILE "codecs/pc.glsl"
#define CODEC "pc32"
#define INFLUENCES 8
#define VERTEX_BYTES 18
#define VERTEX_ALIGNMENT 2
#define PC_BITS 32
#include "tests/codecs/glsl_decoder.inl"

#define DECODER pdc8
#define DECODER_FILE "codecs/pdc.glsl"
#define CODEC "pdc8"
#define INFLUENCES 4
#define VERTEX_BYTES 18
#define VERTEX_ALIGNMENT 1
#define PC_BITS 32
#include "tests/codecs/glsl_decoder.inl"

#define DECODER pdc16
#define DECODER_FILE "codecs/pdc.glsl"
#define CODEC "pdc16"
#define INFLUENCES 4
#define VERTEX_BYTES 18
#define VERTEX_ALIGNMENT 2
#define PC_BITS 32
#include "tests/codecs/glsl_decoder.inl"

#define DECODER pdc32
#define DECODER_FILE "codecs/pdc32.glsl"
#define CODEC "pdc32"
#define INFLUENCES 4
#define VERTEX_BYTES 18
#define VERTEX_ALIGNMENT 2
#define PC_BITS 32
#include "tests/codecs/glsl_decoder.inl"

#define DECODER dpdc16
#define DECODER_FILE "codecs/dpdc16.glsl"
#define CODEC "dpdc16"
#define INFLUENCES 4
#define VERTEX_BYTES 18
#define VERTEX_ALIGNMENT 2
#define PC_BITS 32
#include "tests/codecs/glsl_decoder.inl"

#define DECODER wicked
#define DECODER_FILE "codecs/wicked.glsl"
#define CODEC "wicked"
#define INFLUENCES 4
#define VERTEX_BYTES 0
#define VERTEX_ALIGNMENT 0
#define PC_BITS 0
#include "tests/codecs/glsl_decoder.inl"

// clang-format on

namespace skinbench::glsl {
inline const Decoder* const kDecoders[] = {
    &uc4::decoder,       &uc8::decoder,   &halves4::decoder, &halves8::decoder, &simplex16::decoder,
    &simplex22::decoder, &pc4::decoder,   &pc8::decoder,     &pc16::decoder,    &pc24::decoder,
    &pc40::decoder,      &pc48::decoder,  &pc56::decoder,    &pc64::decoder,    &pc32x8::decoder,
    &pdc8::decoder,      &pdc16::decoder, &pdc32::decoder,   &dpdc16::decoder,   &wicked::decoder,
};
}  // namespace skinbench::glsl
