#pragma once
// lpvctl as a member of sessions. Each run is a separate process; so that one run can undo what an earlier one did, the
// identity that a session issued is stored in $XDG_STATE_HOME/lpvctl (~/.local/state/lpvctl), readable by the user
// only.

#include <functional>
#include <string>

#include "lpv/editor.h"

namespace lpv::cli {

/// Calls `act` with the stored identity of this user in the session. Joins first if there is none, or if the session
/// does not know it any more. If joining or storing the identity fails, `act` runs without one: edits work, undo does
/// not.
Status asMember(const client::Client& client, const std::string& session,
                const std::function<Status(client::Editor&)>& act);

}  // namespace lpv::cli
