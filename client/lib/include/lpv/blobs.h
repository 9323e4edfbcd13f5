#pragma once
// Meshes and textures to the server: each content goes over the wire once.

#include <string>
#include <vector>

#include "lpv/client.h"
#include "scene/mesh.h"
#include "scene/texture.h"

namespace lpv::client {

/// Bytes under their name.
struct Blob {
  v1::BlobKind kind = v1::BLOB_KIND_UNSPECIFIED;
  std::string bytes;
  BlobHash hash;  ///< SHA-256 of bytes, as the server computes it
};

/// Lower-case hexadecimal SHA-256.
BlobHash sha256(const std::string& bytes);

/// The blob of a mesh or a texture; equal content gives equal bytes.
Blob blobOf(const Mesh& mesh);
Blob blobOf(const Texture& texture);

/// Asks which of `blobs` the session lacks and sends those, in parts of at most 1 MiB. Progress counts the bytes that
/// have to travel.
Status uploadMissing(Client& client, const std::string& session, const std::vector<const Blob*>& blobs,
                     const Progress& progress = {});

/// One mesh or texture; returns the hash to name it by in an edit.
Expected<BlobHash> upload(Client& client, const std::string& session, const Mesh& mesh, const Progress& progress = {});
Expected<BlobHash> upload(Client& client, const std::string& session, const Texture& texture,
                          const Progress& progress = {});

}  // namespace lpv::client
