#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>

#include "gpu/account.h"

namespace lpv::gpu {

/// How a buffer's storage is used; determines its flags.
enum class BufferUse {
  kDevice,   ///< written by the GPU and by copies only
  kDynamic,  ///< written from the CPU with update()
};

/// Tag for storage with undefined content: for buffers that are cleared in chunks or written before they are read.
struct Undefined {};

/// An OpenGL buffer object of fixed size, labelled. Move-only; empty (id 0, size 0) after move.
class Buffer {
 public:
  Buffer() = default;
  /// `bytes` of zeros, or of anything, or the content of `data`. Throws Failure (RESOURCE_EXHAUSTED) when there is no
  /// memory.
  Buffer(const std::string& label, std::size_t bytes, BufferUse use = BufferUse::kDevice);
  Buffer(const std::string& label, std::size_t bytes, BufferUse use, Undefined);
  Buffer(const std::string& label, std::span<const std::byte> data, BufferUse use = BufferUse::kDevice);
  Buffer(Buffer&& other) noexcept;
  Buffer& operator=(Buffer&& other) noexcept;
  ~Buffer();

  std::uint32_t id() const { return id_; }
  std::size_t size() const { return size_; }  ///< bytes
  explicit operator bool() const { return id_ != 0; }

  /// Replaces bytes [offset, offset + data.size()); kDynamic only.
  void update(std::size_t offset, std::span<const std::byte> data);
  /// Zeroes the whole buffer on the GPU.
  void clear();
  /// Fills the whole buffer with one 32-bit word on the GPU. Not before an update(), which it may come after on some
  /// drivers.
  void fill(std::uint32_t word);
  /// The same for bytes [offset, offset + bytes), both multiples of 4.
  void fill(std::uint32_t word, std::size_t offset, std::size_t bytes);

  void bindStorage(std::uint32_t binding) const;
  void bindUniform(std::uint32_t binding) const;
  void bindUniformRange(std::uint32_t binding, std::size_t offset, std::size_t bytes) const;
  void bindAsDispatchArguments() const;

 private:
  std::uint32_t id_ = 0;
  std::size_t size_ = 0;
  Charge charge_;
};

/// The bytes of a vector, array or struct.
template <typename T>
std::span<const std::byte> bytesOf(const std::span<const T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::as_bytes(values);
}
template <typename T>
std::span<const std::byte> bytesOfValue(const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::as_bytes(std::span<const T, 1>(&value, 1));
}

}  // namespace lpv::gpu
