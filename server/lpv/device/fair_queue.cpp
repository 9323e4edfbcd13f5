#include "lpv/device/fair_queue.h"

#include <algorithm>

namespace lpv {

namespace {

double counted(double tick) { return tick + std::max(0.0, tick - FairQueue::kShortTick); }

}  // namespace

void FairQueue::arrive(Tenant tenant) {
  Account& account = accounts_[tenant];
  account.used = std::max(account.used, now_);
  account.tick = 0.0;
}

void FairQueue::charge(Tenant tenant, double seconds) {
  Account& account = accounts_[tenant];
  account.used += counted(account.tick + seconds) - counted(account.tick);
  account.tick += seconds;
}

void FairQueue::begin(Tenant tenant) { now_ = std::max(now_, accounts_[tenant].used); }

double FairQueue::used(Tenant tenant) const {
  const auto found = accounts_.find(tenant);
  return found == accounts_.end() ? now_ : found->second.used;
}

}  // namespace lpv
