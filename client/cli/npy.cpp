#include "npy.h"

#include <bit>

namespace lpv::cli {

std::string npyFile(const std::vector<std::size_t>& shape, const std::vector<float>& values) {
  static_assert(std::endian::native == std::endian::little);
  std::string dims;
  for (const std::size_t n : shape) dims += std::to_string(n) + ",";
  if (shape.size() > 1) dims.pop_back();  // "(3,)" but "(3,4)"
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (" + dims + "), }";
  constexpr std::size_t kPreamble = 10;  // magic, version, length of the header
  header.append(63 - (kPreamble + header.size()) % 64, ' ');
  header += '\n';
  std::string out("\x93NUMPY\x01\x00", 8);
  out += char(header.size() & 0xffU);
  out += char(header.size() >> 8U);
  out += header;
  out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  return out;
}

}  // namespace lpv::cli
