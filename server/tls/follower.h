#pragma once

#include <functional>
#include <memory>

#include "base/status.h"
#include "tls/files.h"
#include "tls/pem_files.h"

namespace lpv::tls {

/// Told when the files have become unusable, and with OK when they are good again.
using OnTrouble = std::function<void(const Status&)>;
/// Takes up files that were found good, or says why it cannot.
using TakeUp = std::function<Status(const PemFiles&)>;

/// Follows the files, looking every quarter of a second, so that what is given to its users was whole and good at once.
/// What is bad for two looks is told, and the last good files stay in use.
class Follower {
 public:
  /// INVALID_ARGUMENT for files that check() refuses.
  static Expected<std::unique_ptr<Follower>> follow(const Files& files, OnTrouble onTrouble);
  ~Follower();
  Follower(const Follower&) = delete;
  Follower& operator=(const Follower&) = delete;

  const Files& files() const;
  /// Gives the files in use to `takeUp` at once, whose failure is returned, and later ones on the follower's thread,
  /// until what is returned has gone, which the follower outlives.
  Expected<std::shared_ptr<void>> use(TakeUp takeUp);

 private:
  class Parts;
  explicit Follower(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace lpv::tls
