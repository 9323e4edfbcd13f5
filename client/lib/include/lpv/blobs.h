#pragma once
// Uploads meshes and textures. A session is asked which contents it has, so each is sent once.

#include <string>
#include <vector>

#include "lpv/client.h"
#include "scene/mesh.h"
#include "scene/texture.h"

namespace lpv::client {

/// A mesh or texture as bytes, named by their hash.
struct Blob {
  v1::BlobKind kind = v1::BLOB_KIND_UNSPECIFIED;
  std::string bytes;
  BlobHash hash;  ///< SHA-256 of bytes, as the server computes it
};

/// Lower-case hexadecimal SHA-256.
BlobHash sha256(const std::string& bytes);

/// Serialises a mesh or a texture. Equal content gives equal bytes.
Blob blobOf(const Mesh& mesh);
Blob blobOf(const Texture& texture);

/// Asks which of `blobs` the session lacks and uploads those, in parts of at most 1 MiB. `progress` counts the bytes of
/// the missing blobs.
Status uploadMissing(Client& client, const std::string& session, const std::vector<const Blob*>& blobs,
                     const Progress& progress = {});

/// Uploads one mesh or texture if the session lacks it. Returns the hash that edits name it by.
Expected<BlobHash> upload(Client& client, const std::string& session, const Mesh& mesh, const Progress& progress = {});
Expected<BlobHash> upload(Client& client, const std::string& session, const Texture& texture,
                          const Progress& progress = {});

}  // namespace lpv::client
