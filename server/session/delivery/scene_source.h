#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "base/status.h"
#include "scene/scene.h"

namespace lpv {

/// A session at one revision, as a tick reads it.
struct SceneMoment {
  ScenePtr scene;
  Lookup lookup = Lookup::kSh2;                          ///< as the settings have it
  std::map<std::string, std::uint64_t> clientSequences;  ///< highest accepted edit sequence, by member

  /// 0 for nobody.
  std::uint64_t sequenceOf(const std::string& client) const {
    const auto found = clientSequences.find(client);
    return found == clientSequences.end() ? 0 : found->second;
  }
};

/// What delivery needs of its session. Thread-safe; each function acquires the session's lock for microseconds and may
/// be called with the delivery's lock held.
class SceneSource {
 public:
  virtual ~SceneSource() = default;

  virtual std::uint64_t revision() const = 0;
  /// Takes time that grows with the scene, though not under the session's lock.
  virtual SceneMoment moment() = 0;
  /// The scene from which a view is chosen for readers that give no camera.
  virtual ScenePtr viewScene() const = 0;
  /// Null where the session has no camera of that name.
  virtual std::optional<Camera> camera(const std::string& name) const = 0;
  /// Ok, or why nothing is accepted any more.
  virtual Status accepting() const = 0;
  /// The session is in use, by that member where it is not empty.
  virtual void markUsed(const std::string& client) = 0;
  /// Expires with the session: delivery's work on other threads asks it before it comes back.
  virtual std::weak_ptr<const void> lifetime() const = 0;
};

}  // namespace lpv
