#include "gpu/framebuffer.h"

#include <array>
#include <utility>

#include "gpu/failure.h"

namespace lpv::gpu {

Framebuffer::Framebuffer(const std::string& label, std::initializer_list<const Texture*> colours,
                         const Texture* depth) {
  glCreateFramebuffers(1, &id_);
  std::array<GLenum, 8> draws{};
  GLsizei count = 0;
  for (const Texture* colour : colours) {
    draws[std::size_t(count)] = GL_COLOR_ATTACHMENT0 + GLenum(count);
    glNamedFramebufferTexture(id_, draws[std::size_t(count)], colour->id(), 0);
    size_ = glm::ivec2(colour->size());
    ++count;
  }
  colours_ = count;
  glNamedFramebufferDrawBuffers(id_, count, draws.data());
  if (depth != nullptr) {
    glNamedFramebufferTexture(id_, GL_DEPTH_ATTACHMENT, depth->id(), 0);
    size_ = glm::ivec2(depth->size());
  }
  const GLenum status = glCheckNamedFramebufferStatus(id_, GL_DRAW_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE) {
    glDeleteFramebuffers(1, &id_);
    throw Failure(Code::kInternal, "framebuffer " + label + " is incomplete: " + std::to_string(status));
  }
  glObjectLabel(GL_FRAMEBUFFER, id_, GLsizei(label.size()), label.c_str());
}

Framebuffer Framebuffer::withoutAttachments(const std::string& label, const glm::ivec2& size) {
  Framebuffer out;
  glCreateFramebuffers(1, &out.id_);
  glNamedFramebufferParameteri(out.id_, GL_FRAMEBUFFER_DEFAULT_WIDTH, size.x);
  glNamedFramebufferParameteri(out.id_, GL_FRAMEBUFFER_DEFAULT_HEIGHT, size.y);
  glObjectLabel(GL_FRAMEBUFFER, out.id_, GLsizei(label.size()), label.c_str());
  out.size_ = size;
  return out;
}

Framebuffer::Framebuffer(Framebuffer&& other) noexcept
    : id_(std::exchange(other.id_, 0)), size_(other.size_), colours_(other.colours_) {}

Framebuffer& Framebuffer::operator=(Framebuffer&& other) noexcept {
  Framebuffer taken(std::move(other));
  std::swap(id_, taken.id_);
  std::swap(size_, taken.size_);
  std::swap(colours_, taken.colours_);
  return *this;
}

Framebuffer::~Framebuffer() {
  if (id_ != 0) glDeleteFramebuffers(1, &id_);
}

void Framebuffer::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, id_);
  glViewport(0, 0, size_.x, size_.y);
}

void Framebuffer::clearColour(int attachment, const glm::vec4& value) const {
  glClearNamedFramebufferfv(id_, GL_COLOR, attachment, &value.x);
}

void Framebuffer::clearDepth(float value) const { glClearNamedFramebufferfv(id_, GL_DEPTH, 0, &value); }

}  // namespace lpv::gpu
