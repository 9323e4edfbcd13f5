#include "gpu/buffer_texture.h"

#include <utility>

#include "gpu/failure.h"
#include "gpu/gl.h"

namespace lpv::gpu {

namespace {

GLenum formatOf(BufferTexel texel) {
  switch (texel) {
    case BufferTexel::kVec3:
      return GL_RGB32F;
    case BufferTexel::kUvec3:
      return GL_RGB32UI;
    case BufferTexel::kUvec4:
      return GL_RGBA32UI;
    case BufferTexel::kVec4:
      break;
  }
  return GL_RGBA32F;
}

}  // namespace

BufferTexture::BufferTexture(const std::string& label, const Buffer& buffer, BufferTexel texel) {
  const bool four = texel == BufferTexel::kVec4 || texel == BufferTexel::kUvec4;
  const std::size_t texelBytes = four ? 16 : 12;
  GLint64 limit = 0;
  glGetInteger64v(GL_MAX_TEXTURE_BUFFER_SIZE, &limit);
  if (buffer.size() / texelBytes > std::size_t(limit))
    throw Failure(Code::kResourceExhausted, "GPU buffer " + label + " of " +
                                                std::to_string(buffer.size() / texelBytes) +
                                                " texels exceeds the device's " + std::to_string(limit));
  clearErrors();
  glCreateTextures(GL_TEXTURE_BUFFER, 1, &id_);
  glTextureBuffer(id_, formatOf(texel), buffer.id());
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
