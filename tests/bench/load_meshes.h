#pragma once
// Procedural meshes for benches that are given no files.

#include <cstring>
#include <string>
#include <vector>

#include "lpv/v1/blob.pb.h"

namespace lpv::bench {

/// Numbers as the wire packs them.
template <typename T>
std::string bytesOf(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// The reverse.
template <typename T>
std::vector<T> numbersOf(const std::string& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

/// A sphere of about `triangles` triangles, radius 0.4 m, standing on the origin.
v1::Mesh sphere(int triangles);
/// A box of 6 x 3 x 6 m seen from inside, standing on the origin.
v1::Mesh room();

}  // namespace lpv::bench
