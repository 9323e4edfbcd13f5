// The memory of outcomes: what a client may repeat, and what is too long ago.

#include <gtest/gtest.h>

#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

constexpr std::uint64_t kRemembered = 1024;

class Sequences : public ::testing::Test {
 protected:
  pb::Edit edit(std::uint64_t sequence, double radiance) {
    pb::Edit out = client::editOf({client::setRadiance("Lamp", glm::dvec3(radiance))});
    out.set_sequence(sequence);
    return out;
  }
  /// Sends edits `first`..`last`, each waiting for its acknowledgement.
  void sendThrough(std::uint64_t first, std::uint64_t last) {
    Call call;
    const auto stream = stubs_.scene->StreamEdits(call);
    pb::StreamEditsRequest request;
    request.set_session(session_);
    *request.mutable_client() = me_;
    for (std::uint64_t sequence = first; sequence <= last; ++sequence) {
      *request.mutable_edit() = edit(sequence, double(sequence));
      ASSERT_TRUE(stream->Write(request));
      pb::StreamEditsResponse response;
      do {
        ASSERT_TRUE(stream->Read(&response));
      } while (!response.has_ack());
      ASSERT_EQ(response.ack().sequence(), sequence);
      ASSERT_EQ(response.ack().status().code(), 0) << response.ack().status().message();
    }
    stream->WritesDone();
  }

  ServerProcess fast_{{"--max-edits-per-second", "100000"}};
  Stubs stubs_{fast_.address()};
  std::string session_ = makeLitSession(stubs_);  // revision 1
  pb::ClientIdentity me_ = join(stubs_, session_);
};

// Seen to fail when a forgotten sequence is applied as a new edit.
TEST_F(Sequences, OlderThanTheLast1024AreRefusedNotAppliedAgain) {
  sendThrough(1, kRemembered);
  pb::EditAck ack;
  ASSERT_THAT(tryEdit(stubs_, session_, edit(1, 7.0), &ack, me_), IsOk()) << "the oldest that is remembered";
  EXPECT_EQ(ack.revision(), 2U) << "its first outcome";
  sendThrough(kRemembered + 1, kRemembered + 1);
  EXPECT_THAT(tryEdit(stubs_, session_, edit(1, 7.0), nullptr, me_),
              Refused(StatusCode::FAILED_PRECONDITION, "edit.sequence", "1024"));
  ASSERT_THAT(tryEdit(stubs_, session_, edit(2, 7.0), &ack, me_), IsOk());
  EXPECT_EQ(ack.revision(), 3U);
  EXPECT_EQ(getSession(stubs_, session_).revision(), kRemembered + 2);
  EXPECT_DOUBLE_EQ(findLight(stubs_, session_, "Lamp").radiance().x(), double(kRemembered + 1));
}

}  // namespace
}  // namespace lpv::rpc
