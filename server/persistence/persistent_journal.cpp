#include "persistence/persistent_journal.h"

#include "convert/session.h"
#include "persistence/snapshot.h"

namespace lpv::api {

Durability PersistentJournal::durability() const {
  return store_.durability() == lpv::v1::DURABILITY_DISK ? Durability::kDisk : Durability::kMemory;
}

Position PersistentJournal::create(const SavedSession& state) {
  const store::Head head{state.id, state.epoch, state.requestId, state.created, state.created, state.policy.ttl};
  return store_.create(head, [state] { return store::FullSnapshot{toSnapshot(state), contentsOf(state)}; });
}

Position PersistentJournal::append(const std::string& session, JournalStep step) {
  return store_.append(session,
                       [step = std::move(step)](const store::HasContent& holds) { return toStep(step, holds); });
}

Position PersistentJournal::keepToken(const AccessToken& token) {
  return store_.keepToken({token.id, token.session, toProto(token.role), token.hash, token.expires});
}

Expected<std::vector<AccessToken>> PersistentJournal::tokens() {
  const Expected<std::vector<store::Token>> kept = store_.tokens();
  if (!kept) return kept.status();
  std::vector<AccessToken> out;
  for (const store::Token& token : *kept) {
    const Expected<Role> role = roleOf(token.role);
    if (!role) return Status(Code::kDataLoss, "the state directory has a token of an unknown role: " + token.id);
    out.push_back({token.id, token.session, *role, token.hash, token.expires});
  }
  return out;
}

Expected<std::vector<KeptSession>> PersistentJournal::kept() {
  const Expected<std::vector<store::Head>> heads = store_.heads();
  if (!heads) return heads.status();
  std::vector<KeptSession> out;
  for (const store::Head& head : *heads) {
    out.push_back({head.id, head.requestId, head.created, head.lastUsed, head.ttl});
  }
  return out;
}

Expected<SavedSession> PersistentJournal::load(const std::string& session) {
  const Expected<store::Loaded> loaded = store_.load(session, true);
  return loaded ? fromStore(*loaded) : loaded.status();
}

Expected<SessionSummary> PersistentJournal::summary(const std::string& session) {
  const Expected<store::Loaded> loaded = store_.load(session, false);
  return loaded ? summaryOf(*loaded) : loaded.status();
}

}  // namespace lpv::api
