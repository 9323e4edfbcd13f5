#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "bench/service_load.h"
#include "lpv/client.h"

namespace lpv::bench {

/// What the watchers see. Nothing before start() is counted, but the stages of the very first frame.
class LoadSeen {
 public:
  void start() { counting_ = true; }
  /// A frame or a volume has come.
  bool any() const { return anyFrame_ || anyVolume_; }
  void acknowledged(std::uint64_t revision);
  void frame(const client::FrameResult& frame);
  void volume();
  /// Writes the numbers that are its own.
  void report(Measured* out);

 private:
  std::atomic<bool> counting_{false};
  std::atomic<bool> anyFrame_{false};
  std::atomic<bool> anyVolume_{false};
  std::atomic<std::uint64_t> newest_{0};
  std::atomic<std::int64_t> volumes_{0};
  std::mutex mutex_;
  std::int64_t frames_ = 0;
  double bytes_ = 0.0;
  std::vector<double> behind_;
  std::map<std::string, std::vector<double>> stages_;
  std::map<std::string, double> firstFrame_;
};

}  // namespace lpv::bench
