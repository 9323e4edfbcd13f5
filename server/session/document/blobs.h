#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "base/timers.h"
#include "scene/mesh.h"
#include "scene/texture.h"
#include "session/limits.h"

namespace lpv {

enum class BlobKind { kMesh, kTexture };

/// A mesh or texture and the bytes it came as.
struct Blob {
  BlobKind kind = BlobKind::kMesh;
  BlobHash hash;
  std::shared_ptr<const std::string> bytes;
  MeshPtr mesh;        ///< set for kMesh
  TexturePtr texture;  ///< set for kTexture
};
using BlobPtr = std::shared_ptr<const Blob>;

/// The blobs of one session by hash. Not thread-safe: the session's lock guards it.
class Blobs {
 public:
  explicit Blobs(const Limits& limits) : limits_(limits) {}
  /// From now on; what is there stays.
  void setLimits(const Limits& limits) { limits_ = limits; }

  /// True where it was there already. RESOURCE_EXHAUSTED by name where the session is full.
  Expected<bool> add(const BlobPtr& blob, Clock::time_point now);
  /// Takes a blob back whatever the limits.
  void restore(const BlobPtr& blob, Clock::time_point now);
  BlobPtr find(const BlobHash& hash) const;
  /// Somebody asked for it.
  void touch(const BlobHash& hash, Clock::time_point now);
  /// Blobs that `used` does not hold and that nobody added or asked for since `keepUnusedBlobs` go; says which.
  std::vector<BlobHash> dropUnused(const std::set<BlobHash>& used, Clock::time_point now);

  std::vector<BlobPtr> all() const;
  std::size_t count() const { return entries_.size(); }
  std::int64_t bytes() const { return bytes_; }

 private:
  struct Entry {
    BlobPtr blob;
    Clock::time_point touched;
  };
  void subtract(const Blob& blob);

  Limits limits_;
  std::map<BlobHash, Entry> entries_;
  std::int64_t bytes_ = 0;
  std::int64_t triangles_ = 0;
  std::int64_t texels_ = 0;
};

}  // namespace lpv
