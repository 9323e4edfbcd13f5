#pragma once

#include <atomic>
#include <deque>
#include <optional>
#include <thread>
#include <vector>

#include "rpc/durability/faults/taking_part.h"

namespace lpv::rpc::faults {

/// How a writer sends its edits.
enum class Way { kCalls, kStream };

/// Edits until told to finish. Repeats an edit of unknown outcome with its sequence over a new connection until it
/// knows, but for some that it gives up; repeats now and then what it knows.
class Writer {
 public:
  /// `number` from 1.
  Writer(int number, Way way, Part part, pb::ClientIdentity identity);
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// One edit more, which is not given up, then the end: everything that was done before it is kept when it is
  /// acknowledged.
  void finish() { finishing_ = true; }
  void join() { thread_.join(); }
  /// After join(): whether the last edit was acknowledged.
  bool finished() const { return pending_.empty(); }
  const std::vector<Attempt>& attempts() const { return attempts_; }

 private:
  struct Pending {
    EditId id;
    std::uint64_t removes = 0;
    pb::Edit edit;
    bool givenUp = false;  ///< where its first attempt does not tell
  };

  void run();
  std::optional<Pending> next();
  Attempt begin(const Pending& edit) const;
  void end(Attempt attempt, grpc::StatusCode code, const std::string& message, const pb::EditAck& ack);
  void forgetGivenUp(std::size_t sent);
  void settle(const Pending& edit);

  void callOnce();
  Attempt call(const Pending& edit, std::chrono::milliseconds patience);
  void repeatOne();
  void streamOnce();
  bool takeAnswer(grpc::ClientReaderWriter<pb::StreamEditsRequest, pb::StreamEditsResponse>& stream,
                  std::deque<Attempt>& open);

  const int number_;
  const Way way_;
  const Part part_;
  const pb::ClientIdentity identity_;
  Dice dice_;
  std::unique_ptr<Stubs> stubs_;  ///< of calls; none after a failure
  std::uint64_t sequence_ = 0;
  std::deque<Pending> pending_;         ///< not known, in order
  std::deque<Pending> known_;           ///< acknowledged, the newest few
  std::deque<std::uint64_t> scratch_;   ///< acknowledged, with a scratch light that nobody was asked to delete
  std::vector<Attempt> attempts_;
  std::atomic<bool> finishing_{false};
  bool lastMade_ = false;
  int triesAtTheEnd_ = 0;
  std::thread thread_;
};

}  // namespace lpv::rpc::faults
