#pragma once
// Says from a history alone whether the service kept its word.

#include <string>
#include <vector>

#include "rpc/durability/faults/history.h"

namespace lpv::rpc::faults {

enum class Fault {
  kLost,            ///< an acknowledged edit is missing from the final state
  kTwice,           ///< an edit was done more than once
  kOutcomeChanged,  ///< a repeated sequence got another answer than its first, or the final state says another
  kRefusedButDone,
  kInPart,          ///< some of an edit's operations were done, others not
  kOutOfOrder,      ///< an edit stands before one that was acknowledged before it was sent
  kBackwards,       ///< a reader saw (epoch, revision) fall
  kGap,             ///< a reader was told a change that does not follow what it had
  kStale,           ///< a reader that came after an acknowledgement was shown an older revision
  kMirrorsDiffer,  ///< two hold different scenes at the same (epoch, revision), or a reader's end is not the server's
};

struct Violation {
  Fault fault;
  std::string what;
};

/// Everything that is wrong; empty where nothing is. An edit of unknown outcome may have been done or not.
std::vector<Violation> check(const History& history);

/// A line for each, at most `most` of them.
std::string describe(const std::vector<Violation>& violations, std::size_t most = 20);

}  // namespace lpv::rpc::faults
