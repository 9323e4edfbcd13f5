#include "lpv/resources/cell_box.h"

namespace lpv {

CellBox CellBox::grown(const glm::ivec3& dims, int by) const {
  if (empty()) return *this;
  return {glm::max(lower - by, glm::ivec3(0)), glm::min(upper + by, dims)};
}

}  // namespace lpv
