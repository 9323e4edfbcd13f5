#include "persistence/snapshot.h"

#include <set>

#include "convert/blob_content.h"
#include "convert/geometry.h"
#include "convert/scene.h"
#include "convert/session.h"
#include "store/fold.h"

namespace lpv::api {
namespace {

static_assert(store::kKeptTombstones == kMaxTombstones && store::kKeptOutcomes == kRememberedOutcomes);
static_assert(store::kKeptNameBytes == kRememberedNameBytes && store::kBytesPerName == kRememberedBytesPerName);

pb::BlobKind kindOf(const Blob& blob) {
  return blob.kind == BlobKind::kMesh ? pb::BLOB_KIND_MESH : pb::BLOB_KIND_TEXTURE;
}

void writeSettings(const LightingSettings& options, const SessionPolicy& policy, pb::SessionSettings* out) {
  toProto(options, out);
  out->mutable_ttl()->set_seconds(policy.ttl.count());
  out->set_display_name(policy.displayName);
}

void writeDeleted(const Deleted& in, kept::Tombstone* out) {
  out->set_kind(in.kind == ObjectKind::kLight     ? kept::Tombstone::KIND_LIGHT
                : in.kind == ObjectKind::kSurface ? kept::Tombstone::KIND_SURFACE
                                                  : kept::Tombstone::KIND_CAMERA);
  out->set_name(in.name);
  out->set_revision(in.revision);
}

void writeOutcome(const EditOutcome& in, pb::EditAck* out) {
  out->set_sequence(in.sequence);
  if (!in.status.ok()) toProto(in.status, out->mutable_status());
  out->set_revision(in.revision);
  for (const std::string& name : in.names) out->add_names(name);
  for (const std::string& field : in.skipped) out->add_skipped_fields(field);
}

/// Meshes that came in no upload: with an edit, or deformed by one.
void addMesh(const MeshPtr& mesh, const store::HasContent& holds, std::set<BlobHash>& added, store::LogRecord* out) {
  if (added.contains(mesh->hash) || holds(mesh->hash)) return;
  added.insert(mesh->hash);
  out->contents.push_back({mesh->hash, pb::BLOB_KIND_MESH,
                           mesh->source ? mesh->source : std::make_shared<const std::string>(meshBytes(*mesh))});
}

void addChanges(const Changes& changes, kept::Record* out) {
  for (const Versioned<Light>& light : changes.lights) toProto(light, out->add_lights());
  for (const Versioned<Surface>& surface : changes.surfaces) toProto(surface, out->add_surfaces());
  for (const auto& [name, camera] : changes.cameras) toProto(name, camera, out->add_cameras());
  for (const Deleted& deleted : changes.deleted) writeDeleted(deleted, out->add_deleted());
  if (changes.grid) toProto(*changes.grid, out->mutable_grid());
  out->set_settings_are_revision(changes.options.has_value());
}

}  // namespace

store::LogRecord toStep(const JournalStep& step, const store::HasContent& holds) {
  store::LogRecord out;
  kept::Record& record = out.record;
  record.set_revision(step.changes.revision);
  addChanges(step.changes, &record);
  if (step.settings) writeSettings(step.settings->options, step.settings->policy, record.mutable_settings());
  record.set_client_id(step.client);
  if (step.outcome) writeOutcome(*step.outcome, record.mutable_outcome());
  if (step.joined) {
    record.set_joined_id(step.joined->id);
    record.set_joined_secret_hash(step.joined->secretHash);
  }
  record.set_left_id(step.left);
  if (step.upload) {
    (*record.mutable_uploads())[step.upload->hash] = kindOf(*step.upload);
    out.contents.push_back({step.upload->hash, kindOf(*step.upload), step.upload->bytes});
  }
  for (const BlobHash& hash : step.dropped) record.add_dropped(hash);
  std::set<BlobHash> added;
  for (const Versioned<Light>& light : step.changes.lights) addMesh(light.object->mesh, holds, added, &out);
  for (const Versioned<Surface>& surface : step.changes.surfaces) addMesh(surface.object->mesh, holds, added, &out);
  return out;
}

kept::Snapshot toSnapshot(const SavedSession& state) {
  const DocumentState& document = state.document;
  kept::Snapshot out;
  out.set_revision(document.revision);
  writeSettings(document.options, state.policy, out.mutable_settings());
  out.set_settings_revision(document.optionsRevision);
  toProto(document.grid, out.mutable_grid());
  out.set_grid_revision(document.gridRevision);
  for (const auto& light : document.lights) toProto(light, &(*out.mutable_lights())[light.object->name]);
  for (const auto& surface : document.surfaces) toProto(surface, &(*out.mutable_surfaces())[surface.object->name]);
  for (const DocumentState::Camera& camera : document.cameras) {
    kept::Camera& entry = (*out.mutable_cameras())[camera.name];
    toProto(camera.name, camera.camera, entry.mutable_camera());
    entry.set_revision(camera.revision);
  }
  for (const Deleted& deleted : document.tombstones) writeDeleted(deleted, out.add_tombstones());
  out.set_tombstone_horizon(document.tombstoneHorizon);
  for (const ClientState& client : state.clients) {
    kept::Client& entry = (*out.mutable_clients())[client.id];
    entry.set_secret_hash(client.secretHash);
    for (const EditOutcome& outcome : client.outcomes) writeOutcome(outcome, entry.add_outcomes());
    entry.set_outcome_horizon(client.outcomeHorizon);
    entry.set_accepted_sequence(client.acceptedSequence);
    entry.set_accepted_revision(client.acceptedRevision);
  }
  for (const BlobPtr& blob : state.uploads) (*out.mutable_uploads())[blob->hash] = kindOf(*blob);
  return out;
}

std::vector<store::Content> contentsOf(const SavedSession& state) {
  store::LogRecord out;
  std::set<BlobHash> added;
  for (const BlobPtr& blob : state.uploads) {
    if (added.insert(blob->hash).second) out.contents.push_back({blob->hash, kindOf(*blob), blob->bytes});
  }
  const auto none = [](const std::string&) { return false; };
  for (const auto& light : state.document.lights) addMesh(light.object->mesh, none, added, &out);
  for (const auto& surface : state.document.surfaces) addMesh(surface.object->mesh, none, added, &out);
  return std::move(out.contents);
}

}  // namespace lpv::api
