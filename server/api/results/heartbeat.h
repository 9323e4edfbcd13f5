#pragma once
// What a stream says when it has nothing else to say: a heartbeat every second, instead of it a notice where the
// session has become read-only or is no more, and a notice at its end.

#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include "api/call/deadline.h"
#include "base/mutex.h"
#include "lpv/v1/scene.pb.h"
#include "session/session.h"

namespace lpv::api {

namespace pb = lpv::v1;

inline constexpr std::chrono::seconds kHeartbeatInterval{1};

/// Thread-safe. Calls its wake function, without locks, when something is due.
class HeartbeatEmitter {
 public:
  explicit HeartbeatEmitter(Timers& timers) : state_(std::make_shared<State>(timers)) {}
  ~HeartbeatEmitter() { stop(); }
  HeartbeatEmitter(const HeartbeatEmitter&) = delete;
  HeartbeatEmitter& operator=(const HeartbeatEmitter&) = delete;

  void start(std::function<void()> wake);
  void stop();
  /// The session ends: a notice is due.
  void close(Closing why);
  /// Something was sent: the heartbeat that may be due is not needed.
  void quiet();

  /// Fills `event`'s notice or heartbeat where one is due.
  template <typename Event>
  bool next(const Session& session, Event* event) {
    if (const std::optional<Closing> why = takeClosing()) {
      fillNotice(*why, event->mutable_notice());
      return true;
    }
    if (!takeBeat()) return false;
    if (const bool readOnly = session.readOnly(); takeReadOnly(readOnly)) {
      fillNotice(readOnly, event->mutable_notice());
    } else {
      fillHeartbeat(session, event->mutable_heartbeat());
    }
    return true;
  }
  /// The closing notice has been taken: the stream is over.
  bool over() const;
  /// What the stream's call ends with, once over() is true: INTERNAL where this stream alone failed, OK where its
  /// client closed it, else UNAVAILABLE.
  Status endStatus() const;

 private:
  struct State {
    explicit State(Timers& timers) : deadline(timers) {}
    Deadline deadline;
    Mutex mutex;
    std::function<void()> wake LPV_GUARDED_BY(mutex);
    bool beatDue LPV_GUARDED_BY(mutex) = false;
    bool readOnly LPV_GUARDED_BY(mutex) = false;  ///< as it was told
    std::optional<Closing> closing LPV_GUARDED_BY(mutex);
    bool over LPV_GUARDED_BY(mutex) = false;
  };
  static void beatLater(const std::shared_ptr<State>& state);
  static void wake(State& state);
  std::optional<Closing> takeClosing();
  bool takeBeat();
  /// True where that is news.
  bool takeReadOnly(bool readOnly);
  static void fillNotice(Closing why, pb::Notice* out);
  static void fillNotice(bool readOnly, pb::Notice* out);
  static void fillHeartbeat(const Session& session, pb::Heartbeat* out);

  std::shared_ptr<State> state_;
};

}  // namespace lpv::api
