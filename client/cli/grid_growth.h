#pragma once
// Whether what a command adds makes the grid's cells much larger: a file in millimetres read as metres does.

#include <optional>
#include <string>

#include "lpv/client.h"
#include "scene/bounds.h"
#include "scene/grid.h"

namespace lpv::cli {

/// The session's grid before a command, to be compared with the one after it.
class GridGrowth {
 public:
  /// Reads the grid. There is nothing to compare where the session has no content yet.
  static Expected<GridGrowth> since(client::Client& client, const std::string& session);

  /// Reads the grid again: true if its cells have become more than fourfold as large.
  bool isLarge() const;

  /// Warns of what isLarge() found. `what` was added ("light 'statue'") and takes this much of the world; `scale`: the
  /// --scale that it was added with. Proposes a smaller one where the size is the reason, not the place.
  void warn(const std::string& what, const Bounds& added, const std::optional<glm::dvec3>& scale) const;

 private:
  GridGrowth(client::Client client, std::string session);

  mutable client::Client client_;
  std::string session_;
  std::optional<Grid> before_;
  mutable Grid after_;
};

}  // namespace lpv::cli
