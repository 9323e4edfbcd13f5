#pragma once

#include <functional>
#include <string>
#include <utility>

#include "api/call/context.h"
#include "api/call/deadline.h"

namespace lpv::api {

/// Gives up an answer of which no part is taken for upload_idle: a reader that stops holds memory no longer than a
/// writer that stops. Thread-safe.
class ReaderPatience {
 public:
  /// `field`: of the request, that names what is answered.
  ReaderPatience(const Context& context, std::string field)
      : limit_(context.limits.uploadIdle), field_(std::move(field)), deadline_(*context.timers) {}

  /// A part is there to be taken: calls `giveUp` with DEADLINE_EXCEEDED unless expect() or stop() comes first.
  void expect(std::function<void(const Status&)> giveUp) {
    deadline_.restart(limit_, [giveUp = std::move(giveUp), seconds = limit_.count(), field = field_] {
      giveUp(Status(Code::kDeadlineExceeded, Reason::kUploadIdle,
                    "upload_idle: no part of the answer was taken within " + std::to_string(seconds) +
                        " s; ask again, and take parts as they come",
                    field));
    });
  }
  void stop() { deadline_.stop(); }

 private:
  const std::chrono::seconds limit_;
  const std::string field_;
  Deadline deadline_;
};

}  // namespace lpv::api
