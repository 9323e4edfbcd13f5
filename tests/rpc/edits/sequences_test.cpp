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

// 1, 3, 2 was applied in that order once. Broken by: looking for sequences among those that were forgotten only.
TEST_F(Sequences, RiseOrAreRefused) {
  ASSERT_THAT(tryEdit(stubs_, session_, edit(1, 1.0), nullptr, me_), IsOk());
  ASSERT_THAT(tryEdit(stubs_, session_, edit(3, 3.0), nullptr, me_), IsOk());
  EXPECT_THAT(tryEdit(stubs_, session_, edit(2, 2.0), nullptr, me_),
              Refused(StatusCode::FAILED_PRECONDITION, "edit.sequence", "sequence 2 is not above 3"));
  EXPECT_DOUBLE_EQ(findLight(stubs_, session_, "Lamp").radiance().x(), 3.0);
  pb::EditAck ack;
  EXPECT_THAT(tryEdit(stubs_, session_, edit(1, 1.0), &ack, me_), IsOk()) << "its outcome is remembered";
  EXPECT_EQ(ack.revision(), 2U);
}

// Broken by: no check; a check of edits that leaves undo out.
TEST_F(Sequences, OfAMemberAreOneToTwoToThe63) {
  constexpr std::uint64_t kMost = std::uint64_t(1) << 63;
  for (const std::uint64_t sequence : {std::uint64_t(0), kMost, ~std::uint64_t(0)}) {
    EXPECT_THAT(tryEdit(stubs_, session_, edit(sequence, 5.0), nullptr, me_),
                Refused(StatusCode::INVALID_ARGUMENT, "edit.sequence", "allowed are 1 to 9223372036854775807"));
    pb::UndoRequest undo;
    undo.set_session(session_);
    *undo.mutable_client() = me_;
    undo.set_sequence(sequence);
    pb::UndoResponse undone;
    EXPECT_THAT(stubs_.scene->Undo(Call(), undo, &undone),
                Refused(StatusCode::INVALID_ARGUMENT, "sequence", "count up from 1"));
  }
  EXPECT_THAT(tryEdit(stubs_, session_, edit(kMost - 1, 5.0), nullptr, me_), IsOk());
  EXPECT_EQ(getSession(stubs_, session_).revision(), 2U);
}

// On a stream it is the edit that is refused, not the stream.
TEST_F(Sequences, AreRefusedByEditOnAStream) {
  Call call;
  const auto stream = stubs_.scene->StreamEdits(call);
  pb::StreamEditsRequest request;
  request.set_session(session_);
  *request.mutable_client() = me_;
  std::vector<int> codes;
  for (const std::uint64_t sequence : {0U, 1U, 3U, 2U, 4U}) {
    *request.mutable_edit() = edit(sequence, double(sequence));
    ASSERT_TRUE(stream->Write(request));
  }
  stream->WritesDone();
  for (pb::StreamEditsResponse response; stream->Read(&response);) {
    if (response.has_ack()) codes.push_back(response.ack().status().code());
  }
  EXPECT_THAT(stream->Finish(), IsOk());
  EXPECT_THAT(codes, ::testing::ElementsAre(3, 0, 0, 9, 0));
}

}  // namespace
}  // namespace lpv::rpc
