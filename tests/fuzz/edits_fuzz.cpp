// Edits, undo, redo, repeated sequences, locks, uploads and restarts of three members and nobody, in any order, against
// one session. At any time: revisions only rise, and only with what was accepted; a sequence given again is answered as
// the first time, after a restart too; undo and redo in turn change nothing; the log says what the session holds; who
// follows the changes has the scene.

#include <fuzzer/FuzzedDataProvider.h>

#include "convert/blob_content.h"
#include "fuzz/check.h"
#include "fuzz/edit_world.h"
#include "persistence/snapshot.h"
#include "reference/meshes.h"

namespace lpv::fuzz {
namespace {

namespace pb = lpv::v1;

constexpr int kMostSteps = 60;
constexpr int kMembers = 3;

BlobPtr blobOf(pb::BlobKind kind, const std::string& bytes) {
  const Expected<BlobPtr> blob = api::blobFromBytes(kind, bytes);
  check(blob.ok(), "a good blob is taken");
  return *blob;
}

/// What members upload: two meshes, two textures.
const std::vector<BlobPtr>& uploads() {
  static const std::vector<BlobPtr> all = [] {
    pb::Texture texture;
    texture.set_width(1);
    texture.set_height(1);
    texture.set_format(pb::TEXTURE_FORMAT_RGB8_SRGB);
    texture.set_texels("abc");
    pb::Texture other = texture;
    other.set_texels("xyz");
    return std::vector<BlobPtr>{blobOf(pb::BLOB_KIND_MESH, api::meshBytes(*reference::quad())),
                                blobOf(pb::BLOB_KIND_MESH, api::meshBytes(*reference::pyramid())),
                                blobOf(pb::BLOB_KIND_TEXTURE, texture.SerializeAsString()),
                                blobOf(pb::BLOB_KIND_TEXTURE, other.SerializeAsString())};
  }();
  return all;
}

Limits limitsOfEdits() {
  Limits limits = smallLimits();
  limits.keepUnusedBlobs = std::chrono::minutes(0);
  return limits;
}

bool sameOutcome(const EditOutcome& a, const EditOutcome& b) {
  return a.sequence == b.sequence && a.status.code() == b.status.code() && a.status.message() == b.status.message() &&
         a.revision == b.revision && a.names == b.names && a.skipped == b.skipped;
}

class Run {
 public:
  explicit Run(FuzzedDataProvider& in) : in_(in) {
    LightingSettings options;
    options.grid.longest = 4;
    options.grid.hasBounds = in.ConsumeBool();
    options.grid.bounds = {glm::dvec3(-1.0), glm::dvec3(1.0)};
    session_ = std::make_shared<Session>("room", 1, 1, options, SessionPolicy(), services_);
    session_->journalCreation("");
    for (Member& member : members_) member.identity = *session_->join();
  }

  void steps() {
    for (int i = 0; i < kMostSteps && in_.remaining_bytes() > 0; ++i) {
      const std::uint64_t before = session_->revision();
      step();
      check(session_->revision() >= before, "revisions rise");
      if (in_.ConsumeBool()) mirror_.follow(*session_);
    }
    mirror_.follow(*session_);
    mirror_.compare(*session_);
    compareLog();
  }

 private:
  struct Member {
    ClientIdentity identity;
    std::uint64_t last = 0;  ///< sequence that was sent
    std::map<std::uint64_t, EditOutcome> outcomes;  ///< the first one of each sequence that was not refused as old
  };

  void step() {
    Member* member = pickMember();
    switch (in_.ConsumeIntegralInRange(0, 15)) {
      case 0:
        return upload();
      case 1:
        session_->dropUnusedBlobs();
        return journal_.compact();
      case 2:
        return settings();
      case 3:
        return lock(member);
      case 4:
        return restart();
      case 5:
        return replace(member);
      case 6:
        return undoAndRedo(member);
      case 7:
      case 8:
        return repeatable(member, [&](std::uint64_t sequence) {
          return session_->undoRedo(identityOf(member), sequence, UndoDirection::kUndo);
        });
      case 9:
        return repeatable(member, [&](std::uint64_t sequence) {
          return session_->undoRedo(identityOf(member), sequence, UndoDirection::kRedo);
        });
      default: {
        const Edit made = edit();
        return repeatable(member, [&](std::uint64_t sequence) {
          Edit sent = made;
          sent.sequence = sequence;
          return session_->apply(identityOf(member), sent);
        });
      }
    }
  }

  /// Null is nobody.
  Member* pickMember() {
    const int who = in_.ConsumeIntegralInRange(0, kMembers);
    return who == kMembers ? nullptr : &members_[who];
  }
  static ClientIdentity identityOf(const Member* member) { return member ? member->identity : ClientIdentity(); }

  /// Something with a sequence: new, none, or one that was there before.
  template <typename Make>
  void repeatable(Member* member, const Make& make) {
    const int way = in_.ConsumeIntegralInRange(0, 3);
    const std::uint64_t sequence = !member || way == 0 ? 0
                                   : way == 1          ? in_.ConsumeIntegralInRange(1, 8)
                                                       : ++member->last;
    if (member) member->last = std::max(member->last, sequence);
    const std::uint64_t before = session_->revision();
    const std::string content = scene(*session_);
    const EditOutcome outcome = make(sequence);
    if (member && sequence != 0 && !member->outcomes.contains(sequence)) {
      const std::uint64_t last = member->outcomes.empty() ? 0 : member->outcomes.rbegin()->first;
      const bool old = outcome.status.reason() == Reason::kSequenceOld;
      check(old == (sequence < last), "a sequence that was passed over is refused as old, and no other");
      if (!old) member->outcomes.emplace(sequence, outcome);
    } else if (member && sequence != 0) {
      check(sameOutcome(member->outcomes.at(sequence), outcome), "a sequence is answered as the first time");
      check(session_->revision() == before && scene(*session_) == content, "a repeated sequence changes nothing");
      return;
    }
    if (outcome.status.ok()) {
      check(session_->revision() == before + 1 && outcome.revision == before + 1, "what is accepted is one revision");
    } else {
      checkRefusal(outcome.status);
      check(session_->revision() == before && scene(*session_) == content, "what is refused changes nothing");
    }
  }

  void undoAndRedo(const Member* member) {
    const std::string before = scene(*session_);
    const EditOutcome undone = session_->undoRedo(identityOf(member), 0, UndoDirection::kUndo);
    if (!undone.status.ok()) return;
    if (undone.names.empty()) {
      check(!undone.skipped.empty(), "what takes nothing back says why");
      return check(scene(*session_) == before, "what takes nothing back changes nothing");
    }
    const EditOutcome redone = session_->undoRedo(identityOf(member), 0, UndoDirection::kRedo);
    check(redone.status.ok(), "what was taken back can be made again: " + redone.status.message());
    check(scene(*session_) == before, "undo and redo in turn change nothing");
  }

  void upload() { (void)session_->addBlob(uploads()[in_.PickValueInArray({0U, 1U, 2U, 3U})]); }

  void settings() {
    LightingSettings options = session_->summary().options;
    options.iterations = in_.ConsumeIntegralInRange(-1, 8);
    if (in_.ConsumeBool()) options.grid.longest = in_.ConsumeIntegralInRange(0, 6);
    const std::uint64_t before = session_->revision();
    const Status status = session_->changeSettings([&](const SessionSettings&) {
      return Expected<SessionSettings>(SessionSettings{options, {}});
    });
    if (status.ok()) return;
    checkRefusal(status);
    check(session_->revision() == before, "refused settings change nothing");
  }

  void lock(const Member* member) {
    std::vector<std::string> names;
    for (int i = in_.ConsumeIntegralInRange(0, 2); i > 0; --i) names.push_back(name());
    const Status status =
        session_->lockObjects(identityOf(member), names, std::chrono::seconds(in_.ConsumeIntegralInRange(-1, 61)));
    if (!status.ok()) checkRefusal(status);
  }

  /// A member goes, another comes.
  void replace(Member* member) {
    if (!member) return;
    session_->leave(member->identity);
    *member = {};
    const Expected<ClientIdentity> identity = session_->join();
    check(identity.ok(), "there is room for who comes for one who went");
    member->identity = *identity;
  }

  /// The process ends, another has what was kept.
  void restart() {
    const std::string before = scene(*session_);
    compareLog();
    const Expected<SavedSession> state = journal_.load("room");
    check(state.ok(), "what was kept can be read: " + state.status().message());
    session_ = std::make_shared<Session>(1, 2, *state, services_);
    check(scene(*session_) == before, "a session comes back as it was");
    mirror_ = {};  // another epoch
    compareLog();
  }

  void compareLog() const {
    check(deterministic(api::toSnapshot(session_->state())) == deterministic(journal_.snapshot()),
          "the log says what the session holds");
  }

  std::string name() { return in_.PickValueInArray({"A", "B", "C", "A.001", "", "a/b"}); }
  glm::dvec3 vector() {
    const double x = in_.ConsumeIntegral<std::int8_t>();
    return {x, in_.PickValueInArray({0.0, 1.0, -1.0, 1e300, double(NAN)}), 0.5};
  }
  MeshReference mesh() {
    switch (in_.ConsumeIntegralInRange(0, 3)) {
      case 0:
        return {uploads()[0]->hash, nullptr};
      case 1:
        return {uploads()[1]->hash, nullptr};
      case 2:
        return {uploads()[2]->hash, nullptr};  // a texture
      default: {
        const MeshPtr own = uploads()[in_.ConsumeBool() ? 0 : 1]->mesh;
        return {own->hash, own};
      }
    }
  }
  TransformFields transform() {
    TransformFields fields;
    if (in_.ConsumeBool()) fields.translation = vector();
    if (in_.ConsumeBool()) fields.scale = vector();
    return fields;
  }
  LightFields light() {
    LightFields fields;
    if (in_.ConsumeBool()) fields.mesh = mesh();
    fields.transform = transform();
    if (in_.ConsumeBool()) fields.radiance = vector();
    if (!fields.radiance && in_.ConsumeBool()) fields.power = vector();
    if (in_.ConsumeBool()) fields.texture = in_.ConsumeBool() ? uploads()[2]->hash : std::string();
    if (in_.ConsumeBool()) fields.enabled = in_.ConsumeBool();
    if (in_.ConsumeBool()) fields.group = std::string(1, char('a' + in_.ConsumeIntegralInRange(0, 9)));
    return fields;
  }
  SurfaceFields surface() {
    SurfaceFields fields;
    if (in_.ConsumeBool()) fields.mesh = mesh();
    fields.transform = transform();
    if (in_.ConsumeBool()) fields.roughness = in_.PickValueInArray({0.0, 0.5, 2.0});
    if (in_.ConsumeBool()) fields.albedoTexture = in_.ConsumeBool() ? uploads()[3]->hash : std::string();
    return fields;
  }
  SetVertices vertices() {
    SetVertices out{name(), {}, {}, nullptr, nullptr};
    const std::size_t count = in_.PickValueInArray({0U, 4U, 5U});
    for (std::size_t i = 0; i < count; ++i) out.positions.push_back(vector());
    return out;
  }
  Operation operation() {
    switch (in_.ConsumeIntegralInRange(0, 10)) {
      case 0:
      case 1:
        return CreateLight{name(), light()};
      case 2:
        return CreateSurface{name(), surface()};
      case 3:
        return UpdateLight{name(), light()};
      case 4:
        return UpdateSurface{name(), surface()};
      case 5:
        return DeleteLight{name()};
      case 6:
        return DeleteSurface{name()};
      case 7: {
        Camera camera;
        camera.eye = vector();
        return PutCamera{name(), camera};
      }
      case 8:
        return DeleteCamera{name()};
      case 9:
        return vertices();
      default:
        return FitGrid{};
    }
  }
  Edit edit() {
    Edit out;
    for (int i = in_.ConsumeIntegralInRange(1, 4); i > 0; --i) out.operations.push_back(operation());
    out.undoGroup = in_.PickValueInArray({"", "", "drag", "other"});
    if (in_.ConsumeIntegralInRange(0, 15) == 0) out.expectedRevision = in_.ConsumeIntegralInRange(0, 20);
    return out;
  }

  FuzzedDataProvider& in_;
  FoldedJournal journal_;
  const SessionServices services_{limitsOfEdits(),       &machinery().engine, &machinery().pool, &machinery().timers,
                                  &machinery().counters, api::meshHash,       &journal_};
  std::shared_ptr<Session> session_;
  Member members_[kMembers];
  Mirror mirror_;
};

}  // namespace
}  // namespace lpv::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider in(data, size);
  lpv::fuzz::Run(in).steps();
  return 0;
}
