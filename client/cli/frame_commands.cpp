// frame get

#include <memory>

#include "command.h"
#include "frame_get.h"
#include "import/file_check.h"
#include "output.h"
#include "scene_flags.h"

namespace lpv::cli {

Expected<v1::FrameFormat> frameFormatOf(const std::string& path) {
  const std::string extension = extensionOf(path);
  if (extension == "png") return v1::FRAME_FORMAT_PNG;
  if (extension == "jpg" || extension == "jpeg") return v1::FRAME_FORMAT_JPEG;
  if (extension == "exr") return v1::FRAME_FORMAT_EXR;
  return invalid("output", path + ": cannot write images of type '" + extension + "'; use png, jpg or exr");
}

Expected<client::FrameResult> getFrame(client::Client& client, const std::string& session, const FrameFlags& flags,
                                       const std::optional<v1::Camera>& camera, const std::string& path) {
  const Expected<v1::FrameFormat> format = frameFormatOf(path);
  if (!format) return format.status();
  v1::GetFrameRequest request;
  request.set_session(session);
  request.set_camera_name(flags.cameraName);
  if (camera) *request.mutable_camera() = *camera;
  request.set_width(flags.pixels().x);
  request.set_height(flags.pixels().y);
  request.set_format(*format);
  if (flags.exposure) *request.mutable_exposure() = *flags.exposure;
  auto frame = client.frame(request);
  if (!frame) return frame;
  if (Status status = writeFile(path, frame->file); !status.ok()) return status;
  return frame;
}

void addFrameCommands(CLI::App& app, Commands& commands) {
  struct Options {
    std::string id;
    std::string out;
    FrameFlags frame;
  };
  CLI::App& group = Commands::group(app, "frame", "Frames: get");
  auto given = std::make_shared<Options>();
  CLI::App& get = commands.add(group, "get", "Render one frame and save it", [given](Context& context) {
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    std::optional<v1::Camera> camera;
    if (given->frame.hasCamera()) camera = given->frame.camera();
    const auto frame = getFrame(*client, given->id, given->frame, camera, given->out);
    if (frame && context.json())
      print(JsonObject().text("file", given->out).raw("header", toJson(frame->header)).str());
    return frame.status();
  });
  addSession(get, given->id);
  get.add_option("-o,--output", given->out, "File to write: png or jpg; exr stores linear radiance without tone curve")
      ->required()
      ->type_name("OUT");
  given->frame.addTo(get);
}

}  // namespace lpv::cli
