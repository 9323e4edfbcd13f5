#include "gpu/readback.h"

#include <utility>

#include "gpu/failure.h"
#include "gpu/gl.h"

namespace lpv::gpu {

Readback::Readback(const std::string& label, std::size_t bytes) : size_(bytes), charge_(bytes) {
  constexpr GLbitfield kMapped = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  requireMemory("readback buffer " + label, bytes);
  clearErrors();
  glCreateBuffers(1, &id_);
  glNamedBufferStorage(id_, GLsizeiptr(bytes), nullptr, kMapped | GL_CLIENT_STORAGE_BIT);
  data_ = static_cast<const std::byte*>(glMapNamedBufferRange(id_, 0, GLsizeiptr(bytes), kMapped));
  try {
    throwOnError("readback buffer " + label + " of " + std::to_string(bytes) + " bytes");
    if (data_ == nullptr) throw Failure(Code::kResourceExhausted, "readback buffer " + label + " cannot be mapped");
  } catch (...) {
    glDeleteBuffers(1, &id_);
    throw;
  }
  glObjectLabel(GL_BUFFER, id_, GLsizei(label.size()), label.c_str());
}

Readback::Readback(Readback&& other) noexcept
    : id_(std::exchange(other.id_, 0)),
      size_(std::exchange(other.size_, 0)),
      data_(std::exchange(other.data_, nullptr)),
      charge_(std::move(other.charge_)) {}

Readback& Readback::operator=(Readback&& other) noexcept {
  Readback taken(std::move(other));
  std::swap(id_, taken.id_);
  std::swap(size_, taken.size_);
  std::swap(data_, taken.data_);
  std::swap(charge_, taken.charge_);
  return *this;
}

Readback::~Readback() {
  if (id_ != 0) glDeleteBuffers(1, &id_);  // unmaps
}

void Readback::copyFrom(const Buffer& source, std::size_t sourceOffset, std::size_t offset, std::size_t bytes) {
  glCopyNamedBufferSubData(source.id(), id_, GLintptr(sourceOffset), GLintptr(offset), GLsizeiptr(bytes));
}

void Readback::copyPixels(const Framebuffer& source, int row, int rows, std::uint32_t layout, std::uint32_t type,
                          std::size_t offset) {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, source.id());
  glNamedFramebufferReadBuffer(source.id(), GL_COLOR_ATTACHMENT0);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, id_);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, row, source.size().x, rows, layout, type, reinterpret_cast<void*>(offset));
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
}

}  // namespace lpv::gpu
