// Blobs: parts, names by content, reading back, and uploads that go wrong.

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>
#include <thread>

#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Bytes that an upload of 60 MB or of 3 GB may cost before they have arrived.
constexpr std::int64_t kMayGrow = 16 * kMiB * (kSanitized ? 2 : 1);

class Blobs : public ::testing::Test {
 protected:
  /// An upload whose messages the test writes itself.
  struct Upload {
    explicit Upload(Stubs& stubs) : writer(stubs.blob->UploadBlob(call, &response)) {}
    grpc::Status finish() {
      writer->WritesDone();
      return writer->Finish();
    }
    Call call;
    pb::UploadBlobResponse response;
    std::unique_ptr<grpc::ClientWriter<pb::UploadBlobRequest>> writer;
  };
  pb::UploadBlobRequest opening(std::int64_t size, const std::string& data) {
    pb::UploadBlobRequest request;
    request.mutable_header()->set_session(session_);
    request.mutable_header()->set_kind(pb::BLOB_KIND_MESH);
    request.mutable_header()->set_size(size);
    request.set_data(data);
    return request;
  }
  pb::UploadBlobRequest more(const std::string& data) {
    pb::UploadBlobRequest request;
    request.set_data(data);
    return request;
  }
  /// All parts of a blob; the last status.
  std::pair<std::string, grpc::Status> read(const std::string& hash, std::int64_t offset = 0) {
    pb::ReadBlobRequest request;
    request.set_session(session_);
    request.set_hash(hash);
    request.set_offset(offset);
    Call call;
    const auto reader = stubs_.blob->ReadBlob(call, request);
    std::string bytes;
    first_.Clear();
    pb::ReadBlobResponse part;
    for (bool first = true; reader->Read(&part); first = false) {
      if (first) first_ = part;
      EXPECT_LE(part.ByteSizeLong(), std::size_t(kMiB));
      bytes += part.data();
    }
    const grpc::Status status = reader->Finish();
    return {bytes, status};
  }
  pb::GetStatsResponse stats() {
    pb::GetStatsResponse response;
    EXPECT_THAT(stubs_.server->GetStats(Call(), pb::GetStatsRequest(), &response), IsOk());
    return response;
  }

  Stubs stubs_{server().address()};
  std::string session_ = makeSession(stubs_);
  pb::ReadBlobResponse first_;
};

TEST_F(Blobs, AreNamedByTheirContentAndReadBack) {
  const std::string mesh = sheet(200).SerializeAsString();  // 1.4 MB: several parts each way
  ASSERT_GT(mesh.size(), std::size_t(kMiB));
  pb::UploadBlobResponse response;
  ASSERT_THAT(upload(stubs_, session_, pb::BLOB_KIND_MESH, mesh, &response, 100'000), IsOk());
  EXPECT_EQ(response.hash(), sha256(mesh));
  EXPECT_FALSE(response.existed());
  ASSERT_THAT(upload(stubs_, session_, pb::BLOB_KIND_MESH, mesh, &response), IsOk());
  EXPECT_EQ(response.hash(), sha256(mesh));
  EXPECT_TRUE(response.existed());

  const auto [whole, status] = read(response.hash());
  EXPECT_THAT(status, IsOk());
  EXPECT_TRUE(whole == mesh);
  EXPECT_EQ(first_.kind(), pb::BLOB_KIND_MESH);
  EXPECT_EQ(first_.size(), std::int64_t(mesh.size()));
  const auto [tail, tailStatus] = read(response.hash(), std::int64_t(mesh.size()) - 10);
  EXPECT_THAT(tailStatus, IsOk());
  EXPECT_EQ(tail, mesh.substr(mesh.size() - 10));
  EXPECT_EQ(first_.size(), std::int64_t(mesh.size()));
  const auto [none, end] = read(response.hash(), std::int64_t(mesh.size()));
  EXPECT_THAT(end, IsOk());
  EXPECT_TRUE(none.empty());
  EXPECT_THAT(read(response.hash(), std::int64_t(mesh.size()) + 1).second,
              Refused(StatusCode::OUT_OF_RANGE, "offset", std::to_string(mesh.size())));
  EXPECT_THAT(read(response.hash(), -1).second, Refused(StatusCode::OUT_OF_RANGE, "offset", "-1"));
  EXPECT_THAT(read(std::string(64, '0')).second, Refused(StatusCode::NOT_FOUND, "hash", "000"));
}

TEST_F(Blobs, AreFoundInTheirSessionOnly) {
  const std::string mesh = quad(0.125F).SerializeAsString();
  ASSERT_THAT(upload(stubs_, session_, pb::BLOB_KIND_MESH, mesh), IsOk());
  const auto find = [&](const std::string& session) {
    pb::FindBlobsRequest request;
    request.set_session(session);
    request.add_hashes(std::string(64, '0'));
    request.add_hashes(sha256(mesh));
    pb::FindBlobsResponse response;
    EXPECT_THAT(stubs_.blob->FindBlobs(Call(), request, &response), IsOk());
    return response;
  };
  EXPECT_THAT(find(session_).found(), ElementsAre(sha256(mesh)));
  const std::string other = makeSession(stubs_);
  EXPECT_EQ(find(other).found_size(), 0);
  pb::UploadBlobResponse response;
  ASSERT_THAT(upload(stubs_, other, pb::BLOB_KIND_MESH, mesh, &response), IsOk());
  EXPECT_FALSE(response.existed()) << "what another session has is not told";
}

TEST_F(Blobs, ADeformedMeshCanBeReadByItsHash) {
  apply(stubs_, session_, {client::createLight(light("Lamp"))});
  const std::vector<glm::vec3> moved = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5F}};
  apply(stubs_, session_, {client::setVertices("Lamp", moved)});
  const std::string hash = findLight(stubs_, session_, "Lamp").mesh();
  const auto [bytes, status] = read(hash);
  ASSERT_THAT(status, IsOk());
  EXPECT_EQ(sha256(bytes), hash);
  pb::Mesh mesh;
  ASSERT_TRUE(mesh.ParseFromString(bytes));
  EXPECT_EQ(mesh.positions(), packed<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5F}));
  EXPECT_EQ(mesh.indices(), quad().indices());
}

// Seen to fail when the bytes are not counted at the end, and when they are not counted on the way.
TEST_F(Blobs, OfAnotherFormThanAnnouncedAreRefused) {
  const std::string mesh = quad().SerializeAsString();
  const auto size = std::int64_t(mesh.size());
  {
    Upload upload(stubs_);
    upload.writer->Write(opening(size + 5, mesh));
    EXPECT_THAT(upload.finish(), Refused(StatusCode::INVALID_ARGUMENT, "data", std::to_string(size + 5)));
  }
  {
    Upload upload(stubs_);
    upload.writer->Write(opening(size - 5, mesh));
    EXPECT_THAT(upload.finish(), Refused(StatusCode::INVALID_ARGUMENT, "data", "more bytes"));
  }
  {
    Upload upload(stubs_);
    upload.writer->Write(more(mesh));
    EXPECT_THAT(upload.finish(), Refused(StatusCode::INVALID_ARGUMENT, "header", "header"));
  }
  {
    Upload upload(stubs_);
    EXPECT_THAT(upload.finish(), Refused(StatusCode::INVALID_ARGUMENT, "header", "header"));
  }
  {
    Upload upload(stubs_);
    upload.writer->Write(opening(size, mesh.substr(0, 10)));
    upload.writer->Write(opening(size, mesh.substr(10)));
    EXPECT_THAT(upload.finish(), Refused(StatusCode::INVALID_ARGUMENT, "header", "again"));
  }
  EXPECT_THAT(upload(stubs_, session_, pb::BLOB_KIND_UNSPECIFIED, mesh),
              Refused(StatusCode::INVALID_ARGUMENT, "header.kind", "0"));
  EXPECT_THAT(upload(stubs_, session_, pb::BlobKind(77), mesh),
              Refused(StatusCode::INVALID_ARGUMENT, "header.kind", "77"));
  EXPECT_THAT(upload(stubs_, session_, pb::BLOB_KIND_MESH, ""),
              Refused(StatusCode::INVALID_ARGUMENT, "header.size", "0"));
  EXPECT_THAT(upload(stubs_, "sessions/nobody", pb::BLOB_KIND_MESH, mesh),
              Refused(StatusCode::NOT_FOUND, "header.session", "nobody"));
  pb::FindBlobsRequest find;
  find.set_session(session_);
  find.add_hashes(sha256(mesh));
  pb::FindBlobsResponse found;
  ASSERT_THAT(stubs_.blob->FindBlobs(Call(), find, &found), IsOk());
  EXPECT_EQ(found.found_size(), 0) << "a refused upload left something behind";
}

TEST_F(Blobs, CostNothingByBeingAnnounced) {
  upload(stubs_, session_, pb::BLOB_KIND_MESH, quad().SerializeAsString());  // pages touched by the first upload
  const std::int64_t blobsBefore = stats().blobs();
  server().forgetPeak();
  const std::int64_t before = server().residentBytes();
  for (int i = 0; i < 8; ++i) {
    Upload upload(stubs_);
    upload.writer->Write(opening(3'000'000'000, "0123456789"));
    EXPECT_THAT(upload.finish(), Refused(StatusCode::RESOURCE_EXHAUSTED, "header.size", "max_blob_bytes"));
  }
  {
    std::vector<std::unique_ptr<Upload>> uploads;
    for (int i = 0; i < 8; ++i) {
      uploads.push_back(std::make_unique<Upload>(stubs_));
      uploads.back()->writer->Write(opening(60'000'000, "0123456789"));
    }
    // What the server does with the announcements it does after they were sent.
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    for (const auto& upload : uploads) {  // the client vanishes
      upload->call->TryCancel();
      EXPECT_FALSE(upload->writer->Finish().ok());
    }
  }
  EXPECT_LT(server().peakBytes() - before, kMayGrow);
  EXPECT_EQ(stats().blobs(), blobsBefore);
  EXPECT_THAT(upload(stubs_, session_, pb::BLOB_KIND_MESH, sheet(9).SerializeAsString()), IsOk());
}

TEST_F(Blobs, OnlySoManyAreOnTheirWayAtOnce) {
  ServerProcess narrow({"--max-uploads", "1"});
  Stubs stubs(narrow.address());
  const std::string session = makeSession(stubs);
  const std::string bytes = sheet(9).SerializeAsString();
  {
    Upload one(stubs), other(stubs);
    pb::UploadBlobRequest begun = opening(std::int64_t(bytes.size()), bytes.substr(0, 10));
    begun.mutable_header()->set_session(session);
    for (Upload* upload : {&one, &other}) upload->writer->Write(begun);
    // Both stay open until the server has ended one of them: the first to arrive is taken, whichever that is.
    Upload* refused = nullptr;
    const auto hasEnded = [&](Upload& upload) { return !upload.writer->Write(more("")); };
    ASSERT_TRUE(eventually([&] {
      refused = hasEnded(one) ? &one : hasEnded(other) ? &other : nullptr;
      return refused != nullptr;
    }));
    Upload& taken = refused == &one ? other : one;
    EXPECT_THAT(refused->finish(), Refused(StatusCode::RESOURCE_EXHAUSTED, "max_uploads", "allowed at once are 1"));
    taken.writer->Write(more(bytes.substr(10)));
    EXPECT_THAT(taken.finish(), IsOk());
  }
  // A place is free when the answer is there. Broken by: places that are given up when the call is destroyed.
  for (int i = 0; i < 200; ++i) ASSERT_THAT(upload(stubs, session, pb::BLOB_KIND_MESH, bytes), IsOk()) << i;
}

/// Every prefix of `bytes` at steps, as an upload of its own.
template <typename Check>
void uploadPrefixes(Stubs& stubs, const std::string& session, pb::BlobKind kind, const std::string& bytes,
                    Check check) {
  const std::size_t step = std::max<std::size_t>(1, bytes.size() / 97);
  for (std::size_t length = 1; length < bytes.size(); length += step) {
    check(length, upload(stubs, session, kind, bytes.substr(0, length)));
  }
  check(bytes.size() - 1, upload(stubs, session, kind, bytes.substr(0, bytes.size() - 1)));
}

TEST_F(Blobs, CutShortAreRefused) {
  const std::int64_t before = stats().blobs();
  pb::Mesh mesh = sheet(8);
  mesh.set_normals(mesh.positions());
  mesh.set_uvs(std::string(64 * 8, '\0'));
  // Attributes are optional: cut exactly where one ends, what is left is a mesh by itself.
  pb::Mesh bare = sheet(8);
  const std::size_t whole = bare.ByteSizeLong();
  bare.set_normals(mesh.normals());
  const std::size_t withNormals = bare.ByteSizeLong();
  int accepted = 0;
  uploadPrefixes(stubs_, session_, pb::BLOB_KIND_MESH, mesh.SerializeAsString(),
                 [&](std::size_t length, const grpc::Status& status) {
                   if (length == whole || length == withNormals) {
                     ++accepted;
                     return;
                   }
                   EXPECT_THAT(status, HasCode(StatusCode::INVALID_ARGUMENT)) << length;
                   EXPECT_FALSE(fieldOf(status).empty()) << length;
                 });
  pb::Texture texture;
  texture.set_width(16);
  texture.set_height(16);
  texture.set_format(pb::TEXTURE_FORMAT_RGB8_SRGB);
  texture.set_texels(std::string(16 * 16 * 3, 'x'));
  uploadPrefixes(stubs_, session_, pb::BLOB_KIND_TEXTURE, texture.SerializeAsString(),
                 [](std::size_t length, const grpc::Status& status) {
                   EXPECT_THAT(status, HasCode(StatusCode::INVALID_ARGUMENT)) << length;
                   EXPECT_FALSE(fieldOf(status).empty()) << length;
                 });
  EXPECT_EQ(stats().blobs(), before + accepted);
  EXPECT_THAT(upload(stubs_, session_, pb::BLOB_KIND_TEXTURE, texture.SerializeAsString()), IsOk());
}

TEST_F(Blobs, OfGarbageAreRefused) {
  const std::int64_t before = stats().blobs();
  std::mt19937 random(7);
  for (int i = 0; i < 60; ++i) {
    std::string garbage(std::size_t(1 + random() % 2000), '\0');
    for (char& c : garbage) c = char(random());
    const pb::BlobKind kind = i % 2 == 0 ? pb::BLOB_KIND_MESH : pb::BLOB_KIND_TEXTURE;
    EXPECT_THAT(upload(stubs_, session_, kind, garbage), HasCode(StatusCode::INVALID_ARGUMENT)) << i;
  }
  EXPECT_EQ(stats().blobs(), before);
  EXPECT_TRUE(server().running());
}

/// A texture blob that differs from a good one in one way.
struct BadTexture {
  const char* name;
  const char* field;
  const char* text;
  void (*spoil)(pb::Texture*);
};
class BadTextures : public Blobs, public ::testing::WithParamInterface<BadTexture> {};

TEST_P(BadTextures, AreRefusedByField) {
  pb::Texture texture;
  texture.set_width(2);
  texture.set_height(2);
  texture.set_format(pb::TEXTURE_FORMAT_RGB32F);
  texture.set_texels(packed<float>({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}));
  ASSERT_THAT(upload(stubs_, session_, pb::BLOB_KIND_TEXTURE, texture.SerializeAsString()), IsOk());
  GetParam().spoil(&texture);
  EXPECT_THAT(upload(stubs_, session_, pb::BLOB_KIND_TEXTURE, texture.SerializeAsString()),
              Refused(StatusCode::INVALID_ARGUMENT, GetParam().field, GetParam().text));
}

INSTANTIATE_TEST_SUITE_P(
    All, BadTextures,
    ::testing::Values(
        BadTexture{"TooFewBytes", "texels", "48", [](pb::Texture* bad) { bad->mutable_texels()->pop_back(); }},
        BadTexture{"TooManyBytes", "texels", "48", [](pb::Texture* bad) { *bad->mutable_texels() += "four"; }},
        BadTexture{"NoWidth", "width", "1..16384", [](pb::Texture* bad) { bad->set_width(0); }},
        BadTexture{"NegativeHeight", "height", "1..16384", [](pb::Texture* bad) { bad->set_height(-2); }},
        BadTexture{"TooWide", "width", "1..16384", [](pb::Texture* bad) { bad->set_width(20000); }},
        BadTexture{"NoFormat", "format", "0", [](pb::Texture* bad) { bad->clear_format(); }},
        BadTexture{"NanTexel", "texels", "texel 1",
                   [](pb::Texture* bad) {
                     const float nan = std::numeric_limits<float>::quiet_NaN();
                     std::memcpy(bad->mutable_texels()->data() + 16, &nan, sizeof nan);
                   }},
        BadTexture{"NegativeTexel", "texels", "texel 0",
                   [](pb::Texture* bad) {
                     const float below = -1.0F;
                     std::memcpy(bad->mutable_texels()->data(), &below, sizeof below);
                   }}),
    [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace lpv::rpc
