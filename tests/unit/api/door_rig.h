#pragma once
// A server with access tokens, and a client of it without a network: calls go through the call driver as a door's do.

#include <google/protobuf/message.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "api/call/call_driver.h"
#include "unit/session/session_rig.h"

namespace lpv::test {

inline constexpr const char* kAdminToken = "an admin's token of some length";

/// Sessions, tokens, and the context that a door is given. One session, "room", is there.
class DoorRig {
 public:
  explicit DoorRig(bool tokens, Limits limits = Rig::quick());
  ~DoorRig();

  /// A token for a session.
  MintedToken mint(Role role, const std::string& session = "room");

  Rig rig;
  Access access{rig.journal, rig.timers};
  Registry registry{rig.services};
  api::Context context;
  SessionPtr room;
};

/// One call. The test is its network: it says when messages arrive and when what was written has gone.
class TestCall final : public api::Transport {
 public:
  /// Opens a call of the method that takes such a request.
  TestCall(DoorRig& rig, const google::protobuf::Message& request, const Expected<std::string>& token = std::string());
  ~TestCall() override;

  void read(google::protobuf::Message* into) override;
  void write(const google::protobuf::Message& message) override;
  void finish(const google::protobuf::Message* last, const Status& status) override;

  /// Waits until the server reads, and has this arrive.
  void say(const google::protobuf::Message& message) { arrive(&message, api::ReadResult::kMessage); }
  void sayNonsense() { arrive(nullptr, api::ReadResult::kMalformed); }
  void sayNoMore() { arrive(nullptr, api::ReadResult::kEnd); }
  void cancel() { driver_->onCancel(); }
  /// What is being written has gone.
  void written();

  bool isWriting() const;
  bool hasEnded() const;
  /// Waits for the end.
  Status end() const;
  /// The one answer of a call that has one; null without.
  const google::protobuf::Message* answer() const { return answer_.get(); }
  /// Messages before the end.
  int messages() const;

 private:
  void arrive(const google::protobuf::Message* message, api::ReadResult result);

  std::shared_ptr<api::CallDriver> driver_;
  mutable std::mutex mutex_;
  google::protobuf::Message* into_ = nullptr;
  bool writing_ = false;
  int messages_ = 0;
  int ends_ = 0;
  std::optional<Status> end_;
  std::unique_ptr<google::protobuf::Message> answer_;
};

}  // namespace lpv::test
