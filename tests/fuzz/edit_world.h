#pragma once
// One session with three members whose every step is also kept by a log, as a store would keep it: seal, unseal, fold.

#include <map>
#include <memory>
#include <set>
#include <string>

#include "fuzz/world.h"
#include "persistence/snapshot.h"
#include "session/memory_journal.h"
#include "session/session.h"

namespace lpv::fuzz {

namespace kept = lpv::store::v1;

/// What a store would have on disk: the snapshot that the log folds into, and the contents that it needs.
class FoldedJournal final : public MemoryJournal {
 public:
  Position create(const SavedSession& state) override;
  Position append(const std::string& session, JournalStep step) override;
  Expected<SavedSession> load(const std::string& session) override;

  /// Lets go of contents that nothing needs any more, as compaction does.
  void compact();
  /// Without members.
  kept::Snapshot snapshot() const;

 private:
  void take(const store::Content& content) { contents_[content.hash] = content; }

  kept::Snapshot snapshot_;
  std::map<std::string, store::Content> contents_;
};

/// A reader that asks for what has changed since it last asked, and what it then believes there is.
class Mirror {
 public:
  void follow(const Session& session);
  /// Aborts where it believes something else than the session shows.
  void compare(const Session& session) const;

 private:
  std::optional<std::uint64_t> revision_;
  std::map<std::string, LightPtr> lights_;
  std::map<std::string, SurfacePtr> surfaces_;
  std::set<std::string> cameras_;
};

/// Lights, surfaces and cameras without the revisions at which they changed.
std::string scene(const Session& session);

}  // namespace lpv::fuzz
