#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/status.h"
#include "ops/health.h"

namespace lpv::ops {

/// Plain HTTP for operators: GET /live and /ready (200 "ok", or 503 and the reason), /metrics (Prometheus text format
/// 0.0.4; 503 before publish()). Other paths are 404.
class Endpoint {
 public:
  /// Listens on "HOST:PORT"; port 0 picks a free one. UNAVAILABLE if it cannot listen. `health` must outlive this.
  static Expected<std::unique_ptr<Endpoint>> open(const std::string& address, const Health& health);
  /// Waits for requests in progress.
  ~Endpoint();

  int port() const;
  /// Sets the function that renders /metrics. It is called on the endpoint's threads.
  void publish(std::function<std::string()> metrics);

 private:
  struct Parts;
  explicit Endpoint(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace lpv::ops
