#include "api/call/call_driver.h"

#include <utility>

#include "api/call/address_limit.h"
#include "api/call/admission.h"
#include "api/call/call_end.h"
#include "ops/trace.h"

namespace lpv::api {
namespace {

Status firstMessageIsLate(const Limits& limits) {
  return {Code::kDeadlineExceeded, Reason::kFirstMessage,
          "first_message: no message arrived within " + std::to_string(limits.firstMessage.count()) +
              " s; send the first one right after opening the call"};
}

}  // namespace

CallDriver::CallDriver(const Context& server, const Method& method, CallOrigin origin, Transport& transport)
    : context_(server),
      method_(method),
      clientStreams_(method.descriptor().client_streaming()),
      serverStreams_(method.descriptor().server_streaming()),
      token_(std::move(origin.token)),
      peer_(std::move(origin.peer)),
      transport_(transport),
      first_(*server.timers),
      request_(method.handler.request->New()),
      response_(method.handler.response->New()),
      who_{{}, ops::traceIdOf(origin.traceparent), peer_} {
  context_.hasDeadline = origin.hasDeadline;
}

/// How many calls the address begins; who floods loses its connections.
Status CallDriver::checkAddress() {
  if (!context_.addresses) return {};
  const double most = context_.registry->limits().maxCallsPerSecondPerAddress;
  const AddressLimit::Verdict verdict = context_.addresses->begin(peer_, most, Clock::now());
  if (verdict.flood) transport_.dropPeer();
  if (verdict.news) ++context_.counters->addressBans;
  return verdict.status;
}

void CallDriver::start() {
  Status status = checkAddress();
  if (status.ok()) status = admit(token_, context_);
  if (status.ok()) status = authorize(context_, method_);
  if (!status.ok()) {
    const MutexLock lock(mutex_);
    return finish(status);
  }
  stream_ = method_.handler.open(context_);
  stream_->onWake([weak = weak_from_this()] {
    if (const auto self = weak.lock()) self->pump();
  });
  watchToken();
  first_.restart(context_.limits.firstMessage, [weak = weak_from_this()] {
    if (const auto self = weak.lock()) self->cutOff(firstMessageIsLate(self->context_.limits));
  });
  pump();
}

/// Has the call cut off when its token is revoked or expires, unless it completes anyway.
void CallDriver::watchToken() {
  if (stream_->completesAnyway()) return;
  tokenWatch_ = context_.access->watch(context_.caller, [weak = weak_from_this()](const Status& why) {
    if (const auto self = weak.lock()) self->cutOff(why);
  });
}

void CallDriver::onRead(ReadResult result) {
  if (result == ReadResult::kMalformed) {
    cutOff(invalid("", "the message is no " + request_->GetTypeName() + ": its bytes cannot be parsed"));
    return;
  }
  if (result == ReadResult::kEnd) return inputEnded();
  bool first = false;
  ops::LogContext who;
  {
    const MutexLock lock(mutex_);
    if (phase_ == Phase::kFinished) return;
    first = phase_ == Phase::kAwaitingFirst;
    if (first) phase_ = Phase::kOpening;
    if (first) who_.session = shortId(textAt(*request_, method_.session));
    who = who_;
  }
  return first ? open(std::move(who)) : later();
}

/// Hands the first message to a worker.
void CallDriver::open(ops::LogContext who) {
  first_.stop();
  context_.pool->post([self = shared_from_this(), who = std::move(who)]() mutable {
    const ops::LogScope scope(std::move(who));
    const Status allowed = authorize(self->context_, self->method_, *self->request_);
    if (allowed.ok()) self->stream_->receiveMessage(*self->request_);
    bool cut = false;
    {
      const MutexLock lock(self->mutex_);
      self->phase_ = Phase::kOpen;
      self->outstanding_.read = false;
      self->progress_.handedOver = allowed.ok();
      if (!allowed.ok()) self->cut_ = allowed;
      self->request_->Clear();
      cut = self->isCut();
    }
    if (cut) self->stream_->cancelled();
    self->pump();
  });
}

void CallDriver::later() {
  stream_->receiveMessage(*request_);
  request_->Clear();
  {
    const MutexLock lock(mutex_);
    outstanding_.read = false;
  }
  pump();
}

void CallDriver::inputEnded() {
  first_.stop();
  if (clientStreams_) stream_->halfClosed();
  bool nothingCame = false;
  {
    const MutexLock lock(mutex_);
    outstanding_.read = false;
    progress_.inputEnded = true;
    nothingCame = !clientStreams_ && phase_ == Phase::kAwaitingFirst;
  }
  if (nothingCame) return cutOff(invalid("", "the call ended without its " + request_->GetTypeName()));
  pump();
}

void CallDriver::onWrite(bool ok) {
  {
    const MutexLock lock(mutex_);
    outstanding_.write = false;
    if (!ok && !cut_) cut_ = Status(Code::kCancelled, AnyStream::kClientGone);
  }
  pump();
}

void CallDriver::onCancel() { cutOff(Status(Code::kCancelled, AnyStream::kClientGone)); }

void CallDriver::cutOff(const Status& why) {
  bool cut = false;
  {
    const MutexLock lock(mutex_);
    if (phase_ == Phase::kFinished) return;  // refused at its start, it has no stream
    if (!cut_) cut_ = why;
    if (phase_ == Phase::kOpening) return;  // open() looks when it is done
    cut = isCut();
  }
  if (cut) stream_->cancelled();
  pump();
}

void CallDriver::onDone() {
  first_.stop();
  if (stream_) stream_->cancelled();
  if (context_.addresses) context_.addresses->ended(peer_);
}

/// Starts whatever can be started now.
void CallDriver::pump() {
  const MutexLock lock(mutex_);
  if (phase_ == Phase::kOpening || phase_ == Phase::kFinished) return;
  if (!outstanding_.write && !isCut()) pull();
  if (!outstanding_.write) {
    if (const std::optional<Status> over = end()) return finish(*over);
  }
  read();
}

void CallDriver::pull() {
  response_->Clear();
  if (!stream_->nextMessage(response_.get())) return;
  if (!serverStreams_) {
    progress_.answered = true;
    return;
  }
  outstanding_.write = progress_.sent = true;
  transport_.write(*response_);
}

void CallDriver::read() {
  if (outstanding_.read || progress_.inputEnded) return;
  const bool first = phase_ == Phase::kAwaitingFirst;
  if (!first && (!clientStreams_ || !stream_->wantsRead())) return;
  outstanding_.read = true;
  transport_.read(request_.get());
}

bool CallDriver::isCut() const { return cut_ && !(progress_.handedOver && stream_->completesAnyway()); }

std::optional<Status> CallDriver::end() const {
  if (isCut()) return cut_;
  if (progress_.answered) return Status();
  return stream_->ended();
}

void CallDriver::finish(const Status& status) {
  phase_ = Phase::kFinished;
  const ops::LogScope scope(who_);
  recordEnd(context_, method_, status, progress_.sent, *response_);
  transport_.finish(progress_.answered && status.ok() ? response_.get() : nullptr, status);
}

}  // namespace lpv::api
