#include "persistence/persistent_journal.h"

#include "persistence/snapshot.h"

namespace lpv::api {

using store::Backend;

Durability PersistentJournal::durability() const {
  return queue_.durability() == lpv::v1::DURABILITY_DISK ? Durability::kDisk : Durability::kMemory;
}

Position PersistentJournal::create(const SavedSession& state) {
  const SessionHead head{state.id, state.epoch, state.requestId, state.created, state.created, state.policy.ttl};
  return queue_.takeOver(state.id, [head, state](Backend& tables) {
    return tables.create(head, {toSnapshot(state), contentsOf(state)});
  });
}

Position PersistentJournal::append(const std::string& session, JournalStep step) {
  return queue_.push(session, [session, step = std::move(step)](Backend& tables) {
    return tables.append(session, [&step](const store::HasContent& holds) { return toStep(step, holds); });
  });
}

Position PersistentJournal::setEpoch(const std::string& session, std::uint64_t epoch) {
  return queue_.takeOver(session, [session, epoch](Backend& tables) { return tables.setEpoch(session, epoch); });
}

Position PersistentJournal::touch(const std::string& session, std::chrono::system_clock::time_point used) {
  return queue_.push(session, [session, used](Backend& tables) { return tables.touch(session, used); });
}

Position PersistentJournal::remove(const std::string& session) {
  return queue_.push(session, [session](Backend& tables) { return tables.remove(session); });
}

Position PersistentJournal::keepToken(const AccessToken& token) {
  return queue_.push(token.session, [token](Backend& tables) { return tables.keepToken(token); });
}

Position PersistentJournal::dropToken(const std::string& session, const std::string& tokenId) {
  return queue_.push(session, [tokenId](Backend& tables) { return tables.dropToken(tokenId); });
}

void PersistentJournal::whenDurable(const std::string& session, Position position,
                                    std::function<void(const Status&)> kept) {
  queue_.whenDurable(session, position, std::move(kept));
}

Expected<SavedSession> PersistentJournal::load(const std::string& session) {
  const Expected<store::Loaded> loaded = queue_.load(session, true);
  return loaded ? fromStore(*loaded) : loaded.status();
}

Expected<SessionSummary> PersistentJournal::summary(const std::string& session) {
  const Expected<store::Loaded> loaded = queue_.load(session, false);
  return loaded ? summaryOf(*loaded) : loaded.status();
}

}  // namespace lpv::api
