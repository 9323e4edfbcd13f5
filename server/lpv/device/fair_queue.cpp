#include "lpv/device/fair_queue.h"

#include <algorithm>

namespace lpv {

namespace {

double counted(double tick) { return tick + std::max(0.0, tick - Turns::kShortTick); }

}  // namespace

void Turns::arrive(Party party) {
  Account& account = accounts_[party];
  account.used = std::max(account.used, now_);
  account.tick = 0.0;
}

void Turns::charge(Party party, double seconds) {
  Account& account = accounts_[party];
  account.used += counted(account.tick + seconds) - counted(account.tick);
  account.tick += seconds;
}

void Turns::begin(Party party) { now_ = std::max(now_, accounts_[party].used); }

double Turns::used(Party party) const {
  const auto found = accounts_.find(party);
  return found == accounts_.end() ? now_ : found->second.used;
}

}  // namespace lpv
