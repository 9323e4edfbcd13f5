#pragma once
// The lighting engine as sessions see it: work goes in, finished results come back. No GL type passes this header.

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/status.h"
#include "engine/stage.h"
#include "scene/camera.h"
#include "scene/scene.h"
#include "scene/volume.h"
#include "scene/workload.h"

namespace lpv {

using SessionKey = std::uint64_t;

/// How a frame's pixels come back.
enum class PixelFormat {
  kRgb8,     ///< exposed, tone-mapped, sRGB-coded: 3 bytes per pixel (scene/tonemap.h)
  kRgb32F,   ///< linear radiance, W/(sr m^2), before exposure and tone curve: 3 floats per pixel
};

/// Exposure is fixed in stops, or chosen from the picture's own mean lightness.
struct Exposure {
  bool automatic = true;
  double ev = 0.0;  ///< stops added: colours are multiplied by 2^ev

  bool operator==(const Exposure&) const = default;
};

/// What a picture shows.
enum class FrameQuantity {
  kRadiance,    ///< what the camera sees, W/(sr m^2)
  kIrradiance,  ///< what surfaces receive, W/m^2; 0 where none is seen
};

/// One picture of the scene. `view` names the subscriber (or call) whose G-buffer may be kept while its camera, size
/// and the surfaces stay the same; 0 keeps nothing.
struct FrameRequest {
  std::uint64_t view = 0;
  Camera camera;
  glm::ivec2 size{0};  ///< pixels, each 16..4096
  Exposure exposure;
  PixelFormat format = PixelFormat::kRgb8;
  FrameQuantity quantity = FrameQuantity::kRadiance;  ///< irradiance: kRgb32F, one sample
  int samples = 1;  ///< of each pixel, for edges and textures: a power of two up to 64; light is found once per pixel
  bool reduced = false;  ///< GATHER: near lights are looked at from some pixels, not from each (streams)

  bool operator==(const FrameRequest&) const = default;
};

/// Pixels, rows from top to bottom, tightly packed.
struct Frame {
  glm::ivec2 size{0};
  PixelFormat format = PixelFormat::kRgb8;
  std::vector<std::uint8_t> rgb8;
  std::vector<float> rgb32f;
  double exposureEv = 0.0;  ///< what was applied (automatic exposure says its choice)
  Camera camera;  ///< what it shows the scene through
};
using FramePtr = std::shared_ptr<const Frame>;

/// One tick: bring the session's volume to `scene`'s revision, running only stages whose inputs changed, then read
/// back and render what is asked for.
struct TickRequest {
  SessionKey session = 0;
  ScenePtr scene;
  bool transported = false;  ///< read the transported volume back
  bool probed = false;  ///< and with it what surfaces reflect, for probes (Volume::probed)
  bool injected = false;  ///< read the injected volume back
  bool guarded = false;  ///< and the guard cells with them (Volume::guarded)
  std::vector<FrameRequest> frames;
  bool patient = false;  ///< goes on only while no other session's tick can, and may be abandoned
};

struct StageTime {
  Stage stage = Stage::kUpload;
  double seconds = 0.0;  ///< wall clock from the stage's first piece to its fence, other sessions' pieces left out
};

/// What ran and what was seen, for logs, metrics and the client.
/// Bytes of buffers and textures on the GPU, as they were asked for.
struct MemoryUse {
  std::int64_t light = 0;  ///< volume, lights, shadows and bounces
  std::int64_t frames = 0;  ///< of views that are kept, and of those of this tick
  std::int64_t scene = 0;  ///< meshes and textures, which sessions share that have the same

  bool operator==(const MemoryUse&) const = default;
};

struct TickReport {
  std::vector<StageTime> stages;  ///< in order; skipped stages are absent
  std::vector<std::string> features;  ///< compiled variants that ran, e.g. "count", "propagate", "two-sided"
  std::uint64_t trianglesSkipped = 0;  ///< degenerate light triangles
  std::uint64_t lightsVoxelized = 0;  ///< lights whose geometry was not in the grid yet
  std::uint64_t touchedCells = 0;  ///< cells that hold emitted light, counted per light without PROPAGATE
  std::uint64_t vpls = 0;  ///< GATHER: VPLs that the lights are made of
  std::uint64_t clampedCells = 0;  ///< output cells clamped to phi >= 0, |D| <= phi (MATHS.md 3a)
  double fixedPointError =
      0.0;  ///< bound of the rounding of one injected coefficient, relative to the largest possible
  std::uint64_t pieces = 0;  ///< bounded pieces of work the tick was made of
  std::uint64_t othersPieces = 0;  ///< other sessions' pieces that were begun while it was under way
  double longestPiece = 0.0;  ///< seconds; other sessions had to wait so long for the device
  std::optional<Stage> longestStage;  ///< whose piece that was; none: work without a stage
  double largestPrediction = 0.0;  ///< seconds that a piece was predicted to take
  MemoryUse memory;  ///< at the end
};

struct TickResult {
  std::uint64_t revision = 0;
  VolumePtr transported;  ///< null unless asked for
  VolumePtr injected;  ///< null unless asked for
  std::vector<FramePtr> frames;  ///< one per request, in order
  TickReport report;
};

/// What a tick that starts from nothing is expected to take of the device.
struct Prediction {
  double seconds = 0.0;
  Stage mostly = Stage::kUpload;  ///< the stage that takes the most of it
};

/// Called once, on the GL thread: take the result away and return at once.
using TickDone = std::function<void(Expected<TickResult>)>;

/// What the engine runs on.
struct DeviceInfo {
  int index = -1;  ///< among the listed devices
  std::string name;  ///< GL_RENDERER
  std::string vendor;  ///< GL_VENDOR
  std::string version;  ///< GL_VERSION
  std::string platform;  ///< "device" or "surfaceless"
  bool software = false;
};

/// Owner of one device's GL thread. Thread-safe.
class Engine {
 public:
  virtual ~Engine() = default;
  virtual const DeviceInfo& device() const = 0;
  /// Queues a tick. Sessions take turns, a bounded piece of GPU work at a time. At most one tick per session may be
  /// under way: the caller waits for `done` before the next.
  virtual void submit(TickRequest request, TickDone done) = 0;
  /// Ends the session's tick under way, if it is a patient one, with CANCELLED, as soon as the device is done with the
  /// piece that it works at; one that is nearly through may succeed all the same. What its stages have made is kept.
  virtual void abandon(SessionKey session) = 0;
  /// From what this device was measured to take so far.
  virtual Prediction predict(const Workload& workload) const = 0;
  /// How often the graphics context was lost. Sessions do not notice: what was under way is made again from its scene,
  /// in a new context; UNAVAILABLE only where there is none to be had.
  virtual std::int64_t contextLosses() const = 0;
  /// Drops a session's GPU state once its tick under way, if any, has ended.
  virtual void forget(SessionKey session) = 0;
  /// Drops what is kept for one view.
  virtual void forgetView(SessionKey session, std::uint64_t view) = 0;
};

}  // namespace lpv
