#include "gpu/texture.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "gpu/failure.h"
#include "gpu/usage.h"

namespace lpv::gpu {

namespace {

void setSampling(GLuint id, Sampling sampling) {
  const bool linear = sampling != Sampling::kNearestClamp;
  const GLint minify = sampling == Sampling::kMipmapRepeat ? GL_LINEAR_MIPMAP_LINEAR : linear ? GL_LINEAR : GL_NEAREST;
  const GLint wrap = sampling == Sampling::kMipmapRepeat ? GL_REPEAT : GL_CLAMP_TO_EDGE;
  glTextureParameteri(id, GL_TEXTURE_MIN_FILTER, minify);
  glTextureParameteri(id, GL_TEXTURE_MAG_FILTER, linear ? GL_LINEAR : GL_NEAREST);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTextureParameteri(id, axis, wrap);
}

std::size_t bytesOfTexel(GLenum format) {
  switch (format) {
    case GL_RGBA32F:
      return 16;
    case GL_RGBA16F:
      return 8;
    default:  // GL_R32F, GL_RG16, GL_RGBA8, GL_SRGB8_ALPHA8, GL_DEPTH_COMPONENT32F
      return 4;
  }
}

std::size_t bytesOfLevels(const glm::ivec3& size, GLenum format, int levels) {
  std::size_t texels = 0;
  for (int i = 0; i < levels; ++i) {
    const glm::ivec3 level = glm::max(size >> i, glm::ivec3(1));
    texels += std::size_t(level.x) * std::size_t(level.y) * std::size_t(level.z);
  }
  return texels * bytesOfTexel(format);
}

}  // namespace

Texture::Texture(GLenum target, const std::string& label, const glm::ivec3& size, GLenum format, Sampling sampling,
                 int levels)
    : format_(format), size_(size), charge_(bytesOfLevels(size, format, levels)) {
  requireMemory("texture " + label, charge_.bytes());
  clearErrors();
  glCreateTextures(target, 1, &id_);
  if (target == GL_TEXTURE_3D) {
    glTextureStorage3D(id_, levels, format, size.x, size.y, size.z);
  } else {
    glTextureStorage2D(id_, levels, format, size.x, size.y);
  }
  try {
    throwOnError("texture " + label + " of " + std::to_string(size.x) + " x " + std::to_string(size.y) + " x " +
                 std::to_string(size.z) + " texels");
  } catch (...) {
    glDeleteTextures(1, &id_);
    throw;
  }
  setSampling(id_, sampling);
  usage().objects++;
  glObjectLabel(GL_TEXTURE, id_, GLsizei(label.size()), label.c_str());
}

Texture Texture::make2d(const std::string& label, const glm::ivec2& size, GLenum format, Sampling sampling,
                        int levels) {
  return {GL_TEXTURE_2D, label, glm::ivec3(size, 1), format, sampling, levels};
}

Texture Texture::make3d(const std::string& label, const glm::ivec3& size, GLenum format, Sampling sampling) {
  return {GL_TEXTURE_3D, label, size, format, sampling, 1};
}

Texture::Texture(Texture&& other) noexcept
    : id_(std::exchange(other.id_, 0)),
      format_(other.format_),
      size_(std::exchange(other.size_, glm::ivec3(0))),
      charge_(std::move(other.charge_)) {}

Texture& Texture::operator=(Texture&& other) noexcept {
  Texture taken(std::move(other));
  std::swap(id_, taken.id_);
  std::swap(format_, taken.format_);
  std::swap(size_, taken.size_);
  std::swap(charge_, taken.charge_);
  return *this;
}

Texture::~Texture() {
  if (id_ != 0) glDeleteTextures(1, &id_);
}

void Texture::uploadRows(int row, int rows, GLenum layout, GLenum type, const void* texels, int level) const {
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(id_, level, 0, row, std::max(size_.x >> level, 1), rows, layout, type, texels);
}

void Texture::generateMipmaps() { glGenerateTextureMipmap(id_); }

void Texture::fill(const glm::vec4& texel) const { glClearTexImage(id_, 0, GL_RGBA, GL_FLOAT, &texel); }

void Texture::bind(std::uint32_t unit) const { glBindTextureUnit(unit, id_); }

void Texture::bindImage(std::uint32_t unit, GLenum access) const {
  glBindImageTexture(unit, id_, 0, GL_TRUE, 0, access, format_);
}

int mipLevels(const glm::ivec2& size) { return int(std::bit_width(unsigned(std::max(size.x, size.y)))); }

}  // namespace lpv::gpu
