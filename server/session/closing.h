#pragma once

namespace lpv {

/// Why a session's streams end.
enum class Closing {
  kDeleted,
  kDraining,
  kEncodingFailed,  ///< of one subscriber: its frame could not be encoded; the session goes on
  kClientClosed,    ///< of one subscriber: it has closed its side; the session goes on
  kEvicted,         ///< idle: it is kept on disk, and comes back with the next call
};

}  // namespace lpv
