#include "lpv/turns.h"

#include <algorithm>

namespace lpv {

void Turns::arrive(Party party) {
  double& used = used_[party];
  used = std::max(used, now_);
}

void Turns::begin(Party party) { now_ = std::max(now_, used_[party]); }

double Turns::used(Party party) const {
  const auto found = used_.find(party);
  return found == used_.end() ? now_ : found->second;
}

}  // namespace lpv
