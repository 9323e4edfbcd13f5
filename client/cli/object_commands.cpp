#include "object_commands.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "grid_growth.h"
#include "import/image.h"
#include "import/names.h"
#include "lpv/blobs.h"
#include "membership.h"
#include "output.h"
#include "progress.h"
#include "values.h"

namespace lpv::cli {
namespace {

/// Attempts of a relative move: each is repeated if another member moved the object in between.
constexpr int kRelativeAttempts = 20;

Expected<std::vector<glm::vec3>> readDirections(const std::string& path) {
  std::ifstream file(path);
  if (!file) return localError("directions", path + ": the file cannot be opened");
  std::vector<glm::vec3> out;
  std::size_t number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    std::replace(line.begin(), line.end(), ',', ' ');
    if (line.find_first_not_of(" \t\r") == std::string::npos || line[0] == '#') continue;
    std::istringstream words(line);
    glm::vec3 d(0.0F);
    std::string rest;
    if (!(words >> d.x >> d.y >> d.z) || words >> rest) {
      return localError("directions", path + ": line " + std::to_string(number) + " must be three numbers x,y,z");
    }
    out.push_back(d);
  }
  return out;
}

/// Reads a mesh file and uploads the mesh.
Expected<std::string> uploadMeshFile(client::Client& client, const std::string& session, const std::string& path,
                                     const ImportOptions& options, const std::string& directionsPath) {
  ImportOptions as = options;
  as.keepVertices = !directionsPath.empty();
  Expected<Mesh> mesh = asLocal(importMesh(path, as));
  if (!mesh) return mesh.status();
  if (!directionsPath.empty()) {
    Expected<std::vector<glm::vec3>> directions = readDirections(directionsPath);
    if (!directions) return directions.status();
    if (directions->size() != mesh->positions.size()) {
      return localError("directions", directionsPath + " has " + std::to_string(directions->size()) + " directions, " +
                                          path + " has " + std::to_string(mesh->positions.size()) + " vertices");
    }
    mesh->directions = std::move(*directions);
  }
  ProgressBar bar("uploading");
  return client::upload(client, session, *mesh, [&](auto done, auto total) { bar.show(done, total); });
}

/// Reads an image and uploads the texture; "none" gives "".
Expected<std::string> uploadImageFile(client::Client& client, const std::string& session, const std::string& path,
                                      ImageUse use) {
  if (path == "none") return std::string();
  const Expected<Texture> texture = asLocal(readImage(path, use));
  if (!texture) return texture.status();
  ProgressBar bar("uploading");
  return client::upload(client, session, *texture, [&](auto done, auto total) { bar.show(done, total); });
}

Status moveRelative(Context& context, client::Client& client, const ObjectKind& kind, const std::string& session,
                    const std::string& name, const TransformFlags& flags) {
  Status status;
  for (int attempt = 0; attempt < kRelativeAttempts; ++attempt) {
    const auto listing = kind.list(client, session);
    if (!listing) return listing.status();
    const auto object = std::find_if(listing->items.begin(), listing->items.end(),
                                     [&](const ObjectKind::Placed& placed) { return placed.name == name; });
    if (object == listing->items.end()) {
      return Status(
          Code::kNotFound,
          "the session has no " + kind.word + " '" + name + "'; lpvctl " + kind.word + " list shows the names", "name");
    }
    v1::Edit edit = client::editOf({kind.move(name, flags.relativeTo(object->transform))});
    edit.set_expected_revision(listing->revision);
    status = applyAndPrint(context, client, session, edit, false).status();
    if (status.code() != Code::kAborted) return status;
  }
  return status;
}

/// World bounds, metres, of the mesh file as the flags place it.
Bounds placedBounds(const ObjectFlags& flags) {
  const Expected<Mesh> mesh = importMesh(flags.mesh, flags.import);
  return mesh ? mesh->bounds.transformed(flags.transform.placed().worldFromObject()) : Bounds();
}

Action adding(const std::shared_ptr<ObjectFlags>& flags, const std::string& word, MakeOperation operation) {
  return [flags, word, operation = std::move(operation)](Context& context) -> Status {
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    const Expected<v1::Operation> made = operation(*client);
    if (!made) return made.status();
    const Expected<GridGrowth> growth = GridGrowth::since(*client, flags->id);
    if (!growth) return growth.status();
    const Expected<v1::EditAck> ack = applyAndPrint(context, *client, flags->id, client::editOf({*made}), true);
    if (!ack) return ack.status();
    if (growth->isLarge() && ack->names_size() > 0) {
      growth->warn(word + " '" + ack->names(0) + "'", placedBounds(*flags), flags->transform.scale);
    }
    return {};
  };
}

Action setting(const std::shared_ptr<ObjectFlags>& flags, MakeOperation operation) {
  return [flags, operation = std::move(operation)](Context& context) -> Status {
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    const Expected<v1::Operation> made = operation(*client);
    if (!made) return made.status();
    return applyAndPrint(context, *client, flags->id, client::editOf({*made}), false).status();
  };
}

}  // namespace

Expected<v1::EditAck> applyAndPrint(Context& context, client::Client& client, const std::string& session,
                                    const v1::Edit& edit, bool printName) {
  v1::EditAck made;
  Status status = asMember(client, session, [&](client::Editor& editor) -> Status {
    const Expected<v1::EditAck> ack = editor.apply(edit);
    if (!ack) return ack.status();
    made = *ack;
    if (context.json()) {
      print(toJson(*ack));
    } else if (printName && ack->names_size() > 0) {
      print(ack->names(0));
    }
    return {};
  });
  if (!status.ok()) return status;
  return made;
}

void addMove(CLI::App& group, Commands& commands, const ObjectKind& kind) {
  struct Options {
    std::string id;
    std::string name;
    TransformFlags transform;
    bool relative = false;
  };
  auto given = std::make_shared<Options>();
  CLI::App& app =
      commands.add(group, "move", "Move, turn or scale a " + kind.word + "; other parts keep their values",
                   [given, kind](Context& context) -> Status {
                     Expected<client::Client> client = context.connect();
                     if (!client) return client.status();
                     if (given->relative)
                       return moveRelative(context, *client, kind, given->id, given->name, given->transform);
                     const v1::Edit edit = client::editOf({kind.move(given->name, given->transform.move())});
                     return applyAndPrint(context, *client, given->id, edit, false).status();
                   });
  addSession(app, given->id);
  app.add_option("name", given->name, "Name of the " + kind.word)->required()->type_name("NAME");
  given->transform.addTo(app);
  app.add_flag("--relative", given->relative,
               "Relative move: add the translation, turn about the world's axes, multiply the scale");
  app.parse_complete_callback([given] {
    if (!given->transform.any()) throw CLI::ValidationError("move", "needs --translate, --rotate or --scale");
  });
}

void addRemove(CLI::App& group, Commands& commands, const ObjectKind& kind) {
  struct Options {
    std::string id;
    std::vector<std::string> names;
  };
  auto given = std::make_shared<Options>();
  CLI::App& app = commands.add(group, "remove", "Remove a " + kind.word, [given, kind](Context& context) {
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    std::vector<v1::Operation> operations;
    for (const std::string& name : given->names) operations.push_back(kind.remove(name));
    return applyAndPrint(context, *client, given->id, client::editOf(std::move(operations)), false).status();
  });
  addSession(app, given->id);
  app.add_option("names", given->names, "Names of the " + kind.word + "s; all are removed, or none if one is refused")
      ->required()
      ->type_name("NAME");
}

void ObjectFlags::addVisibilityTo(CLI::App& app) {
  addSwitch(app, "--casts-shadow", castsShadow, "Stand in the way of light (default of add: on)");
  addSwitch(app, "--visible", visibleToCamera,
            "Show the object in frames; it does the rest unseen (default of add: on)");
}

CLI::App& declareAdd(CLI::App& group, Commands& commands, const ObjectKind& kind,
                     const std::shared_ptr<ObjectFlags>& flags, MakeOperation operation) {
  CLI::App& app = commands.add(group, "add", "Add a mesh file as a " + kind.word + " and print its name",
                               adding(flags, kind.word, std::move(operation)));
  addSession(app, flags->id);
  app.add_option("mesh", flags->mesh, "Mesh file: glb, gltf, obj, ply or stl")->required()->type_name("MESHFILE");
  app.add_option("--name", flags->name, "Name (default: the file's name)")->type_name("NAME");
  return app;
}

CLI::App& declareSet(CLI::App& group, Commands& commands, const ObjectKind& kind,
                     const std::shared_ptr<ObjectFlags>& flags, MakeOperation operation) {
  CLI::App& app =
      commands.add(group, "set", "Change the given properties of a " + kind.word, setting(flags, std::move(operation)));
  addSession(app, flags->id);
  app.add_option("name", flags->name, "Name of the " + kind.word)->required()->type_name("NAME");
  app.add_option("--mesh", flags->mesh, "New mesh")->type_name("MESHFILE");
  return app;
}

std::string nameFor(const ObjectFlags& flags) {
  if (!flags.name.empty()) return flags.name;
  return objectName("", "", std::filesystem::path(flags.mesh).stem().string());
}

Expected<UploadedFiles> uploadFiles(client::Client& client, const ObjectFlags& flags, const std::string& directions) {
  UploadedFiles out;
  if (!flags.mesh.empty()) {
    const auto hash = uploadMeshFile(client, flags.id, flags.mesh, flags.import, directions);
    if (!hash) return hash.status();
    out.mesh = *hash;
  }
  if (!flags.texture.empty()) {
    const auto hash = uploadImageFile(client, flags.id, flags.texture,
                                      flags.textureAlpha ? ImageUse::kColourWithAlpha : ImageUse::kColour);
    if (!hash) return hash.status();
    out.texture = *hash;
  }
  if (!flags.normalMap.empty()) {
    const auto hash = uploadImageFile(client, flags.id, flags.normalMap, ImageUse::kNumbers);
    if (!hash) return hash.status();
    out.normalMap = *hash;
  }
  if (!flags.glossMap.empty()) {
    const auto hash = uploadImageFile(client, flags.id, flags.glossMap, ImageUse::kNumbers);
    if (!hash) return hash.status();
    out.glossMap = *hash;
  }
  return out;
}

}  // namespace lpv::cli
