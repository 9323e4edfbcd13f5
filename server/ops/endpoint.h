#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/status.h"
#include "ops/health.h"

namespace lpv::ops {

/// Plain HTTP for those who run the server: GET /live and /ready (200 "ok", or 503 and why), /metrics (Prometheus text
/// format 0.0.4; 503 before there are any). Answers nothing else.
class Endpoint {
 public:
  /// Listens on "HOST:PORT"; port 0 takes a free one. UNAVAILABLE where that is not possible. `health` outlives this.
  static Expected<std::unique_ptr<Endpoint>> open(const std::string& address, const Health& health);
  /// Returns when no question is being answered any more.
  ~Endpoint();

  int port() const;
  /// What /metrics answers with, from now on. Called on threads of the endpoint's.
  void publish(std::function<std::string()> metrics);

 private:
  struct Parts;
  explicit Endpoint(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace lpv::ops
