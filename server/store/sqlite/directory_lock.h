#pragma once

#include <memory>
#include <string>
#include <utility>

#include "base/status.h"

namespace lpv::store {

/// A folder that one process has for itself, as long as this lives. Ends with the process, however that ends.
class DirectoryLock {
 public:
  /// Makes the folder where it is missing. FAILED_PRECONDITION, naming the folder and the other process, where it is
  /// taken; UNAVAILABLE where it cannot be made or written.
  static Expected<std::unique_ptr<DirectoryLock>> take(const std::string& directory);
  /// A database was made here, by this process or one before; remembered in the lock file, which outlives both.
  Status markUsed();
  bool used() const { return used_; }
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  DirectoryLock(int file, std::string directory) : file_(file), directory_(std::move(directory)) {}
  Status write() const;
  const int file_;
  const std::string directory_;
  bool used_ = false;
};

}  // namespace lpv::store
