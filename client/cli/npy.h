#pragma once
// NumPy's array file, version 1.0.

#include <cstddef>
#include <string>
#include <vector>

namespace lpv::cli {

/// A little-endian float32 array in C order; `values` holds the product of `shape` many.
std::string npyFile(const std::vector<std::size_t>& shape, const std::vector<float>& values);

}  // namespace lpv::cli
