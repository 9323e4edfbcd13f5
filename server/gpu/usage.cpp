#include "gpu/usage.h"

namespace lpv::gpu {

Usage& usage() {
  thread_local Usage all;
  return all;
}

}  // namespace lpv::gpu
