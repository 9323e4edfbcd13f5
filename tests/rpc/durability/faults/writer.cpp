#include "rpc/durability/faults/writer.h"

#include <algorithm>
#include <utility>

#include "rpc/durability/faults/mirror.h"

namespace lpv::rpc::faults {
namespace {

constexpr std::size_t kWindow = 8;             // unanswered edits of a stream
constexpr std::size_t kKnown = 500;            // of the 1024 outcomes that a server remembers
constexpr std::size_t kScratchLights = 3;      // a writer's own, before it deletes one
constexpr int kTriesAtTheEnd = 200;            // a server that is well answers one of them
constexpr int kRepeatsAtTheEnd = 20;
constexpr std::chrono::milliseconds kPatience{1000};

Outcome outcomeOf(grpc::StatusCode code) {
  switch (code) {
    case StatusCode::OK:
      return Outcome::kAccepted;
    case StatusCode::UNAVAILABLE:
    case StatusCode::DEADLINE_EXCEEDED:
    case StatusCode::CANCELLED:
    case StatusCode::UNKNOWN:
    case StatusCode::INTERNAL:
      return Outcome::kUnknown;
    default:
      return Outcome::kRefused;
  }
}

}  // namespace

Writer::Writer(int number, Way way, Part part, pb::ClientIdentity identity)
    : number_(number), way_(way), part_(std::move(part)), identity_(std::move(identity)), dice_(part_.seed) {
  thread_ = std::thread([this] { run(); });
}

Writer::~Writer() {
  finishing_ = true;
  if (thread_.joinable()) thread_.join();
}

void Writer::run() {
  while (!(lastMade_ && pending_.empty()) && triesAtTheEnd_ < kTriesAtTheEnd) {
    way_ == Way::kCalls ? callOnce() : streamOnce();
    if (finishing_) ++triesAtTheEnd_;
  }
  for (int i = 0; i < kRepeatsAtTheEnd; ++i) repeatOne();
}

/// A new edit; none where the last has been made.
std::optional<Writer::Pending> Writer::next() {
  if (lastMade_) return std::nullopt;
  Pending out;
  out.id = {number_, ++sequence_};
  lastMade_ = finishing_ || sequence_ == part_.mostEdits;
  out.givenUp = !lastMade_ && dice_.once(5);
  pb::Light lamp;
  lamp.set_name(kLamp);
  *lamp.mutable_radiance() = colourOf(out.id);
  std::vector<pb::Operation> operations = {client::createSurface(surface(nameOf(out.id))),
                                           client::updateLight(lamp, {"radiance"}),
                                           client::createLight(light(scratchOf(out.id)))};
  if (scratch_.size() >= kScratchLights) {
    out.removes = scratch_.front();
    scratch_.pop_front();
    operations.push_back(client::deleteLight(scratchOf({number_, out.removes})));
  }
  out.edit = client::editOf(operations);
  out.edit.set_sequence(out.id.sequence);
  return out;
}

Attempt Writer::begin(const Pending& edit) const {
  Attempt out;
  out.id = edit.id;
  out.removes = edit.removes;
  out.began = part_.moments->next();
  return out;
}

void Writer::end(Attempt attempt, grpc::StatusCode code, const std::string& message, const pb::EditAck& ack) {
  attempt.ended = part_.moments->next();
  attempt.outcome = outcomeOf(code);
  if (attempt.outcome == Outcome::kAccepted) {
    attempt.revision = ack.revision();
    attempt.name = ack.names_size() > 0 ? ack.names(0) : std::string();
  } else {
    attempt.why = message;
  }
  attempts_.push_back(std::move(attempt));
}

/// The first of those that wait is known.
void Writer::settle(const Pending& edit) {
  if (attempts_.back().outcome == Outcome::kAccepted) {
    scratch_.push_back(edit.id.sequence);
    known_.push_back(edit);
    if (known_.size() > kKnown) known_.pop_front();
  }
  pending_.pop_front();
}

/// Of the first `sent` that wait, which were sent and not answered, those that are not repeated.
void Writer::forgetGivenUp(std::size_t sent) {
  std::deque<Pending> kept;
  for (std::size_t i = 0; i < pending_.size(); ++i) {
    if (i >= sent || !pending_[i].givenUp) kept.push_back(std::move(pending_[i]));
  }
  pending_ = std::move(kept);
}

void Writer::callOnce() {
  if (pending_.empty()) {
    std::optional<Pending> edit = next();
    if (!edit) return;
    pending_.push_back(std::move(*edit));
    dice_.pause(0, 30);
  }
  // A client that goes away in the midst of a call, now and then.
  const bool hasty = !finishing_ && dice_.once(20);
  const Attempt attempt = call(pending_.front(), hasty ? dice_.milliseconds(0, 10) : kPatience);
  if (attempt.outcome != Outcome::kUnknown) {
    settle(pending_.front());
    if (dice_.once(16)) repeatOne();
    return;
  }
  stubs_.reset();
  forgetGivenUp(1);
  dice_.pause(10, 60);
}

Attempt Writer::call(const Pending& edit, std::chrono::milliseconds patience) {
  if (!stubs_) stubs_ = std::make_unique<Stubs>(part_.proxy->address());
  pb::ApplyEditRequest request;
  request.set_session(part_.session);
  *request.mutable_client() = identity_;
  *request.mutable_edit() = edit.edit;
  pb::ApplyEditResponse response;
  const auto context = contextFor(patience);
  Attempt attempt = begin(edit);
  const grpc::Status status = stubs_->scene->ApplyEdit(context.get(), request, &response);
  end(std::move(attempt), status.error_code(), status.error_message(), response.ack());
  return attempts_.back();
}

/// One that is known, again: the answer has to be the same.
void Writer::repeatOne() {
  if (known_.empty()) return;
  if (call(known_[std::size_t(dice_.between(0, int(known_.size()) - 1))], kPatience).outcome == Outcome::kUnknown) {
    stubs_.reset();
  }
}

/// A stream until it breaks or everything is answered; what was sent before and not answered comes first.
void Writer::streamOnce() {
  Stubs stubs(part_.proxy->address());
  const auto context = contextFor(dice_.milliseconds(500, 3000));
  const auto stream = stubs.scene->StreamEdits(context.get());
  pb::StreamEditsRequest request;
  request.set_session(part_.session);
  *request.mutable_client() = identity_;
  std::deque<Attempt> open;  // of the first of pending_
  bool alive = stream->Write(request);
  request.Clear();
  while (alive) {
    const bool more = pending_.empty() || (pending_.size() < kWindow && dice_.once(2));
    if (open.size() == pending_.size() && more) {
      std::optional<Pending> edit = next();
      if (edit) pending_.push_back(std::move(*edit));
      if (pending_.empty()) break;
      dice_.pause(0, 30);
    }
    if (open.size() < pending_.size()) {
      const Pending& edit = pending_[open.size()];
      open.push_back(begin(edit));
      *request.mutable_edit() = edit.edit;
      alive = stream->Write(request);
      continue;
    }
    alive = takeAnswer(*stream, open);
    if (!finishing_ && dice_.once(200)) context->TryCancel();
  }
  context->TryCancel();
  const grpc::Status status = stream->Finish();
  for (Attempt& attempt : open) end(std::move(attempt), StatusCode::UNKNOWN, status.error_message(), {});
  forgetGivenUp(open.size());
  if (!pending_.empty()) dice_.pause(10, 60);
}

/// The next acknowledgement; false where the stream has ended, or has to: the edit's outcome is not known.
bool Writer::takeAnswer(grpc::ClientReaderWriter<pb::StreamEditsRequest, pb::StreamEditsResponse>& stream,
                        std::deque<Attempt>& open) {
  pb::StreamEditsResponse response;
  if (!stream.Read(&response)) return false;
  if (!response.has_ack()) return true;
  const pb::EditAck& ack = response.ack();
  EXPECT_EQ(ack.sequence(), open.front().id.sequence) << "answers come in the order of edits";
  const auto code = static_cast<grpc::StatusCode>(ack.status().code());
  if (outcomeOf(code) == Outcome::kUnknown) return false;
  end(std::move(open.front()), code, ack.status().message(), ack);
  open.pop_front();
  settle(pending_.front());
  return true;
}

}  // namespace lpv::rpc::faults
