#pragma once
// A session of one server, four writers, four readers, and faults in an order that a seed decides.

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "rpc/durability/faults/history.h"
#include "rpc/durability/faults/service.h"

namespace lpv::rpc::faults {

struct RunOptions {
  std::uint64_t seed = 1;
  std::chrono::milliseconds length{10'000};  ///< of faults
  bool kills = true;  ///< else the server lives through it, and only connections and readers suffer
  std::uint64_t mostEdits = 0;  ///< of each writer; 0: as many as it manages
};

/// What a run did, for people.
struct Tally {
  int kills = 0;
  int otherFaults = 0;
  std::size_t accepted = 0;
  std::size_t unknown = 0;
  std::size_t repeated = 0;  ///< acknowledged again
  std::size_t reads = 0;
  void add(const Tally& other);
};

/// Runs in a session of its own and deletes it. `service` is running before and afterwards.
History run(Service& service, const RunOptions& options, Tally* tally);

}  // namespace lpv::rpc::faults
