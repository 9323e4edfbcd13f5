#include "api/convert_session.h"
#include "api/paging.h"
#include "api/services.h"

namespace lpv::api {

Expected<SessionPtr> findSession(Context& context, const std::string& field, const std::string& name) {
  const Expected<std::string> id = sessionId(field, name);
  if (!id) return id.status();
  return context.registry->find(*id);
}

Status createSession(Context& context, const pb::CreateSessionRequest& request, pb::CreateSessionResponse* response) {
  const Expected<Settings> settings = fromProto(request.settings());
  if (!settings) return settings.status();
  const Expected<SessionPtr> session =
      context.registry->create(request.session_id(), settings->options, settings->manners, request.request_id());
  if (!session) return session.status();
  toProto((*session)->summary(), response->mutable_session());
  return {};
}

Status getSession(Context& context, const pb::GetSessionRequest& request, pb::GetSessionResponse* response) {
  const Expected<SessionPtr> session = findSession(context, "name", request.name());
  if (!session) return session.status();
  toProto((*session)->summary(), response->mutable_session());
  return {};
}

Status listSessions(Context& context, const pb::ListSessionsRequest& request, pb::ListSessionsResponse* response) {
  const std::vector<SessionPtr> sessions = context.registry->all();
  return page(
      request, sessions, [](const SessionPtr& session) { return session->id(); },
      [&](const SessionPtr& session) { toProto(session->summary(), response->add_sessions()); },
      response->mutable_next_page_token());
}

Status updateSession(Context& context, const pb::UpdateSessionRequest& request, pb::UpdateSessionResponse* response) {
  const Expected<SessionPtr> session = findSession(context, "session.name", request.session().name());
  if (!session) return session.status();
  const SessionSummary now = (*session)->summary();
  const Expected<Settings> settings =
      withMask({now.options, {now.ttl, now.displayName}}, request.session().settings(), request.update_mask());
  if (!settings) return settings.status();
  if (Status s = (*session)->setOptions(settings->options, settings->manners); !s.ok()) return s;
  toProto((*session)->summary(), response->mutable_session());
  return {};
}

Status deleteSession(Context& context, const pb::DeleteSessionRequest& request, pb::DeleteSessionResponse*) {
  const Expected<std::string> id = sessionId("name", request.name());
  return id ? context.registry->remove(*id) : id.status();
}

Status fitSession(Context& context, const pb::FitSessionRequest& request, pb::FitSessionResponse* response) {
  const Expected<SessionPtr> session = findSession(context, "name", request.name());
  if (!session) return session.status();
  Edit edit;
  edit.operations.emplace_back(FitGrid{});
  const EditOutcome outcome = (*session)->apply({}, std::move(edit));
  if (!outcome.status.ok()) return outcome.status;
  toProto((*session)->summary(), response->mutable_session());
  return {};
}

Status joinSession(Context& context, const pb::JoinSessionRequest& request, pb::JoinSessionResponse* response) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return session.status();
  const Expected<ClientIdentity> client = (*session)->join();
  if (!client) return client.status();
  response->mutable_client()->set_client_id(client->id);
  response->mutable_client()->set_secret(client->secret);
  toProto((*session)->summary(), response->mutable_session());
  return {};
}

Status leaveSession(Context& context, const pb::LeaveSessionRequest& request, pb::LeaveSessionResponse*) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return session.status();
  if (Status s = (*session)->verify(fromProto(request.client())); !s.ok()) return s;
  (*session)->leave(fromProto(request.client()));
  return {};
}

}  // namespace lpv::api
