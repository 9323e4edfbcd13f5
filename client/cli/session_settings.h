#pragma once
// The flags of `session create`, `session set` and `render` for a session's settings.

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lpv/v1/session.pb.h"

namespace lpv::cli {

/// Settings given on the command line; those not given stay unset.
class SessionFlags {
 public:
  SessionFlags();
  ~SessionFlags();
  void addTo(CLI::App& app);

  /// Writes the given settings into `settings` and returns their paths ("settings.iterations").
  std::vector<std::string> apply(v1::SessionSettings& settings) const;

 private:
  struct Given;
  std::unique_ptr<Given> given_;
};

}  // namespace lpv::cli
