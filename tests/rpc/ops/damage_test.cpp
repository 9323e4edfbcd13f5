// State that is damaged: said at the start, by session; a database that is gone is not taken for a new one.

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <fstream>

#include "rpc/streams/watched.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Changes a database behind the server's back.
void tamper(const std::string& database, const std::string& sql) {
  sqlite3* handle = nullptr;
  ASSERT_EQ(sqlite3_open(database.c_str(), &handle), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(handle);
  sqlite3_close(handle);
}

/// A state directory with two sessions, "hall" and "attic", that no server has open.
class DamagedState : public ::testing::Test {
 protected:
  DamagedState() {
    ServerProcess process(arguments());
    Stubs stubs(process.address());
    for (const char* id : {"hall", "attic"}) {
      pb::CreateSessionRequest request;
      request.set_session_id(id);
      pb::CreateSessionResponse response;
      EXPECT_THAT(stubs.session->CreateSession(Call(), request, &response), IsOk());
      apply(stubs, std::string("sessions/") + id, {client::createLight(light("Lamp"))});
    }
  }
  ~DamagedState() override { std::filesystem::remove_all(directory_); }

  std::string file(const std::string& name) const { return directory_ + "/" + name; }
  std::vector<std::string> arguments() const { return {"--state-dir", directory_}; }
  /// What a server says that does not start.
  std::string refusal() const {
    const Finished finished = runServer(arguments());
    EXPECT_EQ(finished.status, 1) << finished.errors;
    return finished.errors;
  }
  bool starts() const {
    ServerProcess process(arguments());
    Stubs stubs(process.address());
    pb::ListSessionsResponse all;
    EXPECT_THAT(stubs.session->ListSessions(Call(), {}, &all), IsOk());
    return all.sessions_size() == 2;
  }

  const std::string directory_ = makeDirectory();
};

grpc::Status open(Stubs& stubs, const std::string& id) {
  pb::GetSessionRequest request;
  request.set_name("sessions/" + id);
  pb::GetSessionResponse response;
  return stubs.session->GetSession(Call(), request, &response);
}

TEST_F(DamagedState, IsSaidAtTheStartBySession) {
  tamper(file("sessions.db"),
         "UPDATE snapshots SET sealed = substr(sealed, 1, length(sealed) - 1) || x'ff' WHERE session = 'hall'");
  Watched watched(arguments());
  EXPECT_TRUE(eventually([&] { return watched.metric("lpv_sessions_damaged") == 1.0; }));
  EXPECT_TRUE(eventually([&] {
    return watched.server().log().find("2 sessions read, 1 are damaged") != std::string::npos;
  })) << watched.server().log();
  EXPECT_THAT(watched.server().log(),
              AllOf(HasSubstr("hall"), HasSubstr("cannot be brought back"), HasSubstr("checksum")));
  const HttpAnswer ready = watched.get("/ready");
  EXPECT_EQ(ready.status, 200) << "the others are served";
  EXPECT_THAT(ready.body, AllOf(HasSubstr("1 session is damaged"), HasSubstr("hall"), Not(HasSubstr("attic"))));

  Stubs stubs(watched.server().address());
  EXPECT_THAT(open(stubs, "hall"), HasCode(StatusCode::DATA_LOSS));
  EXPECT_THAT(open(stubs, "attic"), IsOk());
  pb::DeleteSessionRequest request;
  request.set_name("sessions/hall");
  pb::DeleteSessionResponse response;
  ASSERT_THAT(stubs.session->DeleteSession(Call(), request, &response), IsOk());
  EXPECT_EQ(watched.metric("lpv_sessions_damaged"), 0.0) << "it is gone";
  EXPECT_EQ(watched.get("/ready").body, "ok\n");
}

TEST_F(DamagedState, OfContentsIsFoundToo) {
  tamper(file("sessions.db"), "UPDATE contents SET bytes = bytes || x'00'");
  Watched watched(arguments());
  EXPECT_TRUE(eventually([&] { return watched.metric("lpv_sessions_damaged") == 2.0; })) << watched.server().log();
}

TEST_F(DamagedState, NothingIsSaidOfWhatIsWhole) {
  Watched watched(arguments());
  EXPECT_TRUE(
      eventually([&] { return watched.server().log().find("2 sessions read, 0 are damaged") != std::string::npos; }));
  EXPECT_EQ(watched.metric("lpv_sessions_damaged"), 0.0);
  EXPECT_EQ(watched.get("/ready").body, "ok\n");
}

TEST_F(DamagedState, AMissingOrEmptyDatabaseIsNotTakenForANewOne) {
  const std::string whole = file("backup-elsewhere");
  tamper(file("sessions.db"), "PRAGMA wal_checkpoint(TRUNCATE)");  // all of it into the one file
  std::filesystem::copy_file(file("sessions.db"), whole);
  std::filesystem::remove(file("sessions.db"));
  EXPECT_THAT(refusal(), AllOf(HasSubstr("sessions.db is missing or empty"), HasSubstr("lock"),
                               HasSubstr("from a backup"), HasSubstr("begin anew")));
  EXPECT_FALSE(std::filesystem::exists(file("sessions.db"))) << "a refusal makes nothing";
  std::ofstream(file("sessions.db"), std::ios::trunc).close();
  EXPECT_THAT(refusal(), HasSubstr("sessions.db is missing or empty"));
  std::filesystem::remove(file("sessions.db"));
  tamper(file("sessions.db"), "VACUUM; PRAGMA user_version = 0");
  EXPECT_THAT(refusal(), HasSubstr("sessions.db is missing or empty")) << "a database without tables";
  std::filesystem::copy_file(whole, file("sessions.db"), std::filesystem::copy_options::overwrite_existing);
  EXPECT_TRUE(starts()) << "the way out";
}

TEST_F(DamagedState, FilesOfADatabaseThatIsGoneCount) {
  for (const char* left : {"sessions.db-wal", "sessions.db-shm", "sessions.db.bak"}) {
    for (const auto& entry : std::filesystem::directory_iterator(directory_)) std::filesystem::remove(entry.path());
    std::ofstream(file(left)) << "x";
    EXPECT_THAT(refusal(), HasSubstr(left));
  }
}

/// What others keep in the folder (certificates, a token) says nothing about sessions, nor does a start that failed
/// before there was a database.
TEST_F(DamagedState, AFolderWithoutTracesIsNew) {
  for (const auto& entry : std::filesystem::directory_iterator(directory_)) std::filesystem::remove(entry.path());
  std::ofstream(file("admin-token")) << "x";
  std::ofstream(file("lock")) << "4711";
  ServerProcess process(arguments());
  EXPECT_TRUE(process.running());
}

}  // namespace
}  // namespace lpv::rpc
