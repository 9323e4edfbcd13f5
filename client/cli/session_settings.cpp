#include "session_settings.h"

#include <cmath>
#include <glm/glm.hpp>

#include "lpv/convert.h"
#include "values.h"

namespace lpv::cli {
namespace {

struct GridSize {
  bool automatic = false;
  int longest = 0;
};

struct Method {
  v1::InjectionMethod method = v1::INJECTION_METHOD_UNSPECIFIED;
  int samples = 0;
};

std::optional<int> parseCount(const std::string& text) {
  const auto n = parseNumbers(text, {1});
  if (!n || (*n)[0] != std::floor((*n)[0]) || std::abs((*n)[0]) > 1e6) return {};
  return int((*n)[0]);
}

std::optional<GridSize> parseGrid(const std::string& text) {
  if (text == "auto") return GridSize{true, 0};
  const std::optional<int> longest = parseCount(text);
  if (!longest) return {};
  return GridSize{false, *longest};
}

std::optional<glm::ivec3> parseDims(const std::string& text) {
  const auto n = parseNumbers(text, {3});
  if (!n) return {};
  for (const double value : *n) {
    if (value != std::floor(value) || std::abs(value) > 1e6) return {};
  }
  return glm::ivec3((*n)[0], (*n)[1], (*n)[2]);
}

std::optional<Method> parseMethod(const std::string& text) {
  if (text == "compute") return Method{v1::INJECTION_METHOD_COMPUTE, 0};
  if (text == "raster") return Method{v1::INJECTION_METHOD_RASTER, 0};
  if (text.rfind("dense:", 0) != 0) return {};
  const std::optional<int> samples = parseCount(text.substr(6));
  if (!samples) return {};
  return Method{v1::INJECTION_METHOD_DENSE, *samples};
}

std::optional<std::vector<double>> parseBox(const std::string& text) { return parseNumbers(text, {6}); }

}  // namespace

struct SessionFlags::Given {
  std::optional<GridSize> grid;
  std::optional<glm::ivec3> dims;
  std::optional<std::vector<double>> bounds;
  std::optional<v1::Injection> injection;
  std::optional<Method> method;
  std::optional<v1::Transport> transport;
  std::optional<v1::Quality> quality;
  std::optional<int> iterations;
  std::optional<bool> clampFaces;
  std::optional<double> k;
  std::optional<v1::Lookup> lookup;
  std::optional<double> maxError;
  std::optional<v1::Visibility> visibility;
  std::optional<int> bounces;
  std::optional<v1::Gloss> gloss;
  std::optional<double> haze, hazeAbsorption, hazeAnisotropy;
  std::optional<double> ttl;
  std::optional<std::string> displayName;

  void addGridTo(CLI::App& app) {
    auto* size = addParsed<GridSize>(
        app, "--grid", grid, "N|auto", parseGrid,
        "Cells along the longest edge; auto: 16 to 128, as few as the scene needs for --max-error (default: 32, or "
        "up to 64 where the scene needs them)");
    addParsed<glm::ivec3>(app, "--dims", dims, "X,Y,Z", parseDims, "Cells along each axis, instead of --grid")
        ->excludes(size);
    addParsed<std::vector<double>>(app, "--bounds", bounds, "x0,y0,z0,x1,y1,z1", parseBox,
                                   "World box of the grid, metres (default: fitted to the content)");
  }

  void addTransportTo(CLI::App& app) {
    addChoice<v1::Injection>(app, "--injection", injection,
                             {{"count", v1::INJECTION_COUNT}, {"flux", v1::INJECTION_FLUX}},
                             "How light enters cells (default: count with propagate, else flux)");
    addParsed<Method>(app, "--method", method, "compute|raster|dense:N", parseMethod,
                      "How triangles are voxelized (default: compute)");
    addChoice<v1::Transport>(app, "--transport", transport,
                             {{"propagate", v1::TRANSPORT_PROPAGATE},
                              {"gather", v1::TRANSPORT_GATHER},
                              {"direct", v1::TRANSPORT_DIRECT},
                              {"auto", v1::TRANSPORT_AUTO}},
                             "How light travels (default: gather)");
    addChoice<v1::Quality>(app, "--quality", quality, {{"fast", v1::QUALITY_FAST}, {"accurate", v1::QUALITY_ACCURATE}},
                           "Quality of gathering (default: fast)");
    app.add_option("--iterations", iterations, "Propagation iterations (default: cells along the longest edge)")
        ->type_name("N");
    addSwitch(app, "--clamp-faces", clampFaces, "Propagation: clamp face intensities at 0 (default: off)");
    app.add_option("--k", k, "Opening ratio of gathering, 1..64 (default: 1.5 for fast, 3 for accurate)")
        ->type_name("K");
    addChoice<v1::Lookup>(app, "--lookup", lookup,
                          {{"cap", v1::LOOKUP_CAP}, {"sh2", v1::LOOKUP_SH2}, {"nearest", v1::LOOKUP_NEAREST}},
                          "How irradiance is read from the volume (default: sh2 with propagate, else cap)");
    app.add_option(
           "--max-error", maxError,
           "Wanted relative error of irradiance, .01 is 1 %; the server picks the opening ratio, and the grid where no "
           "size is given. session show says what is expected of the scene (default: 0.03, not insisted on)")
        ->type_name("E");
  }

  void addSceneTo(CLI::App& app) {
    addChoice<v1::Visibility>(app, "--visibility", visibility,
                              {{"auto", v1::VISIBILITY_AUTO}, {"on", v1::VISIBILITY_ON}, {"off", v1::VISIBILITY_OFF}},
                              "Whether surfaces cast shadows (default: auto)");
    app.add_option("--bounces", bounces,
                   "Times that surfaces reflect light, 0..32, or auto: as often as --max-error asks for (default: "
                   "auto; 0 with propagate)")
        ->transform(CLI::Transformer(std::map<std::string, int>{{"auto", -1}}))
        ->type_name("N|auto");
    addChoice<v1::Gloss>(app, "--gloss", gloss, {{"on", v1::GLOSS_ON}, {"off", v1::GLOSS_OFF}},
                         "Whether frames show reflections of surfaces that are metal or smooth (default: off)");
    app.add_option("--haze", haze,
                   "Extinction per metre of haze that fills the grid, 0..100: .1 hides a tenth in a metre (default: 0)")
        ->type_name("D");
    app.add_option("--haze-absorption", hazeAbsorption,
                   "Of what haze takes from light, the share that it does not scatter, 0..1 (default: 0)")
        ->type_name("A");
    app.add_option("--haze-anisotropy", hazeAnisotropy,
                   "Mean cosine of what haze scatters, -0.95..0.95: .8 glows around lights as fog does (default: 0)")
        ->type_name("G");
    addParsed<double>(app, "--ttl", ttl, "T", parseDuration,
                      "Remove the session after this time without calls: 90s, 10m, 1h, 2d; 0: never (default: 1h)");
    app.add_option("--display-name", displayName, "Name shown to people (default: none)")->type_name("TEXT");
  }
};

SessionFlags::SessionFlags() : given_(std::make_unique<Given>()) {}
SessionFlags::~SessionFlags() = default;

void SessionFlags::addTo(CLI::App& app) {
  given_->addGridTo(app);
  given_->addTransportTo(app);
  given_->addSceneTo(app);
}

namespace {

void applyGrid(const std::optional<GridSize>& size, const std::optional<glm::ivec3>& dims,
               const std::optional<std::vector<double>>& bounds, v1::GridSettings& grid) {
  if (size && size->automatic) grid.set_automatic(true);
  if (size && !size->automatic) grid.set_longest(size->longest);
  if (dims) {
    grid.mutable_dims()->set_x(dims->x);
    grid.mutable_dims()->set_y(dims->y);
    grid.mutable_dims()->set_z(dims->z);
  }
  if (bounds) {
    const std::vector<double>& b = *bounds;
    *grid.mutable_bounds()->mutable_min() = client::toProto(glm::dvec3(b[0], b[1], b[2]));
    *grid.mutable_bounds()->mutable_max() = client::toProto(glm::dvec3(b[3], b[4], b[5]));
  }
}

google::protobuf::Duration durationOf(double seconds) {
  google::protobuf::Duration out;
  out.set_seconds(std::int64_t(seconds));
  out.set_nanos(std::int32_t((seconds - std::floor(seconds)) * 1e9));
  return out;
}

}  // namespace

std::vector<std::string> SessionFlags::apply(v1::SessionSettings& settings) const {
  std::vector<std::string> paths;
  const auto set = [&paths](const auto& value, const char* name, const auto& write) {
    if (!value) return;
    write(*value);
    paths.push_back(std::string("settings.") + name);
  };
  const Given& g = *given_;
  if (g.grid || g.dims || g.bounds) {
    applyGrid(g.grid, g.dims, g.bounds, *settings.mutable_grid());
    paths.emplace_back("settings.grid");
  }
  set(g.injection, "injection", [&](auto v) { settings.set_injection(v); });
  set(g.method, "method", [&](const Method& m) { settings.set_method(m.method); });
  if (g.method && g.method->samples != 0) {
    settings.set_dense_samples(g.method->samples);
    paths.emplace_back("settings.dense_samples");
  }
  set(g.transport, "transport", [&](auto v) { settings.set_transport(v); });
  set(g.quality, "quality", [&](auto v) { settings.set_quality(v); });
  set(g.iterations, "iterations", [&](int v) { settings.set_iterations(v); });
  set(g.clampFaces, "clamp_faces", [&](bool v) { settings.set_clamp_faces(v); });
  set(g.k, "k", [&](double v) { settings.set_k(v); });
  set(g.lookup, "lookup", [&](auto v) { settings.set_lookup(v); });
  set(g.maxError, "max_error", [&](double v) { settings.set_max_error(v); });
  set(g.visibility, "visibility", [&](auto v) { settings.set_visibility(v); });
  set(g.bounces, "bounces", [&](int v) { settings.set_bounces(v); });
  set(g.gloss, "gloss", [&](auto v) { settings.set_gloss(v); });
  set(g.haze, "haze", [&](double v) { settings.set_haze(v); });
  set(g.hazeAbsorption, "haze_absorption", [&](double v) { settings.set_haze_absorption(v); });
  set(g.hazeAnisotropy, "haze_anisotropy", [&](double v) { settings.set_haze_anisotropy(v); });
  set(g.ttl, "ttl", [&](double v) { *settings.mutable_ttl() = durationOf(v); });
  set(g.displayName, "display_name", [&](const std::string& v) { settings.set_display_name(v); });
  return paths;
}

}  // namespace lpv::cli
