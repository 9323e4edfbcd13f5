#include "scene_upload.h"

#include <algorithm>
#include <map>
#include <utility>

#include "lpv/blobs.h"
#include "lpv/convert.h"
#include "lpv/editor.h"
#include "lpv/edits.h"
#include "progress.h"

namespace lpv::cli {

/// The blobs of all meshes and textures; each is serialised once.
class SceneBlobs {
 public:
  explicit SceneBlobs(const ImportedScene& scene) {
    for (const Light& light : scene.lights) {
      add(light.mesh);
      add(light.texture);
    }
    for (const Surface& surface : scene.surfaces) {
      add(surface.mesh);
      for (const TexturePtr& texture : texturesOf(surface)) add(texture);
    }
  }

  std::string hashOf(const void* content) const {
    const auto found = blobs_.find(content);
    return found == blobs_.end() ? std::string() : found->second.hash;
  }

  std::vector<const client::Blob*> all() const {
    std::vector<const client::Blob*> out;
    for (const auto& entry : blobs_) out.push_back(&entry.second);
    return out;
  }

 private:
  template <typename Pointer>
  void add(const Pointer& content) {
    if (content && !blobs_.contains(content.get())) blobs_.emplace(content.get(), client::blobOf(*content));
  }

  std::map<const void*, client::Blob> blobs_;
};

namespace {

constexpr int kMaxOperations = 1000;
constexpr std::size_t kMaxEditBytes = 900000;  // a message may have 1 MiB

v1::Operation operationFor(const Light& light, const SceneBlobs& blobs) {
  v1::Light out;
  out.set_name(light.name);
  if (light.mesh) out.set_mesh(blobs.hashOf(light.mesh.get()));
  out.set_distant(light.distant);
  *out.mutable_transform() = client::toProto(light.transform);
  *out.mutable_radiance() = client::toProto(light.radiance);
  out.set_texture(blobs.hashOf(light.texture.get()));
  out.set_two_sided(light.twoSided);
  return client::createLight(std::move(out));
}

v1::Operation operationFor(const Surface& surface, const SceneBlobs& blobs) {
  v1::Surface out;
  out.set_name(surface.name);
  out.set_mesh(blobs.hashOf(surface.mesh.get()));
  *out.mutable_transform() = client::toProto(surface.transform);
  *out.mutable_albedo() = client::toProto(surface.albedo);
  out.set_albedo_texture(blobs.hashOf(surface.albedoTexture.get()));
  if (surface.normalTexture) {
    out.set_normal_texture(blobs.hashOf(surface.normalTexture.get()));
    out.set_normal_scale(surface.normalScale);
  }
  out.set_roughness(surface.roughness);
  out.set_metalness(surface.metalness);
  out.set_gloss_texture(blobs.hashOf(surface.glossTexture.get()));
  out.set_two_sided(surface.twoSided);
  if (surface.alphaMode != AlphaMode::kOpaque) {
    out.set_alpha_mode(v1::AlphaMode(surface.alphaMode));
    out.set_alpha_cutoff(surface.alphaCutoff);
    out.set_opacity(surface.opacity);
    *out.mutable_transmission() = client::toProto(surface.transmission);
  }
  return client::createSurface(std::move(out));
}

std::vector<v1::Edit> editsFor(const ImportedScene& scene, const SceneBlobs& blobs, const EarlierLoad& replaced,
                               bool fits) {
  std::vector<v1::Operation> operations;
  for (const std::string& name : replaced.lights) operations.push_back(client::deleteLight(name));
  for (const std::string& name : replaced.surfaces) operations.push_back(client::deleteSurface(name));
  for (const Light& light : scene.lights) operations.push_back(operationFor(light, blobs));
  for (const Surface& surface : scene.surfaces) operations.push_back(operationFor(surface, blobs));
  for (const auto& [name, camera] : scene.cameras) operations.push_back(client::putCamera(name, camera));
  if (fits) operations.push_back(client::fitGrid());

  std::vector<v1::Edit> edits(1);
  std::size_t bytes = 0;
  for (v1::Operation& operation : operations) {
    const std::size_t size = operation.ByteSizeLong() + 8;
    if (edits.back().operations_size() == kMaxOperations || bytes + size > kMaxEditBytes) {
      edits.emplace_back();
      bytes = 0;
    }
    bytes += size;
    *edits.back().add_operations() = std::move(operation);
  }
  return edits;
}

/// Adds the names that the session gave to the objects of an accepted edit.
void collect(const v1::Edit& edit, const v1::EditAck& ack, UploadedScene& made) {
  made.revision = ack.revision();
  for (int i = 0; i < edit.operations_size() && i < ack.names_size(); ++i) {
    const v1::Operation& operation = edit.operations(i);
    if (operation.has_create_light()) made.lights.push_back(ack.names(i));
    if (operation.has_create_surface()) made.surfaces.push_back(ack.names(i));
    if (operation.has_put_camera()) made.cameras.push_back(ack.names(i));
  }
}

void removeCreated(client::Editor& editor, const UploadedScene& made, const std::string& step) {
  std::vector<v1::Operation> operations;
  for (const std::string& name : made.lights) operations.push_back(client::deleteLight(name));
  for (const std::string& name : made.surfaces) operations.push_back(client::deleteSurface(name));
  for (const std::string& name : made.cameras) operations.push_back(client::deleteCamera(name));
  for (std::size_t at = 0; at < operations.size(); at += kMaxOperations) {
    const std::size_t end = std::min(operations.size(), at + kMaxOperations);
    const auto first = operations.begin() + std::ptrdiff_t(at);
    v1::Edit edit = client::editOf({first, operations.begin() + std::ptrdiff_t(end)});
    edit.set_undo_group(step);
    (void)editor.apply(std::move(edit));
  }
}

/// Takes back what the edits before a refused one did: as the member's newest step, or, for nobody's edits, by deleting
/// what they created.
void takeBack(client::Editor& editor, const UploadedScene& made, const std::string& step) {
  if (editor.identity().client_id().empty()) return removeCreated(editor, made, step);
  (void)editor.undo();
}

/// Applies the edits as one undo step.
Expected<UploadedScene> applyAll(client::Editor& editor, std::vector<v1::Edit> edits) {
  const std::string step = "load " + std::to_string(editor.sequence());
  UploadedScene made;
  for (v1::Edit& edit : edits) {
    edit.set_undo_group(step);
    const Expected<v1::EditAck> ack = editor.apply(edit);
    if (!ack) {
      if (made.revision != 0) takeBack(editor, made, step);
      return ack.status();
    }
    collect(edit, *ack, made);
  }
  return made;
}

/// Whether `name` is `wanted`, or what the session makes of it where that is taken: "Lamp.001".
bool isNamedAfter(const std::string& name, const std::string& wanted) {
  if (name.rfind(wanted, 0) != 0) return false;
  const std::string suffix = name.substr(wanted.size());
  return suffix.empty() ||
         (suffix.size() > 3 && suffix[0] == '.' && suffix.find_first_not_of("0123456789", 1) == std::string::npos);
}

/// Adds those of the session's objects that have the name of one of the scene's: the name itself, or one with a number
/// where the mesh is the same too.
template <typename Object, typename Imported>
void findEarlier(const std::vector<Object>& objects, const std::vector<Imported>& imported, const SceneBlobs& blobs,
                 std::vector<std::string>& names, std::size_t& same) {
  for (const Object& object : objects) {
    bool named = false, sameMesh = false;
    for (const Imported& each : imported) {
      if (!isNamedAfter(object.name(), each.name)) continue;
      const bool equal = blobs.hashOf(each.mesh.get()) == object.mesh();
      named = named || equal || object.name() == each.name;
      sameMesh = sameMesh || equal;
    }
    if (named) names.push_back(object.name());
    if (sameMesh) ++same;
  }
}

/// How an object lies to a box.
enum class Place { kInside, kPartly, kOutside };

template <typename Object>
Place placeOf(const Object& object, const Grid& grid) {
  const Bounds box = object.mesh->bounds.transformed(object.transform.worldFromObject());
  const glm::dvec3 lower = grid.gridFromWorld(box.min), upper = grid.gridFromWorld(box.max), dims(grid.dims);
  constexpr double kSlack = 1e-6;  // cells
  if (glm::any(glm::greaterThan(lower, dims)) || glm::any(glm::lessThan(upper, glm::dvec3(0.0))))
    return Place::kOutside;
  const bool inside =
      glm::all(glm::greaterThanEqual(lower, glm::dvec3(-kSlack))) && glm::all(glm::lessThanEqual(upper, dims + kSlack));
  return inside ? Place::kInside : Place::kPartly;
}

/// What of a scene a grid of fixed bounds leaves out, in words.
std::vector<std::string> leftOut(const ImportedScene& scene, const v1::Session& session) {
  std::vector<std::string> out;
  const Grid grid = client::fromProto(session.grid());
  const bool propagates = session.settings().transport() == v1::TRANSPORT_PROPAGATE;
  for (const Light& light : scene.lights) {
    const Place place = light.distant ? Place::kOutside : placeOf(light, grid);
    if (place == Place::kInside || !propagates) continue;
    out.push_back(
        "light '" + light.name + "' lies " + (place == Place::kOutside ? "" : "partly ") +
        "outside the grid's bounds: transport PROPAGATE takes no light from there; use GATHER, or other bounds");
  }
  std::size_t surfaces = 0;
  for (const Surface& surface : scene.surfaces) surfaces += placeOf(surface, grid) == Place::kInside ? 0 : 1;
  if (surfaces == 0) return out;
  const std::string some = std::to_string(surfaces) + " of " + std::to_string(scene.surfaces.size()) +
                           " surfaces reach beyond the grid's bounds; there ";
  out.push_back(some + (propagates ? "they stay dark" : "they look at the lights themselves, which takes longer"));
  return out;
}

}  // namespace

SceneUpload::SceneUpload(const ImportedScene& scene) : scene_(scene), blobs_(std::make_unique<SceneBlobs>(scene)) {}
SceneUpload::~SceneUpload() = default;

Expected<EarlierLoad> SceneUpload::earlier(client::Client& client, const std::string& session) const {
  EarlierLoad out;
  const auto lights = client.lights(session);
  if (!lights) return lights.status();
  const auto surfaces = client.surfaces(session);
  if (!surfaces) return surfaces.status();
  findEarlier(lights->items, scene_.lights, *blobs_, out.lights, out.same);
  findEarlier(surfaces->items, scene_.surfaces, *blobs_, out.surfaces, out.same);
  return out;
}

Expected<UploadedScene> SceneUpload::run(client::Editor& editor, const EarlierLoad& replaced) const {
  client::Client client = editor.client();
  {
    ProgressBar bar("uploading");
    const Status sent = client::uploadMissing(client, editor.session(), blobs_->all(),
                                              [&](auto done, auto total) { bar.show(done, total); });
    if (!sent.ok()) return sent;
  }
  const Expected<v1::Session> session = client.session(editor.session());
  if (!session) return session.status();
  const bool fixed = session->settings().grid().has_bounds();
  Expected<UploadedScene> made = applyAll(editor, editsFor(scene_, *blobs_, replaced, !fixed));
  if (made && fixed) made->warnings = leftOut(scene_, *session);
  return made;
}

}  // namespace lpv::cli
