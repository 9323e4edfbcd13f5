// Edits in order over one stream, each answered; a rejected edit ends nothing.

#include <deque>

#include "api/results/heartbeat.h"
#include "api/services.h"
#include "convert/scene.h"
#include "convert/session.h"

namespace lpv::api {
namespace {

class EditStream final : public StreamOf<EditStream, pb::StreamEditsRequest, pb::StreamEditsResponse> {
 public:
  explicit EditStream(const Context& context) : context_(context), heartbeat_(*context.timers) {}

  void receive(pb::StreamEditsRequest request) override {
    if (hasEnded()) return;
    if (!session_) {
      if (Status s = open(request); !s.ok()) return end(s);
    }
    if (!request.has_edit()) return;
    const MutexLock lock(mutex_);
    if (interrupted_) return;
    waiting_.push_back(std::move(*request.mutable_edit()));
    startNext();
  }

  void halfClosed() override {
    {
      const MutexLock lock(mutex_);
      inputEnded_ = true;
    }
    wake();
  }

  bool wantsRead() override {
    const MutexLock lock(mutex_);
    return waiting_.size() + acks_.size() < std::size_t(context_.limits.maxQueuedEdits);
  }

  bool next(pb::StreamEditsResponse* response) override {
    const MutexLock lock(mutex_);
    if (!acks_.empty() && acks_.front()->told) {
      response->mutable_ack()->Swap(&acks_.front()->ack);
      acks_.pop_front();
      heartbeat_.quiet();
      return true;
    }
    if (session_ && heartbeat_.next(*session_, response)) return true;
    if (heartbeat_.over()) {
      endInNext(Status(Code::kUnavailable, "the session has ended here; see the notice"));
    } else if (interrupted_ && acks_.empty()) {
      endInNext(Status(Code::kUnavailable, "an edit could not be taken now; open the stream again and repeat from it"));
    } else if (inputEnded_ && waiting_.empty() && !working_ && acks_.empty()) {
      endInNext(Status());
    }
    return false;
  }

  void release() override {
    heartbeat_.stop();
    if (session_) session_->unwatch(watcher_);
    // Nobody is told of them: whoever comes back repeats them, and whose token was revoked has none applied.
    const MutexLock lock(mutex_);
    waiting_.clear();
  }

 private:
  /// An edit's acknowledgement, once it is kept.
  struct Place {
    pb::EditAck ack;
    bool told = false;
  };

  Status open(const pb::StreamEditsRequest& request) {
    const Expected<SessionPtr> session = findSession(context_, "session", request.session());
    if (!session) return session.status();
    client_ = fromProto(request.client());
    if (Status s = (*session)->verify(client_); !s.ok()) return s;
    const auto close = whileAlive([](EditStream& self, Closing why) { self.heartbeat_.close(why); });
    watcher_ = (*session)->watch([] {}, close, client_.id);
    {
      const MutexLock lock(mutex_);
      session_ = *session;
    }
    heartbeat_.start(wakeWhileAlive());
    return {};
  }

  /// Applies the next edit on a worker, one at a time so that the order stays.
  void startNext() LPV_REQUIRES(mutex_) {
    if (working_ || waiting_.empty()) return;
    working_ = true;
    context_.pool->post([self = me(), edit = std::move(waiting_.front())] { self->apply(edit); });
    waiting_.pop_front();
  }

  EditOutcome outcomeOf(const pb::Edit& edit) {
    if (Status s = checkSequence(client_, edit.sequence()); !s.ok()) {
      return {.sequence = edit.sequence(), .status = s.within("edit"), .revision = session_->revision(), .names = {}};
    }
    Expected<Edit> parsed = fromProto(edit, context_.limits);
    return parsed ? session_->apply(client_, std::move(*parsed))
                  : session_->recordRejected(client_, edit.sequence(), parsed.status());
  }

  void apply(const pb::Edit& edit) {
    const EditOutcome outcome = outcomeOf(edit);
    const auto place = std::make_shared<Place>();
    {
      const MutexLock lock(mutex_);
      acks_.push_back(place);
      working_ = false;
      // Not taken and not remembered: it comes again, and what was sent after it must not be there before it.
      if (outcome.status.code() == Code::kUnavailable) {
        interrupted_ = true;
        waiting_.clear();
      }
      startNext();  // the next one need not wait for the disk: many are kept at once
    }
    session_->confirmWhenDurable(outcome, [self = me(), place](const EditOutcome& confirmed) {
      {
        const MutexLock lock(self->mutex_);
        toProto(confirmed, *self->session_, &place->ack);
        place->told = true;
      }
      self->wake();
    });
  }

  const Context context_;
  HeartbeatEmitter heartbeat_;
  SessionPtr session_;
  ClientIdentity client_;
  std::uint64_t watcher_ = 0;
  Mutex mutex_;
  std::deque<pb::Edit> waiting_ LPV_GUARDED_BY(mutex_);
  std::deque<std::shared_ptr<Place>> acks_ LPV_GUARDED_BY(mutex_);  ///< in the order of edits
  bool working_ LPV_GUARDED_BY(mutex_) = false;
  bool inputEnded_ LPV_GUARDED_BY(mutex_) = false;
  bool interrupted_ LPV_GUARDED_BY(mutex_) =
      false;  ///< an edit was not taken: the stream ends when all before it are answered
};

}  // namespace

StreamPtr<pb::StreamEditsRequest, pb::StreamEditsResponse> streamEdits(const Context& context) {
  return std::make_shared<EditStream>(context);
}

}  // namespace lpv::api
