#include "store/fold.h"

#include <algorithm>

namespace lpv::store {
namespace {

template <typename Repeated>
void dropFirst(Repeated* entries, std::size_t allowed, const auto& dropping) {
  const int over = entries->size() - int(allowed);
  if (over <= 0) return;
  for (int i = 0; i < over; ++i) dropping((*entries)[i]);
  entries->DeleteSubrange(0, over);
}

void remove(const pb::Tombstone& deleted, pb::Snapshot* snapshot) {
  if (deleted.kind() == pb::Tombstone::KIND_LIGHT) snapshot->mutable_lights()->erase(deleted.name());
  if (deleted.kind() == pb::Tombstone::KIND_SURFACE) snapshot->mutable_surfaces()->erase(deleted.name());
  if (deleted.kind() == pb::Tombstone::KIND_CAMERA) snapshot->mutable_cameras()->erase(deleted.name());
  *snapshot->add_tombstones() = deleted;
}

/// Deletions before creations: a name deleted and given again in one edit is there afterwards.
void foldObjects(const pb::Record& record, pb::Snapshot* snapshot) {
  for (const pb::Tombstone& deleted : record.deleted()) remove(deleted, snapshot);
  for (const lpv::v1::Light& light : record.lights()) (*snapshot->mutable_lights())[light.name()] = light;
  for (const lpv::v1::Surface& surface : record.surfaces()) (*snapshot->mutable_surfaces())[surface.name()] = surface;
  for (const lpv::v1::Camera& camera : record.cameras()) {
    pb::Camera& kept = (*snapshot->mutable_cameras())[camera.name()];
    *kept.mutable_camera() = camera;
    kept.set_revision(record.revision());
  }
  dropFirst(snapshot->mutable_tombstones(), kKeptTombstones, [snapshot](const pb::Tombstone& dropped) {
    snapshot->set_tombstone_horizon(std::max(snapshot->tombstone_horizon(), std::uint64_t(dropped.revision())));
  });
}

void foldSettings(const pb::Record& record, pb::Snapshot* snapshot) {
  if (record.has_settings()) {
    *snapshot->mutable_settings() = record.settings();
    if (record.settings_are_revision()) snapshot->set_settings_revision(record.revision());
  }
  if (record.has_grid()) {
    *snapshot->mutable_grid() = record.grid();
    snapshot->set_grid_revision(record.revision());
  }
}

std::size_t nameBytes(const lpv::v1::EditAck& outcome) {
  std::size_t sum = 0;
  for (const auto* names : {&outcome.names(), &outcome.skipped_fields()}) {
    for (const std::string& name : *names) sum += name.size() + kBytesPerName;
  }
  return sum;
}

/// How many of the newest may be kept.
std::size_t outcomesWithin(const pb::Client& client) {
  std::size_t count = 0, bytes = 0;
  for (int i = client.outcomes_size() - 1; i >= 0 && count < kKeptOutcomes; --i, ++count) {
    bytes += nameBytes(client.outcomes(i));
    if (count > 0 && bytes > kKeptNameBytes) break;
  }
  return count;
}

void foldOutcome(const pb::Record& record, pb::Snapshot* snapshot) {
  const auto found = snapshot->mutable_clients()->find(record.client_id());
  if (found == snapshot->mutable_clients()->end()) return;
  pb::Client& client = found->second;
  const lpv::v1::EditAck& outcome = record.outcome();
  if (outcome.status().code() == 0) {
    client.set_accepted_sequence(std::max(client.accepted_sequence(), outcome.sequence()));
    client.set_accepted_revision(outcome.revision());
  }
  if (outcome.sequence() == 0) return;
  *client.add_outcomes() = outcome;
  dropFirst(client.mutable_outcomes(), outcomesWithin(client), [&client](const lpv::v1::EditAck& dropped) {
    client.set_outcome_horizon(std::max(client.outcome_horizon(), std::uint64_t(dropped.sequence())));
  });
}

}  // namespace

Status fold(const pb::Record& record, pb::Snapshot* snapshot) {
  if (record.revision() != snapshot->revision() && record.revision() != snapshot->revision() + 1) {
    return {Code::kDataLoss, "the log goes from revision " + std::to_string(snapshot->revision()) + " to " +
                                 std::to_string(record.revision()) + ": steps are missing"};
  }
  snapshot->set_revision(record.revision());
  foldObjects(record, snapshot);
  foldSettings(record, snapshot);
  if (!record.joined_id().empty()) {
    (*snapshot->mutable_clients())[record.joined_id()].set_secret_hash(record.joined_secret_hash());
  }
  if (!record.left_id().empty()) snapshot->mutable_clients()->erase(record.left_id());
  if (record.has_outcome()) foldOutcome(record, snapshot);
  for (const auto& [hash, kind] : record.uploads()) (*snapshot->mutable_uploads())[hash] = kind;
  for (const std::string& hash : record.dropped()) snapshot->mutable_uploads()->erase(hash);
  return {};
}

std::map<std::string, lpv::v1::BlobKind> contentsOf(const pb::Snapshot& snapshot) {
  std::map<std::string, lpv::v1::BlobKind> out;
  for (const auto& [name, light] : snapshot.lights()) {
    out[light.mesh()] = lpv::v1::BLOB_KIND_MESH;
    if (!light.texture().empty()) out[light.texture()] = lpv::v1::BLOB_KIND_TEXTURE;
  }
  for (const auto& [name, surface] : snapshot.surfaces()) {
    out[surface.mesh()] = lpv::v1::BLOB_KIND_MESH;
    for (const std::string& hash : {surface.albedo_texture(), surface.normal_texture(), surface.gloss_texture()})
      if (!hash.empty()) out[hash] = lpv::v1::BLOB_KIND_TEXTURE;
  }
  for (const auto& [hash, kind] : snapshot.uploads()) out[hash] = static_cast<lpv::v1::BlobKind>(kind);
  return out;
}

}  // namespace lpv::store
