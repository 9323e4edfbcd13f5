#pragma once
// Presence as one watcher is told of it: nothing is queued, only who was told what last is known. Members are told as
// they are when the watcher takes them, the newest of each; one that is gone is told once.

#include <cstdint>
#include <map>
#include <string>

#include "lpv/v1/session.pb.h"
#include "session/session.h"

namespace lpv::api {

namespace pb = lpv::v1;

/// Not thread-safe.
class PresenceFeed {
 public:
  /// A member is not told of itself.
  void start(const std::string& self) { self_ = self; }
  /// Fills the next notice; false where the watcher knows everything.
  bool next(const Session& session, pb::Presence* out);

 private:
  std::string self_;
  std::uint64_t seen_ = 0;  ///< Session::presenceChanges when there was nothing more to tell
  std::map<std::string, std::uint64_t> told_;  ///< members, each with its change that was told
};

}  // namespace lpv::api
