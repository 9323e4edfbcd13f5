#include "api/call/admission_slot.h"
#include "api/call/deadline.h"
#include "api/call/method_table.h"
#include "api/call/reader_patience.h"
#include "api/services.h"
#include "base/text.h"
#include "convert/blob_content.h"
#include "wire/message_size.h"

namespace lpv::api {
namespace {

/// An upload in progress: bytes arrive, the buffer grows with them, at the end a worker parses.
class Upload final : public StreamOf<Upload, pb::UploadBlobRequest, pb::UploadBlobResponse> {
 public:
  explicit Upload(const Context& context)
      : context_(context), slot_(context.counters->uploads), idle_(*context.timers) {}

  void receive(pb::UploadBlobRequest request) override {
    if (hasEnded()) return;
    if (Status s = take(request); !s.ok()) {
      bytes_ = std::string();
      leave(s);
      return;
    }
    idle_.restart(context_.limits.uploadIdle, whileAlive([seconds = context_.limits.uploadIdle.count()](Upload& self) {
                    self.leave(Status(
                        Code::kDeadlineExceeded, Reason::kUploadIdle,
                        "upload_idle: nothing arrived for " + std::to_string(seconds) + " s; upload again", "data"));
                  }));
  }

  void halfClosed() override {
    idle_.stop();
    if (hasEnded()) return;
    if (!session_) return leave(invalid("header", "the stream ended without a header"));
    if (std::int64_t(bytes_.size()) != size_) {
      return leave(invalid("data", "data has " + std::to_string(bytes_.size()) + " bytes, the header announced " +
                                       std::to_string(size_)));
    }
    context_.pool->post([self = me()] { self->finish(); });
  }

  bool next(pb::UploadBlobResponse* response) override {
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

  Status take(pb::UploadBlobRequest& request) {
    if (!session_) {
      if (!request.has_header()) return invalid("header", "the first message has no header");
      if (Status s = begin(request.header()); !s.ok()) return s.within("header");
      if (Status s = slot_.enter(Reason::kMaxUploads, "max_uploads", context_.limits.maxUploads); !s.ok()) return s;
    } else if (request.has_header()) {
      return invalid("header", "a later message has a header again");
    }
    if (std::int64_t(bytes_.size() + request.data().size()) > size_) {
      return invalid("data", "data has more bytes than the " + std::to_string(size_) + " that the header announced");
    }
    bytes_ += request.data();  // grows with what arrives: an announcement alone costs nothing
    return {};
  }

  Status begin(const pb::BlobHeader& header) {
    if (header.kind() != pb::BLOB_KIND_MESH && header.kind() != pb::BLOB_KIND_TEXTURE) {
      return invalid("kind", "kind has the unknown value " + std::to_string(int(header.kind())));
    }
    if (header.size() < 1)
      return invalid("size", "size is " + std::to_string(header.size()) + ", needed is at least 1");
    if (header.size() > context_.limits.maxBlobBytes) {
      return exhausted(Reason::kMaxBlobBytes, "size",
                       "max_blob_bytes: size is " + std::to_string(header.size()) + ", allowed are " +
                           std::to_string(context_.limits.maxBlobBytes) + " bytes");
    }
    const Expected<SessionPtr> session = findSession(context_, "session", header.session());
    if (!session) return session.status();
    session_ = *session;
    kind_ = header.kind();
    size_ = header.size();
    return {};
  }

  void finish() {
    const Expected<BlobPtr> blob = blobFromBytes(kind_, std::move(bytes_));
    if (!blob) return leave(blob.status());
    const Expected<bool> existed = session_->addBlob(*blob);
    if (!existed) return leave(existed.status());
    session_->whenDurable([self = me(), hash = (*blob)->hash, existed = *existed](const Status& kept) {
      if (!kept.ok()) return self->leave(kept);
      {
        const MutexLock lock(self->mutex_);
        self->answer_.emplace();
        self->answer_->set_hash(hash);
        self->answer_->set_existed(existed);
      }
      self->leave(Status());
    });
  }

  const Context context_;
  AdmissionSlot slot_;
  Deadline idle_;
  SessionPtr session_;
  pb::BlobKind kind_ = pb::BLOB_KIND_UNSPECIFIED;
  std::int64_t size_ = 0;
  std::string bytes_;
  Mutex mutex_;
  std::optional<pb::UploadBlobResponse> answer_ LPV_GUARDED_BY(mutex_);
};

/// While it is written: a copy of its parts, and the bytes, whose buffer doubles as it grows.
std::int64_t mostBytesOf(const Mesh& mesh) { return 3 * std::int64_t(mesh.bytes()); }

/// A blob on its way out, part by part as the client takes them.
class Read final : public StreamOf<Read, pb::ReadBlobRequest, pb::ReadBlobResponse> {
 public:
  explicit Read(const Context& context) : context_(context), patience_(context, "hash") {}

  void receive(pb::ReadBlobRequest request) override {
    context_.pool->post([self = me(), request = std::move(request)] {
      if (Status s = self->open(request); !s.ok()) return self->end(s);
      if (self->hasEnded()) return self->release();
      self->expectReader();
      self->wake();
    });
  }

  bool next(pb::ReadBlobResponse* response) override {
    bool last = false;
    {
      const MutexLock lock(mutex_);
      if (!bytes_ || done_) return false;
      if (first_) {
        response->set_kind(kind_);
        response->set_size(std::int64_t(bytes_->size()));
        first_ = false;
      }
      const std::size_t count = std::min(wire::kMaxPartBytes, bytes_->size() - offset_);
      response->set_data(bytes_->data() + offset_, count);
      offset_ += count;
      last = done_ = offset_ == bytes_->size();
    }
    last ? patience_.stop() : expectReader();
    if (last) endInNext(Status());
    return true;
  }

  void release() override {
    patience_.stop();
    const MutexLock lock(mutex_);
    done_ = true;
    bytes_ = nullptr;
    hold_ = nullptr;
  }

 private:
  void expectReader() {
    patience_.expect(whileAlive([](Read& self, const Status& why) {
      self.release();
      self.end(why);
    }));
  }

  Status open(const pb::ReadBlobRequest& request) {
    const Expected<SessionPtr> session = findSession(context_, "session", request.session());
    if (!session) return session.status();
    std::shared_ptr<const std::string> bytes;
    AnswerHoldPtr hold;
    pb::BlobKind kind = pb::BLOB_KIND_MESH;
    if (const BlobPtr blob = (*session)->findBlob(request.hash())) {
      bytes = blob->bytes;
      if (blob->kind == BlobKind::kTexture) kind = pb::BLOB_KIND_TEXTURE;
    } else if (const MeshPtr mesh = (*session)->findMeshInUse(request.hash())) {
      Expected<AnswerHoldPtr> room = context_.answers->take((*session)->id(), mostBytesOf(*mesh), context_.limits);
      if (!room) return room.status();
      hold = std::move(*room);
      bytes = std::make_shared<const std::string>(meshBytes(*mesh));
      hold->shrinkTo(std::int64_t(bytes->size()));
    } else {
      return Status(Code::kNotFound, "there is no blob \"" + truncatedUtf8(request.hash()) + "\" in this session",
                    "hash");
    }
    if (request.offset() < 0 || request.offset() > std::int64_t(bytes->size())) {
      return Status(Code::kOutOfRange,
                    "offset is " + std::to_string(request.offset()) + ", the blob has " +
                        std::to_string(bytes->size()) + " bytes",
                    "offset");
    }
    const MutexLock lock(mutex_);
    kind_ = kind;
    offset_ = std::size_t(request.offset());
    bytes_ = std::move(bytes);
    hold_ = std::move(hold);
    return {};
  }

  const Context context_;
  ReaderPatience patience_;
  Mutex mutex_;
  std::shared_ptr<const std::string> bytes_ LPV_GUARDED_BY(mutex_);
  AnswerHoldPtr hold_ LPV_GUARDED_BY(mutex_);  ///< of bytes that no session has
  pb::BlobKind kind_ LPV_GUARDED_BY(mutex_) = pb::BLOB_KIND_MESH;
  std::size_t offset_ LPV_GUARDED_BY(mutex_) = 0;
  bool first_ LPV_GUARDED_BY(mutex_) = true;
  bool done_ LPV_GUARDED_BY(mutex_) = false;
};

constexpr int kMaxHashes = 1000;

}  // namespace

Status findBlobs(const Context& context, const pb::FindBlobsRequest& request, pb::FindBlobsResponse* response) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return session.status();
  if (request.hashes_size() > kMaxHashes) {
    return invalid("hashes", "hashes has " + std::to_string(request.hashes_size()) + " entries, allowed are 1000");
  }
  for (const std::string& hash : request.hashes()) {
    if ((*session)->findBlob(hash)) response->add_found(hash);
  }
  return {};
}

StreamPtr<pb::UploadBlobRequest, pb::UploadBlobResponse> uploadBlob(const Context& context) {
  return std::make_shared<Upload>(context);
}

StreamPtr<pb::ReadBlobRequest, pb::ReadBlobResponse> readBlob(const Context& context) {
  return std::make_shared<Read>(context);
}

std::vector<Method> blobMethods() {
  return {
      {"BlobService.UploadBlob", Role::kEditor, "header.session", handler(uploadBlob)},
      {"BlobService.FindBlobs", Role::kEditor, "session", handler(findBlobs)},
      {"BlobService.ReadBlob", Role::kViewer, "session", handler(readBlob)},
  };
}

}  // namespace lpv::api
