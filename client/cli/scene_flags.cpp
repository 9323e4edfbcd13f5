#include "scene_flags.h"

#include <utility>

#include "lpv/convert.h"
#include "values.h"

namespace lpv::cli {
namespace {

std::optional<glm::dvec3> parseColour(const std::string& text) {
  const auto n = parseNumbers(text, {1, 3});
  if (!n) return {};
  return n->size() == 1 ? glm::dvec3((*n)[0]) : glm::dvec3((*n)[0], (*n)[1], (*n)[2]);
}

std::optional<v1::Exposure> parseExposure(const std::string& text) {
  v1::Exposure exposure;
  if (text == "auto") {
    exposure.set_automatic(true);
    return exposure;
  }
  const auto ev = parseNumbers(text, {1});
  if (!ev) return {};
  exposure.set_ev((*ev)[0]);
  return exposure;
}

}  // namespace

void addUpFlag(CLI::App& app, ImportOptions& options) {
  app.add_option_function<std::string>(
         "--up",
         [&options](const std::string& axis) {
           if (axis != "y" && axis != "z") throw CLI::ValidationError("--up", "is '" + axis + "'; allowed are y and z");
           options.zUp = axis == "z";
         },
         "Axis of the file that points up (default: y)")
      ->type_name("y|z");
}

void addImportFlags(CLI::App& app, ImportOptions& options) {
  app.add_option("--scale", options.scale, "Metres per unit of the file (default: 1)")
      ->type_name("S")
      ->check(CLI::Range(1e-9, 1e9));
  addUpFlag(app, options);
  app.add_flag("--ignore-emissive-textures", options.ignoreEmissiveTextures,
               "Let lights emit the mean colour of their emissive texture (default: the texture)");
}

void TransformFlags::addTo(CLI::App& app) {
  addVec3(app, "--translate", translate, "Translation, metres");
  addVec3(app, "--rotate", rotate, "Rotation, degrees: intrinsic X, then Y, then Z");
  addScale(app, "--scale", scale, "Scale factor, one or one per axis");
}

client::Move TransformFlags::move() const {
  client::Move out;
  out.translation = translate;
  if (rotate) out.rotation = rotationFromEulerDegrees(*rotate);
  out.scale = scale;
  return out;
}

Transform TransformFlags::placed() const {
  Transform out;
  if (translate) out.translation = *translate;
  if (rotate) out.rotation = rotationFromEulerDegrees(*rotate);
  if (scale) out.scale = *scale;
  return out;
}

client::Move TransformFlags::relativeTo(const Transform& now) const {
  client::Move out = move();
  if (out.translation) *out.translation += now.translation;
  if (out.rotation) out.rotation = glm::normalize(*out.rotation * now.rotation);
  if (out.scale) *out.scale *= now.scale;
  return out;
}

void FrameFlags::addCameraTo(CLI::App& app) {
  auto* named =
      app.add_option("--camera", cameraName, "Use this camera of the session (default: a view that the server chooses)")
          ->type_name("NAME");
  auto* from = addVec3(app, "--eye", eye, "Position of the camera, metres")->excludes(named);
  auto* to = addVec3(app, "--target", target, "Point the camera looks at, metres")->needs(from);
  from->needs(to);
  addVec3(app, "--up-vector", up, "Up direction (default: 0,1,0; straight down or up: 0,0,-1)")->needs(from);
  app.add_option("--fov", fov, "Vertical field of view, degrees (default: 50)")->type_name("DEGREES")->needs(from);
}

void FrameFlags::addSizeTo(CLI::App& app) {
  addParsed<glm::ivec2>(app, "--size", size, "WxH", parseSize, "Size, pixels (default: 640x360)");
}

void FrameFlags::addFalseColourTo(CLI::App& app) {
  app.add_flag("--false-colour", falseColour,
               "Show illuminance in lux instead, by colours with a legend; with exr, irradiance in W/m^2");
}

void FrameFlags::addTo(CLI::App& app) {
  addCameraTo(app);
  addSizeTo(app);
  addParsed<v1::Exposure>(app, "--exposure", exposure, "EV|auto", parseExposure, "Exposure in stops (default: auto)");
  app.add_option("--samples", samples,
                 "Of each pixel, for edges and textures: 1, 2, 4, 8, 16, 32 or 64 (default: 32; watch: 1)")
      ->type_name("COUNT");
}

v1::Camera FrameFlags::camera() const {
  v1::Camera out;
  if (eye) *out.mutable_eye() = client::toProto(*eye);
  if (target) *out.mutable_target() = client::toProto(*target);
  if (up) *out.mutable_up() = client::toProto(*up);
  if (fov) out.set_fov_degrees(*fov);
  return out;
}

CLI::Option* addColour(CLI::App& app, const std::string& name, std::optional<glm::dvec3>& value,
                       const std::string& about) {
  return addParsed<glm::dvec3>(app, name, value, "v|r,g,b", parseColour, about);
}

}  // namespace lpv::cli
