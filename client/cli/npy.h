#pragma once
// NumPy's array file, version 1.0.

#include <cstddef>
#include <string>
#include <vector>

namespace lpv::cli {

/// The bytes of a little-endian float32 array in C order. `values` has as many items as the product of `shape`.
std::string npyFile(const std::vector<std::size_t>& shape, const std::vector<float>& values);

}  // namespace lpv::cli
