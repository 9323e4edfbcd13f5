#pragma once
// Results as they are made. A watcher holds one result at a time: the next is asked for when the callback has returned
// and always shows the newest revision then. It reopens by itself, after 0.1 to 2 s chosen at random, when the
// connection breaks or nothing (not even a heartbeat) came for 3 s; it ends for errors that reopening cannot cure.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "lpv/client.h"
#include "lpv/latency.h"

namespace lpv::client {

/// Numbers of one watcher since it began.
struct WatchStats {
  std::uint64_t results = 0;    ///< handed to the callback
  std::uint64_t bytes = 0;      ///< of their payloads
  std::uint64_t discarded = 0;  ///< older than one already shown
  std::uint64_t faults = 0;     ///< malformed or with a wrong checksum
  std::uint64_t reopened = 0;   ///< times the stream was opened again
};

/// What a watcher tells besides results.
struct WatchHooks {
  std::function<void(const v1::Subscribed&)> subscribed = {};   ///< after every opening
  std::function<void(const v1::Heartbeat&)> heartbeat = {};
  std::function<void(const v1::Notice&)> notice = {};
  std::function<void(const Status&)> reopening = {};            ///< why the stream broke
  std::function<void(const Status&)> ended = {};                ///< once, unless stopped
  std::shared_ptr<LatencyLog> latency = {};                     ///< told which edits have been seen
};

/// Callbacks run on the watcher's thread. The destructor stops and waits for a callback that is running; stop() may be
/// called from a callback.
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

/// As VolumeWatcher, for pictures.
class FrameWatcher {
 public:
  using OnFrame = std::function<void(FrameResult)>;
  FrameWatcher(const Client& client, v1::FrameSubscription subscription, OnFrame onFrame, WatchHooks hooks = {});
  ~FrameWatcher();
  FrameWatcher(const FrameWatcher&) = delete;
  FrameWatcher& operator=(const FrameWatcher&) = delete;

  /// Moves this subscriber's camera; returns the sequence that the frames showing it echo. Kept over reopening.
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

/// The scene as it changes: a snapshot first, then every change in order, also across reconnections.
class SceneWatcher {
 public:
  /// Snapshot, change or presence, as sent; parts with `more` are followed by the rest. Presence starts anew
  /// when the stream was opened again: whoever is not told of then is gone.
  using OnEvent = std::function<void(const v1::WatchSceneResponse&)>;
  /// `member`: whose eyes these are (Editor::identity): it is present while it watches, and not told of itself.
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
