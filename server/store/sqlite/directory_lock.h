#pragma once

#include <memory>
#include <string>

#include "base/status.h"

namespace lpv::store {

/// A folder that one process has for itself, as long as this lives. Ends with the process, however that ends.
class DirectoryLock {
 public:
  /// Makes the folder where it is missing. FAILED_PRECONDITION, naming the folder and the other process, where it is
  /// taken; UNAVAILABLE where it cannot be made or written.
  static Expected<std::unique_ptr<DirectoryLock>> take(const std::string& directory);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  explicit DirectoryLock(int file) : file_(file) {}
  int file_;
};

}  // namespace lpv::store
