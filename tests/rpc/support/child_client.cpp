// rpc_child_client ADDRESS SESSION frames|upload|edits|scene: a client that tests stop, wake and kill.
//   frames  watches frames, acknowledges each, prints a line for each: revision, then the steady clock's nanoseconds
//   upload  announces a blob of 60 MB, sends 8 MB of it, prints "ready" and stays
//   edits   edits the light "Lamp" over a stream without end, prints "ready" after the first acknowledgement
//   scene   watches the scene, prints "ready" after the first event

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <thread>

#include "lpv/v1/blob.grpc.pb.h"
#include "lpv/v1/result.grpc.pb.h"
#include "lpv/v1/scene.grpc.pb.h"

namespace {

namespace pb = lpv::v1;
using Channel = std::shared_ptr<grpc::Channel>;

void say(const std::string& line) {
  std::puts(line.c_str());
  std::fflush(stdout);
}

void watchFrames(const Channel& channel, const std::string& session) {
  const auto stub = pb::ResultService::NewStub(channel);
  grpc::ClientContext context;
  const auto stream = stub->StreamFrames(&context);
  pb::StreamFramesRequest request;
  request.mutable_subscription()->set_session(session);
  request.mutable_subscription()->set_width(160);
  request.mutable_subscription()->set_height(96);
  stream->Write(request);
  pb::StreamFramesResponse response;
  pb::FrameHeader header;
  while (stream->Read(&response)) {
    if (!response.event().has_part()) continue;
    const pb::FramePart& part = response.event().part();
    if (part.has_header()) header = part.header();
    if (part.index() + 1 != header.part_count()) continue;
    say(std::to_string(header.result().revision()) + " " +
        std::to_string(std::chrono::steady_clock::now().time_since_epoch().count()));
    pb::StreamFramesRequest acknowledge;
    acknowledge.mutable_update()->mutable_acknowledge()->set_result_id(part.result_id());
    if (!stream->Write(acknowledge)) break;
  }
}

void uploadForever(const Channel& channel, const std::string& session) {
  const auto stub = pb::BlobService::NewStub(channel);
  grpc::ClientContext context;
  pb::UploadBlobResponse response;
  const auto writer = stub->UploadBlob(&context, &response);
  pb::UploadBlobRequest request;
  request.mutable_header()->set_session(session);
  request.mutable_header()->set_kind(pb::BLOB_KIND_MESH);
  request.mutable_header()->set_size(60'000'000);
  for (int i = 0; i < 8; ++i) {
    request.set_data(std::string(1'000'000, 'm'));
    writer->Write(request);
    request.Clear();
  }
  say("ready");
  std::this_thread::sleep_for(std::chrono::minutes(5));
}

void editForever(const Channel& channel, const std::string& session) {
  const auto stub = pb::SceneService::NewStub(channel);
  grpc::ClientContext context;
  const auto stream = stub->StreamEdits(&context);
  pb::StreamEditsRequest request;
  request.set_session(session);
  pb::UpdateLight* update = request.mutable_edit()->add_operations()->mutable_update_light();
  update->mutable_light()->set_name("Lamp");
  update->mutable_update_mask()->add_paths("radiance");
  pb::StreamEditsResponse response;
  for (int i = 1;; ++i) {
    update->mutable_light()->mutable_radiance()->set_x(i);
    if (!stream->Write(request) || !stream->Read(&response)) return;
    if (i == 1) say("ready");
  }
}

void watchScene(const Channel& channel, const std::string& session) {
  const auto stub = pb::SceneService::NewStub(channel);
  grpc::ClientContext context;
  pb::WatchSceneRequest request;
  request.set_session(session);
  const auto stream = stub->WatchScene(&context, request);
  pb::WatchSceneResponse response;
  bool first = true;
  while (stream->Read(&response)) {
    if (first) say("ready");
    first = false;
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const Channel channel = grpc::CreateChannel(argv[1], grpc::InsecureChannelCredentials());
  const std::string session = argv[2];
  const std::string what = argv[3];
  if (what == "frames") watchFrames(channel, session);
  if (what == "upload") uploadForever(channel, session);
  if (what == "edits") editForever(channel, session);
  if (what == "scene") watchScene(channel, session);
  return 0;
}
