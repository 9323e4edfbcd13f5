#pragma once
// Whose memory it is that this thread takes of the GPU.

#include <cstddef>
#include <cstdint>
#include <memory>

namespace lpv::gpu {

/// Bytes of buffers, textures and readbacks that count as one owner's. As they were asked for: what a driver adds is
/// not in it. Of one thread.
struct Account {
  std::int64_t bytes = 0;
};
using AccountPtr = std::shared_ptr<Account>;

/// What the calling thread makes from now on counts there, for as long as it lives; null: nowhere.
void chargeTo(AccountPtr account);

/// Bytes on the account that was charged when they were taken. Move-only; nothing after move.
class Charge {
 public:
  Charge() = default;
  explicit Charge(std::size_t bytes);
  Charge(Charge&& other) noexcept;
  Charge& operator=(Charge&& other) noexcept;
  ~Charge();

  std::size_t bytes() const { return bytes_; }

 private:
  AccountPtr account_;
  std::size_t bytes_ = 0;
};

}  // namespace lpv::gpu
