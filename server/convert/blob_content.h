#pragma once
// Meshes and textures between their wire bytes and the domain.

#include <memory>
#include <string>

#include "base/digest.h"
#include "lpv/v1/blob.pb.h"
#include "session/document/blobs.h"

namespace lpv::api {

namespace pb = lpv::v1;

/// A finished mesh (without hash) from its message; INVALID_ARGUMENT names the field.
Expected<Mesh> meshFromProto(const pb::Mesh& message);
/// The message of a mesh; serialised, the bytes that name a deformed mesh.
pb::Mesh meshToProto(const Mesh& mesh);
/// Deterministic bytes of meshToProto.
std::string meshBytes(const Mesh& mesh);
/// The hash of a mesh that came in no blob (Session's MeshHasher).
BlobHash meshHash(const Mesh& mesh);

/// Parses, checks and hashes uploaded bytes.
Expected<BlobPtr> blobFromBytes(pb::BlobKind kind, std::string bytes);
/// A mesh carried inside an edit, hashed as a blob of it would be.
Expected<MeshPtr> inlineMesh(const pb::Mesh& message);

/// Little-endian float32 triples; INVALID_ARGUMENT at `field` where the size is no multiple of 12.
Expected<std::vector<glm::vec3>> vec3sFromBytes(const char* field, const std::string& bytes);

}  // namespace lpv::api
