#pragma once

#include <cstdint>
#include <limits>
#include <map>

namespace lpv {

/// Whose turn it is on a device: the one that has had the least of it (start-time fair queueing, Goyal et al. 1996).
/// Who comes back from a pause starts level with the others: time not used is not saved up. What a tick takes beyond
/// kShortTick counts twice: somebody who drags a lamp in a small scene waits less than twice as long because of one
/// whose large scene takes its time anyway. Times in seconds.
class FairQueue {
 public:
  using Tenant = std::uint64_t;

  /// What feels immediate.
  static constexpr double kShortTick = 0.05;

  /// The tenant has another tick to be worked at.
  void arrive(Tenant tenant);
  void forget(Tenant tenant) { accounts_.erase(tenant); }

  /// Takes time on the tenant's account: predicted when work is queued, later the difference to what it took.
  void charge(Tenant tenant, double seconds);
  /// `tenant` is given a turn: nobody who arrives later starts with less than it had.
  void begin(Tenant tenant);

  /// What counts of the time it has had.
  double used(Tenant tenant) const;

 private:
  struct Account {
    double used = 0.0;
    double tick = 0.0;  ///< that its tick has had
  };

  std::map<Tenant, Account> accounts_;
  double now_ = 0.0;  ///< what the tenant of the last turn had when it began
};

/// The one with the least time used, the first of equals; end() for none.
template <typename Iterator, typename TenantOf>
Iterator leastServed(const FairQueue& turns, Iterator begin, Iterator end, TenantOf tenantOf) {
  Iterator least = end;
  double most = std::numeric_limits<double>::infinity();
  for (Iterator i = begin; i != end; ++i) {
    const double used = turns.used(tenantOf(*i));
    if (used >= most) continue;
    most = used;
    least = i;
  }
  return least;
}

}  // namespace lpv
