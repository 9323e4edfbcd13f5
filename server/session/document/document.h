#pragma once
// A session's scene with its history: edits in, revisions out. Pure state, no threads, no clocks.

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/engine.h"
#include "scene/edits.h"
#include "scene/grid_choice.h"
#include "scene/scene.h"
#include "session/document/blobs.h"
#include "session/document/object_state.h"
#include "session/limits.h"

namespace lpv {

/// An object and the revision that last changed it.
template <typename T>
struct Versioned {
  std::shared_ptr<const T> object;
  std::uint64_t revision = 0;
};

enum class ObjectKind { kLight, kSurface, kCamera };

struct Deleted {
  ObjectKind kind;
  std::string name;
  std::uint64_t revision;
};

/// What differs between two revisions, as current state.
struct Changes {
  bool snapshot = false;       ///< everything: forget what was before
  std::uint64_t revision = 0;  ///< state shown
  std::vector<Versioned<Light>> lights;
  std::vector<Versioned<Surface>> surfaces;
  std::vector<std::pair<std::string, Camera>> cameras;
  std::vector<Deleted> deleted;
  std::optional<LightingSettings> options;
  std::optional<Grid> grid;
};

/// What selfCheck found last.
struct MeasuredError {
  double error = 0.0;  ///< raw relative L2 of irradiance
  double low = 0.0;    ///< the interval that holds it with 95 %
  double high = 0.0;
  std::uint64_t revision = 0;
};

/// Everything a document comes back from.
struct DocumentState {
  std::uint64_t revision = 0;
  LightingSettings options;
  std::uint64_t optionsRevision = 0;
  Grid grid;
  std::uint64_t gridRevision = 0;
  std::vector<Versioned<Light>> lights;
  std::vector<Versioned<Surface>> surfaces;
  struct Camera {
    std::string name;
    lpv::Camera camera;
    std::uint64_t revision = 0;
  };
  std::vector<Camera> cameras;
  std::vector<Deleted> tombstones;  ///< oldest first
  std::uint64_t tombstoneHorizon = 0;
};

/// What a copy of the scene lacks: every object that was changed since the copy was last brought up to date, as it is
/// now; null where it is gone.
struct SceneUpdate {
  bool whole = true;  ///< everything that there is: begin from an empty scene
  std::uint64_t revision = 0;
  LightingSettings options;  ///< as they are carried out (scene/error_goal.h, scene/transport_choice.h)
  Grid grid;
  std::map<std::string, LightPtr> lights;
  std::map<std::string, SurfacePtr> surfaces;
  std::map<std::string, std::optional<Camera>> cameras;
};

/// A grid that an undo or redo brings back.
struct RestoredGrid {
  Grid grid;
  bool holds = true;  ///< false: somebody has created an object beyond it since, so that it is fitted anew
};

/// Names the content of a mesh that no blob carried (SetVertices).
using MeshHasher = std::function<BlobHash(const Mesh&)>;

/// Deletions remembered for readers that come back; older ones get a snapshot.
inline constexpr std::size_t kMaxTombstones = 10'000;

/// RESOURCE_EXHAUSTED, max_tick_seconds, for a session whose ticks are too dear for the device.
Status checkTickSeconds(const Prediction& tick, const Limits& limits);

class Document {
 public:
  /// `options` have passed checkOptions and their grid can be made.
  Document(const LightingSettings& options, const Limits& limits, MeshHasher hasher);
  /// From now on what costs more than it did, and too much, is refused.
  void predictWith(std::function<Prediction(const Workload&)> predict);
  /// RESOURCE_EXHAUSTED, max_tick_seconds, where the document as it is costs too much.
  Status checkCost() const { return checkTickSeconds(predict_(admittedWorkload_), limits_); }

  /// A document that was: `state` is what state() gave.
  Document(const DocumentState& state, const Limits& limits, MeshHasher hasher);
  DocumentState state() const;
  /// From now on; what is there stays.
  void setLimits(const Limits& limits) { limits_ = limits; }
  /// RESOURCE_EXHAUSTED, by name, where there is more in it than the limits allow.
  Status checkTotals() const;

  std::uint64_t revision() const { return revision_; }
  const LightingSettings& options() const { return options_; }
  const Grid& grid() const { return grid_; }
  /// The revision that last wrote the grid; 0: none has.
  std::uint64_t gridRevision() const { return gridRevision_; }
  /// The same as the last edit, undo or redo found them.
  const Grid& gridBefore() const { return replaced_.grid; }
  std::uint64_t gridRevisionBefore() const { return replaced_.gridRevision; }
  std::size_t lightCount() const { return lights_.size(); }
  std::size_t surfaceCount() const { return surfaces_.size(); }
  std::int64_t triangleCount() const { return tally_.triangles; }

  /// The mesh that a SetVertices on `object` would start from, or null.
  MeshPtr meshOf(const std::string& object) const;

  /// Applies every operation or none. On success the revision has risen by one and the names of the objects concerned
  /// are returned, one per operation. Errors name the operation ("operations[3].create_light.radiance").
  Expected<std::vector<std::string>> apply(const Edit& edit, const Blobs& blobs);

  /// Where the session's light was measured with the grid in use, and all of the interval misses the wanted error, the
  /// next edit makes a grid of more cells, where their number is left to the server. Once after each edit by which
  /// objects come or go or the grid is fitted; never fewer cells again while the settings of the grid stand, so that it
  /// does not go back and forth.
  void noteMeasured(const std::optional<MeasuredError>& measured) { measured_ = measured; }
  const std::optional<GridCorrection>& correction() const { return correction_; }

  /// Sets objects, and the grid where one is given, to what they once were: one revision, also where there are none.
  /// RESOURCE_EXHAUSTED, by name, where the session would exceed its limits.
  Status restore(const std::vector<NamedState>& objects, const std::optional<RestoredGrid>& grid = {});

  /// What the last revision changed; every deletion of it, of names given again too.
  const Changes& lastChange() const { return lastChange_; }
  /// What stands under a name, and what stood there before the last edit.
  ObjectState object(const ObjectKey& key) const;
  ObjectState objectBefore(const ObjectKey& key) const;

  /// New settings: a revision where they differ.
  Status setOptions(const LightingSettings& options);

  /// The state as ticks read it. Cheap while nothing changes, else in time of the scene's size.
  ScenePtr snapshot();
  /// What a copy lacks that takes every update (scene_copy.h). In time of what changed since the last call.
  SceneUpdate takeUpdate();

  /// The scene from which a view is chosen for those who give no camera: the state when objects last came or went, when
  /// the grid was last fitted on request, or when something left the surroundings of that state. What moves within them
  /// changes nothing here, so that the view stands still.
  const ScenePtr& viewScene() const { return viewScene_; }

  /// What differs from revision `since`; everything, as a snapshot, where that is unset or no longer known.
  Changes changesSince(std::optional<std::uint64_t> since) const;

  /// World bounds of all surfaces and enabled lights.
  Bounds content() const;

  std::vector<Versioned<Light>> lights() const;
  std::vector<Versioned<Surface>> surfaces() const;
  std::vector<std::pair<std::string, Camera>> cameras() const;
  std::optional<Camera> camera(const std::string& name) const;
  /// Finds a mesh in use by the hash of its content: deformed meshes are in no blob.
  MeshPtr meshInUse(const BlobHash& hash) const;
  /// Hashes of blobs that objects refer to.
  std::set<BlobHash> hashesInUse() const;

 private:
  template <typename T>
  using Objects = std::map<std::string, Versioned<T>>;
  struct CameraEntry {
    Camera camera;
    std::uint64_t revision = 0;
  };
  /// What an edit has replaced so far, to take it back.
  struct Rollback {
    std::map<std::string, std::optional<Versioned<Light>>> lights;
    std::map<std::string, std::optional<Versioned<Surface>>> surfaces;
    std::map<std::string, std::optional<CameraEntry>> cameras;
    std::size_t tombstones = 0;
    Grid grid;
    std::uint64_t gridRevision = 0;
    bool contentAdded = false;
    bool contentRemoved = false;
    bool fitted = false;
    bool restores = false;  ///< an undo or redo
    std::optional<RestoredGrid> restoredGrid;
    bool counted = false;  ///< tally_ has what the edit made

    template <typename T>
    auto& before() {
      if constexpr (std::is_same_v<T, Light>) {
        return lights;
      } else {
        return surfaces;
      }
    }
  };

  Expected<std::string> applyOne(const CreateLight& op, const Blobs& blobs, Rollback& rollback);
  Expected<std::string> applyOne(const UpdateLight& op, const Blobs& blobs, Rollback& rollback);
  Expected<std::string> applyOne(const DeleteLight& op, const Blobs& blobs, Rollback& rollback);
  Expected<std::string> applyOne(const CreateSurface& op, const Blobs& blobs, Rollback& rollback);
  Expected<std::string> applyOne(const UpdateSurface& op, const Blobs& blobs, Rollback& rollback);
  Expected<std::string> applyOne(const DeleteSurface& op, const Blobs& blobs, Rollback& rollback);
  Expected<std::string> applyOne(const SetVertices& op, const Blobs& blobs, Rollback& rollback);
  Expected<std::string> applyOne(const PutCamera& op, const Blobs& blobs, Rollback& rollback);
  Expected<std::string> applyOne(const DeleteCamera& op, const Blobs& blobs, Rollback& rollback);
  Expected<std::string> applyOne(const FitGrid& op, const Blobs& blobs, Rollback& rollback);

  // What lights and surfaces have in common (document_edits.cpp).
  template <typename T>
  Objects<T>& objects() {
    if constexpr (std::is_same_v<T, Light>) {
      return lights_;
    } else {
      return surfaces_;
    }
  }
  template <typename T>
  void put(const std::string& name, std::shared_ptr<const T> object, Rollback& rollback);
  /// The fields with the mesh that they name, where no blob but an object has it.
  template <typename Fields>
  Fields withMeshInUse(const Fields& fields, const Blobs& blobs) const;
  template <typename T>
  Expected<std::string> create(const std::string& name, const auto& fields, const Blobs& blobs, Rollback& rollback);
  template <typename T>
  Expected<std::string> update(const std::string& name, const auto& fields, const Blobs& blobs, Rollback& rollback);
  template <typename T>
  Expected<std::string> remove(const std::string& name, Rollback& rollback);
  template <typename T>
  void deform(const std::string& name, const MeshPtr& mesh, Rollback& rollback);

  Status change(const std::function<Status(Rollback&)>& make);
  Status applyAll(const Edit& edit, const Blobs& blobs, Rollback& rollback, std::vector<std::string>* names);
  Status checkAll(Rollback& rollback);
  void rollBack(Rollback& rollback);
  void restoreOne(const NamedState& wanted, Rollback& rollback);
  template <typename T>
  void restoreOne(const std::string& name, const std::shared_ptr<const T>& object, Rollback& rollback);
  Status checkGroups(const Rollback& rollback) const;
  Workload workload(const LightingSettings& options, const Grid& grid) const;
  Status checkCost(const LightingSettings& options, const Grid& grid);
  std::string freeName(const std::string& wanted) const;
  bool exists(const Deleted& deleted) const;
  Status refit(bool always, const Rollback& rollback);
  void correct(const Rollback& rollback);
  bool missesWhatIsWanted() const;
  void chooseTransportAnew();
  LightingSettings inForce() const;
  int leastCells() const { return correction_ ? correction_->least : 0; }
  bool firstOfItsKind(const Rollback& rollback) const;
  bool firstOfAll(const Rollback& rollback) const;
  Status fitAfter(const Rollback& rollback);
  void noteChange(const Rollback& rollback);
  void updateViewScene(const Rollback& rollback);
  void setStage();
  bool leftViewBounds(const Rollback& rollback) const;
  void count(const Light& light, int sign);
  void count(const Surface& surface, int sign);
  void count(Rollback& rollback);
  void uncount(const Rollback& rollback);
  void notePending(const Rollback& rollback);
  bool sameWorkload(const Rollback& rollback) const;

  Limits limits_;
  MeshHasher hasher_;
  std::function<Prediction(const Workload&)> predict_;
  Workload admittedWorkload_;  ///< what there is to do as of the last change
  LightingSettings options_;
  Grid grid_;
  std::uint64_t revision_ = 0;
  std::uint64_t optionsRevision_ = 0;
  std::uint64_t gridRevision_ = 0;
  std::uint64_t contentRevision_ = 0;  ///< when objects last came or went, or the grid was fitted
  std::uint64_t correctedRevision_ = 0;
  Transport chosen_ =
      Transport::kGather;  ///< where AUTO is asked for: when objects last came or went, and for the grid
  std::optional<MeasuredError> measured_;
  std::optional<GridCorrection> correction_;  ///< not kept: a grid that was corrected is
  Objects<Light> lights_;
  Objects<Surface> surfaces_;
  std::map<std::string, CameraEntry> cameras_;
  std::deque<Deleted> tombstones_;
  std::uint64_t tombstoneHorizon_ = 0;  ///< revisions whose deletions may be forgotten
  Changes lastChange_;
  Rollback replaced_;  ///< by the last edit
  /// What the limits ask for, kept up to date edit by edit.
  struct Tally {
    std::int64_t triangles = 0;
    std::map<std::string, std::int64_t> lightsInGroup;
  };
  Tally tally_;
  /// What the next update brings: objects as the last edit left them. Revision, options and grid are filled in when it
  /// is taken.
  SceneUpdate pending_;
  ScenePtr snapshot_;
  ScenePtr viewScene_;
  Bounds viewBounds_;  ///< world, metres: the content of viewScene_ and its surroundings
};

/// Does the part of SetVertices that takes time. Call outside locks, with `base` = Document::meshOf(object).
Status prepareVertices(SetVertices& op, const MeshPtr& base, const MeshHasher& hasher);

}  // namespace lpv
