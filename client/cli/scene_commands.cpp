// scene load | list

#include <memory>

#include "command.h"
#include "grid_growth.h"
#include "import/scene_file.h"
#include "lpv/convert.h"
#include "membership.h"
#include "output.h"
#include "question.h"
#include "scene_flags.h"
#include "scene_upload.h"

namespace lpv::cli {
namespace {

std::string jsonNames(const std::vector<std::string>& names, const char* kind) {
  std::vector<std::string> items;
  for (const std::string& name : names) items.push_back(JsonObject().text("name", name).text("kind", kind).str());
  return jsonArray(items);
}

void printMade(const Context& context, const ImportedScene& scene, const UploadedScene& made) {
  if (context.json()) {
    print(JsonObject()
              .number("revision", double(made.revision))
              .raw("lights", jsonNames(made.lights, "light"))
              .raw("surfaces", jsonNames(made.surfaces, "surface"))
              .raw("cameras", jsonNames(made.cameras, "camera"))
              .str());
    return;
  }
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < made.lights.size() && i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    rows.push_back({"light", made.lights[i], std::to_string(light.mesh->triangles.size()) + " triangles",
                    "radiance " + shortText(light.radiance.x) + "," + shortText(light.radiance.y) + "," +
                        shortText(light.radiance.z) + (light.twoSided ? " two-sided" : "") +
                        (light.texture ? " textured" : "")});
  }
  for (std::size_t i = 0; i < made.surfaces.size() && i < scene.surfaces.size(); ++i) {
    const Surface& surface = scene.surfaces[i];
    rows.push_back({"surface", made.surfaces[i], std::to_string(surface.mesh->triangles.size()) + " triangles",
                    surface.albedoTexture ? "textured" : ""});
  }
  for (const std::string& name : made.cameras) rows.push_back({"camera", name, "", ""});
  printTable(rows);
}

struct LoadOptions {
  std::string id;
  std::string file;
  bool replace = false;
  bool add = false;
  ImportOptions import;
};

/// Says, or asks on a terminal, what is to be done about an earlier load of the same objects. Returns what shall be
/// removed.
Expected<EarlierLoad> decideOn(const EarlierLoad& earlier, const Context& context, const LoadOptions& options) {
  if (options.replace) return earlier;
  if (options.add || earlier.same == 0) return EarlierLoad();
  const std::string there = "the session has objects of " + options.file + " already: " + std::to_string(earlier.same);
  if (context.json() || !canAsk()) {
    warn(there +
         ", which are there twice now; --replace replaces them, lpvctl undo takes this load back, --add says "
         "that it is meant");
    return EarlierLoad();
  }
  const std::string answer = ask(there + ". Replace them, add them again, or cancel? [r/a/C]");
  if (answer == "r" || answer == "replace") return earlier;
  if (answer == "a" || answer == "add") return EarlierLoad();
  return localError("", "cancelled; nothing was loaded");
}

Status loadScene(Context& context, const LoadOptions& options) {
  const Expected<ImportedScene> scene = asLocal(importScene(options.file, options.import));
  if (!scene) return scene.status();
  for (const std::string& warning : scene->warnings) warn(warning);
  for (const std::string& assumed : scene->assumed) note(assumed);
  Expected<client::Client> client = context.connect();
  if (!client) return client.status();
  const SceneUpload upload(*scene);
  const Expected<EarlierLoad> earlier = upload.earlier(*client, options.id);
  if (!earlier) return earlier.status();
  const Expected<EarlierLoad> replaced = decideOn(*earlier, context, options);
  if (!replaced) return replaced.status();
  const Expected<GridGrowth> growth = GridGrowth::since(*client, options.id);
  if (!growth) return growth.status();
  Status status = asMember(*client, options.id, [&](client::Editor& editor) -> Status {
    const Expected<UploadedScene> made = upload.run(editor, *replaced);
    if (!made) return made.status();
    for (const std::string& warning : made->warnings) warn(warning);
    if (made->lights.empty())
      warn("the file has no emissive material and adds no light; add one with lpvctl light add");
    printMade(context, *scene, *made);
    return {};
  });
  if (status.ok() && growth->isLarge()) {
    growth->warn("the content of " + options.file, boundsOf(*scene), glm::dvec3(options.import.scale));
  }
  return status;
}

void addSceneLoad(CLI::App& group, Commands& commands) {
  auto given = std::make_shared<LoadOptions>();
  CLI::App& app = commands.add(group, "load", "Add the lights, surfaces and cameras of a scene file",
                               [given](Context& context) { return loadScene(context, *given); });
  addSession(app, given->id);
  app.add_option("file", given->file, "Scene file: glb, gltf, obj, ply or stl")->required()->type_name("FILE");
  auto* replace =
      app.add_flag("--replace", given->replace,
                   "Remove the session's lights and surfaces of the same names first, as a part of the same "
                   "undo step (default: asked on a terminal where the file was loaded before)");
  app.add_flag("--add", given->add, "Add the objects once more where the file was loaded before, without being asked")
      ->excludes(replace);
  addImportFlags(app, given->import);
}

std::string objectJson(const char* kind, const google::protobuf::Message& object) {
  return JsonObject().raw(kind, toJson(object)).str();
}

Status listScene(Context& context, const std::string& id) {
  Expected<client::Client> client = context.connect();
  if (!client) return client.status();
  const auto lights = client->lights(id);
  if (!lights) return lights.status();
  const auto surfaces = client->surfaces(id);
  if (!surfaces) return surfaces.status();
  const auto cameras = client->cameras(id);
  if (!cameras) return cameras.status();
  if (context.json()) {
    for (const v1::Light& light : lights->items) print(objectJson("light", light));
    for (const v1::Surface& surface : surfaces->items) print(objectJson("surface", surface));
    for (const v1::Camera& camera : cameras->items) print(objectJson("camera", camera));
    return {};
  }
  std::vector<std::vector<std::string>> rows;
  for (const v1::Light& light : lights->items) {
    rows.push_back({"light", light.name(), std::to_string(light.status().triangle_count()) + " triangles"});
  }
  for (const v1::Surface& surface : surfaces->items) {
    rows.push_back({"surface", surface.name(), std::to_string(surface.triangle_count()) + " triangles"});
  }
  for (const v1::Camera& camera : cameras->items) rows.push_back({"camera", camera.name()});
  printTable(rows);
  return {};
}

void addSceneList(CLI::App& group, Commands& commands) {
  auto id = std::make_shared<std::string>();
  CLI::App& app = commands.add(group, "list", "List the lights, surfaces and cameras",
                               [id](Context& context) { return listScene(context, *id); });
  addSession(app, *id);
}

}  // namespace

void addSceneCommands(CLI::App& app, Commands& commands) {
  CLI::App& group = Commands::group(app, "scene", "Scene files: load, list");
  addSceneLoad(group, commands);
  addSceneList(group, commands);
}

}  // namespace lpv::cli
