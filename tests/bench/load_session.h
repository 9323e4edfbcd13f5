#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/service_load.h"
#include "lpv/client.h"

namespace lpv::bench {

inline constexpr const char* kCamera = "bench";  ///< of the session, where it moves
inline constexpr double kFov = 60.0;              ///< degrees

void setVec(v1::Vec3* out, double x, double y, double z);

/// A session of the load's kind: scene, light, and the light's vertices for deforming. Deleted with this.
class LoadSession {
 public:
  /// `load` has to outlive this.
  LoadSession(const Load& load, client::Client client, std::string server);
  ~LoadSession();
  LoadSession(const LoadSession&) = delete;
  LoadSession& operator=(const LoadSession&) = delete;

  /// Creates the session with everything in it.
  Status prepare();

  /// The edit of step `i`: the light on a circle, or breathing in place; or the camera on a circle.
  v1::Edit step(int i) const;

  /// The light on its place again.
  v1::Edit stillEdit() const { return moved(0.0, 0.0); }
  /// What references of that need besides the scene's file: the light in world metres, W/(sr m^2), and the room where
  /// there is no file, as JSON.
  std::string stillScene() const;

  const std::string& id() const { return id_; }
  client::Client& client() { return client_; }
  std::int64_t lightTriangles() const { return lightTriangles_; }

 private:
  Expected<std::string> lpvctl(std::vector<std::string> arguments) const;
  Status addScene();
  Status addLight();
  Status readLight();
  void measureLight();
  Status placeLight();
  v1::Edit moved(double dx, double dz) const;
  v1::Edit orbited(double phase) const;
  v1::Edit deformed(double phase) const;

  const Load& load_;
  client::Client client_;
  std::string server_;
  std::string id_;
  std::string light_;
  std::vector<std::uint32_t> indices_;
  std::vector<float> positions_;  ///< of the light, x y z each, metres before its scale
  double span_ = 1.0;  ///< height of the light, likewise
  double base_[3] = {0.0, 0.0, 0.0};  ///< translation that stands the light on its place
  std::int64_t lightTriangles_ = 0;
};

}  // namespace lpv::bench
