// What browsers send on a socket, whole messages in any order, against the door's calls without its network: every call
// that begins ends once, what closes the socket says why in the 123 bytes that a close has, and a socket that has gone
// leaves nothing behind.

#include <google/protobuf/stubs/logging.h>

#include <map>

#include "fuzz/check.h"
#include "fuzz/message_input.h"
#include "fuzz/world.h"
#include "inputs.pb.h"
#include "unit/web/page_rig.h"
#include "web/calls.h"

namespace lpv::fuzz {
namespace {

constexpr int kMostSaid = 60;
/// A watcher of an engine that is done at once never runs dry.
constexpr int kMostTurns = 40;

void work(test::PageSocket& socket) {
  for (int i = 0; i < kMostTurns; ++i) {
    const bool busy = socket.turn();
    machinery().settle();
    if (!busy && !socket.turn()) return;
  }
}

/// Of the requests that inputs.proto has, the one that is set.
std::string requestBytes(const Call& call) {
  const google::protobuf::Reflection* reflection = call.GetReflection();
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  reflection->ListFields(call, &fields);
  for (const auto* field : fields) {
    if (field->message_type()) return reflection->GetMessage(call, field).SerializeAsString();
  }
  return {};
}

void say(web_door::Calls& calls, test::PageSocket& socket, Said said) {
  if (said.has_holds()) socket.holdsBack = said.holds();
  if (said.has_turn()) return work(socket);
  if (said.has_raw()) return calls.receive(said.raw());
  if (!said.has_step()) return;
  web::v1::ToServer& step = *said.mutable_step();
  if (said.has_request()) step.set_message(requestBytes(said.request()));
  if (step.has_hello() && step.hello().token() == "it") step.mutable_hello()->set_token(kAdminToken);
  calls.receive(step.SerializeAsString());
}

void checkWhatWasSaid(const test::PageSocket& socket, std::uint32_t last) {
  std::map<std::uint32_t, int> ends;
  for (const web::v1::ToClient& step : socket.said) {
    check(step.has_welcome() == (step.call() == 0), "a welcome is of no call, and nothing else is");
    check(step.call() <= last, "nothing is said of a call that has not begun");
    check(ends[step.call()] == 0, "nothing is said of a call after its end");
    if (!step.has_end()) continue;
    ++ends[step.call()];
    check(step.end().code() == 0 || !step.end().message().empty(), "a refusal says why");
  }
}

void play(const Page& page) {
  World world(page.tokens());
  const api::Context context = world.serverContext();
  const auto socket = std::make_shared<test::PageSocket>();
  const auto calls = std::make_shared<web_door::Calls>(context, "ipv4:10.0.0.1:1", socket);
  std::uint32_t last = 0;
  for (const Said& said : page.said()) {
    say(*calls, *socket, said);
    if (said.step().has_begin()) last = std::max(last, said.step().call());
    if (socket->closedWith) break;
  }
  if (socket->closedWith) {
    check(!socket->reason.empty() && socket->reason.size() <= 123 && isUtf8(socket->reason), "a close says why");
  }
  check(calls->count() <= web_door::kMostCalls, "calls are bounded");
  checkWhatWasSaid(*socket, last);
  calls->lost();
  socket->holdsBack = false;
  work(*socket);
  check(calls->count() == 0, "a lost socket leaves no call");
  check(!calls->full(), "and no message");
}

}  // namespace
}  // namespace lpv::fuzz

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  google::protobuf::SetLogHandler(nullptr);
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t maxSize,
                                               unsigned seed) {
  static const std::vector<std::string> words = {"",
                                                 "it",
                                                 "sessions/room",
                                                 "room",
                                                 "Lamp",
                                                 "lpv.v1.SessionService/GetSession",
                                                 "lpv.v1.SessionService/CreateSession",
                                                 "lpv.v1.SceneService/WatchScene",
                                                 "lpv.v1.SceneService/StreamEdits",
                                                 "lpv.v1.SceneService/ApplyEdit",
                                                 "lpv.v1.ResultService/StreamFrames",
                                                 "lpv.v1.ResultService/WatchVolume",
                                                 "lpv.v1.BlobService/UploadBlob",
                                                 "lpv.v1.SceneService/Nothing"};
  lpv::fuzz::Page page;
  return lpv::fuzz::mutateText(&page, words, data, size, maxSize, seed);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  lpv::fuzz::Page page;
  if (!lpv::fuzz::parseText(data, size, &page) || page.said_size() > lpv::fuzz::kMostSaid) return -1;
  lpv::fuzz::play(page);
  return 0;
}
