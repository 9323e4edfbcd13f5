// Calls for the server, sessions and tokens.

#include <grpcpp/generic/generic_stub.h>

#include <future>

#include "connection.h"
#include "google/protobuf/wrappers.pb.h"
#include "wire/message_size.h"

namespace lpv::client {

const char* version() { return LPV_VERSION; }

Expected<v1::GetServerInfoResponse> Client::serverInfo() {
  return unary(*connection_, *connection_->server, &v1::ServerService::Stub::GetServerInfo, v1::GetServerInfoRequest());
}

Expected<v1::GetStatsResponse> Client::stats() {
  return unary(*connection_, *connection_->server, &v1::ServerService::Stub::GetStats, v1::GetStatsRequest());
}

Expected<bool> Client::healthy(const std::string& service) {
  // The two messages of the health protocol are encoded like StringValue and Int32Value, so no generated code is
// needed.
  using Stub = grpc::TemplatedGenericStub<google::protobuf::StringValue, google::protobuf::Int32Value>;
  Stub stub(connection_->channel);
  Call call(*connection_);
  google::protobuf::StringValue request;
  request.set_value(service);
  google::protobuf::Int32Value response;
  std::promise<grpc::Status> done;
  stub.UnaryCall(&call.context, "/grpc.health.v1.Health/Check", grpc::StubOptions(), &request, &response,
                 [&done](grpc::Status status) { done.set_value(std::move(status)); });
  const grpc::Status status = done.get_future().get();
  if (!status.ok()) return statusFrom(status, address());
  return response.value() == 1;  // SERVING
}

Expected<v1::CreateSessionResponse> Client::createSession(const v1::CreateSessionRequest& request) {
  return unary(*connection_, *connection_->sessions, &v1::SessionService::Stub::CreateSession, request);
}

Expected<v1::Session> Client::session(const std::string& session) {
  v1::GetSessionRequest request;
  request.set_name(sessionName(session));
  auto response = unary(*connection_, *connection_->sessions, &v1::SessionService::Stub::GetSession, request);
  if (!response) return response.status();
  return response->session();
}

Expected<std::vector<v1::Session>> Client::sessions() {
  std::vector<v1::Session> all;
  v1::ListSessionsRequest request;
  request.set_page_size(1000);
  do {
    auto page = unary(*connection_, *connection_->sessions, &v1::SessionService::Stub::ListSessions, request);
    if (!page) return page.status();
    all.insert(all.end(), page->sessions().begin(), page->sessions().end());
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return all;
}

Expected<v1::Session> Client::updateSession(const v1::Session& session, const std::vector<std::string>& paths) {
  v1::UpdateSessionRequest request;
  *request.mutable_session() = session;
  request.mutable_session()->set_name(sessionName(session.name()));
  for (const std::string& path : paths) request.mutable_update_mask()->add_paths(path);
  auto response = unary(*connection_, *connection_->sessions, &v1::SessionService::Stub::UpdateSession, request);
  if (!response) return response.status();
  return response->session();
}

Status Client::deleteSession(const std::string& session) {
  v1::DeleteSessionRequest request;
  request.set_name(sessionName(session));
  return unary(*connection_, *connection_->sessions, &v1::SessionService::Stub::DeleteSession, request).status();
}

Expected<v1::Session> Client::fitSession(const std::string& session) {
  v1::FitSessionRequest request;
  request.set_name(sessionName(session));
  auto response = unary(*connection_, *connection_->sessions, &v1::SessionService::Stub::FitSession, request);
  if (!response) return response.status();
  return response->session();
}

Expected<v1::CreateTokenResponse> Client::createToken(const v1::CreateTokenRequest& request) {
  return unary(*connection_, *connection_->sessions, &v1::SessionService::Stub::CreateToken, request);
}

Expected<std::vector<v1::AccessToken>> Client::tokens(const std::string& session) {
  std::vector<v1::AccessToken> all;
  v1::ListTokensRequest request;
  request.set_session(sessionName(session));
  do {
    auto page = unary(*connection_, *connection_->sessions, &v1::SessionService::Stub::ListTokens, request);
    if (!page) return page.status();
    for (v1::AccessToken& token : *page->mutable_tokens()) all.push_back(std::move(token));
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return all;
}

Status Client::revokeToken(const std::string& session, const std::string& tokenId) {
  v1::RevokeTokenRequest request;
  request.set_session(sessionName(session));
  request.set_token_id(tokenId);
  return unary(*connection_, *connection_->sessions, &v1::SessionService::Stub::RevokeToken, request).status();
}

Status Client::exportSession(const std::string& session, const std::function<bool(const std::string&)>& sink) {
  v1::ExportSessionRequest request;
  request.set_name(sessionName(session));
  Call call(*connection_, timeFor(std::uint64_t(1) << 30U));
  const auto reader = connection_->sessions->ExportSession(&call.context, request);
  v1::ExportSessionResponse part;
  bool wanted = true;
  while (reader->Read(&part)) {
    if (wanted && !sink(part.data())) {
      wanted = false;
      call.context.TryCancel();
    }
  }
  return statusFrom(reader->Finish(), address());
}

Expected<v1::ImportSessionResponse> Client::importSession(const std::string& id, const std::string& file,
                                                          const Progress& progress) {
  Call call(*connection_, timeFor(file.size()));
  v1::ImportSessionResponse response;
  const auto writer = connection_->sessions->ImportSession(&call.context, &response);
  v1::ImportSessionRequest part;
  part.set_session_id(id);
  std::size_t at = 0;
  do {
    part.set_data(file.substr(at, wire::kMaxPartBytes));
    at += part.data().size();
    if (!writer->Write(part)) break;  // Finish says why
    part.clear_session_id();
    if (progress) progress(at, file.size());
  } while (at < file.size());
  writer->WritesDone();
  const grpc::Status status = writer->Finish();
  if (!status.ok()) return statusFrom(status, address());
  return response;
}

}  // namespace lpv::client
