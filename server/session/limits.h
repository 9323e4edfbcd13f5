#pragma once

#include <chrono>
#include <cstdint>

namespace lpv {

/// Limits enforced at the door; a refusal names the limit as it is called on the command line (PROTOCOL.md).
struct Limits {
  int maxSessions = 128;
  int maxClientsPerSession = 64;
  int maxSubscribersPerSession = 64;
  int maxLights = 1024;
  int maxSurfaces = 4096;
  int maxCameras = 256;
  std::int64_t maxTriangles = 2'000'000;       ///< of all blobs and deformed meshes of a session
  std::int64_t maxTexels = 64 * 1024 * 1024;   ///< of all textures of a session
  std::int64_t maxBlobBytes = 64 * 1024 * 1024;
  int maxOperationsPerEdit = 1000;
  int maxQueuedEdits = 256;                    ///< a stream's reader pauses here
  double maxEditsPerSecond = 240.0;            ///< per client
  int maxUndoSteps = 100;                      ///< per client; older ones are forgotten
  std::int64_t maxUndoBytes = 256 * 1024 * 1024;  ///< of a session's steps with their meshes; the oldest are forgotten
  double maxPresenceUpdatesPerSecond = 30.0;  ///< per client
  std::chrono::seconds presenceIdle{15};  ///< a member without streams who says nothing for so long is gone
  /// A member without streams who says nothing for so long gives its place to one who joins a full session.
  std::chrono::seconds memberSilent{3600};
  double maxTickRate = 30.0;  ///< ticks of one session per second, on average
  double maxTickSeconds = 30.0;  ///< that a tick from nothing is predicted to take of the device
  int maxSessionFiles = 4;  ///< on their way in or out at once, of the whole server; each is held in memory
  int maxUploads = 32;  ///< of blobs on their way at once, of the whole server; each is held in memory
  std::int64_t maxAnswerBytes = 512 * 1024 * 1024;  ///< that answers in progress hold, of the whole server
  std::int64_t maxAnswerBytesPerSession = 128 * 1024 * 1024;  ///< the same of one session, but for its first answer
  double maxCallsPerSecondPerAddress = 2000.0;  ///< that begin; not of trusted proxies
  int maxFrameEdge = 4096;  ///< pixels
  int minFrameEdge = 16;
  int maxProbePoints = 16384;
  std::chrono::seconds uploadIdle{60};
  std::chrono::seconds firstMessage{10};
  std::chrono::seconds maxWait{30};  ///< of a call for its result, without a deadline of its own
  std::chrono::seconds selfCheck{10};  ///< between two comparisons of a session's volume with the truth; 0: none
  std::chrono::minutes keepUnusedBlobs{10};  ///< an uploaded blob nobody refers to is dropped after this
};

}  // namespace lpv
