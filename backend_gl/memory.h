// GPU objects that free themselves, and the way of bytes into and out of device-local buffers. All of it needs the
// owning context to be current, destructors included.
#pragma once

#include <glad/gl.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <utility>

#include "common/core/result.h"

namespace skinbench {

template <void (*destroy)(GLuint)>
class GlObject {
public:
    GlObject() = default;
    explicit GlObject(GLuint id) : id_(id) {}
    GlObject(GlObject&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
    GlObject& operator=(GlObject&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }
    ~GlObject() {
        if (id_) destroy(id_);
    }
    GLuint id() const { return id_; }

private:
    GLuint id_ = 0;
};

inline void destroyBuffer(GLuint id) { glDeleteBuffers(1, &id); }
inline void destroyVertexArray(GLuint id) { glDeleteVertexArrays(1, &id); }
inline void destroyTexture(GLuint id) { glDeleteTextures(1, &id); }
inline void destroyFramebuffer(GLuint id) { glDeleteFramebuffers(1, &id); }
inline void destroyProgram(GLuint id) { glDeleteProgram(id); }
inline void destroyShader(GLuint id) { glDeleteShader(id); }

using GlBuffer = GlObject<destroyBuffer>;
using GlVertexArray = GlObject<destroyVertexArray>;
using GlTexture = GlObject<destroyTexture>;
using GlFramebuffer = GlObject<destroyFramebuffer>;
using GlProgramObject = GlObject<destroyProgram>;
using GlShader = GlObject<destroyShader>;

// Errors that earlier calls left behind; at most one of each kind, and none of them ours any more.
void dropGlErrors();

// The first pending error as a sentence about `what`, which takes `bytes` of device memory.
Result<void> checkGl(const std::string& what, uint64_t bytes);

// Immutable, and device-local without flags: only copies and shaders write it. `what` is for the message.
Result<GlBuffer> makeBuffer(uint64_t bytes, const std::string& what, GLbitfield flags = 0);
void clearBuffer(const GlBuffer& buffer, uint64_t bytes);

// Host memory that the device sees, through which everything goes in pieces, so that neither copies of a stream nor
// palettes ever exist as a whole on the host.
class Staging {
public:
    static Result<Staging> make();

    // fill(at, out) writes the bytes [at, at + out.size()) of the content; pieces are multiples of 4 but for the last.
    using Fill = std::function<void(uint64_t at, std::span<std::byte> out)>;
    void write(const GlBuffer& to, uint64_t offset, uint64_t size, const Fill& fill);
    void write(const GlBuffer& to, uint64_t offset, std::span<const std::byte> bytes);
    void finish();  // until everything written has arrived
    void read(const GlBuffer& from, std::span<std::byte> out);

private:
    static constexpr uint64_t kBytes = uint64_t{64} << 20;
    GlBuffer buffer_;
    std::byte* memory_ = nullptr;
    uint64_t used_ = 0;
};

}  // namespace skinbench
