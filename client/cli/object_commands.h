#pragma once
// What lights and surfaces have in common on the command line.

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

/// How to find and change one kind of object.
struct ObjectKind {
  std::string word;  ///< "light"
  /// Transforms by name, at a revision.
  struct Placed {
    std::string name;
    Transform transform;
  };
  std::function<Expected<client::Listing<Placed>>(client::Client&, const std::string& session)> list;
  std::function<v1::Operation(const std::string& name, const client::Move& move)> move;
  std::function<v1::Operation(const std::string& name)> remove;
};

/// One edit; the acknowledgement is printed with --json, else its first name where `printName`.
Status applyAndPrint(Context& context, client::Client& client, const std::string& session, const v1::Edit& edit,
                     bool printName);

/// `move` and `remove`.
void addMove(CLI::App& group, Commands& commands, const ObjectKind& kind);
void addRemove(CLI::App& group, Commands& commands, const ObjectKind& kind);

/// Flags that lights and surfaces share.
struct ObjectFlags {
  std::string id;  ///< of the session
  std::string name;
  std::string mesh;
  std::string texture;
  TransformFlags transform;
  ImportOptions import;
};

using MakeOperation = std::function<Expected<v1::Operation>(client::Client&)>;

/// `add` and `set`, with the flags that make them; the caller adds those of its kind. `operation` uploads what is given
/// and says what to do.
CLI::App& declareAdd(CLI::App& group, Commands& commands, const ObjectKind& kind,
                     const std::shared_ptr<ObjectFlags>& flags, MakeOperation operation);
CLI::App& declareSet(CLI::App& group, Commands& commands, const ObjectKind& kind,
                     const std::shared_ptr<ObjectFlags>& flags, MakeOperation operation);

/// The name given to a new object, else its file's.
std::string nameFor(const ObjectFlags& flags);

/// Hashes of the files that were given, on the server now. "" for the texture "none", which takes a texture away.
struct UploadedFiles {
  std::optional<std::string> mesh;
  std::optional<std::string> texture;
};
/// `directions`: a file of emission directions, one per vertex in the mesh file's order; may be empty.
Expected<UploadedFiles> uploadFiles(client::Client& client, const ObjectFlags& flags,
                                    const std::string& directions = {});

/// Writes what is given into a message and keeps the paths, for an update's mask.
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

/// `list`: `list` asks for the objects, `row` makes a line of a table of one.
template <typename List, typename Row>
void addList(CLI::App& group, Commands& commands, const ObjectKind& kind, List list, Row row) {
  auto id = std::make_shared<std::string>();
  CLI::App& app =
      commands.add(group, "list", "Lists the " + kind.word + "s", [id, list, row](Context& context) -> Status {
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
