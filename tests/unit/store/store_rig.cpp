#include "unit/store/store_rig.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>

namespace lpv::store {

Folder::Folder() {
  path_ = (std::filesystem::temp_directory_path() / "lpv-store-XXXXXX").string();
  if (!mkdtemp(path_.data())) ADD_FAILURE() << "cannot make " << path_;
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

FileLimit::FileLimit(std::uintmax_t bytes) {
  signal(SIGXFSZ, SIG_IGN);
  getrlimit(RLIMIT_FSIZE, &before_);
  rlimit limit = before_;
  limit.rlim_cur = rlim_t(bytes);
  setrlimit(RLIMIT_FSIZE, &limit);
}

FileLimit::~FileLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

Position SqliteStore::create(const SessionHead& head, const FullSnapshot& whole) {
  return takeOver(head.id, [=](Backend& tables) { return tables.create(head, whole); });
}

Position SqliteStore::append(const std::string& session, MakeLogRecord make) {
  return push(session, [session, make = std::move(make)](Backend& tables) { return tables.append(session, make); });
}

Position SqliteStore::setEpoch(const std::string& session, std::uint64_t epoch) {
  return takeOver(session, [=](Backend& tables) { return tables.setEpoch(session, epoch); });
}

Position SqliteStore::touch(const std::string& session, std::chrono::system_clock::time_point used) {
  return push(session, [=](Backend& tables) { return tables.touch(session, used); });
}

Position SqliteStore::remove(const std::string& session) {
  return push(session, [=](Backend& tables) { return tables.remove(session); });
}

std::unique_ptr<SqliteStore> openStore(const Folder& folder, SqliteOptions options, CommitQueueOptions queue) {
  options.directory = folder.path();
  Expected<std::unique_ptr<SqliteBackend>> tables = SqliteBackend::open(std::move(options));
  EXPECT_TRUE(tables.ok()) << tables.status().message();
  return tables ? std::make_unique<SqliteStore>(std::move(*tables), std::move(queue)) : nullptr;
}

Position createSession(SqliteStore& store, const std::string& id, std::uint64_t epoch) {
  SessionHead head;
  head.id = id;
  head.epoch = epoch;
  head.requestId = "request of " + id;
  head.created = head.lastUsed = std::chrono::system_clock::time_point(std::chrono::seconds(1'000'000));
  head.ttl = std::chrono::seconds(3600);
  pb::Snapshot snapshot;
  (*snapshot.mutable_clients())["me"].set_secret_hash("hash of my secret");
  return store.create(head, {snapshot, {}});
}

pb::Record lampRecord(std::uint64_t revision, const std::string& mesh) {
  pb::Record record;
  record.set_revision(revision);
  lpv::v1::Light* light = record.add_lights();
  light->set_name("Lamp");
  light->set_mesh(mesh);
  light->mutable_radiance()->set_x(double(revision));
  light->mutable_status()->set_revision(revision);
  record.set_client_id("me");
  record.mutable_outcome()->set_sequence(revision);
  record.mutable_outcome()->set_revision(revision);
  return record;
}

MakeLogRecord lampStep(std::uint64_t revision, const std::string& mesh, const std::string& bytes) {
  return [=](const HasContent& holds) {
    LogRecord step{lampRecord(revision, mesh), {}};
    if (!holds(mesh)) {
      step.contents.push_back({mesh, lpv::v1::BLOB_KIND_MESH, std::make_shared<const std::string>(bytes)});
    }
    return step;
  };
}

Status keptAt(CommitQueue& store, Position position, const std::string& session) {
  std::promise<Status> promise;
  store.whenDurable(session, position, [&promise](const Status& status) { promise.set_value(status); });
  return promise.get_future().get();
}

std::int64_t ask(const Folder& folder, const std::string& sql) {
  const Expected<std::unique_ptr<Database>> database = Database::open(folder.database());
  EXPECT_TRUE(database.ok());
  Statement statement = (*database)->query(sql.c_str());
  const Expected<bool> row = statement.step();
  EXPECT_TRUE(row.ok() && *row) << row.status().message();
  return statement.integer(0);
}

void tamper(const Folder& folder, const std::string& sql) {
  const Expected<std::unique_ptr<Database>> database = Database::open(folder.database());
  ASSERT_TRUE(database.ok());
  const Status status = (*database)->run(sql.c_str());
  ASSERT_TRUE(status.ok()) << status.message();
}

}  // namespace lpv::store
