#pragma once
// What every call needs, whichever door it came through: who asks, the first message's deadline, expulsion when the
// token is revoked, what happens when the client goes away, and the end's audit line and count. A door brings messages
// and takes them (Transport); handlers see typed messages only (api/call/stream.h).

#include <google/protobuf/message.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "api/call/deadline.h"
#include "api/call/method.h"
#include "base/mutex.h"
#include "ops/log_scope.h"

namespace lpv::api {

/// One call's connection to its client, as a door has it. The functions start something and return at once; what they
/// started is answered through the CallDriver later, never from inside them. They are called one at a time, at most one
/// read() and one write() are started at any time, and nothing is called after finish().
class Transport {
 public:
  virtual ~Transport() = default;
  /// Reads the next message into `*into`, then calls CallDriver::onRead().
  virtual void read(google::protobuf::Message* into) = 0;
  /// Sends a message, of which the transport keeps no reference, then calls CallDriver::onWrite().
  virtual void write(const google::protobuf::Message& message) = 0;
  /// Ends the call; `last`, where it is not null, is sent before, as a unary answer is. No write is in flight; a read
  /// may be, and is dropped.
  virtual void finish(const google::protobuf::Message* last, const Status& status) = 0;
  /// Ends the connections of the call's peer, and all their calls, where the transport knows how. finish() is called
  /// all the same.
  virtual void dropPeer() {}
};

/// What a door knows of a call before its first message.
struct CallOrigin {
  Expected<std::string> token = std::string();  ///< as the client showed it, empty for none; or what is wrong with it
  std::string peer;  ///< "ipv4:127.0.0.1:50000"
  std::string traceparent;  ///< W3C Trace Context; empty for none
  bool hasDeadline = false;  ///< the client gives up by itself, within a day
};

/// How a read went.
enum class ReadResult {
  kMessage,  ///< the message is there
  kEnd,  ///< the client sends no more
  kMalformed,  ///< bytes came that are no message of this type
};

/// One call, from its admission to its end. Thread-safe. Rules kept here and nowhere else: one write in flight; finish
/// exactly once, and only when nothing is being written; nothing is started after it. The first message goes to a
/// worker, since the session that it names may have to come back from disk; nothing else happens to the call
/// meanwhile.
class CallDriver : public std::enable_shared_from_this<CallDriver> {
 public:
  /// The server's context and the transport outlive the call, the transport until finish().
  CallDriver(const Context& server, const Method& method, CallOrigin origin, Transport& transport);

  /// Admits the call, or finishes it: UNAUTHENTICATED, PERMISSION_DENIED. Once, before anything else.
  void start();
  void onRead(ReadResult result);
  /// `ok`: further messages may be sent.
  void onWrite(bool ok);
  /// The client has gone, or has cancelled the call.
  void onCancel();
  /// The transport is done with the call, after finish().
  void onDone();

 private:
  enum class Phase {
    kAwaitingFirst,  ///< no message has come
    kOpening,  ///< a worker has the first one
    kOpen,
    kFinished,
  };
  /// What the transport has not answered yet.
  struct Outstanding {
    bool read = false;
    bool write = false;
  };
  /// How far the call has come.
  struct Progress {
    bool handedOver = false;  ///< the first message, to the handler
    bool inputEnded = false;
    bool sent = false;  ///< a message, so that an error is no refusal
    bool answered = false;  ///< the one response of a call that sends one is in response_
  };

  Status checkAddress();
  void watchToken();
  void open(ops::LogContext who);
  void later();
  void inputEnded();
  /// Ends the call whatever its stream thinks; the first reason counts.
  void cutOff(const Status& why);
  void pump();
  /// There is a reason to cut the call off, and it does not complete anyway.
  bool isCut() const LPV_REQUIRES(mutex_);
  void pull() LPV_REQUIRES(mutex_);
  void read() LPV_REQUIRES(mutex_);
  std::optional<Status> end() const LPV_REQUIRES(mutex_);
  void finish(const Status& status) LPV_REQUIRES(mutex_);

  Context context_;
  const Method& method_;
  const bool clientStreams_;
  const bool serverStreams_;
  const Expected<std::string> token_;
  const std::string peer_;
  Transport& transport_;
  Deadline first_;
  std::shared_ptr<AnyStream> stream_;
  std::shared_ptr<void> tokenWatch_;
  const std::unique_ptr<google::protobuf::Message> request_;  ///< the transport's while a read is outstanding
  const std::unique_ptr<google::protobuf::Message> response_;
  Mutex mutex_;  ///< held while the transport is called
  Phase phase_ LPV_GUARDED_BY(mutex_) = Phase::kAwaitingFirst;
  Outstanding outstanding_ LPV_GUARDED_BY(mutex_);
  Progress progress_ LPV_GUARDED_BY(mutex_);
  std::optional<Status> cut_ LPV_GUARDED_BY(mutex_);  ///< why the call was cut off
  ops::LogContext who_ LPV_GUARDED_BY(mutex_);
};

}  // namespace lpv::api
