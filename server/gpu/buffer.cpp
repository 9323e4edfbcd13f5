#include "gpu/buffer.h"

#include <utility>
#include <vector>

#include "gpu/failure.h"
#include "gpu/gl.h"
#include "gpu/usage.h"

namespace lpv::gpu {

namespace {

std::uint32_t createStorage(const std::string& label, std::size_t bytes, const void* data, BufferUse use) {
  requireMemory("buffer " + label, bytes);
  clearErrors();
  GLuint id = 0;
  glCreateBuffers(1, &id);
  const GLsizeiptr size = GLsizeiptr(bytes == 0 ? 4 : bytes);  // GL has no empty storage
  glNamedBufferStorage(id, size, bytes == 0 ? nullptr : data, use == BufferUse::kDynamic ? GL_DYNAMIC_STORAGE_BIT : 0);
  try {
    throwOnError("buffer " + label + " of " + std::to_string(bytes) + " bytes");
  } catch (...) {
    glDeleteBuffers(1, &id);
    throw;
  }
  usage().objects++;
  usage().bytes += std::uint64_t(size);
  glObjectLabel(GL_BUFFER, id, GLsizei(label.size()), label.c_str());
  return id;
}

// What update() writes soon after a clear can be lost: NVIDIA 580 clears last, barrier or not. So a buffer that can be
// updated gets its zeros as content.
std::uint32_t createZeros(const std::string& label, std::size_t bytes, BufferUse use) {
  if (use == BufferUse::kDevice) return createStorage(label, bytes, nullptr, use);
  requireMemory("buffer " + label, bytes);
  return createStorage(label, bytes, std::vector<std::byte>(bytes).data(), use);
}

}  // namespace

Buffer::Buffer(const std::string& label, std::size_t bytes, BufferUse use)
    : id_(createZeros(label, bytes, use)), size_(bytes), charge_(bytes) {
  if (use == BufferUse::kDevice) clear();
}

Buffer::Buffer(const std::string& label, std::size_t bytes, BufferUse use, Undefined)
    : id_(createStorage(label, bytes, nullptr, use)), size_(bytes), charge_(bytes) {}

Buffer::Buffer(const std::string& label, std::span<const std::byte> data, BufferUse use)
    : id_(createStorage(label, data.size(), data.data(), use)), size_(data.size()), charge_(data.size()) {}

Buffer::Buffer(Buffer&& other) noexcept
    : id_(std::exchange(other.id_, 0)), size_(std::exchange(other.size_, 0)), charge_(std::move(other.charge_)) {}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
  Buffer taken(std::move(other));
  std::swap(id_, taken.id_);
  std::swap(size_, taken.size_);
  std::swap(charge_, taken.charge_);
  return *this;
}

Buffer::~Buffer() {
  if (id_ != 0) glDeleteBuffers(1, &id_);
}

void Buffer::update(std::size_t offset, std::span<const std::byte> data) {
  if (data.empty()) return;
  glNamedBufferSubData(id_, GLintptr(offset), GLsizeiptr(data.size()), data.data());
}

void Buffer::clear() { fill(0); }

void Buffer::fill(std::uint32_t word) { fill(word, 0, size_ / 4 * 4); }

void Buffer::fill(std::uint32_t word, std::size_t offset, std::size_t bytes) {
  if (bytes == 0) return;
  glClearNamedBufferSubData(id_, GL_R32UI, GLintptr(offset), GLsizeiptr(bytes), GL_RED_INTEGER, GL_UNSIGNED_INT, &word);
}

void Buffer::bindStorage(std::uint32_t binding) const { glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, id_); }

void Buffer::bindUniform(std::uint32_t binding) const { glBindBufferBase(GL_UNIFORM_BUFFER, binding, id_); }

void Buffer::bindUniformRange(std::uint32_t binding, std::size_t offset, std::size_t bytes) const {
  glBindBufferRange(GL_UNIFORM_BUFFER, binding, id_, GLintptr(offset), GLsizeiptr(bytes));
}

void Buffer::bindAsDispatchArguments() const { glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, id_); }

}  // namespace lpv::gpu
