#pragma once

#include "session/journal.h"
#include "store/store.h"

namespace lpv::api {

/// A journal in a store: turns what sessions say into messages, on the store's thread, and back.
class PersistentJournal final : public Journal {
 public:
  /// `store` outlives this.
  explicit PersistentJournal(store::Store& store) : store_(store) {}

  Durability durability() const override;
  Status writable() const override { return store_.writable(); }
  Position create(const SavedSession& state) override;
  Position append(const std::string& session, JournalStep step) override;
  Position setEpoch(const std::string& session, std::uint64_t epoch) override {
    return store_.setEpoch(session, epoch);
  }
  Position touch(const std::string& session, std::chrono::system_clock::time_point used) override {
    return store_.touch(session, used);
  }
  Position remove(const std::string& session) override { return store_.remove(session); }
  Position keepToken(const AccessToken& token) override;
  Position dropToken(const std::string& tokenId) override { return store_.dropToken(tokenId); }
  void whenDurable(Position position, std::function<void(const Status&)> kept) override {
    store_.whenDurable(position, std::move(kept));
  }
  Status flush() override { return store_.flush(); }
  Expected<std::vector<KeptSession>> kept() override;
  Expected<std::vector<AccessToken>> tokens() override;
  Expected<SavedSession> load(const std::string& session) override;
  Expected<SessionSummary> summary(const std::string& session) override;
  std::uint64_t highestEpoch() override { return store_.highestEpoch(); }

 private:
  store::Store& store_;
};

}  // namespace lpv::api
