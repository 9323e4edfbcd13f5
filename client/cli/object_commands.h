#pragma once
// What the commands for lights and for surfaces share.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "lpv/edits.h"
#include "output.h"
#include "scene_flags.h"

namespace lpv::cli {

/// How one kind of object is listed, moved and removed.
struct ObjectKind {
  std::string word;  ///< "light"
  /// Lists names and transforms with the revision they were read at.
  struct Placed {
    std::string name;
    Transform transform;
  };
  std::function<Expected<client::Listing<Placed>>(client::Client&, const std::string& session)> list;
  std::function<v1::Operation(const std::string& name, const client::Move& move)> move;
  std::function<v1::Operation(const std::string& name)> remove;
};

/// Applies one edit. Prints the acknowledgement with --json, else the first object's name if `printName`.
Expected<v1::EditAck> applyAndPrint(Context& context, client::Client& client, const std::string& session,
                                    const v1::Edit& edit, bool printName);

/// Declares the commands `move` and `remove`.
void addMove(CLI::App& group, Commands& commands, const ObjectKind& kind);
void addRemove(CLI::App& group, Commands& commands, const ObjectKind& kind);

/// Writes the given fields into a message and collects their paths for the update mask.
class MaskBuilder {
 public:
  template <typename T, typename Write>
  void set(const char* path, const std::optional<T>& value, Write write) {
    if (!value) return;
    write(*value);
    paths_.emplace_back(path);
  }
  const std::vector<std::string>& paths() const { return paths_; }

 private:
  std::vector<std::string> paths_;
};

/// Flags that lights and surfaces share.
struct ObjectFlags {
  std::string id;  ///< of the session
  std::string name;
  std::string mesh;
  std::string texture;
  bool textureAlpha = false;  ///< the texture keeps its alpha
  std::string normalMap;      ///< of surfaces
  std::string glossMap;       ///< of surfaces
  std::optional<bool> castsShadow;
  std::optional<bool> visibleToCamera;
  TransformFlags transform;
  ImportOptions import;

  void addVisibilityTo(CLI::App& app);
  /// Writes what was given of castsShadow and visibleToCamera.
  template <typename Object>
  void writeVisibility(MaskBuilder& fields, Object& object) const {
    fields.set("casts_shadow", castsShadow, [&](bool on) { object.set_casts_shadow(on); });
    fields.set("visible_to_camera", visibleToCamera, [&](bool on) { object.set_visible_to_camera(on); });
  }
};

using MakeOperation = std::function<Expected<v1::Operation>(client::Client&)>;

/// Declare the commands `add` and `set` with the flags that both kinds share; the caller adds the flags of its kind.
/// `operation` uploads the files that were given and returns the operation.
CLI::App& declareAdd(CLI::App& group, Commands& commands, const ObjectKind& kind,
                     const std::shared_ptr<ObjectFlags>& flags, MakeOperation operation);
CLI::App& declareSet(CLI::App& group, Commands& commands, const ObjectKind& kind,
                     const std::shared_ptr<ObjectFlags>& flags, MakeOperation operation);

/// The name for a new object: the one given, else the file's.
std::string nameFor(const ObjectFlags& flags);

/// Hashes of the uploaded files. "" for a picture "none", which removes the object's texture.
struct UploadedFiles {
  std::optional<std::string> mesh;
  std::optional<std::string> texture;
  std::optional<std::string> normalMap;
  std::optional<std::string> glossMap;
};
/// Uploads the files that were given. `directions`: file of emission directions, one per vertex in the mesh file's
/// order; "": none.
Expected<UploadedFiles> uploadFiles(client::Client& client, const ObjectFlags& flags,
                                    const std::string& directions = {});

/// Declares the command `list`. `list` requests the objects, `row` formats one as a line of the table.
template <typename List, typename Row>
void addList(CLI::App& group, Commands& commands, const ObjectKind& kind, List list, Row row) {
  auto id = std::make_shared<std::string>();
  CLI::App& app =
      commands.add(group, "list", "List the " + kind.word + "s", [id, list, row](Context& context) -> Status {
        Expected<client::Client> client = context.connect();
        if (!client) return client.status();
        const auto listing = list(*client, *id);
        if (!listing) return listing.status();
        std::vector<std::vector<std::string>> rows;
        for (const auto& object : listing->items) {
          if (context.json()) print(toJson(object));
          rows.push_back(row(object));
        }
        if (!context.json()) printTable(rows);
        return {};
      });
  addSession(app, *id);
}

}  // namespace lpv::cli
