#include "ops/endpoint.h"

#include <CivetServer.h>

#include <utility>
#include <vector>

#include "base/mutex.h"

namespace lpv::ops {
namespace {

struct Answer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
};

Answer answerOf(const Status& status) {
  if (status.ok()) return {200, "text/plain; charset=utf-8", "ok\n"};
  return {503, "text/plain; charset=utf-8", status.message() + "\n"};
}

/// One page, rendered for every GET.
class Page final : public CivetHandler {
 public:
  using CivetHandler::handleGet;
  explicit Page(std::function<Answer()> make) : make_(std::move(make)) {}

  bool handleGet(CivetServer*, mg_connection* connection) override {
    const Answer answer = make_();
    const std::string all = "HTTP/1.1 " + std::to_string(answer.status) +
                            (answer.status == 200 ? " OK" : " Unavailable") + "\r\nContent-Type: " + answer.type +
                            "\r\nContent-Length: " + std::to_string(answer.body.size()) +
                            "\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n" + answer.body;
    mg_write(connection, all.data(), all.size());
    return true;
  }

 private:
  std::function<Answer()> make_;
};

/// Initialises the library; otherwise mg_start() would, and nothing would release it.
struct Library {
  Library() { mg_init_library(MG_FEATURES_DEFAULT); }
  ~Library() { mg_exit_library(); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
};

/// "localhost" may be an address of either family, and civetweb resolves no names.
std::string numeric(const std::string& address) {
  const std::string name = "localhost:";
  return address.starts_with(name) ? "127.0.0.1:" + address.substr(name.size()) : address;
}

}  // namespace

struct Endpoint::Parts {
  explicit Parts(const Health& health)
      : live([&health] { return answerOf(health.live()); }), ready([&health] { return answerOf(health.ready()); }) {}

  Answer metricsPage() {
    const MutexLock lock(mutex);
    if (!render) return answerOf(Status(Code::kUnavailable, "starting"));
    return {200, "text/plain; version=0.0.4; charset=utf-8", render()};
  }

  Page live;
  Page ready;
  Mutex mutex;
  std::function<std::string()> render LPV_GUARDED_BY(mutex);
  Page metrics{[this] { return metricsPage(); }};
  Library library;
  std::unique_ptr<CivetServer> server;  ///< last member: destroyed first, which ends its threads
};

Endpoint::Endpoint(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Endpoint::~Endpoint() = default;

Expected<std::unique_ptr<Endpoint>> Endpoint::open(const std::string& address, const Health& health) {
  auto parts = std::make_unique<Parts>(health);
  // Several threads, so that a slow request does not block the others; a request must arrive within 5 s.
  const std::vector<std::string> options{
      "listening_ports", numeric(address), "num_threads", "4", "request_timeout_ms", "5000"};
  try {
    parts->server = std::make_unique<CivetServer>(options);
  } catch (const CivetException&) {
    return Status(Code::kUnavailable,
                  "cannot listen on " + address + " (--ops-listen): it is in use or not an address of this machine",
                  "ops-listen");
  }
  parts->server->addHandler("/live$", parts->live);
  parts->server->addHandler("/ready$", parts->ready);
  parts->server->addHandler("/metrics$", parts->metrics);
  return std::unique_ptr<Endpoint>(new Endpoint(std::move(parts)));
}

int Endpoint::port() const { return parts_->server->getListeningPorts().front(); }

void Endpoint::publish(std::function<std::string()> metrics) {
  const MutexLock lock(parts_->mutex);
  parts_->render = std::move(metrics);
}

}  // namespace lpv::ops
