#pragma once

#include <atomic>
#include <string>

#include "base/status.h"

namespace lpv::api {

/// One of so many large things that the server holds in memory at once, on their way in or out; given up when it goes.
class AdmissionSlot {
 public:
  /// `taken` counts them, and outlives this.
  explicit AdmissionSlot(std::atomic<int>& taken) : taken_(taken) {}
  ~AdmissionSlot() { leave(); }
  AdmissionSlot(const AdmissionSlot&) = delete;
  AdmissionSlot& operator=(const AdmissionSlot&) = delete;

  /// RESOURCE_EXHAUSTED (`reason`, and `limit` as its message names it) where all are taken.
  Status enter(Reason reason, const char* limit, int most) {
    const int before = taken_.fetch_add(1);
    here_ = true;
    if (before < most) return {};
    leave();
    return exhausted(reason, limit,
                     std::string(limit) + ": the server is busy with " + std::to_string(before) +
                         ", allowed at once are " + std::to_string(most) + "; try again in a while")
        .retriedAfter(std::chrono::seconds(1));
  }
  void leave() {
    if (here_.exchange(false)) --taken_;
  }

 private:
  std::atomic<int>& taken_;
  std::atomic<bool> here_{false};
};

}  // namespace lpv::api
