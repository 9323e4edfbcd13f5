#pragma once
// The lpv.v1 services as C++ calls. Everything that can fail says so by value (base/status.h); nothing throws.
//
//   auto client = lpv::client::Client::connect({.address = "localhost:50051"});
//   if (!client) return report(client.status());
//   auto session = client->createSession({});
//
// Sessions may be named "sessions/{id}" or just "{id}".

#include <chrono>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/status.h"
#include "lpv/results.h"
#include "lpv/v1/blob.pb.h"
#include "lpv/v1/result.pb.h"
#include "lpv/v1/scene.pb.h"
#include "lpv/v1/server.pb.h"
#include "lpv/v1/session.pb.h"
#include "scene/mesh.h"

namespace lpv::client {

class Connection;

/// Encryption and mutual authentication; all empty: plain text.
struct TlsOptions {
  std::string caFile = {};    ///< PEM roots that vouch for the server; empty: the system's
  std::string certFile = {};  ///< PEM certificate of this client
  std::string keyFile = {};   ///< its PEM private key
  bool enabled = false;       ///< TLS with the system's roots, without any file
};

/// Where and how to connect.
struct ConnectOptions {
  std::string address = "localhost:50051";   ///< HOST:PORT; no proxy is taken from the environment
  std::string tokenFile = {};                     ///< file whose first line is the access token; empty: none
  std::string token = {};                         ///< the access token itself; tokenFile wins
  TlsOptions tls = {};
  std::chrono::milliseconds timeout{30000};  ///< of one call; transfers get more time for their size
};

/// Bytes done, bytes in all. Called on the thread that made the call.
using Progress = std::function<void(std::uint64_t done, std::uint64_t total)>;

/// All items of a listing and the scene revision they were read at.
template <typename T>
struct Listing {
  std::vector<T> items;
  std::uint64_t revision = 0;
};

/// A connection to one server. Cheap to copy, safe to share between threads; calls block until answered.
/// Errors: the server's status as it is; UNAVAILABLE where no server answers; DEADLINE_EXCEEDED after `timeout`.
class Client {
 public:
  /// Prepares a connection; the network is first used by the first call. INVALID_ARGUMENT for files that cannot be
  /// read.
  static Expected<Client> connect(const ConnectOptions& options);

  /// Ends every call in flight and to come with CANCELLED. Safe from any thread, not from a signal handler.
  void cancel();

  const std::string& address() const;

  // The server.
  Expected<v1::GetServerInfoResponse> serverInfo();
  Expected<v1::GetStatsResponse> stats();
  /// grpc.health.v1: true when `service` (empty: the server as a whole) is serving.
  Expected<bool> healthy(const std::string& service = {});

  // Sessions.
  Expected<v1::CreateSessionResponse> createSession(const v1::CreateSessionRequest& request);
  Expected<v1::Session> session(const std::string& session);
  Expected<std::vector<v1::Session>> sessions();
  /// Changes the fields of `session.settings` named by `paths` ("settings.iterations").
  Expected<v1::Session> updateSession(const v1::Session& session, const std::vector<std::string>& paths);
  Status deleteSession(const std::string& session);
  /// Refits the grid to the content.
  Expected<v1::Session> fitSession(const std::string& session);
  Expected<v1::CreateTokenResponse> createToken(const v1::CreateTokenRequest& request);
  Status revokeToken(const std::string& session, const std::string& tokenId);
  /// Hands the session's snapshot file to `sink` piece by piece; `sink` returns false to stop.
  Status exportSession(const std::string& session, const std::function<bool(const std::string&)>& sink);
  /// A new session from a snapshot file; `id` empty: the server chooses.
  Expected<v1::ImportSessionResponse> importSession(const std::string& id, const std::string& file,
                                                    const Progress& progress = {});

  // Blobs: meshes and textures by content.
  /// Which of `hashes` the session has.
  Expected<std::vector<BlobHash>> findBlobs(const std::string& session, const std::vector<BlobHash>& hashes);
  /// Sends a serialised Mesh or Texture in parts and returns its hash; see lpv/blobs.h for the comfortable way.
  Expected<BlobHash> uploadBlob(const std::string& session, v1::BlobKind kind, const std::string& bytes,
                                const Progress& progress = {});
  Expected<std::string> readBlob(const std::string& session, const BlobHash& hash);

  // The scene. For many edits, undo and retries without doubt see lpv/editor.h.
  /// One edit without a client identity: a lost answer leaves it open whether it was applied.
  Expected<v1::EditAck> applyEdit(const std::string& session, const v1::Edit& edit);
  Expected<Listing<v1::Light>> lights(const std::string& session);
  Expected<Listing<v1::Surface>> surfaces(const std::string& session);
  Expected<Listing<v1::Camera>> cameras(const std::string& session);
  /// For a request with an identity; Editor::undo and redo make them.
  Expected<v1::UndoResponse> undo(const v1::UndoRequest& request);
  Expected<v1::RedoResponse> redo(const v1::RedoRequest& request);

  // Results that read your writes: from the session's revision when the call arrives, or `min_revision`.
  Expected<VolumeResult> volume(const v1::GetVolumeRequest& request);
  Expected<FrameResult> frame(const v1::GetFrameRequest& request);
  /// Irradiance at any number of points: batches of 16384, each from the first batch's revision or a later one; `info`
  /// is the last batch's.
  Expected<ProbeResult> probe(const std::string& session, const std::vector<SurfacePoint>& points,
                              bool volumeOnly = false, std::optional<std::uint64_t> minRevision = {});
  Expected<v1::PickResponse> pick(const v1::PickRequest& request);

  /// For this library's own streams.
  const std::shared_ptr<Connection>& connection() const { return connection_; }

 private:
  explicit Client(std::shared_ptr<Connection> connection) : connection_(std::move(connection)) {}
  std::shared_ptr<Connection> connection_;
};

/// "sessions/{id}" from "{id}" or itself.
std::string sessionName(const std::string& idOrName);
/// "{id}" from "sessions/{id}" or itself.
std::string sessionId(const std::string& idOrName);

/// Version of this library, "major.minor.patch".
const char* version();

}  // namespace lpv::client
