// light add | sky | move | set | remove | list

#include <memory>
#include <string>
#include <vector>

#include "lpv/convert.h"
#include "object_commands.h"
#include "output.h"
#include "values.h"

namespace lpv::cli {
namespace {

struct LightFlags : ObjectFlags {
  std::string directions;
  std::optional<glm::dvec3> radiance;
  std::optional<glm::dvec3> power;
  std::optional<std::string> group;
  std::optional<bool> enabled;
  std::optional<bool> twoSided;
  std::optional<bool> distant;

  void addTo(CLI::App& app) {
    auto* radiant =
        addColour(app, "--radiance", radiance, "Radiance, W/(sr m^2), linear Rec.709 (default of add: 1,1,1)");
    addColour(app, "--power", power, "Power of the whole light, W per colour, instead of radiance")->excludes(radiant);
    app.add_option("--texture", texture, "Image that multiplies the radiance (default of add: none)")
        ->type_name("IMG|none");
    app.add_option("--directions", directions,
                   "Emission directions, one line x,y,z per vertex (default: the mesh's normals)")
        ->type_name("FILE");
    app.add_option("--group", group,
                   "Light group; each group has its own volume layer (default of add: the unnamed group)")
        ->type_name("G");
    addSwitch(app, "--distant", distant,
              "Shine from so far away that the directions are the same everywhere: the mesh is what is seen from the "
              "middle of the scene, in the unit of the distance (default of add: off)");
    addVisibilityTo(app);
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

/// Uploads the files that were given, writes the given fields into `light` and returns their paths.
Expected<std::vector<std::string>> writeLight(const LightFlags& flags, client::Client& client, v1::Light& light) {
  const Expected<UploadedFiles> files = uploadFiles(client, flags, flags.directions);
  if (!files) return files.status();
  MaskBuilder fields;
  fields.set("mesh", files->mesh, [&](const std::string& hash) { light.set_mesh(hash); });
  fields.set("texture", files->texture, [&](const std::string& hash) { light.set_texture(hash); });
  fields.set("radiance", flags.radiance, [&](const auto& v) { *light.mutable_radiance() = client::toProto(v); });
  fields.set("power", flags.power, [&](const auto& v) { *light.mutable_power() = client::toProto(v); });
  fields.set("two_sided", flags.twoSided, [&](bool on) { light.set_two_sided(on); });
  fields.set("enabled", flags.enabled, [&](bool on) { light.set_enabled(on); });
  fields.set("distant", flags.distant, [&](bool on) { light.set_distant(on); });
  fields.set("group", flags.group, [&](const std::string& group) { light.set_group(group); });
  flags.writeVisibility(fields, light);
  return fields.paths();
}

Expected<v1::Operation> newLight(const LightFlags& flags, client::Client& client) {
  const v1::Operation moved = client::moveLight("", flags.transform.move());
  v1::Light light = moved.update_light().light();  // has the parts of the transform that were given
  light.set_name(nameFor(flags));
  const auto written = writeLight(flags, client, light);
  if (!written) return written.status();
  return client::createLight(light);
}

Expected<v1::Operation> changedLight(const LightFlags& flags, client::Client& client) {
  v1::Operation operation = client::moveLight(flags.name, flags.transform.move());
  v1::UpdateLight& update = *operation.mutable_update_light();
  const auto paths = writeLight(flags, client, *update.mutable_light());
  if (!paths) return paths.status();
  for (const std::string& path : *paths) update.mutable_update_mask()->add_paths(path);
  return operation;
}

/// All of the sky: the server has the mesh.
Status addSky(Context& context, const LightFlags& flags) {
  Expected<client::Client> client = context.connect();
  if (!client) return client.status();
  const Expected<v1::Operation> made = newLight(flags, *client);
  if (!made) return made.status();
  return applyAndPrint(context, *client, flags.id, client::editOf({*made}), true).status();
}

void addLightSky(CLI::App& group, Commands& commands) {
  auto given = std::make_shared<LightFlags>();
  given->name = "sky";
  given->distant = true;
  CLI::App& app = commands.add(group, "sky", "Light the scene by a picture of the sky, or evenly, and print the name",
                               [given](Context& context) { return addSky(context, *given); });
  addSession(app, given->id);
  app.add_option("picture", given->texture,
                 "Equirectangular image: hdr, exr or any other; its middle is towards +x (default: none, even light)")
      ->type_name("IMG");
  app.add_option("--name", given->name, "Name (default: sky)")->type_name("NAME");
  addColour(app, "--radiance", given->radiance,
            "Radiance, W/(sr m^2), linear Rec.709; multiplies the picture (default: 1,1,1)");
  addVec3(app, "--rotate", given->transform.rotate, "Rotation, degrees: intrinsic X, then Y, then Z");
  app.add_option("--group", given->group,
                 "Light group; each group has its own volume layer (default: the unnamed group)")
      ->type_name("G");
  addSwitch(app, "--visible", given->visibleToCamera, "Show the sky in frames (default: on)");
}

void addLightAdd(CLI::App& group, Commands& commands, const ObjectKind& kind) {
  auto given = std::make_shared<LightFlags>();
  CLI::App& app =
      declareAdd(group, commands, kind, given, [given](client::Client& client) { return newLight(*given, client); });
  app.add_flag_callback(
      "--two-sided", [given] { given->twoSided = true; }, "Emit from both sides (default: the front only)");
  given->addTo(app);
}

void addLightSet(CLI::App& group, Commands& commands, const ObjectKind& kind) {
  auto given = std::make_shared<LightFlags>();
  CLI::App& app = declareSet(group, commands, kind, given,
                             [given](client::Client& client) { return changedLight(*given, client); });
  addSwitch(app, "--enabled", given->enabled, "Switch the light on or off");
  addSwitch(app, "--two-sided", given->twoSided, "Emit from both sides or from the front only");
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
          light.distant() ? "distant" : "at " + triple(at),
          std::string(light.two_sided() ? "two-sided" : "one-sided"),
          light.has_enabled() && !light.enabled() ? "off" : "on",
          light.group().empty() ? "" : "group " + light.group()};
}

}  // namespace

void addLightCommands(CLI::App& app, Commands& commands) {
  CLI::App& group = Commands::group(app, "light", "Lights: add, sky, move, set, remove, list");
  const ObjectKind kind = lightKind();
  addLightAdd(group, commands, kind);
  addLightSky(group, commands);
  addMove(group, commands, kind);
  addLightSet(group, commands, kind);
  addRemove(group, commands, kind);
  addList(
      group, commands, kind, [](client::Client& client, const std::string& session) { return client.lights(session); },
      lightRow);
}

}  // namespace lpv::cli
