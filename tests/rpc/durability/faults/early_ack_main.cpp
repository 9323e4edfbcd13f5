// lpvd with a fault: edits are acknowledged before they are stored, and storing waits. The fault test has to find it.
// It is lpvd's own main with another journal under its feet; lpvd itself has no switch for it.

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "persistence/persistent_journal.h"

namespace lpv::api {

/// A PersistentJournal that says "kept" at once, but of a new session and of its first members: what gets lost shall be
/// edits.
class EarlyAckJournal final : public PersistentJournal {
 public:
  explicit EarlyAckJournal(store::CommitQueue& queue) : PersistentJournal(queue), slow_(queue) {}

  void whenDurable(const std::string& session, Position position, std::function<void(const Status&)> kept) override {
    if (position <= created_ + kFirstSteps) return PersistentJournal::whenDurable(session, position, std::move(kept));
    kept({});
  }
  Position append(const std::string& session, JournalStep step) override {
    slow_.push(session, [last = last_](store::Backend&) {
      waitOnce(*last);
      return store::Written(Status());
    });
    return PersistentJournal::append(session, std::move(step));
  }
  Position create(const SavedSession& state) override { return created_ = PersistentJournal::create(state); }

 private:
  using Time = std::chrono::steady_clock::time_point;

  static constexpr Position kFirstSteps = 16;  ///< two a step: the wait and the step

  /// On the queue's thread, within a transaction: of the steps that go into one, the first waits.
  static void waitOnce(Time& last) {
    constexpr std::chrono::milliseconds kWait{100};
    if (std::chrono::steady_clock::now() - last < kWait / 2) return;
    std::this_thread::sleep_for(kWait);
    last = std::chrono::steady_clock::now();
  }

  store::CommitQueue& slow_;
  std::atomic<Position> created_{0};
  std::shared_ptr<Time> last_ = std::make_shared<Time>();  ///< the queue's thread's
};

}  // namespace lpv::api

#define PersistentJournal EarlyAckJournal
#include "app/main.cpp"  // NOLINT(bugprone-suspicious-include): the same program
