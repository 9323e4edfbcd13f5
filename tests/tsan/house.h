#pragma once
// A whole server without a door or a GPU: workers, timers, an engine with a thread, sessions on disk, access tokens.

#include <future>
#include <memory>
#include <string>
#include <thread>

#include "api/services.h"
#include "persistence/persistent_journal.h"
#include "unit/session/small_engine.h"
#include "unit/store/store_rig.h"

namespace lpv::test {

namespace pb = lpv::v1;

class House {
 public:
  explicit House(const store::Folder& folder);
  /// Drains first, as a server does.
  ~House();

  const api::Context& context() const { return *context_; }
  Registry& registry() { return *registry_; }
  const ThreadedEngine& engine() const { return engine_; }
  /// The text of /metrics.
  std::string metrics();

  /// A call that is answered at once.
  template <typename Response, typename Request>
  Status ask(Status (*function)(const api::Context&, const Request&, Response*), const Request& request,
             Response* response) {
    return function(*context_, request, response);
  }
  /// A call that is answered when what it did is kept; waits.
  template <typename Response, typename Request>
  Status ask(void (*function)(const api::Context&, const Request&, Response*, api::Done), const Request& request,
             Response* response) {
    std::promise<Status> promise;
    function(*context_, request, response, [&promise](const Status& status) { promise.set_value(status); });
    return promise.get_future().get();
  }

 private:
  Counters counters_;
  Timers timers_;
  WorkerPool pool_{3};
  ThreadedEngine engine_;
  std::unique_ptr<store::SqliteStore> store_;
  std::unique_ptr<api::PersistentJournal> journal_;
  std::unique_ptr<Access> access_;
  std::unique_ptr<Registry> registry_;
  std::unique_ptr<api::Context> context_;
  SessionServices services_;
};

}  // namespace lpv::test
