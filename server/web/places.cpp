#include "web/places.h"

namespace lpv::web_door {

Expected<std::shared_ptr<void>> Places::take(const std::string& network, bool shared) {
  const MutexLock lock(mutex_);
  if (all_ >= kMost)
    return exhausted(
        "web", "the server has 256 sockets whose token it has not seen, as many as are allowed; try again in a while");
  if (!shared && taken_[network] >= kMostOfAnAddress)
    return exhausted("web", "this address has 32 sockets whose token was not seen, as many as are allowed; close some");
  ++all_;
  ++taken_[network];
  return std::shared_ptr<void>(this, [network](void* places) {
    auto& self = *static_cast<Places*>(places);
    const MutexLock gone(self.mutex_);
    --self.all_;
    if (--self.taken_[network] == 0) self.taken_.erase(network);
  });
}

}  // namespace lpv::web_door
