#pragma once

namespace lpv {

/// Why a session's streams end.
enum class Closing {
  kDeleted,
  kDraining,
  kEvicted,  ///< idle: it is kept on disk, and comes back with the next call
};

}  // namespace lpv
