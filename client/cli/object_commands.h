#pragma once
// What lights and surfaces have in common on the command line.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "lpv/edits.h"
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

/// Reads a mesh file and uploads it; with a file of directions, one per vertex in the file's order.
Expected<std::string> uploadMeshFile(client::Client& client, const std::string& session, const std::string& path,
                                     const ImportOptions& options, const std::string& directionsPath);

/// Reads an image and uploads it; "none" gives "", which takes a texture away.
Expected<std::string> uploadImageFile(client::Client& client, const std::string& session, const std::string& path);

}  // namespace lpv::cli
