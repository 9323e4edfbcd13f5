#include "api/call/method_table.h"
#include "api/call/paging.h"
#include "api/services.h"
#include "convert/presence.h"
#include "convert/session.h"

namespace lpv::api {

Expected<SessionPtr> findSession(const Context& context, const std::string& field, const std::string& name) {
  const Expected<std::string> id = sessionId(field, name);
  if (!id) return id.status();
  return context.registry->find(*id);
}

namespace {

/// The session as the answer to a call, where what it waited for is kept.
template <typename Response>
Done answer(const SessionPtr& session, Response* response, Done done) {
  session->updateForecast();
  return [session, response, done = std::move(done)](const Status& kept) {
    if (kept.ok()) toProto(session->summary(), response->mutable_session());
    done(kept);
  };
}

template <typename Response>
void answerWhenKept(const SessionPtr& session, Response* response, Done done) {
  session->whenDurable(answer(session, response, std::move(done)));
}

}  // namespace

void createSession(const Context& context, const pb::CreateSessionRequest& request, pb::CreateSessionResponse* response,
                   Done done) {
  const Expected<SessionSettings> settings = fromProto(request.settings());
  if (!settings) return done(settings.status());
  const Expected<SessionPtr> session =
      context.registry->create(request.session_id(), settings->options, settings->policy, request.request_id());
  if (!session) return done(session.status());
  const Expected<MintedToken> token = ownerToken(context, (*session)->id());
  if (!token) return done(token.status());
  response->set_owner_token(token->token);
  whenBothKept(context, *session, *token, answer(*session, response, std::move(done)));
}

Status getSession(const Context& context, const pb::GetSessionRequest& request, pb::GetSessionResponse* response) {
  const Expected<SessionPtr> session = findSession(context, "name", request.name());
  if (!session) return session.status();
  (*session)->updateForecast();
  toProto((*session)->summary(), response->mutable_session());
  return {};
}

Status listSessions(const Context& context, const pb::ListSessionsRequest& request,
                    pb::ListSessionsResponse* response) {
  std::vector<SessionSummary> sessions = context.registry->summaries();
  std::erase_if(sessions, [&](const auto& each) { return !allow(context, each.id, Role::kViewer).ok(); });
  return page(
      request, sessions, [](const SessionSummary& session) { return session.id; },
      [&](const SessionSummary& session) { toProto(session, response->add_sessions()); },
      response->mutable_next_page_token());
}

void updateSession(const Context& context, const pb::UpdateSessionRequest& request, pb::UpdateSessionResponse* response,
                   Done done) {
  const Expected<SessionPtr> session = findSession(context, "session.name", request.session().name());
  if (!session) return done(session.status());
  const Status changed = (*session)->changeSettings(
      [&](const SessionSettings& now) { return withMask(now, request.session().settings(), request.update_mask()); });
  if (!changed.ok()) return done(changed);
  answerWhenKept(*session, response, std::move(done));
}

void deleteSession(const Context& context, const pb::DeleteSessionRequest& request, pb::DeleteSessionResponse*,
                   Done done) {
  const Expected<std::string> id = sessionId("name", request.name());
  if (!id) return done(id.status());
  context.registry->remove(*id, std::move(done));
}

void fitSession(const Context& context, const pb::FitSessionRequest& request, pb::FitSessionResponse* response,
                Done done) {
  const Expected<SessionPtr> session = findSession(context, "name", request.name());
  if (!session) return done(session.status());
  Edit edit;
  edit.operations.emplace_back(FitGrid{});
  const EditOutcome outcome = (*session)->apply({}, std::move(edit));
  if (!outcome.status.ok()) return done(outcome.status);
  answerWhenKept(*session, response, std::move(done));
}

void joinSession(const Context& context, const pb::JoinSessionRequest& request, pb::JoinSessionResponse* response,
                 Done done) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return done(session.status());
  const Expected<ClientIdentity> client = (*session)->join(fromProto(request));
  if (!client) return done(client.status());
  response->mutable_client()->set_client_id(client->id);
  response->mutable_client()->set_secret(client->secret);
  answerWhenKept(*session, response, std::move(done));
}

void leaveSession(const Context& context, const pb::LeaveSessionRequest& request, pb::LeaveSessionResponse*,
                  Done done) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return done(session.status());
  if (Status s = (*session)->verify(fromProto(request.client())); !s.ok()) return done(s);
  (*session)->leave(fromProto(request.client()));
  (*session)->whenDurable(std::move(done));
}

Status updatePresence(const Context& context, const pb::UpdatePresenceRequest& request, pb::UpdatePresenceResponse*) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return session.status();
  const Expected<PresenceUpdate> update = fromProto(request.presence());
  if (!update) return update.status().within("presence");
  return (*session)->present(fromProto(request.client()), *update);
}

std::vector<Method> sessionMethods() {
  return {
      {"SessionService.CreateSession", Role::kAdmin, "session_id", handler(createSession), "create", "session.name"},
      {"SessionService.GetSession", Role::kViewer, "name", handler(getSession)},
      {"SessionService.ListSessions", Role::kViewer, "", handler(listSessions)},
      {"SessionService.UpdateSession", Role::kEditor, "session.name", handler(updateSession)},
      {"SessionService.DeleteSession", Role::kOwner, "name", handler(deleteSession), "delete"},
      {"SessionService.FitSession", Role::kEditor, "name", handler(fitSession)},
      {"SessionService.JoinSession", Role::kViewer, "session", handler(joinSession)},
      {"SessionService.LeaveSession", Role::kViewer, "session", handler(leaveSession)},
      {"SessionService.UpdatePresence", Role::kViewer, "session", handler(updatePresence)},
      {"SessionService.CreateToken", Role::kOwner, "session", handler(createToken), "share"},
      {"SessionService.RevokeToken", Role::kOwner, "session", handler(revokeToken), "revoke"},
      {"SessionService.ListTokens", Role::kOwner, "session", handler(listTokens), "tokens"},
      {"SessionService.ExportSession", Role::kViewer, "name", handler(exportSession)},
      {"SessionService.ImportSession", Role::kAdmin, "session_id", handler(importSession), "import", "session.name"},
  };
}

}  // namespace lpv::api
