#pragma once

#include <atomic>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "rpc/durability/faults/mirror.h"
#include "rpc/durability/faults/taking_part.h"

namespace lpv::rpc::faults {

/// (epoch, revision): the order of everything that readers are told.
using Position = std::pair<std::uint64_t, std::uint64_t>;

/// Watches the scene, and volumes where wanted, over streams that it opens again where they break. Now and then it
/// stops reading or acknowledging for a while, or goes away.
class Reader {
 public:
  Reader(std::string name, bool volumes, const Part& part);
  ~Reader();
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  /// From now on it reads what comes.
  void calm() { calm_ = true; }
  /// What it has: the scene's or, where it watches volumes too, the older of both.
  Position position() const;
  void stop();

  // After stop().
  const std::vector<Read>& reads() const { return reads_; }
  Mirror mirror() const { return {name_, mirror_.state()}; }

 private:
  void watchScene(Dice& dice);
  void watchVolumes(Dice& dice);
  /// Stops for a while, now and then; false where it goes away.
  bool stays(Dice& dice);
  void record(Read read, Position* position);

  const std::string name_;
  const Part part_;
  const bool volumes_;
  std::atomic<bool> calm_{false};
  std::atomic<bool> stopping_{false};
  SceneMirror mirror_;  ///< the scene's thread's
  mutable std::mutex mutex_;
  std::vector<Read> reads_;
  Position scenePosition_;
  Position volumePosition_;
  std::thread sceneThread_;
  std::thread volumeThread_;
};

}  // namespace lpv::rpc::faults
