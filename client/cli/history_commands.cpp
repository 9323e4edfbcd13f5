// undo | redo | pick

#include <memory>

#include "command.h"
#include "lpv/convert.h"
#include "lpv/editor.h"
#include "membership.h"
#include "output.h"
#include "scene_flags.h"
#include "values.h"

namespace lpv::cli {
namespace {

/// `call` is Editor::undo or Editor::redo.
template <typename Response>
void addStep(CLI::App& parent, Commands& commands, const std::string& name, const std::string& about,
             Expected<Response> (client::Editor::*call)()) {
  auto id = std::make_shared<std::string>();
  CLI::App& app = commands.add(parent, name, about, [id, call](Context& context) {
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    return asMember(*client, *id, [&](client::Editor& editor) -> Status {
      const Expected<Response> done = (editor.*call)();
      if (!done) return done.status();
      if (context.json()) print(toJson(*done));
      for (const std::string& field : done->skipped_fields()) {
        if (!context.json()) print("kept, because another member has changed it since: " + field);
      }
      return {};
    });
  });
  addSession(app, *id);
}

/// Finds the session's camera `name`. NOT_FOUND if it has none of that name.
Expected<v1::Camera> namedCamera(client::Client& client, const std::string& session, const std::string& name) {
  const auto cameras = client.cameras(session);
  if (!cameras) return cameras.status();
  for (const v1::Camera& camera : cameras->items) {
    if (camera.name() == name) return camera;
  }
  return Status(Code::kNotFound, "the session has no camera '" + name + "'; lpvctl scene list shows its cameras",
                "camera_name");
}

void printPick(const Context& context, const v1::PickResponse& pick) {
  if (context.json()) return print(toJson(pick));
  if (!pick.hit()) return print("nothing");
  const auto triple = [](const v1::Vec3& v) {
    return numberText(v.x()) + "," + numberText(v.y()) + "," + numberText(v.z());
  };
  print(pick.kind() + " " + pick.object() + " at " + triple(pick.position()) + " normal " + triple(pick.normal()));
}

}  // namespace

void addHistoryCommands(CLI::App& app, Commands& commands) {
  addStep(app, commands, "undo", "Undo the last edit that this user made in the session with lpvctl",
          &client::Editor::undo);
  addStep(app, commands, "redo", "Redo the last edit that was undone", &client::Editor::redo);
}

void addPickCommand(CLI::App& app, Commands& commands) {
  struct Options {
    std::string id;
    std::optional<std::vector<double>> pixel;
    FrameFlags frame;
  };
  auto given = std::make_shared<Options>();
  CLI::App& command =
      commands.add(app, "pick", "Print the object and point that a pixel shows", [given](Context& context) {
        Expected<client::Client> client = context.connect();
        if (!client) return client.status();
        v1::PickRequest request;
        request.set_session(given->id);
        request.set_x((*given->pixel)[0]);
        request.set_y((*given->pixel)[1]);
        request.set_width(given->frame.pixels().x);
        request.set_height(given->frame.pixels().y);
        if (given->frame.hasCamera()) *request.mutable_camera() = given->frame.camera();
        if (!given->frame.cameraName.empty()) {
          const auto camera = namedCamera(*client, given->id, given->frame.cameraName);
          if (!camera) return camera.status();
          *request.mutable_camera() = *camera;
        }
        const auto pick = client->pick(request);
        if (pick) printPick(context, *pick);
        return pick.status();
      });
  addSession(command, given->id);
  addParsed<std::vector<double>>(
      command, "--pixel", given->pixel, "x,y", [](const std::string& text) { return parseNumbers(text, {2}); },
      "Pixel, from the top left; 0.5,0.5 is the centre of the first one")
      ->required();
  given->frame.addCameraTo(command);
  given->frame.addSizeTo(command);
}

}  // namespace lpv::cli
