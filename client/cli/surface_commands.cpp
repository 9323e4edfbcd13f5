// surface add | move | set | remove | list

#include <memory>
#include <string>
#include <vector>

#include "lpv/convert.h"
#include "object_commands.h"
#include "output.h"
#include "values.h"

namespace lpv::cli {
namespace {

struct SurfaceFlags : ObjectFlags {
  SurfaceFlags() { textureAlpha = true; }

  std::optional<glm::dvec3> albedo;
  std::optional<double> normalScale;
  std::optional<double> roughness;
  std::optional<double> metalness;
  std::optional<bool> oneSided;
  std::optional<v1::AlphaMode> alpha;
  std::optional<double> cutoff;
  std::optional<double> opacity;
  std::optional<glm::dvec3> transmission;

  void addTo(CLI::App& app) {
    addColour(app, "--albedo", albedo, "Linear reflectance, 0..1 (default of add: 0.8)");
    app.add_option("--texture", texture, "Image that multiplies the albedo (default of add: none)")
        ->type_name("IMG|none");
    app.add_option(
           "--normal-map", normalMap,
           "Picture of tangent-space normals as glTF has them, that bends the normals of frames; none removes it")
        ->type_name("IMG|none");
    app.add_option("--normal-scale", normalScale, "How much it bends, 0..16 (default of add: 1)")->type_name("S");
    app.add_option("--roughness", roughness, "Roughness, 0..1 (default of add: 1)")->type_name("R");
    app.add_option("--metalness", metalness, "Metalness, 0..1 (default of add: 0)")->type_name("M");
    app.add_option("--gloss-map", glossMap,
                   "Picture whose green multiplies the roughness and whose blue the metalness, as glTF has it; none "
                   "removes it")
        ->type_name("IMG|none");
    addSwitch(app, "--one-sided", oneSided, "Show and light the front only (default of add: off)");
    addChoice<v1::AlphaMode>(
        app, "--alpha", alpha,
        {{"opaque", v1::ALPHA_MODE_OPAQUE}, {"mask", v1::ALPHA_MODE_MASK}, {"blend", v1::ALPHA_MODE_BLEND}},
        "How alpha, opacity times the texture's, is read: not at all, as a mask that cuts out, or as the share that "
        "covers (default of add: blend with --opacity or --transmission, else opaque)");
    app.add_option("--alpha-cutoff", cutoff, "Lowest alpha that a mask covers, 0..1 (default of add: 0.5)")
        ->type_name("A");
    app.add_option("--opacity", opacity,
                   "Opacity, 0..1 (default of add: 1); (1 - alpha) x transmission of light passes, unrefracted")
        ->type_name("O");
    addColour(app, "--transmission", transmission, "Colour of light that passes, 0..1 (default of add: 1)");
    addVisibilityTo(app);
    transform.addTo(app);
    addUpFlag(app, import);
  }
};

ObjectKind surfaceKind() {
  ObjectKind kind;
  kind.word = "surface";
  kind.list = [](client::Client& client, const std::string& session) -> Expected<client::Listing<ObjectKind::Placed>> {
    const auto surfaces = client.surfaces(session);
    if (!surfaces) return surfaces.status();
    client::Listing<ObjectKind::Placed> out{{}, surfaces->revision};
    for (const v1::Surface& s : surfaces->items) out.items.push_back({s.name(), client::fromProto(s.transform())});
    return out;
  };
  kind.move = client::moveSurface;
  kind.remove = client::deleteSurface;
  return kind;
}

/// Uploads the files that were given, writes the given fields into `surface` and returns their paths.
Expected<std::vector<std::string>> writeSurface(const SurfaceFlags& flags, client::Client& client,
                                                v1::Surface& surface) {
  const Expected<UploadedFiles> files = uploadFiles(client, flags);
  if (!files) return files.status();
  MaskBuilder fields;
  fields.set("mesh", files->mesh, [&](const std::string& hash) { surface.set_mesh(hash); });
  fields.set("albedo_texture", files->texture, [&](const std::string& hash) { surface.set_albedo_texture(hash); });
  fields.set("normal_texture", files->normalMap, [&](const std::string& hash) { surface.set_normal_texture(hash); });
  fields.set("gloss_texture", files->glossMap, [&](const std::string& hash) { surface.set_gloss_texture(hash); });
  fields.set("normal_scale", flags.normalScale, [&](double v) { surface.set_normal_scale(v); });
  fields.set("albedo", flags.albedo, [&](const auto& v) { *surface.mutable_albedo() = client::toProto(v); });
  fields.set("roughness", flags.roughness, [&](double v) { surface.set_roughness(v); });
  fields.set("metalness", flags.metalness, [&](double v) { surface.set_metalness(v); });
  fields.set("two_sided", flags.oneSided, [&](bool on) { surface.set_two_sided(!on); });
  fields.set("alpha_mode", flags.alpha, [&](v1::AlphaMode mode) { surface.set_alpha_mode(mode); });
  fields.set("alpha_cutoff", flags.cutoff, [&](double v) { surface.set_alpha_cutoff(v); });
  fields.set("opacity", flags.opacity, [&](double v) { surface.set_opacity(v); });
  fields.set("transmission", flags.transmission,
             [&](const auto& v) { *surface.mutable_transmission() = client::toProto(v); });
  flags.writeVisibility(fields, surface);
  return fields.paths();
}

Expected<v1::Operation> newSurface(const SurfaceFlags& flags, client::Client& client) {
  const v1::Operation moved = client::moveSurface("", flags.transform.move());
  v1::Surface surface = moved.update_surface().surface();  // has the parts of the transform that were given
  surface.set_name(nameFor(flags));
  if (flags.opacity || flags.transmission) surface.set_alpha_mode(v1::ALPHA_MODE_BLEND);
  const auto written = writeSurface(flags, client, surface);
  if (!written) return written.status();
  return client::createSurface(surface);
}

Expected<v1::Operation> changedSurface(const SurfaceFlags& flags, client::Client& client) {
  v1::Operation operation = client::moveSurface(flags.name, flags.transform.move());
  v1::UpdateSurface& update = *operation.mutable_update_surface();
  const auto paths = writeSurface(flags, client, *update.mutable_surface());
  if (!paths) return paths.status();
  for (const std::string& path : *paths) update.mutable_update_mask()->add_paths(path);
  return operation;
}

void addSurfaceAdd(CLI::App& group, Commands& commands, const ObjectKind& kind) {
  auto given = std::make_shared<SurfaceFlags>();
  CLI::App& app =
      declareAdd(group, commands, kind, given, [given](client::Client& client) { return newSurface(*given, client); });
  given->addTo(app);
}

void addSurfaceSet(CLI::App& group, Commands& commands, const ObjectKind& kind) {
  auto given = std::make_shared<SurfaceFlags>();
  CLI::App& app = declareSet(group, commands, kind, given,
                             [given](client::Client& client) { return changedSurface(*given, client); });
  given->addTo(app);
  requireSomeFlag(app);
}

std::vector<std::string> surfaceRow(const v1::Surface& surface) {
  const v1::Vec3& albedo = surface.albedo();
  return {surface.name(), std::to_string(surface.triangle_count()) + " triangles",
          "albedo " + shortText(albedo.x()) + "," + shortText(albedo.y()) + "," + shortText(albedo.z()),
          surface.albedo_texture().empty() ? "" : "textured",
          surface.alpha_mode() == v1::ALPHA_MODE_MASK    ? "mask from " + shortText(surface.alpha_cutoff())
          : surface.alpha_mode() == v1::ALPHA_MODE_BLEND ? "opacity " + shortText(surface.opacity())
                                                         : ""};
}

}  // namespace

void addSurfaceCommands(CLI::App& app, Commands& commands) {
  CLI::App& group = Commands::group(app, "surface", "Surfaces: add, move, set, remove, list");
  const ObjectKind kind = surfaceKind();
  addSurfaceAdd(group, commands, kind);
  addMove(group, commands, kind);
  addSurfaceSet(group, commands, kind);
  addRemove(group, commands, kind);
  addList(
      group, commands, kind,
      [](client::Client& client, const std::string& session) { return client.surfaces(session); }, surfaceRow);
}

}  // namespace lpv::cli
