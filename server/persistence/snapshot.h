#pragma once
// Sessions to lpv.store.v1 and back. What comes back is checked like an upload: a file may be anybody's.

#include <map>

#include "session/journal.h"
#include "store/backend.h"

namespace lpv::api {

namespace kept = lpv::store::v1;

/// A step with the content that it brings and `holds` does not name. May take as long as serialising a mesh does.
store::LogRecord toStep(const JournalStep& step, const store::HasContent& holds);
/// Without contents.
kept::Snapshot toSnapshot(const SavedSession& state);
/// What `snapshot`'s objects and uploads are made of, each once.
std::vector<store::Content> contentsOf(const SavedSession& state);

/// The session that was kept; DATA_LOSS where content is missing, does not parse or is not what its hash says, where an
/// object's fields are out of range, and where the settings cannot be used.
Expected<SavedSession> fromStore(const store::Loaded& loaded);
/// In numbers.
Expected<SessionSummary> summaryOf(const store::Loaded& loaded);

}  // namespace lpv::api
