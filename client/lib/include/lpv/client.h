#pragma once
// The lpv.v1 services as C++ calls. Errors are returned as values (base/status.h); nothing throws.
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

/// Encryption and mutual authentication. All fields empty: plain text.
struct TlsOptions {
  std::string caFile = {};    ///< PEM root certificates; empty: the system's
  std::string certFile = {};  ///< PEM certificate of this client
  std::string keyFile = {};   ///< its PEM private key
  bool enabled = false;       ///< TLS with the system's root certificates, without any file
};

/// Where and how to connect.
struct ConnectOptions {
  std::string address = "localhost:50051";   ///< HOST:PORT; proxy variables of the environment are ignored
  std::string tokenFile = {};                     ///< file with the access token in its first line; empty: none
  std::string token = {};                         ///< the access token; tokenFile takes precedence
  TlsOptions tls = {};
  std::chrono::milliseconds timeout{30000};  ///< of one call; transfers get more time by their size
};

/// Receives the bytes transferred so far and in total. Called on the thread that made the call.
using Progress = std::function<void(std::uint64_t done, std::uint64_t total)>;

/// All items of a listing and the revision of the scene that they show.
template <typename T>
struct Listing {
  std::vector<T> items;
  std::uint64_t revision = 0;
};

/// A connection to one server. Cheap to copy, safe to share between threads; calls block until answered.
/// Errors: the server's status; UNAVAILABLE if no server answers; DEADLINE_EXCEEDED after `timeout`.
class Client {
 public:
  /// Prepares a connection without using the network; the first call connects. INVALID_ARGUMENT if a file of `options`
  /// cannot be read.
  static Expected<Client> connect(const ConnectOptions& options);

  /// Cancels all calls, those in flight and later ones. Safe from any thread, but not from a signal handler.
  void cancel();

  const std::string& address() const;

  // The server.
  Expected<v1::GetServerInfoResponse> serverInfo();
  Expected<v1::GetStatsResponse> stats();
  /// Asks grpc.health.v1 whether `service` is serving; empty: the server as a whole.
  Expected<bool> healthy(const std::string& service = {});

  // Sessions.
  Expected<v1::CreateSessionResponse> createSession(const v1::CreateSessionRequest& request);
  Expected<v1::Session> session(const std::string& session);
  Expected<std::vector<v1::Session>> sessions();
  /// Changes the fields of `session` that `paths` name ("settings.iterations").
  Expected<v1::Session> updateSession(const v1::Session& session, const std::vector<std::string>& paths);
  Status deleteSession(const std::string& session);
  /// Fits the grid to the content.
  Expected<v1::Session> fitSession(const std::string& session);
  Expected<v1::CreateTokenResponse> createToken(const v1::CreateTokenRequest& request);
  /// Those that are neither revoked nor expired, without their secrets.
  Expected<std::vector<v1::AccessToken>> tokens(const std::string& session);
  Status revokeToken(const std::string& session, const std::string& tokenId);
  /// Exports the session as a snapshot file and passes its bytes to `sink` in chunks; `sink` returns false to stop.
  Status exportSession(const std::string& session, const std::function<bool(const std::string&)>& sink);
  /// Creates a session from a snapshot file. `id` empty: the server chooses one.
  Expected<v1::ImportSessionResponse> importSession(const std::string& id, const std::string& file,
                                                    const Progress& progress = {});

  // Blobs: meshes and textures by content.
  /// Those of `hashes` that the session has.
  Expected<std::vector<BlobHash>> findBlobs(const std::string& session, const std::vector<BlobHash>& hashes);
  /// Uploads a serialised Mesh or Texture in parts and returns its hash. lpv/blobs.h has simpler functions.
  Expected<BlobHash> uploadBlob(const std::string& session, v1::BlobKind kind, const std::string& bytes,
                                const Progress& progress = {});
  Expected<std::string> readBlob(const std::string& session, const BlobHash& hash);

  // The scene. lpv/editor.h has streams of edits, undo, and retries that never apply an edit twice.
  /// Applies one edit without a client identity. If the answer is lost, it is unknown whether the edit was applied.
  Expected<v1::EditAck> applyEdit(const std::string& session, const v1::Edit& edit);
  Expected<Listing<v1::Light>> lights(const std::string& session);
  Expected<Listing<v1::Surface>> surfaces(const std::string& session);
  Expected<Listing<v1::Camera>> cameras(const std::string& session);
  /// Needs a client identity in the request; Editor::undo and redo fill it in.
  Expected<v1::UndoResponse> undo(const v1::UndoRequest& request);
  Expected<v1::RedoResponse> redo(const v1::RedoRequest& request);

  // Results that read your writes: they show the session's revision when the call arrives, or `min_revision`, or later.
  Expected<VolumeResult> volume(const v1::GetVolumeRequest& request);
  Expected<FrameResult> frame(const v1::GetFrameRequest& request);
  /// Irradiance at any number of points. They are sent in batches of 16384, or 256 with the light around them; later
  /// batches show the revision of the first or a later one. `info` is that of the last batch.
  Expected<ProbeResult> probe(const std::string& session, const std::vector<SurfacePoint>& points,
                              const ProbeWish& wish = {});
  Expected<v1::PickResponse> pick(const v1::PickRequest& request);

  /// Used by this library's streams.
  const std::shared_ptr<Connection>& connection() const { return connection_; }

 private:
  explicit Client(std::shared_ptr<Connection> connection) : connection_(std::move(connection)) {}
  std::shared_ptr<Connection> connection_;
};

/// Resource name "sessions/{id}" from "{id}" or from itself.
std::string sessionName(const std::string& idOrName);
/// "{id}" from "sessions/{id}" or from itself.
std::string sessionId(const std::string& idOrName);

/// Version of this library, "major.minor.patch".
const char* version();

}  // namespace lpv::client
