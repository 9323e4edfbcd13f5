// lpvd with a fault: edits are acknowledged before they are stored, and storing waits. The fault test has to find it.
// It is lpvd's own main with another store under its feet; lpvd itself has no switch for it.

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "store/sqlite/sqlite_store.h"

namespace lpv::store {

/// A SqliteStore that says "kept" at once, but of a new session and of its first members: what gets lost shall be
/// edits.
class EarlyAckStore final : public Store {
 public:
  static Expected<std::unique_ptr<EarlyAckStore>> open(SqliteOptions options) {
    Expected<std::unique_ptr<SqliteStore>> store = SqliteStore::open(std::move(options));
    if (!store) return store.status();
    return std::make_unique<EarlyAckStore>(std::move(*store));
  }
  explicit EarlyAckStore(std::unique_ptr<SqliteStore> store) : store_(std::move(store)) {}

  void whenDurable(Position position, Kept kept) override {
    if (position <= created_ + kFirstSteps) return store_->whenDurable(position, std::move(kept));
    kept({});
  }
  Position append(const std::string& session, MakeLogRecord step) override {
    return store_->append(session, [last = last_, step = std::move(step)](const HasContent& holds) {
      waitOnce(*last);
      return step(holds);
    });
  }

  lpv::v1::Durability durability() const override { return store_->durability(); }
  Status writable() const override { return store_->writable(); }
  Position create(const Head& head, MakeFullSnapshot whole) override {
    return created_ = store_->create(head, std::move(whole));
  }
  Position setEpoch(const std::string& session, std::uint64_t epoch) override {
    return store_->setEpoch(session, epoch);
  }
  Position touch(const std::string& session, std::chrono::system_clock::time_point used) override {
    return store_->touch(session, used);
  }
  Position remove(const std::string& session) override { return store_->remove(session); }
  Position keepToken(const Token& token) override { return store_->keepToken(token); }
  Position dropToken(const std::string& tokenId) override { return store_->dropToken(tokenId); }
  Status flush() override { return store_->flush(); }
  std::int64_t queued() const override { return store_->queued(); }
  Expected<std::vector<Head>> heads() override { return store_->heads(); }
  Expected<std::vector<Token>> tokens() override { return store_->tokens(); }
  Expected<Loaded> load(const std::string& session, bool withContents) override {
    return store_->load(session, withContents);
  }
  std::uint64_t highestEpoch() override { return store_->highestEpoch(); }

 private:
  using Time = std::chrono::steady_clock::time_point;

  static constexpr Position kFirstSteps = 8;

  /// On the store's thread, within a transaction: of the steps that go into one, the first waits.
  static void waitOnce(Time& last) {
    constexpr std::chrono::milliseconds kWait{100};
    if (std::chrono::steady_clock::now() - last < kWait / 2) return;
    std::this_thread::sleep_for(kWait);
    last = std::chrono::steady_clock::now();
  }

  std::unique_ptr<SqliteStore> store_;
  std::atomic<Position> created_{0};
  std::shared_ptr<Time> last_ = std::make_shared<Time>();  ///< the store's thread's
};

}  // namespace lpv::store

#define SqliteStore EarlyAckStore
#include "app/main.cpp"  // NOLINT(bugprone-suspicious-include): the same program
