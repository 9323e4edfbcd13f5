#include "bench/service_load.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <thread>

#include "lpv/client.h"
#include "lpv/editor.h"
#include "lpv/watch.h"

namespace lpv::bench {
namespace {

using Steady = std::chrono::steady_clock;

/// An lpvd that lives as long as this.
class OwnServer {
 public:
  ~OwnServer() {
    if (pid_ > 0) {
      kill(pid_, SIGTERM);
      waitpid(pid_, nullptr, 0);
    }
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  Expected<std::string> start() {
    char name[] = "/tmp/lpv-bench-XXXXXX";
    if (!mkdtemp(name)) return Status(Code::kInternal, "no temporary folder");
    folder_ = name;
    const std::string portFile = folder_ + "/port";
    pid_ = fork();
    if (pid_ == 0) {
      execl(LPVD_PATH, "lpvd", "--listen", "127.0.0.1:0", "--port-file", portFile.c_str(), "--log-level", "warn",
            static_cast<char*>(nullptr));
      _exit(127);
    }
    for (int i = 0; i < 200; ++i) {
      std::ifstream file(portFile);
      int port = 0;
      if (file >> port) return "127.0.0.1:" + std::to_string(port);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return Status(Code::kUnavailable, "lpvd did not start");
  }

 private:
  pid_t pid_ = -1;
  std::string folder_;
};

/// Runs lpvctl and returns its first line.
Expected<std::string> lpvctl(const std::string& server, const std::string& arguments) {
  const std::string command = std::string(LPVCTL_PATH) + " --server " + server + " " + arguments;
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return Status(Code::kInternal, "cannot run " + command);
  char line[512] = "";
  if (!fgets(line, sizeof line, pipe)) line[0] = '\0';
  while (fgetc(pipe) != EOF) {
  }
  if (pclose(pipe) != 0) return Status(Code::kInternal, "failed: " + command);
  std::string out(line);
  while (!out.empty() && (out.back() == '\n' || out.back() == '\r')) out.pop_back();
  return out;
}

template <typename T>
std::string bytesOf(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// A sphere of about `triangles` triangles, radius 0.4 m, standing on the origin.
v1::Mesh sphere(int triangles) {
  const int rings = std::max(3, int(std::lround(std::sqrt(triangles / 4.0))));
  const int sectors = 2 * rings;
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
  for (int r = 0; r <= rings; ++r) {
    const double theta = M_PI * r / rings;
    for (int s = 0; s <= sectors; ++s) {
      const double phi = 2.0 * M_PI * s / sectors;
      for (const double v : {0.4 * std::sin(theta) * std::cos(phi), 0.4 + 0.4 * std::cos(theta),
                             -0.4 * std::sin(theta) * std::sin(phi)}) {
        positions.push_back(float(v));
      }
    }
  }
  const auto at = [sectors](int r, int s) { return std::uint32_t(r * (sectors + 1) + s); };
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      for (const std::uint32_t i : {at(r, s), at(r + 1, s), at(r + 1, s + 1)}) indices.push_back(i);
      for (const std::uint32_t i : {at(r, s), at(r + 1, s + 1), at(r, s + 1)}) indices.push_back(i);
    }
  }
  v1::Mesh mesh;
  mesh.set_positions(bytesOf(positions));
  mesh.set_indices(bytesOf(indices));
  return mesh;
}

/// A box of 6 x 3 x 6 m seen from inside: the procedural room.
v1::Mesh room() {
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const auto base = std::uint32_t(positions.size() / 3);
      for (int corner = 0; corner < 4; ++corner) {
        double p[3];
        p[axis] = side;
        p[(axis + 1) % 3] = (corner == 1 || corner == 2) ? 1 : 0;
        p[(axis + 2) % 3] = corner >= 2 ? 1 : 0;
        for (const double v : {6.0 * p[0] - 3.0, 3.0 * p[1], 6.0 * p[2] - 3.0}) positions.push_back(float(v));
      }
      for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) indices.push_back(base + i);
    }
  }
  v1::Mesh mesh;
  mesh.set_positions(bytesOf(positions));
  mesh.set_indices(bytesOf(indices));
  return mesh;
}

void setVec(v1::Vec3* out, double x, double y, double z) {
  out->set_x(x);
  out->set_y(y);
  out->set_z(z);
}

/// A session on its way: scene, light, and the light's vertices for deforming.
class Stage {
 public:
  Stage(const Load& load, client::Client client, std::string server)
      : load_(load), client_(std::move(client)), server_(std::move(server)) {}
  ~Stage() {
    if (!session_.empty()) (void)client_.deleteSession(session_).ok();
  }

  Status prepare() {
    v1::CreateSessionRequest request;
    request.mutable_settings()->mutable_grid()->set_longest(load_.grid);
    request.mutable_settings()->set_iterations(load_.iterations);
    const auto created = client_.createSession(request);
    if (!created) return created.status();
    session_ = client::sessionId(created->session().name());
    if (Status s = addScene(); !s.ok()) return s;
    if (Status s = addLight(); !s.ok()) return s;
    return readLight();
  }

  /// The edit of step `i`: the light on a circle, or breathing in place.
  v1::Edit step(int i) const {
    v1::Edit edit;
    const double phase = 0.15 * i;
    if (!load_.deform) {
      v1::UpdateLight* update = edit.add_operations()->mutable_update_light();
      update->mutable_light()->set_name(light_);
      setVec(update->mutable_light()->mutable_transform()->mutable_translation(), base_[0] + 0.4 * std::cos(phase),
             base_[1], base_[2] + 0.4 * std::sin(phase));
      update->mutable_update_mask()->add_paths("transform.translation");
      return edit;
    }
    std::vector<float> moved = positions_;
    for (std::size_t v = 0; v + 2 < moved.size(); v += 3) {
      const float sway = 1.0F + 0.05F * float(std::sin(phase + double(moved[v + 1]) / span_ * 6.0));
      moved[v] *= sway;
      moved[v + 2] *= sway;
    }
    v1::SetVertices* set = edit.add_operations()->mutable_set_vertices();
    set->set_object(light_);
    set->set_positions(bytesOf(moved));
    return edit;
  }

  const std::string& session() const { return session_; }
  client::Client& client() { return client_; }
  std::int64_t lightTriangles() const { return lightTriangles_; }

 private:
  Status addScene() {
    if (!load_.sceneFile.empty()) {
      return lpvctl(server_, "scene load " + session_ + " '" + load_.sceneFile + "' >/dev/null").status();
    }
    v1::Edit edit;
    v1::Surface* surface = edit.add_operations()->mutable_create_surface();
    surface->set_name("room");
    *surface->mutable_inline_mesh() = room();
    return client_.applyEdit(session_, edit).status();
  }

  Status addLight() {
    if (!load_.lightFile.empty()) {
      const auto name =
          lpvctl(server_, "light add " + session_ + " '" + load_.lightFile + "' --name bench --scale " +
                              std::to_string(load_.lightScale) + " --radiance " + std::to_string(load_.radiance) + "," +
                              std::to_string(load_.radiance) + "," + std::to_string(load_.radiance));
      if (!name) return name.status();
      light_ = *name;
      return {};
    }
    v1::Edit edit;
    v1::Light* light = edit.add_operations()->mutable_create_light();
    light->set_name("bench");
    *light->mutable_inline_mesh() = sphere(load_.lightTriangles);
    setVec(light->mutable_radiance(), load_.radiance, load_.radiance, load_.radiance);
    const auto ack = client_.applyEdit(session_, edit);
    if (!ack) return ack.status();
    light_ = ack->names(0);
    return {};
  }

  /// The light's vertices from the server, and the translation that stands it on its place; fits the grid.
  Status readLight() {
    const auto lights = client_.lights(session_);
    if (!lights) return lights.status();
    const auto mine = std::find_if(lights->items.begin(), lights->items.end(),
                                   [this](const v1::Light& light) { return light.name() == light_; });
    lightTriangles_ = mine->status().triangle_count();
    const auto blob = client_.readBlob(session_, mine->mesh());
    if (!blob) return blob.status();
    v1::Mesh mesh;
    if (!mesh.ParseFromString(*blob)) return Status(Code::kInternal, "the light's mesh cannot be read back");
    positions_.resize(mesh.positions().size() / sizeof(float));
    std::memcpy(positions_.data(), mesh.positions().data(), mesh.positions().size());
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
    v1::Edit edit;
    v1::UpdateLight* update = edit.add_operations()->mutable_update_light();
    update->mutable_light()->set_name(light_);
    setVec(update->mutable_light()->mutable_transform()->mutable_translation(), base_[0], base_[1], base_[2]);
    update->mutable_update_mask()->add_paths("transform.translation");
    edit.add_operations()->mutable_fit_grid();
    return client_.applyEdit(session_, edit).status();
  }

  const Load& load_;
  client::Client client_;
  std::string server_;
  std::string session_;
  std::string light_;
  std::vector<float> positions_;
  double span_ = 1.0;
  double base_[3] = {0.0, 0.0, 0.0};
  std::int64_t lightTriangles_ = 0;
};

/// What the watchers see. The warm-up before start() is not counted.
class Seen {
 public:
  void start() { counting_ = true; }
  void acknowledged(std::uint64_t revision) { newest_ = std::max(newest_.load(), revision); }
  void frame(const client::FrameResult& frame) {
    if (!counting_) return;
    const std::lock_guard lock(mutex_);
    ++frames_;
    bytes_ += double(frame.file.size());
    const std::uint64_t newest = newest_;
    const std::uint64_t shown = frame.header.result().revision();
    behind_.push_back(newest > shown ? double(newest - shown) : 0.0);
    for (const v1::StageTime& time : frame.header.result().stage_times()) {
      stages_[time.stage()].push_back(time.seconds());
    }
  }
  void volume() {
    if (counting_) ++volumes_;
  }
  void report(Measured* out) {
    const std::lock_guard lock(mutex_);
    out->frames = double(frames_);
    out->frameBytes = bytes_;
    out->volumes = double(volumes_);
    out->revisionsBehind = median(behind_);
    for (auto& [stage, seconds] : stages_) out->stageSeconds[stage] = median(seconds);
  }

 private:
  static double median(std::vector<double>& values) {
    if (values.empty()) return 0.0;
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
    return values[values.size() / 2];
  }

  std::atomic<bool> counting_{false};
  std::atomic<std::uint64_t> newest_{0};
  std::atomic<std::int64_t> volumes_{0};
  std::mutex mutex_;
  std::int64_t frames_ = 0;
  double bytes_ = 0.0;
  std::vector<double> behind_;
  std::map<std::string, std::vector<double>> stages_;
};

v1::FrameSubscription frameSubscription(const Load& load, const client::Editor& editor) {
  v1::FrameSubscription subscription;
  subscription.set_session("sessions/" + client::sessionId(editor.session()));
  *subscription.mutable_client() = editor.identity();
  subscription.set_width(load.width);
  subscription.set_height(load.height);
  if (load.camera.size() == 6) {
    v1::Camera* camera = subscription.mutable_camera()->mutable_camera();
    setVec(camera->mutable_eye(), load.camera[0], load.camera[1], load.camera[2]);
    setVec(camera->mutable_target(), load.camera[3], load.camera[4], load.camera[5]);
    camera->set_fov_degrees(60.0);
  }
  return subscription;
}

/// Sends edits at the wanted rate for `seconds`; returns how many.
Expected<double> drive(const Load& load, const Stage& stage, client::EditStream& edits, int* step, double seconds) {
  const auto begin = Steady::now();
  const auto interval = std::chrono::duration<double>(1.0 / load.rate);
  int sent = 0;
  while (Steady::now() - begin < std::chrono::duration<double>(seconds)) {
    const auto ack = edits.send(stage.step((*step)++));
    if (!ack) return ack.status();
    ++sent;
    std::this_thread::sleep_until(begin + interval * sent);
  }
  return double(sent);
}

constexpr double kWarmUpSeconds = 3.0;

Expected<Measured> measure(const Load& load, Stage& stage) {
  const auto editor = client::Editor::join(stage.client(), stage.session(), "bench");
  if (!editor) return editor.status();
  Seen seen;
  auto latency = std::make_shared<client::LatencyLog>();
  client::WatchHooks hooks;
  hooks.latency = latency;
  client::FrameWatcher frames(
      stage.client(), frameSubscription(load, *editor), [&](client::FrameResult frame) { seen.frame(frame); }, hooks);
  std::optional<client::VolumeWatcher> volumes;
  if (load.watchVolume) {
    v1::VolumeSubscription subscription;
    subscription.set_session("sessions/" + stage.session());
    volumes.emplace(stage.client(), subscription, [&](client::VolumeResult) { seen.volume(); });
  }
  client::EditStream edits(
      *editor, [&](const v1::EditAck& ack) { seen.acknowledged(ack.revision()); }, {}, latency);
  int step = 0;
  if (const auto warm = drive(load, stage, edits, &step, kWarmUpSeconds); !warm) return warm.status();

  const auto before = stage.client().stats();
  if (!before) return before.status();
  seen.start();
  const auto begin = Steady::now();
  const auto sent = drive(load, stage, edits, &step, load.seconds);
  if (!sent) return sent.status();
  Measured out;
  out.seconds = std::chrono::duration<double>(Steady::now() - begin).count();
  const auto after = stage.client().stats();
  if (!after) return after.status();
  out.edits = *sent;
  out.ticks = double(after->ticks() - before->ticks());
  seen.report(&out);
  out.latency = latency->summary();
  return out;
}

}  // namespace

Expected<Measured> run(const Load& load) {
  OwnServer own;
  std::string address = load.server;
  if (address.empty()) {
    const Expected<std::string> started = own.start();
    if (!started) return started.status();
    address = *started;
  }
  client::ConnectOptions options;
  options.address = address;
  const auto client = client::Client::connect(options);
  if (!client) return client.status();
  Stage stage(load, *client, address);
  if (Status s = stage.prepare(); !s.ok()) return s;
  Expected<Measured> out = measure(load, stage);
  if (!out) return out;
  const auto info = stage.client().serverInfo();
  const auto session = stage.client().session(stage.session());
  if (!info || !session) return Status(Code::kUnavailable, "the server went away");
  out->device = info->device().name();
  out->version = "lpvd " + info->version();
  out->lightTriangles = stage.lightTriangles();
  out->surfaceTriangles = session->triangle_count() - out->lightTriangles;
  return out;
}

}  // namespace lpv::bench
