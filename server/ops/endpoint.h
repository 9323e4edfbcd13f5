#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/address.h"
#include "base/status.h"
#include "ops/health.h"

namespace lpv::ops {

/// Plain HTTP for operators: GET /live and /ready (200 "ok", or 503 and the reason; /ready with a line "warning: ..."
/// for what is to be seen to), /metrics (Prometheus text format 0.0.4; 503 before publish()). Other paths are 404.
class Endpoint {
 public:
  /// Listens; the host is an address or "localhost". UNAVAILABLE if it cannot listen. `health` must outlive this.
  static Expected<std::unique_ptr<Endpoint>> open(const HostPort& at, const Health& health);
  /// Waits for pages that are being made.
  ~Endpoint();

  int port() const;
  /// Sets the function that renders /metrics. It is called on a thread of the endpoint.
  void publish(std::function<std::string()> metrics);

 private:
  struct Parts;
  explicit Endpoint(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace lpv::ops
