#pragma once
// EXT_meshopt_compression, decoded by meshoptimizer.

#include <cstddef>
#include <string>
#include <string_view>

#include "base/status.h"

namespace lpv::cli {

/// A compressed buffer view, as its extension describes it.
struct MeshoptView {
  std::string_view bytes;
  std::size_t count = 0;
  std::size_t stride = 0;  ///< bytes of an element
  std::string mode;        ///< ATTRIBUTES, TRIANGLES or INDICES
  std::string filter;      ///< NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL
};

/// Whether this program was built with meshoptimizer.
bool meshoptIsBuiltIn();

/// The `count` x `stride` bytes; INVALID_ARGUMENT if they cannot be decoded or meshoptimizer is not built in.
Expected<std::string> decodeMeshopt(const MeshoptView& view);

}  // namespace lpv::cli
