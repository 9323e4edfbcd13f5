#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>

#include "base/mutex.h"
#include "base/status.h"

namespace lpv::web_door {

/// How many sockets may be open that have not shown a good token. Thread-safe.
class Places {
 public:
  static constexpr std::size_t kMost = 256;
  static constexpr std::size_t kMostOfAnAddress = 32;

  /// A place for as long as what is returned lives, which this outlives. RESOURCE_EXHAUSTED where none is free.
  /// `network` as api::networkOf() has it; `shared`: many clients are behind it, only the limit of all counts.
  Expected<std::shared_ptr<void>> take(const std::string& network, bool shared);

 private:
  Mutex mutex_;
  std::map<std::string, std::size_t> taken_ LPV_GUARDED_BY(mutex_);
  std::size_t all_ LPV_GUARDED_BY(mutex_) = 0;
};

}  // namespace lpv::web_door
