#include "lpv/blobs.h"

#include <openssl/sha.h>

#include <array>
#include <set>

#include "lpv/convert.h"

namespace lpv::client {
namespace {

template <typename Message>
Blob blobFrom(v1::BlobKind kind, const Message& message) {
  Blob blob{kind, message.SerializeAsString(), {}};
  blob.hash = sha256(blob.bytes);
  return blob;
}

Expected<BlobHash> uploadOne(Client& client, const std::string& session, const Blob& blob, const Progress& progress) {
  if (Status status = uploadMissing(client, session, {&blob}, progress); !status.ok()) return status;
  return blob.hash;
}

}  // namespace

BlobHash sha256(const std::string& bytes) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest.data());
  BlobHash hash;
  for (const unsigned char byte : digest) {
    hash += "0123456789abcdef"[byte >> 4U];
    hash += "0123456789abcdef"[byte & 15U];
  }
  return hash;
}

Blob blobOf(const Mesh& mesh) { return blobFrom(v1::BLOB_KIND_MESH, toProto(mesh)); }
Blob blobOf(const Texture& texture) { return blobFrom(v1::BLOB_KIND_TEXTURE, toProto(texture)); }

Status uploadMissing(Client& client, const std::string& session, const std::vector<const Blob*>& blobs,
                     const Progress& progress) {
  std::vector<BlobHash> hashes;
  std::set<BlobHash> done;
  for (const Blob* blob : blobs) {
    if (done.insert(blob->hash).second) hashes.push_back(blob->hash);
  }
  const Expected<std::vector<BlobHash>> found = client.findBlobs(session, hashes);
  if (!found) return found.status();
  done = std::set<BlobHash>(found->begin(), found->end());
  std::vector<const Blob*> missing;
  std::uint64_t total = 0;
  for (const Blob* blob : blobs) {
    if (!done.insert(blob->hash).second) continue;
    missing.push_back(blob);
    total += blob->bytes.size();
  }
  std::uint64_t sent = 0;
  for (const Blob* blob : missing) {
    const auto report = [&](std::uint64_t part, std::uint64_t) {
      if (progress) progress(sent + part, total);
    };
    const Expected<BlobHash> hash = client.uploadBlob(session, blob->kind, blob->bytes, report);
    if (!hash) return hash.status();
    if (*hash != blob->hash) return Status(Code::kInternal, "a blob arrived as " + *hash + ", sent was " + blob->hash);
    sent += blob->bytes.size();
  }
  return {};
}

Expected<BlobHash> upload(Client& client, const std::string& session, const Mesh& mesh, const Progress& progress) {
  return uploadOne(client, session, blobOf(mesh), progress);
}

Expected<BlobHash> upload(Client& client, const std::string& session, const Texture& texture,
                          const Progress& progress) {
  return uploadOne(client, session, blobOf(texture), progress);
}

}  // namespace lpv::client
