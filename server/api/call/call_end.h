#pragma once
// What a call leaves behind: a count of what was refused, an audit line, a line in the debug log.

#include <string>

#include "api/call/method.h"

namespace lpv::api {

/// Counts and logs the end of a call, within its LogScope. `sent`: it has sent something before, so that an error is no
/// refusal. `response` names the session where the call made one.
void recordEnd(const Context& context, const Method& method, const Status& status, bool sent,
               const google::protobuf::Message& response);

/// "sessions/room" without what is the same in all names, cut to what ids can have.
std::string shortId(const std::string& session);

}  // namespace lpv::api
