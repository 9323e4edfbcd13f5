#include "tsan/house.h"

#include <gtest/gtest.h>

#include "convert/blob_content.h"
#include "ops/metrics.h"

namespace lpv::test {

House::House(const store::Folder& folder) {
  store::SqliteOptions sqlite;
  sqlite.compactAfterRecords = 20;
  store::CommitQueueOptions queue;
  queue.retry = std::chrono::milliseconds(5);
  queue.executor = [this](std::function<void()> call) { pool_.post(std::move(call)); };
  queue.onCommit = [this](std::chrono::duration<double> took, bool) {
    counters_.storeCommitSeconds.observe(took.count());
  };
  store_ = store::openStore(folder, std::move(sqlite), std::move(queue));
  journal_ = std::make_unique<api::PersistentJournal>(*store_);
  access_ = std::make_unique<Access>(*journal_, timers_);
  EXPECT_TRUE(access_->open().ok());
  EXPECT_TRUE(access_->require("an admin's token of this test").ok());
  Limits limits;
  limits.maxTickRate = 1e9;
  limits.maxEditsPerSecond = 1e9;
  limits.maxPresenceUpdatesPerSecond = 1e9;
  limits.keepUnusedBlobs = std::chrono::minutes(0);
  limits.selfCheck = std::chrono::seconds(1);
  services_ = {limits, &engine_, &pool_, &timers_, &counters_, api::meshHash, journal_.get(), access_.get(), {}};
  registry_ = std::make_unique<Registry>(services_);
  EXPECT_TRUE(registry_->open().ok());
  context_ = std::make_unique<api::Context>(api::Context{registry_.get(), &pool_, &timers_, &counters_, limits,
                                                         engine_.device(), "tsan", std::chrono::system_clock::now(),
                                                         access_.get()});
}

House::~House() {
  EXPECT_TRUE(registry_->quiesce().ok());
  registry_->drain();
  timers_.stop();
  pool_.stop();
}

std::string House::metrics() {
  ops::MetricSources sources;
  sources.counters = &counters_;
  sources.answers = context_->answers.get();
  sources.damaged = services_.damaged.get();
  sources.registry = registry_.get();
  sources.journal = journal_.get();
  sources.engine = &engine_;
  sources.storeQueue = [this] { return store_->queued(); };
  sources.started = context_->started;
  return ops::renderMetrics(sources);
}

}  // namespace lpv::test
