#pragma once
// A reader's copy of the scene, made of the events of WatchScene, whatever becomes of the streams in between.

#include <optional>

#include "lpv/v1/scene.pb.h"
#include "rpc/durability/faults/history.h"

namespace lpv::rpc::faults {

namespace pb = lpv::v1;

/// The light whose colour says the last edit.
inline constexpr const char* kLamp = "Lamp";
/// That colour, W/(sr m^2).
pb::Vec3 colourOf(const EditId& id);

/// A scene to which objects are added, changed, deleted.
class SceneBuilder {
 public:
  void put(const pb::Light& light);
  void put(const pb::Surface& surface);
  void erase(const std::string& name);
  void clear();

  const SceneState& state() const { return state_; }
  void stand(std::uint64_t epoch, std::uint64_t revision);
  /// Sum of all objects' hashes: it does not depend on the order in which they came.
  std::uint64_t digest() const { return digest_; }
  /// The edit whose colour the lamp has is there.
  bool whole() const { return state_.last.empty() || state_.objects.contains(state_.last); }

 private:
  void put(const std::string& name, std::uint64_t revision, const std::string& bytes);

  SceneState state_;
  std::uint64_t digest_ = 0;
};

/// What WatchScene told.
class SceneMirror {
 public:
  /// Takes an event. The read where it was the last part of a snapshot or change.
  std::optional<Read> take(const pb::WatchSceneResponse& event);
  /// The stream is over: what came in half is forgotten, and the next stream has to begin where `since` says.
  void breakOff();
  /// What the next stream asks for.
  void askIn(pb::WatchSceneRequest* request) const;

  const SceneState& state() const { return scene_.state(); }

 private:
  template <typename Event>
  void takeObjects(const Event& event);
  Read read() const;

  SceneBuilder scene_;
  bool inSnapshot_ = false;  ///< parts of it are missing
  std::optional<std::uint64_t> follows_;
};

}  // namespace lpv::rpc::faults
