#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>

#include "gpu/account.h"
#include "gpu/gl.h"

namespace lpv::gpu {

/// How a texture is filtered and what is read outside 0..1.
enum class Sampling {
  kNearestClamp,   ///< the texel itself
  kLinearClamp,    ///< (tri)linear, edge texels repeated outwards
  kMipmapRepeat,   ///< trilinear over the mip chain, tiled
};

/// A 2D or 3D texture of fixed size, labelled. Move-only; empty (id 0) after move.
class Texture {
 public:
  Texture() = default;
  /// Throws Failure (RESOURCE_EXHAUSTED) when there is no memory. `format` is a sized internal format (GL_RGBA32F).
  static Texture make2d(const std::string& label, const glm::ivec2& size, GLenum format, Sampling sampling,
                        int levels = 1);
  static Texture make3d(const std::string& label, const glm::ivec3& size, GLenum format, Sampling sampling);
  Texture(Texture&& other) noexcept;
  Texture& operator=(Texture&& other) noexcept;
  ~Texture();

  std::uint32_t id() const { return id_; }
  const glm::ivec3& size() const { return size_; }  ///< texels; z = 1 for 2D
  std::size_t bytes() const { return charge_.bytes(); }  ///< of all levels
  explicit operator bool() const { return id_ != 0; }

  /// Rows [row, row + rows) of one level of a 2D texture from tightly packed client memory.
  void uploadRows(int row, int rows, GLenum layout, GLenum type, const void* texels, int level = 0) const;
  void generateMipmaps();
  /// Sets every texel of level 0, of a format of floats.
  void fill(const glm::vec4& texel) const;

  void bind(std::uint32_t unit) const;
  /// Whole level 0, all layers, as an image of the texture's own format.
  void bindImage(std::uint32_t unit, GLenum access) const;

 private:
  Texture(GLenum target, const std::string& label, const glm::ivec3& size, GLenum format, Sampling sampling,
          int levels);

  std::uint32_t id_ = 0;
  GLenum format_ = 0;
  glm::ivec3 size_{0};
  Charge charge_;
};

/// Number of levels of a full mip chain for a texture of this size.
int mipLevels(const glm::ivec2& size);

}  // namespace lpv::gpu
