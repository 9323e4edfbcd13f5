#pragma once
// lpvctl as a member of sessions. Every run is a process of its own, but what one did the next can undo: the identity
// that a session issued is kept in $XDG_STATE_HOME/lpvctl (~/.local/state/lpvctl), readable by the user alone.

#include <functional>
#include <string>

#include "lpv/editor.h"

namespace lpv::cli {

/// Calls `act` as the member that this user's lpvctl is in the session; joins where it is none yet, or the session does
/// not know it any more. Where it cannot join, or not keep the identity, it acts as nobody: edits work, undo does not.
Status asMember(const client::Client& client, const std::string& session,
                const std::function<Status(client::Editor&)>& act);

}  // namespace lpv::cli
