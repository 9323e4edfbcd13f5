#pragma once
// Sessions that are kept in a folder, by a registry that can be started again on it.

#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "convert/blob_content.h"
#include "persistence/persistent_journal.h"
#include "session/registry.h"
#include "unit/session/session_rig.h"
#include "unit/store/store_rig.h"

namespace lpv::test {

/// A registry with a state directory.
class KeptSessions : public testing::Test {
 protected:
  KeptSessions() { start(); }
  ~KeptSessions() override { stop(); }

  void start(std::chrono::seconds retain = std::chrono::hours(1)) {
    store::SqliteOptions options;
    options.compactAfterRecords = 7;  // often: what comes back was folded and not
    store::CommitQueueOptions queue;
    queue.retry = std::chrono::milliseconds(5);
    store_ = store::openStore(folder_, options, queue);
    ASSERT_NE(store_, nullptr);
    journal_.emplace(*store_);
    SessionServices services = rig_.services;
    services.hasher = api::meshHash;
    services.journal = &*journal_;
    registry_ = std::make_unique<Registry>(services, retain);
    ASSERT_TRUE(registry_->open().ok());
  }
  void stop() {
    rig_.settle();
    registry_.reset();
    journal_.reset();
    store_.reset();
  }
  void restart() {
    stop();
    start();
  }
  SessionPtr create(const std::string& id, std::chrono::seconds ttl = std::chrono::hours(1)) {
    const Expected<SessionPtr> session = registry_->create(id, LightingSettings(), {ttl, "Hall"}, "");
    EXPECT_TRUE(session.ok()) << session.status().message();
    return session ? *session : nullptr;
  }
  SessionPtr find(const std::string& id) {
    const Expected<SessionPtr> session = registry_->find(id);
    EXPECT_TRUE(session.ok()) << session.status().message();
    return session ? *session : nullptr;
  }
  static EditOutcome edit(const SessionPtr& session, std::vector<Operation> operations, std::uint64_t sequence = 0,
                          const ClientIdentity& client = {}) {
    EditOutcome outcome = session->apply(client, editOf(std::move(operations), sequence));
    EXPECT_TRUE(outcome.status.ok()) << outcome.status.message();
    return outcome;
  }
  /// What somebody is told.
  static EditOutcome confirmed(const SessionPtr& session, const EditOutcome& outcome) {
    std::promise<EditOutcome> promise;
    session->confirmWhenDurable(outcome, [&promise](const EditOutcome& told) { promise.set_value(told); });
    return promise.get_future().get();
  }

  store::Folder folder_;
  Rig rig_;
  std::unique_ptr<store::SqliteStore> store_;
  std::optional<api::PersistentJournal> journal_;
  std::unique_ptr<Registry> registry_;
};

}  // namespace lpv::test
