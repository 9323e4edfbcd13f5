#include "scene/forecast.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "scene/error_goal.h"
#include "scene/grid_choice.h"
#include "scene/patches.h"
#include "scene/predicted_error.h"
#include "scene/shadowing.h"
#include "scene/transport_choice.h"

namespace lpv {

namespace {

/// Of polygons looked at in the shaders' single precision.
constexpr double kSinglePrecision = 1e-4;
constexpr std::size_t kMostNames = 3;

int longestOf(const Grid& grid) { return std::max({grid.dims.x, grid.dims.y, grid.dims.z}); }

std::string percentText(double error) {
  char text[32];
  std::snprintf(text, sizeof text, error < 0.0995 ? "%.2g %%" : "%.0f %%", 100.0 * error);
  return text;
}

/// "64 cells along the longest edge".
std::string edge(int cells) { return std::to_string(cells) + " cells along the longest edge"; }

bool emitsLight(const Light& light) { return light.enabled && emittedRadiance(light) != glm::dvec3(0.0); }

/// What looking at the lights comes to: exact where every light is looked at as polygons (kFewPolygons).
double directError(const Scene& scene, LightingSettings options) {
  options.transport = Transport::kDirect;
  const std::size_t most = options.openingRatio() < kAccurateOpeningRatio ? kFewPolygons : kMostPolygons;
  std::size_t all = 0;
  bool polygons = true;
  for (const auto& [name, light] : scene.lights) {
    if (!emitsLight(*light)) continue;
    all += light->mesh->evenTriangles().size();
    polygons = polygons && light->texture == nullptr && light->mesh->directions.empty() &&
               light->mesh->evenTriangles().size() <= most;
  }
  if (polygons && all > 0 && all <= kMostPolygonsOfAll) return kSinglePrecision;
  return std::hypot(expectedError(options, kDefaultCellsOfLongestEdge),
                    ErrorPredictor(scene, options).ofTouching(scene.grid));
}

/// Whether GATHER's frames and probes do, wherever the receiver is.
bool looksAtLights(const Scene& scene) { return isShadowed(scene) || bouncesFor(scene) > 0; }

using Names = std::vector<std::string>;

std::string listed(const Names& names) {
  std::string out = names.size() == 1 ? "light " : "lights ";
  for (std::size_t i = 0; i < std::min(names.size(), kMostNames); ++i) out += (i > 0 ? ", " : "") + names[i];
  if (names.size() > kMostNames) out += " and " + std::to_string(names.size() - kMostNames) + " more";
  return out;
}

/// What PROPAGATE loses: it knows no light but what is injected into the grid's cells.
std::string lightsLeftOut(const Scene& scene) {
  const Bounds grid = scene.grid.bounds();
  Names outside, partly;
  for (const auto& [name, light] : scene.lights) {
    if (!emitsLight(*light)) continue;
    const Bounds box = light->mesh->bounds.transformed(light->transform.worldFromObject());
    const bool apart =
        light->distant || glm::any(glm::lessThan(box.max, grid.min)) || glm::any(glm::greaterThan(box.min, grid.max));
    const bool within =
        glm::all(glm::greaterThanEqual(box.min, grid.min)) && glm::all(glm::lessThanEqual(box.max, grid.max));
    const std::string& known = sessionName(name, *light);
    if (light->distant && !outside.empty() && outside.back() == known) continue;  // another part
    if (apart) outside.push_back(known);
    if (!apart && !within) partly.push_back(known);
  }
  std::string out;
  if (!outside.empty()) {
    out += " " + listed(outside) +
           (outside.size() == 1 ? " lies outside the grid: PROPAGATE gives it no light."
                                : " lie outside the grid: PROPAGATE gives them no light.");
  }
  if (!partly.empty()) {
    out += " " + listed(partly) + (partly.size() == 1 ? " lies" : " lie") +
           " partly outside the grid: PROPAGATE gives no light to what is outside.";
  }
  return out;
}

/// What would help a scene whose grid misses the wanted error.
std::string help(const Scene& scene, const LightingSettings& asked) {
  const std::string others = asked.grid.hasBounds ? "transport DIRECT would"
                                                  : "transport DIRECT, or bounds around "
                                                    "what is looked at, would";
  if (asked.lookup != Lookup::kCap) return "lookup CAP would";
  LightingSettings accurate = asked;
  accurate.quality = Quality::kAccurate;
  const bool mayBe = asked.k == 0.0 && asked.quality == Quality::kFast;
  if (mayBe && predictError(scene, scene.grid, resolved(accurate)).value_or(1.0) <= wantedError(asked))
    return "quality ACCURATE would";
  if (ErrorPredictor(scene, resolved(asked)).ofTouching(scene.grid) > wantedError(asked))
    return "lights with textures farther from what they nearly touch would";
  const Expected<GridChoice> finer = tryGrids(scene, asked, 1, kMaxCellsPerAxis);
  if (finer.ok() && finer->reached) {
    return std::to_string(finer->tried.back().cells) + " cells would (" + percentText(finer->tried.back().error) +
           "), or " + others;
  }
  return others;
}

/// How the cells in use came about, where they are the server's choice and those that it would choose now.
std::string chosen(const LightingSettings& asked, const GridChoice& choice, double error) {
  const std::string wanted = percentText(wantedError(asked));
  const int cells = longestOf(choice.grid);
  if (!choice.reached) return edge(cells) + " reach " + percentText(error) + ", and " + wanted + " is wanted: ";
  if (choice.tried.size() == 1) {
    return edge(cells) + (asked.grid.automatic ? ", the fewest" : ", the default") + ": predicted error " +
           percentText(error) + ", wanted " + wanted + ".";
  }
  const GridChoice::Tried& before = choice.tried[choice.tried.size() - 2];
  return edge(cells) + ": " + std::to_string(before.cells) + " are predicted to miss " + wanted + " (" +
         percentText(before.error) + "), " + std::to_string(cells) + " reach " + percentText(error) + ".";
}

std::string gathered(const Scene& scene, const LightingSettings& asked, double error,
                     const std::optional<GridCorrection>& correction) {
  const int cells = longestOf(scene.grid);
  const std::string wanted = percentText(wantedError(asked));
  const bool reached = error <= wantedError(asked);
  if (choosesCells(asked.grid) && correction && correction->least == cells) {
    return edge(cells) + ": measured " + percentText(correction->error) + " with " +
           std::to_string(correction->missed) + ", wanted " + wanted + "; predicted error " + percentText(error) + ".";
  }
  if (choosesCells(asked.grid)) {
    const Expected<GridChoice> choice = chooseGrid(scene, asked, correction ? correction->least : 0);
    if (choice.ok() && longestOf(choice->grid) == cells) {
      const std::string text = chosen(asked, *choice, error);
      return choice->reached ? text : text + help(scene, asked) + ".";
    }
    const std::string now = choice.ok() ? "; fitted now it would have " + std::to_string(longestOf(choice->grid)) : "";
    return edge(cells) + ", from when the grid was last fitted" + now + ": predicted error " + percentText(error) +
           ", wanted " + wanted + ".";
  }
  const std::string given = edge(cells) + ", as asked for: predicted error " + percentText(error);
  return reached ? given + "." : given + ", and " + wanted + " is wanted: " + help(scene, asked) + ".";
}

}  // namespace

Forecast forecast(const Scene& scene, const LightingSettings& asked, const std::optional<GridCorrection>& correction) {
  LightingSettings options = resolved(asked);
  const bool automatic = asked.transport == Transport::kAuto;
  if (automatic) options.transport = scene.options.transport;
  const int cells = longestOf(scene.grid);
  Forecast out{expectedError(options, cells), ""};
  switch (options.transport) {
    case Transport::kAuto:
      break;
    case Transport::kPropagate:
      out.choice = edge(cells) + ": PROPAGATE is as wrong with any grid; transport GATHER or DIRECT would be right." +
                   lightsLeftOut(scene);
      break;
    case Transport::kDirect:
      out.error = directError(scene, options);
      out.choice = "DIRECT looks at the lights, whatever the grid: expected error " + percentText(out.error) + ".";
      break;
    case Transport::kGather: {
      const std::optional<double> predicted = predictError(scene, scene.grid, options);
      out.error = predicted.value_or(out.error);
      out.choice = predicted ? gathered(scene, asked, *predicted, correction)
                             : edge(cells) +
                                   ": the scene gives nothing to predict from, so the expected error is that "
                                   "of a light in a room, " +
                                   percentText(out.error) + ".";
      if (!looksAtLights(scene)) break;
      out.error = directError(scene, options);
      out.choice = "Frames and probes look at the lights themselves, for shadows and bounces: expected error " +
                   percentText(out.error) + " of what nothing is in the way of. Volumes: " + out.choice;
      break;
    }
  }
  if (automatic) {
    const TransportChoice now = chooseTransport(scene);
    out.choice = std::string("Transport ") + (options.transport == Transport::kDirect ? "DIRECT: " : "GATHER: ") +
                 (now.transport == options.transport ? now.reason : "from when objects last came or went") + ". " +
                 out.choice;
  }
  return out;
}

}  // namespace lpv
