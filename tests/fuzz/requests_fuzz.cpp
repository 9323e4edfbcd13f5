// Every request of every service, parsed from bytes and made in process, one after another: nothing ends the process,
// what is refused changes nothing and says why, and every answer is a message that clients can read.
//
// Has found a refusal that cut a name within a character (seeds/requests/cut-name).

#include <google/protobuf/descriptor.h>
#include <google/protobuf/stubs/logging.h>

#include <set>

#include "convert/blob_content.h"
#include "fuzz/calls.h"
#include "fuzz/check.h"
#include "fuzz/message_input.h"
#include "reference/meshes.h"

namespace lpv::fuzz {
namespace {

namespace pb = lpv::v1;

constexpr int kMostCalls = 8;

std::vector<std::string> words() {
  std::string accents;
  for (int i = 0; i < 79; ++i) accents += "\xc3\xa9";
  std::vector<std::string> out = {"",
                                  "room",
                                  "sessions/room",
                                  "sessions/hall",
                                  "sessions/",
                                  "hall",
                                  "Lamp",
                                  "Wall",
                                  "Front",
                                  "Lamp.001",
                                  "a",
                                  "b",
                                  "it",
                                  "drag",
                                  "key",
                                  "fill",
                                  accents,
                                  "x" + accents,
                                  "a/b",
                                  "\n",
                                  "*",
                                  "light",
                                  "settings"};
  for (const char* path : {"grid",         "injection",   "method", "dense_samples",   "transport",       "quality",
                           "iterations",   "clamp_faces", "k",      "lookup",          "max_error",       "visibility",
                           "bounces",      "gloss",       "haze",   "haze_absorption", "haze_anisotropy", "ttl",
                           "display_name", "grid.bounds", "nothing"}) {
    out.push_back(std::string("settings.") + path);
  }
  for (const char* path : {"mesh",
                           "inline_mesh",
                           "transform",
                           "transform.translation",
                           "transform.rotation",
                           "transform.scale",
                           "transform.matrix",
                           "radiance",
                           "power",
                           "texture",
                           "two_sided",
                           "enabled",
                           "group",
                           "albedo",
                           "albedo_texture",
                           "roughness",
                           "metalness",
                           "casts_shadow",
                           "visible_to_camera",
                           "distant",
                           "alpha_mode",
                           "alpha_cutoff",
                           "opacity",
                           "transmission"}) {
    out.emplace_back(path);
  }
  out.push_back(api::meshHash(*reference::quad()));
  out.push_back(api::meshHash(*reference::pyramid()));
  return out;
}

/// A request that somebody adds to a service and not to inputs.proto would go unseen.
void checkThatNoneIsMissing() {
  std::set<std::string> there;
  const google::protobuf::Descriptor* call = Call::descriptor();
  for (int i = 0; i < call->field_count(); ++i) {
    if (call->field(i)->message_type()) there.insert(call->field(i)->message_type()->full_name());
  }
  for (const google::protobuf::FileDescriptor* file :
       {pb::GetServerInfoRequest::descriptor()->file(), pb::GetSessionRequest::descriptor()->file(),
        pb::ApplyEditRequest::descriptor()->file(), pb::ProbeRequest::descriptor()->file(),
        pb::UploadBlobRequest::descriptor()->file()}) {
    for (int s = 0; s < file->service_count(); ++s) {
      for (int m = 0; m < file->service(s)->method_count(); ++m) {
        const std::string& name = file->service(s)->method(m)->input_type()->full_name();
        check(there.contains(name), "inputs.proto has " + name);
      }
    }
  }
}

}  // namespace
}  // namespace lpv::fuzz

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  google::protobuf::SetLogHandler(nullptr);
  lpv::fuzz::checkThatNoneIsMissing();
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t maxSize,
                                               unsigned seed) {
  static const std::vector<std::string> words = lpv::fuzz::words();
  lpv::fuzz::Calls calls;
  return lpv::fuzz::mutateText(&calls, words, data, size, maxSize, seed);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  lpv::fuzz::Calls calls;
  if (!lpv::fuzz::parseText(data, size, &calls) || calls.calls_size() > lpv::fuzz::kMostCalls) return -1;
  lpv::fuzz::Caller caller(calls.tokens());
  for (const lpv::fuzz::Call& call : calls.calls()) caller.make(call);
  return 0;
}
