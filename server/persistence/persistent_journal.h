#pragma once

#include "session/journal.h"
#include "store/commit_queue.h"

namespace lpv::api {

/// A journal in a store: turns what sessions say into changes of the store's tables, on the queue's thread, and back.
class PersistentJournal : public Journal {
 public:
  /// `queue` outlives this.
  explicit PersistentJournal(store::CommitQueue& queue) : queue_(queue) {}

  Durability durability() const override;
  Status available() const override { return queue_.available(); }
  Status writable(const std::string& session) const override { return queue_.writable(session); }
  Position create(const SavedSession& state) override;
  Position append(const std::string& session, JournalStep step) override;
  Position setEpoch(const std::string& session, std::uint64_t epoch) override;
  Position touch(const std::string& session, std::chrono::system_clock::time_point used) override;
  Position remove(const std::string& session) override;
  Position keepToken(const AccessToken& token) override;
  Position dropToken(const std::string& session, const std::string& tokenId) override;
  void whenDurable(const std::string& session, Position position, std::function<void(const Status&)> kept) override;
  Status flush() override { return queue_.flush(); }
  Expected<std::vector<SessionHead>> heads() override { return queue_.heads(); }
  Expected<std::vector<AccessToken>> tokens() override { return queue_.tokens(); }
  Expected<SavedSession> load(const std::string& session) override;
  Expected<SessionSummary> summary(const std::string& session) override;
  std::uint64_t highestEpoch() override { return queue_.highestEpoch(); }

 private:
  store::CommitQueue& queue_;
};

}  // namespace lpv::api
