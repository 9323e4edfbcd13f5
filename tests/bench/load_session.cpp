#include "bench/load_session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "bench/load_meshes.h"
#include "rpc/support/child_process.h"

namespace lpv::bench {
namespace {

constexpr std::chrono::minutes kLoadingPatience{5};

}  // namespace

void setVec(v1::Vec3* out, double x, double y, double z) {
  out->set_x(x);
  out->set_y(y);
  out->set_z(z);
}

LoadSession::LoadSession(const Load& load, client::Client client, std::string server)
    : load_(load), client_(std::move(client)), server_(std::move(server)) {}

LoadSession::~LoadSession() {
  if (!id_.empty()) (void)client_.deleteSession(id_).ok();
}

Status LoadSession::prepare() {
  v1::CreateSessionRequest request;
  request.mutable_settings()->mutable_grid()->set_longest(load_.grid);
  const bool propagate = load_.transport == "propagate";
  request.mutable_settings()->set_transport(propagate                     ? v1::TRANSPORT_PROPAGATE
                                            : load_.transport == "direct" ? v1::TRANSPORT_DIRECT
                                                                          : v1::TRANSPORT_GATHER);
  if (propagate) request.mutable_settings()->set_iterations(load_.iterations);
  if (load_.visibility != "auto") {
    request.mutable_settings()->set_visibility(load_.visibility == "on" ? v1::VISIBILITY_ON : v1::VISIBILITY_OFF);
  }
  if (load_.bounces != "auto") request.mutable_settings()->set_bounces(std::stoi(load_.bounces));
  const auto created = client_.createSession(request);
  if (!created) return created.status();
  id_ = client::sessionId(created->session().name());
  if (Status s = addScene(); !s.ok()) return s;
  if (Status s = addLight(); !s.ok()) return s;
  if (Status s = readLight(); !s.ok()) return s;
  measureLight();
  if (Status s = placeLight(); !s.ok() || !load_.orbit) return s;
  return client_.applyEdit(id_, orbited(0.0)).status();
}

v1::Edit LoadSession::step(int i) const {
  const double phase = 0.15 * i;
  if (load_.orbit) return orbited(phase);
  return load_.deform ? deformed(phase) : moved(0.4 * std::cos(phase), 0.4 * std::sin(phase));
}

/// The light that far from its place, metres.
v1::Edit LoadSession::moved(double dx, double dz) const {
  v1::Edit edit;
  v1::UpdateLight* update = edit.add_operations()->mutable_update_light();
  update->mutable_light()->set_name(light_);
  setVec(update->mutable_light()->mutable_transform()->mutable_translation(), base_[0] + dx, base_[1], base_[2] + dz);
  update->mutable_update_mask()->add_paths("transform.translation");
  return edit;
}

/// The camera a little to the side, looking where it looked: 10 cm, or a twentieth of its distance where that is less.
v1::Edit LoadSession::orbited(double phase) const {
  const std::vector<double>& at = load_.camera;
  const double distance = std::hypot(at[3] - at[0], at[4] - at[1], at[5] - at[2]);
  const double aside = std::min(0.1, 0.05 * distance);
  v1::Edit edit;
  v1::Camera* camera = edit.add_operations()->mutable_put_camera();
  camera->set_name(kCamera);
  setVec(camera->mutable_eye(), at[0] + aside * std::cos(phase), at[1], at[2] + aside * std::sin(phase));
  setVec(camera->mutable_target(), at[3], at[4], at[5]);
  camera->set_fov_degrees(kFov);
  return edit;
}

v1::Edit LoadSession::deformed(double phase) const {
  std::vector<float> positions = positions_;
  for (std::size_t v = 0; v + 2 < positions.size(); v += 3) {
    const float sway = 1.0F + 0.05F * float(std::sin(phase + double(positions[v + 1]) / span_ * 6.0));
    positions[v] *= sway;
    positions[v + 2] *= sway;
  }
  v1::Edit edit;
  v1::SetVertices* set = edit.add_operations()->mutable_set_vertices();
  set->set_object(light_);
  set->set_positions(bytesOf(positions));
  return edit;
}

/// Runs lpvctl and returns its first line.
Expected<std::string> LoadSession::lpvctl(std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(), {"--server", server_});
  rpc::ChildProcess process(rpc::whereItIs(LPVCTL_PATH), arguments);
  if (process.wait(kLoadingPatience) != 0) return Status(Code::kInternal, "lpvctl failed: " + process.errors());
  const std::string output = process.output();
  return output.substr(0, output.find('\n'));
}

Status LoadSession::addScene() {
  if (!load_.sceneFile.empty()) return lpvctl({"scene", "load", id_, load_.sceneFile}).status();
  v1::Edit edit;
  v1::Surface* surface = edit.add_operations()->mutable_create_surface();
  surface->set_name("room");
  *surface->mutable_inline_mesh() = room();
  return client_.applyEdit(id_, edit).status();
}

Status LoadSession::addLight() {
  if (!load_.lightFile.empty()) {
    const auto name = lpvctl({"light", "add", id_, load_.lightFile, "--name", "bench", "--scale",
                              std::to_string(load_.lightScale), "--radiance", std::to_string(load_.radiance)});
    if (!name) return name.status();
    light_ = *name;
    return {};
  }
  v1::Edit edit;
  v1::Light* light = edit.add_operations()->mutable_create_light();
  light->set_name("bench");
  *light->mutable_inline_mesh() = sphere(load_.lightTriangles);
  setVec(light->mutable_radiance(), load_.radiance, load_.radiance, load_.radiance);
  const auto ack = client_.applyEdit(id_, edit);
  if (!ack) return ack.status();
  light_ = ack->names(0);
  return {};
}

/// The light's vertices, from the server.
Status LoadSession::readLight() {
  const auto lights = client_.lights(id_);
  if (!lights) return lights.status();
  const auto mine = std::find_if(lights->items.begin(), lights->items.end(),
                                 [this](const v1::Light& light) { return light.name() == light_; });
  if (mine == lights->items.end()) return Status(Code::kInternal, "the light is gone");
  lightTriangles_ = mine->status().triangle_count();
  const auto blob = client_.readBlob(id_, mine->mesh());
  if (!blob) return blob.status();
  v1::Mesh mesh;
  if (!mesh.ParseFromString(*blob)) return Status(Code::kInternal, "the light's mesh cannot be read back");
  positions_ = numbersOf<float>(mesh.positions());
  indices_ = numbersOf<std::uint32_t>(mesh.indices());
  return {};
}

std::string LoadSession::stillScene() const {
  std::vector<double> placed;
  for (std::size_t i = 0; i < positions_.size(); ++i)
    placed.push_back(double(positions_[i]) * load_.lightScale + base_[i % 3]);
  nlohmann::json scene = {{"light", {{"positions", placed}, {"indices", indices_}, {"radiance", load_.radiance}}}};
  if (load_.sceneFile.empty()) {
    const v1::Mesh mesh = room();
    scene["room"] = {{"positions", numbersOf<float>(mesh.positions())},
                     {"indices", numbersOf<std::uint32_t>(mesh.indices())}};
  }
  return scene.dump();
}

/// Its height, and the translation that stands it on its place.
void LoadSession::measureLight() {
  double low[3] = {1e30, 1e30, 1e30};
  double high[3] = {-1e30, -1e30, -1e30};
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    low[i % 3] = std::min(low[i % 3], double(positions_[i]));
    high[i % 3] = std::max(high[i % 3], double(positions_[i]));
  }
  span_ = std::max(high[1] - low[1], 1e-6);
  for (int axis = 0; axis < 3; ++axis) {
    const double anchor = axis == 1 ? low[axis] : 0.5 * (low[axis] + high[axis]);
    base_[axis] = load_.place[std::size_t(axis)] - anchor * load_.lightScale;
  }
}

/// Also fits the grid.
Status LoadSession::placeLight() {
  v1::Edit edit = moved(0.0, 0.0);
  edit.add_operations()->mutable_fit_grid();
  return client_.applyEdit(id_, edit).status();
}

}  // namespace lpv::bench
