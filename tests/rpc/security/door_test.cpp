// What the door refuses before any handler runs: compressed messages, large messages, large metadata, and what it
// offers beside the services: health and reflection.

#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>

#include "rpc/support/details.h"
#include "rpc/support/http2_client.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::size_t kChunk = 16 * std::size_t(kMiB);
constexpr int kChunks = 60;
constexpr std::int64_t kBomb = std::int64_t(kChunk) * kChunks;  // 1.007 GB of zeros

/// Deflates once and repeats the block: a full flush makes each chunk readable by itself.
std::string gzippedZeros() {
  const std::string zeros(kChunk, '\0');
  std::string chunk(kChunk / 64, '\0');
  z_stream z{};
  deflateInit2(&z, 9, Z_DEFLATED, -15, 9, Z_DEFAULT_STRATEGY);
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(zeros.data()));
  z.avail_in = uInt(zeros.size());
  z.next_out = reinterpret_cast<Bytef*>(chunk.data());
  z.avail_out = uInt(chunk.size());
  deflate(&z, Z_FULL_FLUSH);
  chunk.resize(z.total_out);
  deflateEnd(&z);
  const uLong one = crc32_z(0, reinterpret_cast<const Bytef*>(zeros.data()), zeros.size());
  uLong crc = 0;
  std::string out("\x1f\x8b\x08\0\0\0\0\0\2\xff", 10);
  for (int i = 0; i < kChunks; ++i) {
    out += chunk;
    crc = crc32_combine(crc, one, z_off_t(kChunk));
  }
  out += std::string("\3\0", 2);  // the last block, empty
  for (const std::uint32_t word : {std::uint32_t(crc), std::uint32_t(kBomb)}) {
    for (int shift = 0; shift < 32; shift += 8) out.push_back(char(word >> shift));
  }
  return out;
}

/// Bytes that a gzip stream expands to, checksum verified; -1 where it is none.
std::int64_t inflatedSize(const std::string& gzip) {
  z_stream z{};
  inflateInit2(&z, 15 + 16);
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(gzip.data()));
  z.avail_in = uInt(gzip.size());
  std::string out(4 * std::size_t(kMiB), '\0');
  std::int64_t total = 0;
  int state = Z_OK;
  while (state == Z_OK) {
    z.next_out = reinterpret_cast<Bytef*>(out.data());
    z.avail_out = uInt(out.size());
    state = inflate(&z, Z_NO_FLUSH);
    total += std::int64_t(out.size() - z.avail_out);
  }
  inflateEnd(&z);
  return state == Z_STREAM_END ? total : -1;
}

TEST(Door, RefusesAGigabyteOfZerosGzipped) {
  const std::string bomb = gzippedZeros();
  ASSERT_LT(bomb.size(), std::size_t(kMiB)) << "small enough to pass as a message";
  ASSERT_EQ(inflatedSize(bomb), kBomb);
  Stubs stubs(server().address());
  const std::string session = makeLitSession(stubs);
  // The same by hand without compression is answered: what is refused below is the encoding.
  pb::GetSessionRequest plain;
  plain.set_name(session);
  const RawAnswer good =
      rawCall(server().port(), "/lpv.v1.SessionService/GetSession", {}, framed(false, plain.SerializeAsString()));
  ASSERT_TRUE(good.ended);
  ASSERT_EQ(good.grpcStatus, 0);
  server().forgetPeak();
  const std::int64_t before = server().residentBytes();
  for (const char* path : {"/lpv.v1.SessionService/GetSession", "/lpv.v1.BlobService/UploadBlob",
                           "/lpv.v1.SceneService/StreamEdits", "/lpv.v1.ResultService/WatchVolume"}) {
    const RawAnswer answer = rawCall(server().port(), path, {{"grpc-encoding", "gzip"}}, framed(true, bomb));
    EXPECT_TRUE(answer.ended) << path;
    EXPECT_EQ(answer.grpcStatus, int(StatusCode::UNIMPLEMENTED)) << path;
    // Said to be identity and yet flagged as compressed: never read as a message.
    EXPECT_TRUE(rawCall(server().port(), path, {}, framed(true, bomb)).ended) << path;
  }
  EXPECT_LT(server().peakBytes() - before, 16 * kMiB * (kSanitized ? 2 : 1));
  EXPECT_EQ(getSession(stubs, session).light_count(), 1);
}

TEST(Door, RefusesAClientLibraryThatCompresses) {
  grpc::ChannelArguments arguments;
  arguments.SetCompressionAlgorithm(GRPC_COMPRESS_GZIP);
  Stubs zipped(server().address(), arguments);
  pb::CreateSessionRequest request;
  request.set_request_id(std::string(100, 'z'));
  pb::CreateSessionResponse response;
  const grpc::Status status = zipped.session->CreateSession(Call(), request, &response);
  EXPECT_THAT(status, HasCode(StatusCode::UNIMPLEMENTED));
}

TEST(Door, RefusesMessagesAboveOneMebibyte) {
  Stubs stubs(server().address());
  const std::string session = makeLitSession(stubs);
  const auto withBytes = [&](std::size_t vertices) {
    return tryEdit(stubs, session,
                   client::editOf({client::setVertices("Nobody", std::vector<glm::vec3>(vertices, glm::vec3(0.0F)))}));
  };
  EXPECT_THAT(withBytes(87'000), HasCode(StatusCode::NOT_FOUND)) << "1.04 MB is read";
  EXPECT_THAT(withBytes(88'000), HasCode(StatusCode::RESOURCE_EXHAUSTED)) << "1.06 MB is not";
  pb::UploadBlobResponse uploaded;
  EXPECT_THAT(upload(stubs, session, pb::BLOB_KIND_MESH, sheet(300).SerializeAsString(), &uploaded, 2'000'000),
              HasCode(StatusCode::RESOURCE_EXHAUSTED));
  // On a stream as well: an edit that was not read is never answered with success.
  Call call;
  const auto stream = stubs.scene->StreamEdits(call);
  pb::StreamEditsRequest edit;
  edit.set_session(session);
  *edit.mutable_edit() =
      client::editOf({client::setVertices("Nobody", std::vector<glm::vec3>(88'000, glm::vec3(0.0F)))});
  stream->Write(edit);
  pb::StreamEditsResponse response;
  while (stream->Read(&response)) EXPECT_FALSE(response.has_ack());
  EXPECT_THAT(stream->Finish(), HasCode(StatusCode::RESOURCE_EXHAUSTED));
  EXPECT_EQ(getSession(stubs, session).revision(), 1U);
}

/// Metadata far beyond the limit costs the client its connection, which may take the next call with it: that one is
/// made on a connection of its own.
TEST(Door, RefusesMetadataAboveEightKibibytes) {
  Stubs stubs(server().address()), bystander(server().address());
  const auto withMetadata = [](Stubs& caller, std::size_t bytes) {
    Call call;
    call->AddMetadata("x-ballast", std::string(bytes, 'b'));
    pb::ListSessionsResponse response;
    return caller.session->ListSessions(call, pb::ListSessionsRequest(), &response);
  };
  EXPECT_THAT(withMetadata(stubs, 7'000), IsOk());
  EXPECT_THAT(withMetadata(stubs, 9'000), HasCode(StatusCode::RESOURCE_EXHAUSTED));
  EXPECT_THAT(withMetadata(stubs, 100'000), ::testing::Not(IsOk()));
  EXPECT_THAT(withMetadata(bystander, 10), IsOk());
}

TEST(Door, AnswersHealthChecks) {
  client::Client client = clientOf(server().address());
  for (const char* service : {"", "lpv.v1.ResultService", "lpv.v1.SceneService"}) {
    const Expected<bool> healthy = client.healthy(service);
    ASSERT_TRUE(healthy.ok()) << service << ": " << healthy.status().message();
    EXPECT_TRUE(*healthy) << service;
  }
  EXPECT_FALSE(client.healthy("lpv.v1.NoService").ok());
}

/// What the reflection service answers when it is asked for a list: names somewhere in bytes, or the error. It speaks
/// grpc.reflection.v1alpha; its two messages are written by hand here: field 7 of the request asks for the list.
std::string reflected(const std::string& address) {
  Stubs stubs(address);
  grpc::GenericStub generic(stubs.channel);
  grpc::CompletionQueue queue;
  Call call;
  const auto stream =
      generic.PrepareCall(call, "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", &queue);
  const auto wait = [&queue] {
    void* tag = nullptr;
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  };
  stream->StartCall(nullptr);
  EXPECT_TRUE(wait());
  const grpc::Slice slice(std::string("\x3a\x01*", 3));
  stream->Write(grpc::ByteBuffer(&slice, 1), nullptr);
  (void)wait();
  grpc::ByteBuffer answer;
  stream->Read(&answer, nullptr);
  std::string names;
  if (wait()) {
    std::vector<grpc::Slice> slices;
    EXPECT_TRUE(answer.Dump(&slices).ok());
    for (const grpc::Slice& each : slices) names.append(reinterpret_cast<const char*>(each.begin()), each.size());
    call->TryCancel();
  }
  grpc::Status status;
  stream->Finish(&status, nullptr);
  wait();
  queue.Shutdown();
  while (wait()) {
  }
  return names.empty() ? "refused: " + std::to_string(status.error_code()) : names;
}

TEST(Door, ListsItsServicesByReflection) {
  const std::string names = reflected(server().address());
  for (const char* service : {"lpv.v1.ServerService", "lpv.v1.SessionService", "lpv.v1.BlobService",
                              "lpv.v1.SceneService", "lpv.v1.ResultService", "grpc.health.v1.Health"}) {
    EXPECT_THAT(names, HasSubstr(service));
  }
}

// Broken by: the library's own registration, which it does when it is loaded.
TEST(Door, ListsNothingToStrangersUnlessToldTo) {
  const std::string directory = makeDirectory();
  std::ofstream(directory + "/admin") << "the admin's token, for a test\n";
  const ServerProcess locked({"--admin-token-file", directory + "/admin"});
  EXPECT_EQ(reflected(locked.address()), "refused: " + std::to_string(int(StatusCode::UNIMPLEMENTED)));
  const ServerProcess told({"--admin-token-file", directory + "/admin", "--reflection"});
  EXPECT_THAT(reflected(told.address()), HasSubstr("lpv.v1.ServerService"));
  std::filesystem::remove_all(directory);
}

/// How many of 20 calls are refused, and that they say why.
int refusedOfTwenty(ServerProcess& process) {
  Stubs stubs(process.address());
  int refused = 0;
  for (int i = 0; i < 20; ++i) {
    pb::GetServerInfoResponse response;
    const grpc::Status status = stubs.server->GetServerInfo(Call(), {}, &response);
    if (status.ok()) continue;
    ++refused;
    EXPECT_THAT(status, HasCode(StatusCode::RESOURCE_EXHAUSTED));
    EXPECT_EQ(reasonOf(status), "MAX_CALLS_PER_SECOND_PER_ADDRESS");
    EXPECT_GT(pauseOf(status), 0.0);
  }
  return refused;
}

TEST(Door, AnAddressBeginsSoManyCallsUnlessItIsATrustedProxy) {
  ServerProcess limited({"--trusted-proxy", "none", "--max-calls-per-second-per-address", "1"});
  EXPECT_GT(refusedOfTwenty(limited), 0);
  ServerProcess behindAProxy({"--trusted-proxy", "10.0.0.0/8, 127.0.0.1", "--max-calls-per-second-per-address", "1"});
  EXPECT_EQ(refusedOfTwenty(behindAProxy), 0);
  EXPECT_THAT(runServer({"--trusted-proxy", "proxy.example"}).errors,
              AllOf(HasSubstr("--trusted-proxy"), HasSubstr("proxy.example"), HasSubstr("10.1.0.0/16")));
}

}  // namespace
}  // namespace lpv::rpc
