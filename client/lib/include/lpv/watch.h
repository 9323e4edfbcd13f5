#pragma once
// Subscriptions. A watcher has one credit: it acknowledges a result when the callback has returned, and the next result
// shows the newest revision then. It reconnects by itself, after a random 0.1 to 2 s, when the connection breaks or
// nothing (not even a heartbeat) arrived for 3 s. It ends on errors that reconnecting cannot cure.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "lpv/client.h"
#include "lpv/latency.h"

namespace lpv::client {

/// Counters of one watcher since its construction.
struct WatchStats {
  std::uint64_t results = 0;  ///< results passed to the callback
  std::uint64_t bytes = 0;  ///< bytes of their payloads
  std::uint64_t discarded = 0;  ///< results older than one already delivered
  std::uint64_t faults = 0;  ///< results that were malformed or had a wrong checksum
  std::uint64_t reopened = 0;  ///< times the stream was reconnected
};

/// Callbacks of a watcher besides its results.
struct WatchHooks {
  std::function<void(const v1::Subscribed&)> subscribed = {};  ///< after every connect
  std::function<void(const v1::Heartbeat&)> heartbeat = {};
  std::function<void(const v1::Notice&)> notice = {};
  std::function<void(const Status&)> reopening = {};  ///< why the stream broke
  std::function<void(const Status&)> ended = {};  ///< called once, unless stop() ended the watcher
  std::shared_ptr<LatencyLog> latency = {};  ///< records which edits have been seen
};

/// Watches volumes. Callbacks run on the watcher's thread. The destructor stops the watcher and waits for a running
/// callback; stop() may be called from a callback.
class VolumeWatcher {
 public:
  using OnVolume = std::function<void(VolumeResult)>;
  VolumeWatcher(const Client& client, v1::VolumeSubscription subscription, OnVolume onVolume, WatchHooks hooks = {});
  ~VolumeWatcher();
  VolumeWatcher(const VolumeWatcher&) = delete;
  VolumeWatcher& operator=(const VolumeWatcher&) = delete;

  void stop();
  WatchStats stats() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Watches frames; otherwise like VolumeWatcher.
class FrameWatcher {
 public:
  using OnFrame = std::function<void(FrameResult)>;
  FrameWatcher(const Client& client, v1::FrameSubscription subscription, OnFrame onFrame, WatchHooks hooks = {});
  ~FrameWatcher();
  FrameWatcher(const FrameWatcher&) = delete;
  FrameWatcher& operator=(const FrameWatcher&) = delete;

  /// Moves this subscriber's camera, also for later reconnects. Returns the sequence that frames showing it echo.
  std::uint64_t setCamera(const v1::Camera& camera);
  void setExposure(const v1::Exposure& exposure);
  /// Pixels.
  void setSize(int width, int height);
  void stop();
  WatchStats stats() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Watches the scene: delivers a snapshot, then every change in order, also across reconnects.
class SceneWatcher {
 public:
  /// Called with each snapshot, change or presence message. Messages with `more` are continued by the next one. After a
  /// reconnect presence starts again: members that are not listed then have left.
  using OnEvent = std::function<void(const v1::WatchSceneResponse&)>;
  /// `member`: identity of the member that watches (Editor::identity). It counts as present while it watches and gets
  /// no messages about itself.
  SceneWatcher(const Client& client, std::string session, std::uint64_t sinceRevision, OnEvent onEvent,
               WatchHooks hooks = {}, v1::ClientIdentity member = {});
  ~SceneWatcher();
  SceneWatcher(const SceneWatcher&) = delete;
  SceneWatcher& operator=(const SceneWatcher&) = delete;

  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lpv::client
