// light add | move | set | remove | list

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

struct LightFlags {
  std::string id;
  std::string name;
  std::string mesh;
  std::string texture;
  std::string directions;
  std::optional<glm::dvec3> radiance;
  std::optional<glm::dvec3> power;
  std::optional<std::string> group;
  std::optional<bool> enabled;
  std::optional<bool> twoSided;
  TransformFlags transform;
  ImportOptions import;

  void addTo(CLI::App& app) {
    auto* radiant = addColour(app, "--radiance", radiance, "W/(sr m^2), linear Rec.709 (1,1,1)");
    addColour(app, "--power", power, "W per colour over the whole light, instead")->excludes(radiant);
    app.add_option("--texture", texture, "Image that multiplies the radiance")->type_name("IMG|none");
    app.add_option("--directions", directions, "Emission directions, x,y,z per vertex and line")->type_name("FILE");
    app.add_option("--group", group, "Light group: a volume layer of its own")->type_name("G");
    transform.addTo(app);
    addUpFlag(app, import);
  }
};

ObjectKind lightKind() {
  ObjectKind kind;
  kind.word = "light";
  kind.list = [](client::Client& client, const std::string& session) -> Expected<client::Listing<ObjectKind::Placed>> {
    const auto lights = client.lights(session);
    if (!lights) return lights.status();
    client::Listing<ObjectKind::Placed> out{{}, lights->revision};
    for (const v1::Light& l : lights->items) out.items.push_back({l.name(), client::fromProto(l.transform())});
    return out;
  };
  kind.move = client::moveLight;
  kind.remove = client::deleteLight;
  return kind;
}

/// Uploads the files given and names them in the light.
Status writeFiles(const LightFlags& flags, client::Client& client, v1::Light& light, std::vector<std::string>& paths) {
  if (!flags.mesh.empty()) {
    const auto hash = uploadMeshFile(client, flags.id, flags.mesh, flags.import, flags.directions);
    if (!hash) return hash.status();
    light.set_mesh(*hash);
    paths.emplace_back("mesh");
  }
  if (!flags.texture.empty()) {
    const auto hash = uploadImageFile(client, flags.id, flags.texture);
    if (!hash) return hash.status();
    light.set_texture(*hash);
    paths.emplace_back("texture");
  }
  return {};
}

/// Writes what was given; uploads files. Returns the paths written.
Expected<std::vector<std::string>> writeLight(const LightFlags& flags, client::Client& client, v1::Light& light) {
  std::vector<std::string> paths;
  if (Status status = writeFiles(flags, client, light, paths); !status.ok()) return status;
  if (flags.radiance) {
    *light.mutable_radiance() = client::toProto(*flags.radiance);
    paths.emplace_back("radiance");
  }
  if (flags.power) {
    *light.mutable_power() = client::toProto(*flags.power);
    paths.emplace_back("power");
  }
  if (flags.twoSided) {
    light.set_two_sided(*flags.twoSided);
    paths.emplace_back("two_sided");
  }
  if (flags.enabled) {
    light.set_enabled(*flags.enabled);
    paths.emplace_back("enabled");
  }
  if (flags.group) {
    light.set_group(*flags.group);
    paths.emplace_back("group");
  }
  return paths;
}

void addAdd(CLI::App& group, Commands& commands) {
  auto given = std::make_shared<LightFlags>();
  CLI::App& app =
      commands.add(group, "add", "Makes a mesh file a light and prints its name", [given](Context& context) {
        Expected<client::Client> client = context.connect();
        if (!client) return client.status();
        v1::Operation operation = client::moveLight("", given->transform.move());
        v1::Light light = operation.update_light().light();  // with the given parts of the transform
        const std::string stem = std::filesystem::path(given->mesh).stem().string();
        light.set_name(given->name.empty() ? objectName("", "", stem) : given->name);
        const auto written = writeLight(*given, *client, light);
        if (!written) return written.status();
        return applyAndPrint(context, *client, given->id, client::editOf({client::createLight(light)}), true);
      });
  addSession(app, given->id);
  app.add_option("mesh", given->mesh, "glb, gltf, obj, ply or stl")->required()->type_name("MESHFILE");
  app.add_option("--name", given->name, "Name (the file's)")->type_name("NAME");
  app.add_flag_callback(
      "--two-sided", [given] { given->twoSided = true; }, "Emits from both sides");
  given->addTo(app);
}

void addSet(CLI::App& group, Commands& commands) {
  auto given = std::make_shared<LightFlags>();
  CLI::App& app =
      commands.add(group, "set", "Changes what is given, nothing else", [given](Context& context) -> Status {
        Expected<client::Client> client = context.connect();
        if (!client) return client.status();
        v1::Operation operation = client::moveLight(given->name, given->transform.move());
        v1::UpdateLight& update = *operation.mutable_update_light();
        const auto paths = writeLight(*given, *client, *update.mutable_light());
        if (!paths) return paths.status();
        for (const std::string& path : *paths) update.mutable_update_mask()->add_paths(path);
        return applyAndPrint(context, *client, given->id, client::editOf({operation}), false);
      });
  addSession(app, given->id);
  app.add_option("name", given->name, "Name of the light")->required()->type_name("NAME");
  app.add_option("--mesh", given->mesh, "Another mesh")->type_name("MESHFILE");
  addSwitch(app, "--enabled", given->enabled, "Whether it shines");
  addSwitch(app, "--two-sided", given->twoSided, "Whether it emits from both sides");
  given->addTo(app);
  requireSomeFlag(app);
}

std::vector<std::string> lightRow(const v1::Light& light) {
  const glm::dvec3 at = client::fromProto(light.transform().translation());
  const glm::dvec3 c = client::fromProto(light.has_power() ? light.power() : light.radiance());
  const auto triple = [](const glm::dvec3& v) { return shortText(v.x) + "," + shortText(v.y) + "," + shortText(v.z); };
  return {light.name(),
          std::to_string(light.status().triangle_count()) + " triangles",
          (light.has_power() ? "power " : "radiance ") + triple(c),
          "at " + triple(at),
          std::string(light.two_sided() ? "two-sided" : "one-sided"),
          light.has_enabled() && !light.enabled() ? "off" : "on",
          light.group()};
}

void addList(CLI::App& group, Commands& commands) {
  auto id = std::make_shared<std::string>();
  CLI::App& app = commands.add(group, "list", "Lists the lights", [id](Context& context) {
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    const auto lights = client->lights(*id);
    if (!lights) return lights.status();
    std::vector<std::vector<std::string>> rows;
    for (const v1::Light& light : lights->items) {
      if (context.json()) print(toJson(light));
      rows.push_back(lightRow(light));
    }
    if (!context.json()) printTable(rows);
    return Status();
  });
  addSession(app, *id);
}

}  // namespace

void addLightCommands(CLI::App& app, Commands& commands) {
  CLI::App& group = Commands::group(app, "light", "Lights: add, move, set, remove, list");
  const ObjectKind kind = lightKind();
  addAdd(group, commands);
  addMove(group, commands, kind);
  addSet(group, commands);
  addRemove(group, commands, kind);
  addList(group, commands);
}

}  // namespace lpv::cli
