#pragma once

#include <cstdint>

namespace lpv::ops {

/// Resources that this process uses; 0 if the system does not report them.
struct ProcessUse {
  double cpuSeconds = 0.0;  ///< user and system, of all threads so far
  std::int64_t residentBytes = 0;
  std::int64_t openFiles = 0;
};
ProcessUse processUse();

}  // namespace lpv::ops
