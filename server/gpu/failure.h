#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

#include "base/status.h"

namespace lpv::gpu {

/// Failure of GPU work. Thrown by constructors of GL objects and programs, caught once per tick on the GL thread, where
/// it becomes the tick's Status; it never leaves the engine's interface.
class Failure : public std::runtime_error {
 public:
  explicit Failure(Status status) : std::runtime_error(status.message()), status_(std::move(status)) {}
  Failure(Code code, const std::string& message) : Failure(Status(code, message)) {}

  const Status& status() const { return status_; }

 private:
  Status status_;
};

/// Clears GL's error flags, so that a later throwOnError reports only errors of the work in between.
void clearErrors();

/// Throws RESOURCE_EXHAUSTED for GL_OUT_OF_MEMORY and INTERNAL for any other raised flag, naming `what`.
void throwOnError(const std::string& what);

/// Throws RESOURCE_EXHAUSTED for more bytes than the machine has memory: a driver may try to find 4 TiB for minutes.
void requireMemory(const std::string& what, std::size_t bytes);

/// Throws UNAVAILABLE when the context was lost (KHR_robustness).
void throwOnReset();

}  // namespace lpv::gpu
