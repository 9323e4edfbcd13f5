// Calls for blobs and the scene.

#include <algorithm>

#include "connection.h"

namespace lpv::client {
namespace {

/// Reads all pages of a listing; `items` returns a response's repeated field.
template <typename Item, typename Stub, typename Request, typename Response, typename Items>
Expected<Listing<Item>> listAll(Connection& connection, Stub& stub,
                                grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                                const std::string& session, const Items& items) {
  Listing<Item> all;
  Request request;
  request.set_session(sessionName(session));
  request.set_page_size(1000);
  do {
    Expected<Response> page = unary(connection, stub, method, request);
    if (!page) return page.status();
    for (const Item& item : items(*page)) all.items.push_back(item);
    all.revision = page->revision();
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return all;
}

}  // namespace

Expected<std::vector<BlobHash>> Client::findBlobs(const std::string& session, const std::vector<BlobHash>& hashes) {
  constexpr std::size_t kBatch = 1000;
  std::vector<BlobHash> found;
  for (std::size_t at = 0; at < hashes.size(); at += kBatch) {
    v1::FindBlobsRequest request;
    request.set_session(sessionName(session));
    for (std::size_t i = at; i < std::min(at + kBatch, hashes.size()); ++i) request.add_hashes(hashes[i]);
    auto response = unary(*connection_, *connection_->blobs, &v1::BlobService::Stub::FindBlobs, request);
    if (!response) return response.status();
    found.insert(found.end(), response->found().begin(), response->found().end());
  }
  return found;
}

Expected<BlobHash> Client::uploadBlob(const std::string& session, v1::BlobKind kind, const std::string& bytes,
                                      const Progress& progress) {
  Call call(*connection_, timeFor(bytes.size()));
  v1::UploadBlobResponse response;
  const auto writer = connection_->blobs->UploadBlob(&call.context, &response);
  v1::UploadBlobRequest part;
  part.mutable_header()->set_session(sessionName(session));
  part.mutable_header()->set_kind(kind);
  part.mutable_header()->set_size(std::int64_t(bytes.size()));
  std::size_t at = 0;
  do {
    part.set_data(bytes.substr(at, kPartBytes));
    at += part.data().size();
    if (!writer->Write(part)) break;  // Finish says why
    part.clear_header();
    if (progress) progress(at, bytes.size());
  } while (at < bytes.size());
  writer->WritesDone();
  const grpc::Status status = writer->Finish();
  if (!status.ok()) return statusFrom(status, address());
  return response.hash();
}

Expected<std::string> Client::readBlob(const std::string& session, const BlobHash& hash) {
  v1::ReadBlobRequest request;
  request.set_session(sessionName(session));
  request.set_hash(hash);
  Call call(*connection_, timeFor(std::uint64_t(64) << 20U));
  const auto reader = connection_->blobs->ReadBlob(&call.context, request);
  std::string bytes;
  std::int64_t size = -1;
  v1::ReadBlobResponse part;
  while (reader->Read(&part)) {
    if (size < 0) size = part.size();
    bytes += part.data();
  }
  const grpc::Status status = reader->Finish();
  if (!status.ok()) return statusFrom(status, address());
  if (size != std::int64_t(bytes.size())) {
    return Status(Code::kInternal, "the blob has " + std::to_string(bytes.size()) + " bytes, the server announced " +
                                       std::to_string(size));
  }
  return bytes;
}

Expected<v1::EditAck> Client::applyEdit(const std::string& session, const v1::Edit& edit) {
  v1::ApplyEditRequest request;
  request.set_session(sessionName(session));
  *request.mutable_edit() = edit;
  auto response = unary(*connection_, *connection_->scene, &v1::SceneService::Stub::ApplyEdit, request);
  if (!response) return response.status();
  return response->ack();
}

Expected<Listing<v1::Light>> Client::lights(const std::string& session) {
  return listAll<v1::Light>(*connection_, *connection_->scene, &v1::SceneService::Stub::ListLights, session,
                            [](const v1::ListLightsResponse& page) -> const auto& { return page.lights(); });
}

Expected<Listing<v1::Surface>> Client::surfaces(const std::string& session) {
  return listAll<v1::Surface>(*connection_, *connection_->scene, &v1::SceneService::Stub::ListSurfaces, session,
                              [](const v1::ListSurfacesResponse& page) -> const auto& { return page.surfaces(); });
}

Expected<Listing<v1::Camera>> Client::cameras(const std::string& session) {
  return listAll<v1::Camera>(*connection_, *connection_->scene, &v1::SceneService::Stub::ListCameras, session,
                             [](const v1::ListCamerasResponse& page) -> const auto& { return page.cameras(); });
}

Expected<v1::UndoResponse> Client::undo(const v1::UndoRequest& request) {
  return unary(*connection_, *connection_->scene, &v1::SceneService::Stub::Undo, request);
}

Expected<v1::RedoResponse> Client::redo(const v1::RedoRequest& request) {
  return unary(*connection_, *connection_->scene, &v1::SceneService::Stub::Redo, request);
}

}  // namespace lpv::client
