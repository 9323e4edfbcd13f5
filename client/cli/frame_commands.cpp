// frame get

#include <memory>

#include "command.h"
#include "files.h"
#include "frame_get.h"
#include "import/file_check.h"
#include "output.h"
#include "progress.h"
#include "scene_flags.h"
#include "values.h"

namespace lpv::cli {

void FrameFile::addTo(CLI::App& app) {
  app.add_option("-o,--output", path,
                 "File to write: png or jpg; exr stores linear radiance without tone curve; - is stdout")
      ->required()
      ->type_name("OUT");
  addChoice<v1::FrameFormat>(
      app, "--format", given,
      {{"png", v1::FRAME_FORMAT_PNG}, {"jpg", v1::FRAME_FORMAT_JPEG}, {"exr", v1::FRAME_FORMAT_EXR}},
      "Format of the image (default: the extension's; png for stdout)");
}

Expected<v1::FrameFormat> FrameFile::format() const {
  if (given) return *given;
  if (isStandardStream(path)) return v1::FRAME_FORMAT_PNG;
  const std::string extension = extensionOf(path);
  if (extension == "png") return v1::FRAME_FORMAT_PNG;
  if (extension == "jpg" || extension == "jpeg") return v1::FRAME_FORMAT_JPEG;
  if (extension == "exr") return v1::FRAME_FORMAT_EXR;
  return localError("output",
                    path + ": cannot write images of type '" + extension + "'; use png, jpg or exr, or say --format");
}

Expected<client::FrameResult> getFrame(client::Client& client, const std::string& session, const FrameFlags& flags,
                                       const std::optional<v1::Camera>& camera, const FrameFile& file) {
  const Expected<v1::FrameFormat> format = file.format();
  if (!format) return format.status();
  v1::GetFrameRequest request;
  request.set_session(session);
  request.set_camera_name(flags.cameraName);
  if (camera) *request.mutable_camera() = *camera;
  request.set_width(flags.pixels().x);
  request.set_height(flags.pixels().y);
  request.set_format(*format);
  if (flags.exposure) *request.mutable_exposure() = *flags.exposure;
  request.set_samples(flags.samples);
  if (flags.falseColour) request.set_quantity(v1::FRAME_QUANTITY_IRRADIANCE);
  Expected<client::FrameResult> frame = [&] {
    const Spinner spinner("rendering");
    return client.frame(request);
  }();
  if (!frame) return frame;
  if (Status status = writeFile(file.path, frame->file); !status.ok()) return status;
  return frame;
}

void addFrameCommands(CLI::App& app, Commands& commands) {
  struct Options {
    std::string id;
    FrameFile out;
    FrameFlags frame;
  };
  CLI::App& group = Commands::group(app, "frame", "Frames: get");
  auto given = std::make_shared<Options>();
  CLI::App& get = commands.add(group, "get", "Render one frame and save it", [given](Context& context) {
    checkBinaryOutput(context, "frame get", given->out.path);
    Expected<client::Client> client = context.connect();
    if (!client) return client.status();
    std::optional<v1::Camera> camera;
    if (given->frame.hasCamera()) camera = given->frame.camera();
    const auto frame = getFrame(*client, given->id, given->frame, camera, given->out);
    if (frame && context.json())
      print(JsonObject().text("file", given->out.path).raw("header", toJson(frame->header)).str());
    return frame.status();
  });
  addSession(get, given->id);
  given->out.addTo(get);
  given->frame.addTo(get);
  given->frame.addFalseColourTo(get);
}

}  // namespace lpv::cli
