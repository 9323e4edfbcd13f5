#pragma once
// Procedural meshes for benches that are given no files.

#include <string>
#include <vector>

#include "lpv/v1/blob.pb.h"

namespace lpv::bench {

/// Numbers as the wire packs them.
template <typename T>
std::string bytesOf(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// A sphere of about `triangles` triangles, radius 0.4 m, standing on the origin.
v1::Mesh sphere(int triangles);
/// A box of 6 x 3 x 6 m seen from inside, standing on the origin.
v1::Mesh room();

}  // namespace lpv::bench
