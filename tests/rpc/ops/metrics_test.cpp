// Metrics: those of the table are in the scrape, and they move when what they count happens.

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>

#include "rpc/streams/seen.h"
#include "rpc/streams/watched.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Metrics : public ::testing::Test {
 protected:
  Metrics() : watched_({"--max-lights", "1", "--max-sessions", "1", "--self-check", "1"}) {}

  pb::UpdateSubscriptionRequest acknowledgement(const std::string& subscriber, std::uint64_t resultId) const {
    pb::UpdateSubscriptionRequest request;
    request.set_session(session_);
    request.set_subscriber(subscriber);
    request.mutable_update()->mutable_acknowledge()->set_result_id(resultId);
    return request;
  }
  void getVolume() {
    pb::GetVolumeRequest request;
    request.set_session(session_);
    auto client = clientOf(watched_.server().address());
    EXPECT_TRUE(client.volume(request).ok());
  }
  double metric(const std::string& series) const { return watched_.metric(series); }

  Watched watched_;
  Stubs stubs_{watched_.server().address()};
  std::string session_ = makeLitSession(stubs_);
};

/// Each metric of the scrape is in the table with its type, and the other way round.
TEST_F(Metrics, AreThoseOfTheTable) {
  std::map<std::string, std::string> documented;
  std::ifstream table(METRICS_TABLE);
  for (std::string line; std::getline(table, line);) {
    if (line.starts_with("## ")) break;  // the tables behind are about the log
    if (!line.starts_with("| `")) continue;
    const std::size_t end = line.find('`', 3);
    const std::size_t type = line.find("| ", end) + 2;
    documented[line.substr(3, end - 3)] = line.substr(type, line.find(' ', type) - type);
  }
  ASSERT_GT(documented.size(), 20U) << METRICS_TABLE;
  std::map<std::string, std::string> scraped;
  const HttpAnswer answer = watched_.get("/metrics");
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.type, "text/plain; version=0.0.4; charset=utf-8");
  for (const std::string& line : linesOf(answer.body)) {
    std::istringstream words(line);
    std::string hash, word, name, type;
    words >> hash >> word >> name >> type;
    if (hash == "#" && word == "TYPE") scraped[name] = type;
  }
  EXPECT_EQ(scraped, documented);
}

/// The dashboard asks for nothing that is not there.
TEST_F(Metrics, OfTheDashboardAreThere) {
  std::stringstream dashboard;
  dashboard << std::ifstream(DASHBOARD).rdbuf();
  const std::string text = dashboard.str();
  const std::string scrape = watched_.get("/metrics").body;
  const std::regex name("(lpv|process)_[a-z_]+");
  int found = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), name), end; it != end; ++it, ++found) {
    EXPECT_THAT(scrape, ::testing::ContainsRegex("\n(# TYPE )?" + it->str() + "[ {]"));
  }
  EXPECT_GT(found, 20) << DASHBOARD;
}

TEST_F(Metrics, NameNoSessionAndNoClient) {
  const pb::ClientIdentity client = join(stubs_, session_);
  getVolume();
  const std::string scrape = watched_.get("/metrics").body;
  EXPECT_THAT(scrape, Not(HasSubstr(session_.substr(session_.find('/') + 1))));
  EXPECT_THAT(scrape, Not(HasSubstr(client.client_id())));
}

TEST_F(Metrics, MoveWithEdits) {
  EXPECT_EQ(metric("lpv_edits_accepted_total"), 1);
  EXPECT_EQ(metric("lpv_edits_rejected_total{reason=\"max_lights\"}"), 0) << "there before it happens";
  apply(stubs_, session_, {client::setRadiance("Lamp", {2, 2, 2})});
  EXPECT_EQ(metric("lpv_edits_accepted_total"), 2);
  EXPECT_THAT(tryEdit(stubs_, session_, client::editOf({client::createLight(light("Second"))})),
              HasCode(StatusCode::RESOURCE_EXHAUSTED));
  EXPECT_THAT(tryEdit(stubs_, session_, client::editOf({client::setRadiance("Lamp", {-1, 0, 0})})),
              HasCode(StatusCode::INVALID_ARGUMENT));
  EXPECT_EQ(metric("lpv_edits_rejected_total{reason=\"max_lights\"}"), 1);
  EXPECT_EQ(metric("lpv_edits_rejected_total{reason=\"invalid_argument\"}"), 1);
  EXPECT_EQ(metric("lpv_edits_rejected_total{reason=\"resource_exhausted\"}"), 0) << "counted by its name";
  EXPECT_EQ(metric("lpv_edits_accepted_total"), 2);
}

TEST_F(Metrics, MoveWithTicksAndResults) {
  EXPECT_EQ(metric("lpv_tick_seconds_count"), 0);
  getVolume();
  auto after = watched_.scrape();
  EXPECT_EQ(after["lpv_tick_seconds_count"], 1);
  EXPECT_GT(after["lpv_tick_seconds_sum"], 0.0);
  EXPECT_EQ(after["lpv_tick_seconds_bucket{le=\"+Inf\"}"], 1);
  EXPECT_EQ(after["lpv_stage_seconds_count{stage=\"voxelize\"}"], 1);
  EXPECT_EQ(after["lpv_stage_seconds_count{stage=\"gather\"}"], 1);
  EXPECT_EQ(after["lpv_stage_seconds_count{stage=\"propagate\"}"], 0) << "GATHER does not propagate";
  EXPECT_EQ(after["lpv_volumes_encoded_total"], 1);
  EXPECT_EQ(after["lpv_results_total{kind=\"volume\",format=\"half\"}"] +
                after["lpv_results_total{kind=\"volume\",format=\"float\"}"] +
                after["lpv_results_total{kind=\"volume\",format=\"compact\"}"],
            1);
  EXPECT_EQ(after["lpv_result_bytes_total{kind=\"frame\",format=\"png\"}"], 0);
  apply(stubs_, session_, {client::setRadiance("Lamp", {2, 2, 2})});
  pb::GetFrameRequest frame;
  frame.set_session(session_);
  auto client = clientOf(watched_.server().address());
  ASSERT_TRUE(client.frame(frame).ok());
  after = watched_.scrape();
  EXPECT_EQ(after["lpv_tick_seconds_count"], 2);
  EXPECT_EQ(after["lpv_stage_seconds_count{stage=\"voxelize\"}"], 1) << "a new colour is no new geometry";
  EXPECT_EQ(after["lpv_stage_seconds_count{stage=\"shade\"}"], 1);
  EXPECT_EQ(after["lpv_results_total{kind=\"frame\",format=\"png\"}"], 1);
  EXPECT_GT(after["lpv_result_bytes_total{kind=\"frame\",format=\"png\"}"], 100);
  EXPECT_TRUE(eventually([this] { return metric("lpv_measured_error_worst") > 0.0; })) << "the session measures itself";
}

TEST_F(Metrics, MoveWithClientsAndReaders) {
  const pb::ClientIdentity client = join(stubs_, session_);
  EXPECT_EQ(metric("lpv_clients"), 1);
  pb::LeaveSessionRequest leave;
  leave.set_session(session_);
  *leave.mutable_client() = client;
  pb::LeaveSessionResponse left;
  ASSERT_THAT(stubs_.session->LeaveSession(Call(), leave, &left), IsOk());
  EXPECT_EQ(metric("lpv_clients"), 0);

  pb::WatchVolumeRequest request;
  request.mutable_subscription()->set_session(session_);
  Call call;
  const auto reader = stubs_.result->WatchVolume(call, request);
  Seen<pb::WatchVolumeResponse> seen;
  ASSERT_TRUE(seen.next(*reader));
  EXPECT_EQ(metric("lpv_subscribers"), 1);
  EXPECT_EQ(metric("lpv_acknowledge_lag_seconds_count"), 0);
  EXPECT_EQ(metric("lpv_results_coalesced_total"), 0);
  for (int i = 1; i <= 2; ++i) {  // for another reader: this one has not acknowledged what it has
    apply(stubs_, session_, {client::setRadiance("Lamp", glm::dvec3(1.0 + i))});
    getVolume();
    EXPECT_EQ(metric("lpv_results_coalesced_total"), i);
  }
  pb::UpdateSubscriptionResponse updated;
  const auto applied = acknowledgement(seen.subscriber, seen.result.result_id());
  ASSERT_THAT(stubs_.result->UpdateSubscription(Call(), applied, &updated), IsOk());
  EXPECT_EQ(metric("lpv_acknowledge_lag_seconds_count"), 1);
  call->TryCancel();
  EXPECT_TRUE(eventually([this] { return metric("lpv_subscribers") == 0; }));
}

TEST_F(Metrics, MoveWithSessionsAndRefusals) {
  EXPECT_EQ(metric("lpv_sessions"), 1);
  EXPECT_EQ(metric("lpv_sessions_kept"), 0) << "nothing is kept without --state-dir";
  pb::CreateSessionRequest second;
  pb::CreateSessionResponse ignored;
  EXPECT_THAT(stubs_.session->CreateSession(Call(), second, &ignored), HasCode(StatusCode::RESOURCE_EXHAUSTED));
  EXPECT_EQ(metric("lpv_calls_refused_total{reason=\"max_sessions\"}"), 1);
  pb::WatchSceneRequest watch;
  watch.set_session("sessions/nowhere");
  Call call;
  const auto reader = stubs_.scene->WatchScene(call, watch);
  pb::WatchSceneResponse event;
  EXPECT_FALSE(reader->Read(&event));
  EXPECT_THAT(reader->Finish(), HasCode(StatusCode::NOT_FOUND));
  EXPECT_EQ(metric("lpv_calls_refused_total{reason=\"not_found\"}"), 1) << "streams as well";
  const std::string mesh = sheet(10).SerializeAsString();
  ASSERT_THAT(upload(stubs_, session_, pb::BLOB_KIND_MESH, mesh), IsOk());
  EXPECT_GE(metric("lpv_blob_bytes"), double(mesh.size()));
  pb::DeleteSessionRequest remove;
  remove.set_name(session_);
  pb::DeleteSessionResponse removed;
  ASSERT_THAT(stubs_.session->DeleteSession(Call(), remove, &removed), IsOk());
  EXPECT_EQ(metric("lpv_sessions"), 0);
}

TEST_F(Metrics, OfTheProcessAndItsDeviceAreThere) {
  const std::string scrape = watched_.get("/metrics").body;
  EXPECT_THAT(scrape, HasSubstr("lpv_device_info{name=\""));
  EXPECT_THAT(scrape, ::testing::ContainsRegex("lpv_build_info\\{version=\"[0-9]+\\.[0-9]+\\.[0-9]+\"\\} 1"));
  EXPECT_EQ(metric("lpv_context_losses_total"), 0);
  EXPECT_EQ(metric("lpv_tick_failures_total{reason=\"internal\"}"), 0);
  EXPECT_GT(metric("process_resident_memory_bytes"), double(kMiB));
  EXPECT_GT(metric("process_open_fds"), 3);
  EXPECT_GT(metric("process_start_time_seconds"), 1.7e9);
  const double before = metric("process_cpu_seconds_total");
  EXPECT_GT(before, 0.0);
  getVolume();
  EXPECT_GT(metric("process_cpu_seconds_total"), before);
}

}  // namespace
}  // namespace lpv::rpc
