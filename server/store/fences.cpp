#include "store/fences.h"

namespace lpv::store {

void Fences::add(const std::string& session, Position position, const Status& why) {
  if (now(session).ok()) fences_[session] = {position, kOpen, why};
}

void Fences::lift(const std::string& session, Position position) {
  const auto found = fences_.find(session);
  if (found != fences_.end() && found->second.to == kOpen) found->second.to = position;
}

Status Fences::at(const std::string& session, Position position) const {
  const auto found = fences_.find(session);
  if (found == fences_.end()) return {};
  const Fence& fence = found->second;
  return position >= fence.from && position < fence.to ? fence.why : Status();
}

}  // namespace lpv::store
