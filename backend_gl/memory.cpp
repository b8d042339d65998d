#include "backend_gl/memory.h"

#include <format>

#include "backend_gl/context.h"

namespace skinbench {

void dropGlErrors() {
    // A lost context may report GL_CONTEXT_LOST for ever.
    for (int i = 0; i < 16 && glGetError() != GL_NO_ERROR; ++i) {
    }
}

Result<void> checkGl(const std::string& what, uint64_t bytes) {
    GLenum error = glGetError();
    if (error == GL_NO_ERROR) return {};
    dropGlErrors();
    if (error == GL_OUT_OF_MEMORY)
        return deviceError(std::format(
            "{} needs {} MiB of device memory, and the device gave out of it; use fewer copies or a smaller scene",
            what, (bytes + (1 << 20) - 1) >> 20));
    return deviceError(std::format("{}: OpenGL said {}; validation names the call", what, glErrorName(error)));
}

Result<GlBuffer> makeBuffer(uint64_t bytes, const std::string& what, GLbitfield flags) {
    GLuint id = 0;
    glCreateBuffers(1, &id);
    GlBuffer buffer(id);
    glNamedBufferStorage(id, static_cast<GLsizeiptr>(std::max<uint64_t>(bytes, 4)), nullptr, flags);
    SKINBENCH_TRY(checkGl(what, bytes));
    return buffer;
}

void clearBuffer(const GlBuffer& buffer, uint64_t bytes) {
    bool words = std::max<uint64_t>(bytes, 4) % 4 == 0;
    glClearNamedBufferData(buffer.id(), words ? GL_R32UI : GL_R8UI, GL_RED_INTEGER,
                           words ? GL_UNSIGNED_INT : GL_UNSIGNED_BYTE, nullptr);
}

Result<Staging> Staging::make() {
    // The read bit makes drivers choose cached memory, so that reading back is fast too.
    constexpr GLbitfield kAccess = GL_MAP_READ_BIT | GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    Staging staging;
    GLuint id = 0;
    glCreateBuffers(1, &id);
    staging.buffer_ = GlBuffer(id);
    glNamedBufferStorage(id, kBytes, nullptr, kAccess | GL_CLIENT_STORAGE_BIT);
    staging.memory_ = static_cast<std::byte*>(glMapNamedBufferRange(id, 0, kBytes, kAccess));
    SKINBENCH_TRY(checkGl("OpenGL: the staging buffer", kBytes));
    if (!staging.memory_) return deviceError("OpenGL: the staging buffer cannot be mapped");
    return staging;
}

void Staging::write(const GlBuffer& to, uint64_t offset, uint64_t size, const Fill& fill) {
    for (uint64_t at = 0; at < size;) {
        if (used_ == kBytes) finish();
        uint64_t piece = std::min(size - at, kBytes - used_);
        fill(at, {memory_ + used_, piece});
        glCopyNamedBufferSubData(buffer_.id(), to.id(), static_cast<GLintptr>(used_),
                                 static_cast<GLintptr>(offset + at), static_cast<GLsizeiptr>(piece));
        at += piece;
        used_ = std::min((used_ + piece + 255) / 256 * 256, kBytes);
    }
}

void Staging::write(const GlBuffer& to, uint64_t offset, std::span<const std::byte> bytes) {
    write(to, offset, bytes.size(),
          [&](uint64_t at, std::span<std::byte> out) { std::memcpy(out.data(), bytes.data() + at, out.size()); });
}

void Staging::finish() {
    glFinish();
    used_ = 0;
}

void Staging::read(const GlBuffer& from, std::span<std::byte> out) {
    finish();
    for (uint64_t at = 0; at < out.size();) {
        uint64_t piece = std::min(out.size() - at, kBytes);
        glCopyNamedBufferSubData(from.id(), buffer_.id(), static_cast<GLintptr>(at), 0, static_cast<GLsizeiptr>(piece));
        glFinish();
        std::memcpy(out.data() + at, memory_, piece);
        at += piece;
    }
}

}  // namespace skinbench
