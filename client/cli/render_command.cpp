// render: creates a temporary session, saves one frame, deletes the session.

#include <memory>
#include <utility>

#include "command.h"
#include "files.h"
#include "frame_get.h"
#include "import/image.h"
#include "import/scene_file.h"
#include "key_light.h"
#include "lpv/convert.h"
#include "output.h"
#include "scene/default_view.h"
#include "scene_flags.h"
#include "scene_upload.h"
#include "session_settings.h"

namespace lpv::cli {
namespace {

/// Propagation iterations with PROPAGATE. More than a live session can afford: light spreads one cell per iteration,
/// and a single frame may take its time.
constexpr int kIterations = 512;
/// ttl of the session: if this process is killed, the server removes the session.
constexpr std::int64_t kLifeSeconds = 600;

struct RenderOptions {
  std::string file;
  std::string sky;  ///< picture; "": none
  FrameFile out;
  ImportOptions import;
  SessionFlags session;
  FrameFlags frame;
};

/// Deletes the session in its destructor, also after an error or Ctrl-C.
class TemporarySession {
 public:
  TemporarySession(const Context& context, std::string name) : context_(context), name_(std::move(name)) {}
  ~TemporarySession() {
    Expected<client::Client> client = context_.connectForCleanup();
    if (client) (void)client->deleteSession(name_);
  }
  TemporarySession(const TemporarySession&) = delete;
  TemporarySession& operator=(const TemporarySession&) = delete;
  const std::string& name() const { return name_; }

 private:
  const Context& context_;
  std::string name_;
};

/// The camera of the flags, else of the file; empty: the server's default view.
std::optional<v1::Camera> cameraFor(const RenderOptions& options, const ImportedScene& scene) {
  if (options.frame.hasCamera()) return options.frame.camera();
  if (!options.frame.cameraName.empty() || scene.cameras.empty()) return {};
  return client::toProto(scene.cameras.front().second);
}

/// The same where nothing is chosen on the server.
Camera viewOf(const RenderOptions& options, const ImportedScene& file, const Scene& scene) {
  const glm::dvec2 size = options.frame.pixels();
  Camera camera = file.cameras.empty() ? DefaultView(scene).camera(size.x / size.y) : file.cameras.front().second;
  if (!options.frame.hasCamera()) return camera;
  camera.eye = *options.frame.eye;
  camera.target = *options.frame.target;
  camera.setUpByView();
  if (options.frame.up) camera.up = *options.frame.up;
  camera.fovDegrees = options.frame.fov.value_or(Camera().fovDegrees);
  return camera;
}

/// A light of all of the sky; it has no mesh (scene_upload.cpp).
Expected<Light> skyLight(const std::string& picture) {
  Expected<Texture> read = asLocal(readImage(picture));
  if (!read) return read.status();
  Light sky;
  sky.name = "sky";
  sky.distant = true;
  sky.texture = std::make_shared<const Texture>(std::move(*read));
  return sky;
}

Status render(Context& context, const RenderOptions& options) {
  checkBinaryOutput(context, "render", options.out.path);
  if (const auto format = options.out.format(); !format) return format.status();
  Expected<ImportedScene> scene = asLocal(importScene(options.file, options.import));
  if (!scene) return scene.status();
  for (const std::string& warning : scene->warnings) warn(warning);
  for (const std::string& assumed : scene->assumed) note(assumed);
  std::optional<v1::Camera> camera = cameraFor(options, *scene);
  if (!options.sky.empty()) {
    const Expected<Light> sky = skyLight(options.sky);
    if (!sky) return sky.status();
    scene->lights.push_back(*sky);
  }
  if (scene->lights.empty() && !scene->surfaces.empty()) {
    const Scene unlit = sceneOf(*scene);
    const Camera view = viewOf(options, *scene, unlit);
    if (Status s = asLocal(checkCamera(view)); !s.ok()) return s;
    scene->lights.push_back(keyLight(unlit, view));
    if (options.frame.cameraName.empty()) camera = client::toProto(view);  // the server's would show the light, too
    note("the file has no emissive material: added a light '" + scene->lights.back().name + "' beside the camera");
  }
  Expected<client::Client> client = context.connect();
  if (!client) return client.status();

  v1::CreateSessionRequest request;
  request.mutable_settings()->mutable_ttl()->set_seconds(kLifeSeconds);
  request.mutable_settings()->set_quality(v1::QUALITY_ACCURATE);
  request.mutable_settings()->set_iterations(kIterations);
  options.session.apply(*request.mutable_settings());
  const auto created = client->createSession(request);
  if (!created) return created.status();
  const TemporarySession session(context, created->session().name());
  Expected<client::Editor> editor = client::Editor::join(*client, session.name(), "");
  if (!editor) return editor.status();
  const auto uploaded = SceneUpload(*scene).run(*editor);
  if (!uploaded) return uploaded.status();
  for (const std::string& warning : uploaded->warnings) warn(warning);

  const auto frame = getFrame(*client, session.name(), options.frame, camera, options.out);
  if (frame && context.json()) {
    print(JsonObject().text("file", options.out.path).raw("header", toJson(frame->header)).str());
  }
  return frame.status();
}

}  // namespace

void addRenderCommand(CLI::App& app, Commands& commands) {
  auto given = std::make_shared<RenderOptions>();
  CLI::App& command =
      commands.add(app, "render", "Render one frame of a scene file in a temporary session (default quality: accurate)",
                   [given](Context& context) { return render(context, *given); });
  command.add_option("file", given->file, "Scene file: glb, gltf, obj, ply or stl")->required()->type_name("FILE");
  given->out.addTo(command);
  command
      .add_option(
          "--sky", given->sky,
          "Equirectangular image of the sky that lights the scene as well; its middle is towards +x (default: none)")
      ->type_name("IMG");
  addImportFlags(command, given->import);
  given->frame.addTo(command);
  given->frame.addFalseColourTo(command);
  given->session.addTo(command);
}

}  // namespace lpv::cli
