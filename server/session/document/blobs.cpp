#include "session/document/blobs.h"

namespace lpv {
namespace {

std::int64_t trianglesOf(const Blob& blob) { return blob.mesh ? std::int64_t(blob.mesh->triangles.size()) : 0; }
std::int64_t texelsOf(const Blob& blob) {
  return blob.texture ? std::int64_t(blob.texture->width) * blob.texture->height : 0;
}

}  // namespace

Expected<bool> Blobs::add(const BlobPtr& blob, Clock::time_point now) {
  if (const auto found = entries_.find(blob->hash); found != entries_.end()) {
    found->second.touched = now;
    return true;
  }
  if (triangles_ + trianglesOf(*blob) > limits_.maxTriangles) {
    return exhausted(Reason::kMaxTriangles, "max_triangles",
                     "max_triangles: the session holds " + std::to_string(triangles_) + " triangles, this mesh has " +
                         std::to_string(trianglesOf(*blob)) + ", allowed are " + std::to_string(limits_.maxTriangles));
  }
  if (texels_ + texelsOf(*blob) > limits_.maxTexels) {
    return exhausted(Reason::kMaxTexels, "max_texels",
                     "max_texels: the session holds " + std::to_string(texels_) + " texels, this texture has " +
                         std::to_string(texelsOf(*blob)) + ", allowed are " + std::to_string(limits_.maxTexels));
  }
  restore(blob, now);
  return false;
}

void Blobs::restore(const BlobPtr& blob, Clock::time_point now) {
  entries_[blob->hash] = {blob, now};
  bytes_ += std::int64_t(blob->bytes->size());
  triangles_ += trianglesOf(*blob);
  texels_ += texelsOf(*blob);
}

BlobPtr Blobs::find(const BlobHash& hash) const {
  const auto found = entries_.find(hash);
  return found == entries_.end() ? nullptr : found->second.blob;
}

void Blobs::touch(const BlobHash& hash, Clock::time_point now) {
  if (const auto found = entries_.find(hash); found != entries_.end()) found->second.touched = now;
}

std::vector<BlobHash> Blobs::dropUnused(const std::set<BlobHash>& used, Clock::time_point now) {
  std::vector<BlobHash> dropped;
  for (auto it = entries_.begin(); it != entries_.end();) {
    if (used.contains(it->first)) {
      it->second.touched = now;
      ++it;
    } else if (now - it->second.touched < limits_.keepUnusedBlobs) {
      ++it;
    } else {
      subtract(*it->second.blob);
      dropped.push_back(it->first);
      it = entries_.erase(it);
    }
  }
  return dropped;
}

std::vector<BlobPtr> Blobs::all() const {
  std::vector<BlobPtr> out;
  for (const auto& [hash, entry] : entries_) out.push_back(entry.blob);
  return out;
}

void Blobs::subtract(const Blob& blob) {
  bytes_ -= std::int64_t(blob.bytes->size());
  triangles_ -= trianglesOf(blob);
  texels_ -= texelsOf(blob);
}

}  // namespace lpv
