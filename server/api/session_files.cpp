// Sessions as files: what lpv.store.v1 keeps of them, sealed like a snapshot.

#include <set>

#include "api/call/admission_slot.h"
#include "api/call/deadline.h"
#include "api/call/reader_patience.h"
#include "api/services.h"
#include "convert/session.h"
#include "persistence/snapshot.h"
#include "store/envelope.h"
#include "wire/message_size.h"

namespace lpv::api {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t(1) << 30U;

Status tooLarge(std::size_t bytes) {
  return exhausted(Reason::kMaxSessionFileBytes, "data",
                   "max_session_file_bytes: the session's file has " + std::to_string(bytes) +
                       " bytes or more, allowed are " + std::to_string(kMaxFileBytes));
}

/// What a session's file is made of.
struct FileParts {
  kept::SessionFile snapshot;  ///< alone
  std::vector<store::Content> contents;
  std::size_t bytes = 0;  ///< of the file, at most
};

FileParts filePartsOf(const SavedSession& state) {
  constexpr std::size_t kFieldBytes = 128;  // hash, kind, lengths
  FileParts out;
  *out.snapshot.mutable_snapshot() = toSnapshot(state);
  out.contents = contentsOf(state);
  out.bytes = out.snapshot.ByteSizeLong() + store::kEnvelopeBytes;
  for (const store::Content& content : out.contents) out.bytes += content.bytes->size() + kFieldBytes;
  return out;
}

/// Written part by part, each of which is let go of: serialised messages of one type that follow each other are one.
std::string fileOf(FileParts parts) {
  std::string file;
  file.reserve(parts.bytes);
  parts.snapshot.AppendToString(&file);
  for (store::Content& content : parts.contents) {
    kept::SessionFile one;
    kept::Content* out = one.add_contents();
    out->set_hash(content.hash);
    out->set_kind(content.kind);
    out->set_bytes(*content.bytes);
    content.bytes = nullptr;
    one.AppendToString(&file);
  }
  return store::sealSerialized(std::move(file));
}

/// What a session of this server may hold.
Status checkLimits(const SavedSession& state, const Limits& limits) {
  Blobs room(limits);
  for (const store::Content& content : contentsOf(state)) {
    if (std::int64_t(content.bytes->size()) <= limits.maxBlobBytes) continue;
    return exhausted(Reason::kMaxBlobBytes, "data",
                     "max_blob_bytes: content " + content.hash + " has " + std::to_string(content.bytes->size()) +
                         " bytes, allowed are " + std::to_string(limits.maxBlobBytes));
  }
  for (const BlobPtr& blob : state.uploads) {
    const Expected<bool> added = room.add(blob, Clock::now());
    if (!added) return added.status();
  }
  std::set<std::string> groups;
  for (const auto& light : state.document.lights) groups.insert(light.object->group);
  if (groups.size() > std::size_t(kMaxGroups)) {
    return invalid("data", "the session's lights are in " + std::to_string(groups.size()) + " groups, allowed are " +
                               std::to_string(kMaxGroups));
  }
  return Document(state.document, limits, {}).checkTotals();
}

Expected<SavedSession> stateOf(const std::string& bytes, const Limits& limits) {
  kept::SessionFile file;
  Status status = store::unseal("the file", bytes, &file);
  store::Loaded loaded;
  if (status.ok()) {
    file.mutable_snapshot()->clear_clients();
    loaded.snapshot.Swap(file.mutable_snapshot());
    for (kept::Content& content : *file.mutable_contents()) {
      loaded.contents.push_back(
          {content.hash(), content.kind(), std::make_shared<const std::string>(std::move(*content.mutable_bytes()))});
    }
    const Expected<SavedSession> state = fromStore(loaded);
    status = state ? checkLimits(*state, limits) : state.status();
    if (status.ok()) return state;
  }
  return status.code() == Code::kDataLoss ? invalid("data", status.message()) : status;
}

/// A session on its way out, part by part as the client takes them.
class Export final : public StreamOf<Export, pb::ExportSessionRequest, pb::ExportSessionResponse> {
 public:
  explicit Export(const Context& context)
      : context_(context), slot_(context.counters->sessionFiles), patience_(context, "name") {}

  void receive(pb::ExportSessionRequest request) override {
    const Expected<SessionPtr> session = findSession(context_, "name", request.name());
    if (!session) return end(session.status());
    if (Status s = slot_.enter(Reason::kMaxSessionFiles, "max_session_files", context_.limits.maxSessionFiles); !s.ok())
      return end(s);
    FileParts parts = filePartsOf((*session)->state());
    if (parts.bytes > kMaxFileBytes) return giveUp(tooLarge(parts.bytes));
    Expected<AnswerHoldPtr> hold = context_.answers->take((*session)->id(), std::int64_t(parts.bytes), context_.limits);
    if (!hold) return giveUp(hold.status());
    std::string file = fileOf(std::move(parts));
    (*hold)->shrinkTo(std::int64_t(file.size()));
    const MutexLock lock(mutex_);
    hold_ = std::move(*hold);
    bytes_ = std::move(file);
    expectReader();
  }

  bool next(pb::ExportSessionResponse* response) override {
    const MutexLock lock(mutex_);
    if (offset_ >= bytes_.size()) return false;
    const std::size_t count = std::min(wire::kMaxPartBytes, bytes_.size() - offset_);
    response->set_data(bytes_.data() + offset_, count);
    offset_ += count;
    expectReader();
    if (offset_ == bytes_.size()) endInNext(Status());
    return true;
  }

  void release() override {
    patience_.stop();
    {
      const MutexLock lock(mutex_);
      bytes_ = std::string();
      hold_ = nullptr;
    }
    slot_.leave();
  }

 private:
  void expectReader() {
    patience_.expect(whileAlive([](Export& self, const Status& why) { self.giveUp(why); }));
  }

  void giveUp(Status why) {
    release();
    end(std::move(why));
  }

  const Context context_;
  AdmissionSlot slot_;
  ReaderPatience patience_;
  Mutex mutex_;
  std::string bytes_ LPV_GUARDED_BY(mutex_);
  AnswerHoldPtr hold_ LPV_GUARDED_BY(mutex_);
  std::size_t offset_ LPV_GUARDED_BY(mutex_) = 0;
};

/// A file on its way in; a worker makes the session at its end.
class Import final : public StreamOf<Import, pb::ImportSessionRequest, pb::ImportSessionResponse> {
 public:
  explicit Import(const Context& context)
      : context_(context), slot_(context.counters->sessionFiles), idle_(*context.timers) {}

  void receive(pb::ImportSessionRequest request) override {
    if (hasEnded()) return;
    if (!begun_) {
      if (Status s = slot_.enter(Reason::kMaxSessionFiles, "max_session_files", context_.limits.maxSessionFiles);
          !s.ok())
        return end(s);
      wantedId_ = request.session_id();
    }
    begun_ = true;
    if (bytes_.size() + request.data().size() > kMaxFileBytes) {
      bytes_ = std::string();
      return leave(tooLarge(kMaxFileBytes + 1));
    }
    bytes_ += request.data();
    idle_.restart(context_.limits.uploadIdle, whileAlive([](Import& self) {
                    self.leave(Status(Code::kDeadlineExceeded, Reason::kUploadIdle,
                                      "upload_idle: nothing arrived in time", "data"));
                  }));
  }

  void halfClosed() override {
    idle_.stop();
    if (hasEnded()) return;
    context_.pool->post([self = me()] { self->finish(); });
  }

  bool next(pb::ImportSessionResponse* response) override {
    const MutexLock lock(mutex_);
    if (!answer_) return false;
    *response = *answer_;
    answer_.reset();
    return true;
  }

  void release() override { idle_.stop(); }

 private:
  /// The place is free before the client hears of the end, and may ask for the next.
  void leave(Status status) {
    slot_.leave();
    end(std::move(status));
  }

  void finish() {
    Expected<SavedSession> state = stateOf(bytes_, context_.limits);
    bytes_ = std::string();
    if (!state) return leave(state.status());
    const Expected<SessionPtr> session = context_.registry->create(wantedId_, std::move(*state));
    if (!session) return leave(session.status());
    const Expected<MintedToken> token = ownerToken(context_, (*session)->id());
    if (!token) return leave(token.status());
    (*session)->updateForecast();
    whenBothKept(context_, *session, *token,
                 [self = me(), session = *session, token = token->token](const Status& kept) {
                   if (!kept.ok()) return self->leave(kept);
                   {
                     const MutexLock lock(self->mutex_);
                     self->answer_.emplace();
                     toProto(session->summary(), self->answer_->mutable_session());
                     self->answer_->set_owner_token(token);
                   }
                   self->leave(Status());
                 });
  }

  const Context context_;
  AdmissionSlot slot_;
  Deadline idle_;
  bool begun_ = false;
  std::string wantedId_;
  std::string bytes_;
  Mutex mutex_;
  std::optional<pb::ImportSessionResponse> answer_ LPV_GUARDED_BY(mutex_);
};

}  // namespace

StreamPtr<pb::ExportSessionRequest, pb::ExportSessionResponse> exportSession(const Context& context) {
  return std::make_shared<Export>(context);
}

StreamPtr<pb::ImportSessionRequest, pb::ImportSessionResponse> importSession(const Context& context) {
  return std::make_shared<Import>(context);
}

}  // namespace lpv::api
