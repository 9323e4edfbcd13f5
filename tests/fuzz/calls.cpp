#include "fuzz/calls.h"

#include <utility>
#include <vector>

#include "api/call/admission.h"
#include "api/call/method_table.h"
#include "convert/blob_content.h"
#include "fuzz/check.h"
#include "fuzz/message_input.h"
#include "reference/meshes.h"

namespace lpv::fuzz {

using google::protobuf::Message;
namespace pb = lpv::v1;

namespace {

/// What the call driver says to the role of whoever makes a call, before its handler sees it.
Status allowed(const Message& request, const api::Context& context) {
  return api::authorize(context, *api::methodOf(*request.GetDescriptor()), request);
}

/// Messages that one stream gives at once, at most: a watcher of an engine that is done at once never runs dry.
constexpr int kMostMessages = 20;

}  // namespace

template <typename Request, typename Response>
class Caller::Flow final : public OpenStream {
 public:
  Flow(Caller& caller, api::StreamPtr<Request, Response> stream) : caller_(caller), stream_(std::move(stream)) {}

  void receive(const Request& request) {
    if (stream_->wantsRead()) stream_->receive(request);
  }
  bool drain() override {
    for (int i = 0; i < kMostMessages; ++i) {
      Response response;
      if (!stream_->next(&response)) break;
      caller_.answered({}, &response);
    }
    const std::optional<Status> ended = stream_->ended();
    if (ended) caller_.answered(*ended, nullptr);
    return !ended;
  }
  void halfClose() override { stream_->halfClosed(); }
  void cancel() override { stream_->cancelled(); }

 private:
  Caller& caller_;
  api::StreamPtr<Request, Response> stream_;
};

Caller::~Caller() {
  for (const auto& [type, stream] : streams_) stream->halfClose();
  machinery().settle();
  for (const auto& [type, stream] : streams_) {
    if (stream->drain()) stream->cancel();
  }
  machinery().settle();
  streams_.clear();
}

/// Whatever an answer contains, a client's library can read it.
void Caller::answered(const Status& status, Message* response) {
  if (!status.ok()) {
    checkRefusal(status);
    refused_ = true;
  }
  if (!response) return;
  const std::unique_ptr<Message> read(response->New());
  check(read->ParseFromString(response->SerializeAsString()), "an answer can be read: " + response->ShortDebugString());
  for (Message* message : everyMessage(response)) {
    if (const auto* ack = dynamic_cast<const pb::EditAck*>(message)) {
      refused_ = refused_ || ack->status().code() != 0;
      check((ack->status().code() != 0) == !ack->status().message().empty(), "a refused edit says why");
    }
    if (const auto* subscribed = dynamic_cast<const pb::Subscribed*>(message)) subscriber_ = subscribed->subscriber();
    if (const auto* made = dynamic_cast<const pb::CreateTokenResponse*>(message)) token_ = made->token_id();
    if (const auto* file = dynamic_cast<const pb::ExportSessionResponse*>(message)) exported_ = file->data();
  }
}

void Caller::fillIn(Message* call) const {
  static const std::string pyramid = api::meshBytes(*reference::pyramid());
  for (Message* message : everyMessage(call)) {
    if (auto* identity = dynamic_cast<pb::ClientIdentity*>(message); identity && identity->secret().empty()) {
      const ClientIdentity& member = identity->client_id() == "b" ? world_.b() : world_.a();
      if (identity->client_id() != "a" && identity->client_id() != "b") continue;
      identity->set_client_id(member.id);
      identity->set_secret(member.secret);
    }
    if (auto* update = dynamic_cast<pb::UpdateSubscriptionRequest*>(message); update && update->subscriber() == "it") {
      update->set_subscriber(subscriber_);
    }
    if (auto* pick = dynamic_cast<pb::PickRequest*>(message); pick && pick->subscriber() == "it") {
      pick->set_subscriber(subscriber_);
    }
    if (auto* token = dynamic_cast<pb::RevokeTokenRequest*>(message); token && token->token_id() == "it") {
      token->set_token_id(token_);
    }
    if (auto* file = dynamic_cast<pb::ImportSessionRequest*>(message); file && file->data() == "it") {
      file->set_data(exported_);
    }
    if (auto* upload = dynamic_cast<pb::UploadBlobRequest*>(message); upload && upload->data() == "it") {
      upload->set_data(pyramid);
      upload->mutable_header()->set_size(std::int64_t(pyramid.size()));
    }
  }
}

void Caller::make(Call call) {
  finishUploads(call.request_case());
  fillIn(&call);
  Call read;  // as a door does: from bytes
  if (!read.ParseFromString(call.SerializeAsString())) return;
  const std::string before = world_.content();
  refused_ = false;
  dispatch(read, world_.contextOf(read.role() == pb::ROLE_UNSPECIFIED ? Role::kAdmin : Role(read.role())));
  machinery().settle();
  if (last_ && !last_->drain()) forget(last_);
  check(!refused_ || world_.content() == before, "what is refused changes nothing: " + read.ShortDebugString());
  last_ = nullptr;
  drainAll();
}

void Caller::forget(const OpenStream* gone) {
  std::erase_if(streams_, [gone](const auto& entry) { return entry.second.get() == gone; });
}

void Caller::drainAll() {
  std::erase_if(streams_, [](const auto& entry) { return !entry.second->drain(); });
}

/// Uploads and imports are over when something else comes.
void Caller::finishUploads(Call::RequestCase next) {
  const auto finish = [&](Call::RequestCase kind) {
    const auto found = streams_.find(kind);
    if (next != kind && found != streams_.end()) found->second->halfClose();
  };
  finish(Call::kUploadBlob);
  finish(Call::kImportSession);
  machinery().settle();
  drainAll();
}

template <typename Request, typename Response>
void Caller::ask(Status (*function)(const api::Context&, const Request&, Response*), const Request& request,
                 const api::Context& context) {
  if (const Status status = allowed(request, context); !status.ok()) return answered(status, nullptr);
  Response response;
  const Status status = function(context, request, &response);
  answered(status, status.ok() ? &response : nullptr);
}

template <typename Request, typename Response>
void Caller::askLater(void (*function)(const api::Context&, const Request&, Response*, api::Done),
                      const Request& request, const api::Context& context) {
  if (const Status status = allowed(request, context); !status.ok()) return answered(status, nullptr);
  Response response;
  int answers = 0;
  function(context, request, &response, [&](const Status& status) {
    ++answers;
    answered(status, status.ok() ? &response : nullptr);
  });
  check(answers == 1, "a call is answered once, at once where nothing is kept on disk");
}

template <typename Request, typename Response>
void Caller::say(Call::RequestCase kind, api::StreamPtr<Request, Response> (*open)(const api::Context&),
                 const Request& request, const api::Context& context) {
  std::unique_ptr<OpenStream>& place = streams_[kind];
  if (!place) {
    if (const Status status = allowed(request, context); !status.ok()) {
      streams_.erase(kind);
      return answered(status, nullptr);
    }
    place = std::make_unique<Flow<Request, Response>>(*this, open(context));
  }
  last_ = place.get();
  static_cast<Flow<Request, Response>&>(*place).receive(request);
}

void Caller::dispatch(const Call& call, const api::Context& context) {
  const Call::RequestCase kind = call.request_case();
  switch (kind) {
#define LPV_ASK(how, Case, name, function) \
  case Call::k##Case:                      \
    return how(&api::function, call.name(), context)
    LPV_ASK(ask, GetServerInfo, get_server_info, getServerInfo);
    LPV_ASK(ask, GetStats, get_stats, getStats);
    LPV_ASK(askLater, CreateSession, create_session, createSession);
    LPV_ASK(ask, GetSession, get_session, getSession);
    LPV_ASK(ask, ListSessions, list_sessions, listSessions);
    LPV_ASK(askLater, UpdateSession, update_session, updateSession);
    LPV_ASK(askLater, DeleteSession, delete_session, deleteSession);
    LPV_ASK(askLater, FitSession, fit_session, fitSession);
    LPV_ASK(askLater, JoinSession, join_session, joinSession);
    LPV_ASK(askLater, LeaveSession, leave_session, leaveSession);
    LPV_ASK(ask, UpdatePresence, update_presence, updatePresence);
    LPV_ASK(askLater, CreateToken, create_token, createToken);
    LPV_ASK(askLater, RevokeToken, revoke_token, revokeToken);
    LPV_ASK(ask, ListTokens, list_tokens, listTokens);
    LPV_ASK(ask, FindBlobs, find_blobs, findBlobs);
    LPV_ASK(askLater, ApplyEdit, apply_edit, applyEdit);
    LPV_ASK(ask, ListLights, list_lights, listLights);
    LPV_ASK(ask, ListSurfaces, list_surfaces, listSurfaces);
    LPV_ASK(ask, ListCameras, list_cameras, listCameras);
    LPV_ASK(askLater, Undo, undo, undo);
    LPV_ASK(askLater, Redo, redo, redo);
    LPV_ASK(ask, LockObjects, lock_objects, lockObjects);
    LPV_ASK(ask, UpdateSubscription, update_subscription, updateSubscription);
    LPV_ASK(ask, Pick, pick, pick);
#undef LPV_ASK
#define LPV_SAY(Case, name, function) \
  case Call::k##Case:                 \
    return say(kind, &api::function, call.name(), context)
    LPV_SAY(ExportSession, export_session, exportSession);
    LPV_SAY(ImportSession, import_session, importSession);
    LPV_SAY(UploadBlob, upload_blob, uploadBlob);
    LPV_SAY(ReadBlob, read_blob, readBlob);
    LPV_SAY(StreamEdits, stream_edits, streamEdits);
    LPV_SAY(WatchScene, watch_scene, watchScene);
    LPV_SAY(WatchVolume, watch_volume, watchVolume);
    LPV_SAY(StreamVolume, stream_volume, streamVolume);
    LPV_SAY(WatchFrames, watch_frames, watchFrames);
    LPV_SAY(StreamFrames, stream_frames, streamFrames);
    LPV_SAY(GetVolume, get_volume, getVolume);
    LPV_SAY(GetFrame, get_frame, getFrame);
    LPV_SAY(Probe, probe, probe);
    LPV_SAY(StreamProbe, stream_probe, streamProbe);
#undef LPV_SAY
    case Call::REQUEST_NOT_SET:
      return;
  }
}

}  // namespace lpv::fuzz
