#include "ops/endpoint.h"

#include <utility>

#include "base/mutex.h"
#include "http/server.h"

namespace lpv::ops {
namespace {

http::Answer answerOf(const Status& status) {
  if (status.ok()) return {.body = "ok\n"};
  return {.status = 503, .body = status.message() + "\n"};
}

/// Readiness, and below it what is to be seen to.
http::Answer readyPage(const Health& health) {
  http::Answer answer = answerOf(health.ready());
  for (const std::string& warning : health.warnings()) answer.body += "warning: " + warning + "\n";
  return answer;
}

/// "localhost" may be an address of either family; it is the older one here.
HostPort numeric(HostPort at) {
  if (at.host == "localhost") at.host = "127.0.0.1";
  return at;
}

}  // namespace

struct Endpoint::Parts {
  http::Answer metricsPage() {
    const MutexLock lock(mutex);
    if (!render) return answerOf(Status(Code::kUnavailable, "starting"));
    return {200, "text/plain; version=0.0.4; charset=utf-8", render()};
  }

  Mutex mutex;
  std::function<std::string()> render LPV_GUARDED_BY(mutex);
  std::unique_ptr<http::Server> server;  ///< last member: destroyed first, which ends its threads
};

Endpoint::Endpoint(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Endpoint::~Endpoint() = default;

Expected<std::unique_ptr<Endpoint>> Endpoint::open(const HostPort& at, const Health& health) {
  auto parts = std::make_unique<Parts>();
  std::map<std::string, http::Handler> paths{
      {"/live", [&health](const http::Request&) { return answerOf(health.live()); }},
      {"/ready", [&health](const http::Request&) { return readyPage(health); }},
      {"/metrics", [page = parts.get()](const http::Request&) { return page->metricsPage(); }}};
  Expected<std::unique_ptr<http::Server>> server = http::Server::open(numeric(at), std::move(paths), {});
  if (!server) return Status(Code::kUnavailable, "--ops-listen: " + server.status().message(), "ops-listen");
  parts->server = std::move(*server);
  return std::unique_ptr<Endpoint>(new Endpoint(std::move(parts)));
}

int Endpoint::port() const { return parts_->server->port(); }

void Endpoint::publish(std::function<std::string()> metrics) {
  const MutexLock lock(parts_->mutex);
  parts_->render = std::move(metrics);
}

}  // namespace lpv::ops
