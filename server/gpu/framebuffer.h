#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <initializer_list>
#include <string>

#include "gpu/texture.h"

namespace lpv::gpu {

/// A labelled framebuffer over textures, which must outlive it. Move-only; empty (id 0) after move.
class Framebuffer {
 public:
  Framebuffer() = default;
  /// With colour attachments in order and a depth texture or null. Throws Failure (INTERNAL) if it is incomplete.
  Framebuffer(const std::string& label, std::initializer_list<const Texture*> colours, const Texture* depth);
  /// Without attachments: fragment shaders run for their side effects only.
  static Framebuffer withoutAttachments(const std::string& label, const glm::ivec2& size);
  Framebuffer(Framebuffer&& other) noexcept;
  Framebuffer& operator=(Framebuffer&& other) noexcept;
  ~Framebuffer();

  std::uint32_t id() const { return id_; }
  const glm::ivec2& size() const { return size_; }  ///< pixels
  int colours() const { return colours_; }          ///< colour attachments

  /// Makes it the draw target, with a viewport of its whole size.
  void bind() const;
  void clearColour(int attachment, const glm::vec4& value) const;
  void clearDepth(float value) const;

 private:
  std::uint32_t id_ = 0;
  glm::ivec2 size_{0};
  int colours_ = 0;
};

}  // namespace lpv::gpu
