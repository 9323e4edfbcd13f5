#pragma once
// Who wrote what last, and the steps that members can take back (PROTOCOL.md, "Edits and scene"). Pure state, no
// threads, no clocks. It lives as long as the process has the session in memory: it is in no log and no snapshot.
//
// Every value that a field ever had is known by the revision that wrote it. A step remembers, per field, what was there
// before it and what it left; taking it back sets the first, and its revision with it, where the second is still there.
// So taking back two steps, one after the other, works, and what somebody else has written since stays.

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "scene/edits.h"
#include "session/document/document.h"
#include "session/document/object_state.h"
#include "session/limits.h"

namespace lpv {

/// The grid in lists of what was skipped, as Session has it.
inline constexpr const char* kGridField = "session.grid";

/// Which way along a member's steps.
enum class UndoDirection { kUndo, kRedo };

class History {
 public:
  explicit History(const Limits& limits) : limits_(limits) {}
  /// From now on; what is there stays.
  void setLimits(const Limits& limits) { limits_ = limits; }

  /// `document` has just applied `edit`, which gave the objects these names. Edits without a client (`client` empty)
  /// are no steps, but they are writes.
  void recordWrites(const std::string& client, const Edit& edit, const std::vector<std::string>& names,
                    const Document& document);

  struct Plan;
  /// What undoing, or redoing, the member's newest step would do now. FAILED_PRECONDITION where there is none.
  Expected<Plan> plan(const std::string& client, UndoDirection direction, const Document& document) const;
  /// `document` has just restored plan.objects and plan.grid.
  void done(const std::string& client, UndoDirection direction, Plan plan, const Document& document);

  /// Forgets a member's steps.
  void leave(const std::string& client);
  /// Adds the meshes and textures that steps may bring back.
  void addHashesInUse(std::set<BlobHash>& out) const;
  /// Steps that `client` can take back.
  std::size_t depth(const std::string& client) const;

 private:
  /// Revisions that wrote an object's fields; 0: before this history began.
  using Writes = std::array<std::uint64_t, kMaxFields>;
  /// An object from its creation on; deleted and brought back it is the same one, created again it is another.
  struct ObjectIncarnation {
    Writes writes{};
  };
  using IncarnationPtr = std::shared_ptr<ObjectIncarnation>;
  /// What has a name: a life, or null, and the revision that made it so.
  struct NameBinding {
    IncarnationPtr life;
    std::uint64_t write = 0;

    bool operator==(const NameBinding&) const = default;
  };
  /// One side of a change of what has a name.
  struct WholeSide {
    NameBinding standing;
    Writes writes{};  ///< of the life, as the step left or found them
    ObjectState object;  ///< to bring back
  };
  struct WholeChange {
    WholeSide before;
    WholeSide after;
  };
  struct FieldSide {
    std::uint64_t write = 0;
    FieldValue value;
  };
  struct FieldChange {
    ObjectKey key;
    FieldSide before;
    FieldSide after;
  };
  struct GridSide {
    std::uint64_t write = 0;
    Grid grid;
  };
  struct GridChange {
    GridSide before;
    GridSide after;
  };
  struct Step {
    std::uint64_t number = 0;  ///< rises over all members
    std::string group;
    std::map<ObjectKey, WholeChange> wholes;
    std::map<std::pair<IncarnationPtr, std::size_t>, FieldChange> fields;
    std::optional<GridChange> grid;  ///< where the edit fitted it

    bool empty() const { return wholes.empty() && fields.empty() && !grid; }
  };
  struct Member {
    std::deque<Step> undo;  ///< oldest first
    std::deque<Step> redo;  ///< the next one last
    bool grouping = false;  ///< the last thing done was an edit: one of the same group joins it
  };
  struct HeldBlob {
    int uses = 0;
    std::int64_t bytes = 0;
  };
  /// What an edit does to one object.
  struct FieldsWritten {
    bool whole = false;
    FieldSet fields;
  };

  static std::map<ObjectKey, FieldsWritten> touches(const Edit& edit, const std::vector<std::string>& names,
                                                    const Document& document);
  NameBinding& standing(const ObjectKey& key, bool stands);
  const NameBinding* find(const ObjectKey& key) const;
  void recordObject(const ObjectKey& key, const Document& document, Step& step);
  void recordFields(const ObjectKey& key, const FieldSet& fields, const Document& document, Step& step);
  void recordGrid(const Document& document, Step& step);
  std::uint64_t gridWriteOf(std::uint64_t revision) const;
  void push(const std::string& client, Step step);
  static void merge(Step& into, Step step);

  void planWhole(const ObjectKey& key, const WholeChange& change, UndoDirection direction, const Document& document,
                 Plan& plan) const;
  void planField(const IncarnationPtr& life, std::size_t field, const FieldChange& change, UndoDirection direction,
                 const Document& document, Plan& plan) const;

  void planGrid(const Step& step, UndoDirection direction, const Document& document, Plan& plan) const;
  bool createdBeyond(const Step& step, UndoDirection direction, const Document& document, const Plan& plan) const;
  void recordRestoredGrid(UndoDirection direction, const Document& document, Plan& plan);

  void weigh(const Step& step, int sign);
  void hold(const ObjectState& object, int sign);
  void hold(const FieldValue& value, int sign);
  void hold(const BlobHash& hash, std::int64_t bytes, int sign);
  void forget(std::deque<Step>& steps, bool newest);
  void forgetMuch();
  void forgetNames();

  Limits limits_;
  std::map<ObjectKey, NameBinding> names_;
  std::map<std::string, Member> members_;
  /// The grid that a revision of the document put in place, and the revision that first wrote that grid.
  struct {
    std::uint64_t revision = 0;
    std::uint64_t write = 0;
  } gridWrite_;
  std::map<BlobHash, HeldBlob> held_;
  std::int64_t bytes_ = 0;  ///< of all steps, about
  std::uint64_t lastNumber_ = 0;
  std::size_t forgetNamesAt_ = 10'000;
};

struct History::Plan {
  std::vector<NamedState> objects;  ///< for Document::restore
  std::optional<RestoredGrid> grid;  ///< the same
  /// "name.field", or "name" for a whole object, or kGridField: left as somebody else has made it.
  std::vector<std::string> skipped;

 private:
  friend class History;
  Step applied;  ///< what of the step is not skipped
  std::map<ObjectKey, ObjectState> states;
};

}  // namespace lpv
