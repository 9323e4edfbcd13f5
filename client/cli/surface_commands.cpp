// surface add | move | set | remove | list

#include <filesystem>
#include <memory>
#include <utility>

#include "import/names.h"
#include "lpv/convert.h"
#include "object_commands.h"
#include "output.h"
#include "values.h"

namespace lpv::cli {
namespace {

struct SurfaceFlags {
  std::string id;
  std::string name;
  std::string mesh;
  std::string texture;
  std::optional<glm::dvec3> albedo;
  std::optional<double> roughness;
  std::optional<double> metalness;
  std::optional<bool> oneSided;
  TransformFlags transform;
  ImportOptions import;

  void addTo(CLI::App& app) {
    addColour(app, "--albedo", albedo, "Linear reflectance, 0..1 (0.8)");
    app.add_option("--texture", texture, "Image that multiplies the albedo")->type_name("IMG|none");
    app.add_option("--roughness", roughness, "0..1 (1)")->type_name("R");
    app.add_option("--metalness", metalness, "0..1 (0)")->type_name("M");
    addSwitch(app, "--one-sided", oneSided, "Whether only its front is seen and lit");
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

/// Writes what was given; uploads files. Returns the paths written.
Expected<std::vector<std::string>> writeSurface(const SurfaceFlags& flags, client::Client& client,
                                                v1::Surface& surface) {
  std::vector<std::string> paths;
  if (!flags.mesh.empty()) {
    const auto hash = uploadMeshFile(client, flags.id, flags.mesh, flags.import, {});
    if (!hash) return hash.status();
    surface.set_mesh(*hash);
    paths.emplace_back("mesh");
  }
  if (!flags.texture.empty()) {
    const auto hash = uploadImageFile(client, flags.id, flags.texture);
    if (!hash) return hash.status();
    surface.set_albedo_texture(*hash);
    paths.emplace_back("albedo_texture");
  }
  if (flags.albedo) {
    *surface.mutable_albedo() = client::toProto(*flags.albedo);
    paths.emplace_back("albedo");
  }
  if (flags.roughness) {
    surface.set_roughness(*flags.roughness);
    paths.emplace_back("roughness");
  }
  if (flags.metalness) {
    surface.set_metalness(*flags.metalness);
    paths.emplace_back("metalness");
  }
  if (flags.oneSided) {
    surface.set_one_sided(*flags.oneSided);
    paths.emplace_back("one_sided");
  }
  return paths;
}

void addAdd(CLI::App& group, Commands& commands) {
  auto given = std::make_shared<SurfaceFlags>();
  CLI::App& app = commands.add(group, "add", "Makes a mesh file a surface and prints its name", [given](Context& c) {
    Expected<client::Client> client = c.connect();
    if (!client) return client.status();
    v1::Operation operation = client::moveSurface("", given->transform.move());
    v1::Surface surface = operation.update_surface().surface();  // with the given parts of the transform
    const std::string stem = std::filesystem::path(given->mesh).stem().string();
    surface.set_name(given->name.empty() ? objectName("", "", stem) : given->name);
    const auto written = writeSurface(*given, *client, surface);
    if (!written) return written.status();
    return applyAndPrint(c, *client, given->id, client::editOf({client::createSurface(surface)}), true);
  });
  addSession(app, given->id);
  app.add_option("mesh", given->mesh, "glb, gltf, obj, ply or stl")->required()->type_name("MESHFILE");
  app.add_option("--name", given->name, "Name (the file's)")->type_name("NAME");
  given->addTo(app);
}

void addSet(CLI::App& group, Commands& commands) {
  auto given = std::make_shared<SurfaceFlags>();
  CLI::App& app =
      commands.add(group, "set", "Changes what is given, nothing else", [given](Context& context) -> Status {
        Expected<client::Client> client = context.connect();
        if (!client) return client.status();
        v1::Operation operation = client::moveSurface(given->name, given->transform.move());
        v1::UpdateSurface& update = *operation.mutable_update_surface();
        const auto paths = writeSurface(*given, *client, *update.mutable_surface());
        if (!paths) return paths.status();
        for (const std::string& path : *paths) update.mutable_update_mask()->add_paths(path);
        return applyAndPrint(context, *client, given->id, client::editOf({operation}), false);
      });
  addSession(app, given->id);
  app.add_option("name", given->name, "Name of the surface")->required()->type_name("NAME");
  app.add_option("--mesh", given->mesh, "Another mesh")->type_name("MESHFILE");
  given->addTo(app);
  requireSomeFlag(app);
}

void addList(CLI::App& group, Commands& commands) {
  auto id = std::make_shared<std::string>();
  CLI::App& app = commands.add(group, "list", "Lists the surfaces", [id](Context& context) {
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    const auto surfaces = client->surfaces(*id);
    if (!surfaces) return surfaces.status();
    std::vector<std::vector<std::string>> rows;
    for (const v1::Surface& surface : surfaces->items) {
      if (context.json()) print(toJson(surface));
      rows.push_back({surface.name(), std::to_string(surface.triangle_count()) + " triangles",
                      "albedo " + shortText(surface.albedo().x()) + "," + shortText(surface.albedo().y()) + "," +
                          shortText(surface.albedo().z()),
                      surface.albedo_texture().empty() ? "" : "textured"});
    }
    if (!context.json()) printTable(rows);
    return Status();
  });
  addSession(app, *id);
}

}  // namespace

void addSurfaceCommands(CLI::App& app, Commands& commands) {
  CLI::App& group = Commands::group(app, "surface", "Surfaces: add, move, set, remove, list");
  const ObjectKind kind = surfaceKind();
  addAdd(group, commands);
  addMove(group, commands, kind);
  addSet(group, commands);
  addRemove(group, commands, kind);
  addList(group, commands);
}

}  // namespace lpv::cli
