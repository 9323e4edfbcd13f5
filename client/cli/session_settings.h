#pragma once
// The flags of `session create`, `session set` and `render` that say what a session wants.

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lpv/v1/session.pb.h"

namespace lpv::cli {

/// Reads itself from the command line; what was not given stays unset.
class SessionFlags {
 public:
  SessionFlags();
  ~SessionFlags();
  void addTo(CLI::App& app);

  /// Writes what was given into `settings` and returns the paths written ("settings.iterations").
  std::vector<std::string> apply(v1::SessionSettings& settings) const;

 private:
  struct Given;
  std::unique_ptr<Given> given_;
};

}  // namespace lpv::cli
