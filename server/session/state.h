#pragma once
// A session as values: what is kept of it, and what is told of it.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/engine.h"
#include "scene/forecast.h"
#include "session/document/blobs.h"
#include "session/document/document.h"
#include "session/members/members.h"
#include "store/saved.h"

namespace lpv {

/// Settings of a session that are not its light transport's.
struct SessionPolicy {
  std::chrono::seconds ttl{3600};  ///< 0 = never expires
  std::string displayName;
};

/// All of a session's settings.
struct SessionSettings {
  LightingSettings options;
  SessionPolicy policy;
};

/// How long an accepted edit is sure to live.
enum class Durability { kMemory, kDisk };

/// A session in numbers.
struct SessionSummary {
  std::string id;
  std::string displayName;
  LightingSettings options;
  Grid grid;
  std::uint64_t revision = 0;
  std::uint64_t epoch = 0;
  std::chrono::system_clock::time_point created;
  std::chrono::seconds ttl{3600};
  std::size_t lights = 0;
  std::size_t surfaces = 0;
  std::int64_t triangles = 0;
  std::size_t clients = 0;
  std::size_t subscribers = 0;
  std::size_t blobs = 0;
  std::int64_t blobBytes = 0;
  std::chrono::system_clock::time_point lastUsed;
  std::optional<MeasuredError> measured;
  std::optional<Forecast> forecast;  ///< the last that was made
  std::optional<MemoryUse> memory;   ///< on the GPU, at the end of the last tick
  Durability durability = Durability::kMemory;
};

/// Everything that a session comes back from. Not in it: what was computed, subscribers, and the default view, which is
/// chosen anew from the scene as it comes back.
struct SavedSession {
  std::string id;
  std::uint64_t epoch = 0;
  std::string requestId;  ///< of the call that made it
  std::chrono::system_clock::time_point created;
  SessionPolicy policy;
  DocumentState document;
  std::vector<ClientState> clients;
  std::vector<BlobPtr> uploads;  ///< in use or not
};

}  // namespace lpv
