#include "gpu/buffer_texture.h"

#include <utility>

#include "gpu/failure.h"
#include "gpu/gl.h"

namespace lpv::gpu {

BufferTexture::BufferTexture(const std::string& label, const Buffer& buffer) {
  constexpr std::size_t kTexelBytes = 16;
  GLint64 limit = 0;
  glGetInteger64v(GL_MAX_TEXTURE_BUFFER_SIZE, &limit);
  if (buffer.size() / kTexelBytes > std::size_t(limit))
    throw Failure(Code::kResourceExhausted, "GPU buffer " + label + " of " +
                                                std::to_string(buffer.size() / kTexelBytes) +
                                                " texels exceeds the device's " + std::to_string(limit));
  clearErrors();
  glCreateTextures(GL_TEXTURE_BUFFER, 1, &id_);
  glTextureBuffer(id_, GL_RGBA32F, buffer.id());
  try {
    throwOnError("buffer texture " + label);
  } catch (...) {
    glDeleteTextures(1, &id_);
    throw;
  }
  glObjectLabel(GL_TEXTURE, id_, GLsizei(label.size()), label.c_str());
}

BufferTexture::BufferTexture(BufferTexture&& other) noexcept : id_(std::exchange(other.id_, 0)) {}

BufferTexture& BufferTexture::operator=(BufferTexture&& other) noexcept {
  BufferTexture taken(std::move(other));
  std::swap(id_, taken.id_);
  return *this;
}

BufferTexture::~BufferTexture() {
  if (id_ != 0) glDeleteTextures(1, &id_);
}

void BufferTexture::bind(std::uint32_t unit) const { glBindTextureUnit(unit, id_); }

}  // namespace lpv::gpu
