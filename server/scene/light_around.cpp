#include "scene/light_around.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene/emitter_walk.h"
#include "scene/parted_patches.h"
#include "scene/reflected_light.h"

namespace lpv {
namespace {

constexpr double kGoldenAngle = 2.399963229728653;
/// Triangles are cut until they look like caps: |vector irradiance| over fluence is this or more, or so often.
constexpr double kLikeACap = 0.999;
constexpr int kMostCuts = 7;
/// Rec. 709.
const glm::dvec3 kLuminance(0.2126, 0.7152, 0.0722);

struct Corners {
  glm::dvec3 of[3];
};

void addCut(LightAround& to, const Corners& t, int sides, const glm::dvec3& radiance, const glm::dmat3& turn,
            int cuts) {
  Arriving light = triangleMoments(t.of, sides);
  if (!(light.fluence > 0.0)) return;
  if (cuts == kMostCuts || glm::length(light.vectorIrradiance) >= kLikeACap * light.fluence) {
    light.vectorIrradiance = turn * light.vectorIrradiance;
    return to.add(light, radiance);
  }
  const glm::dvec3 &a = t.of[0], &b = t.of[1], &c = t.of[2];
  const glm::dvec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
  for (const Corners& part : {Corners{{a, ab, ca}}, Corners{{ab, b, bc}}, Corners{{ca, bc, c}}, Corners{{ab, bc, ca}}})
    addCut(to, part, sides, radiance, turn, cuts + 1);
}

/// Adds up what stands for one light.
struct Around {
  glm::dvec3 radiance;
  LightAround sum = {};
  glm::dmat3 back{1.0};

  void turned(const glm::dmat3& turn) { back = glm::transpose(turn) / glm::length(turn[0]); }
  void triangle(const glm::dvec3 (&corners)[3], int sides) { sum.addTriangle(corners, sides, radiance, back); }
  void vpl(const SeenVpl& seen) {
    Arriving light = lightFromVpl(seen.record, seen.from, seen.sides);
    light.vectorIrradiance = back * light.vectorIrradiance;
    sum.add(light, radiance * seen.colour);
  }
};

/// A light with something in its way: what all of it loses in the mean, and beside that what its points lose more or
/// less than the mean, each where it is seen.
LightAround shadowed(const LightAround& open, const std::vector<LightVisibility::PointSeen>& points) {
  glm::dvec3 all(0.0), seen(0.0);
  for (const auto& p : points) {
    all += p.fluence;
    seen += p.fluence * p.share;
  }
  if (seen == all) return open;
  glm::dvec3 mean(1.0), scale(0.0);
  const double y0 = harmonicsOf(glm::dvec3(0.0, 0.0, 1.0))[0];
  for (int c = 0; c < 3; ++c) {
    if (!(all[c] > 0.0)) continue;
    mean[c] = seen[c] / all[c];
    scale[c] = open.radiance[0][c] / y0 / all[c];
  }
  LightAround out;
  for (std::size_t i = 0; i < out.radiance.size(); ++i) out.radiance[i] = mean * open.radiance[i];
  for (const auto& p : points) out.addFrom(p.direction, scale * p.fluence * (p.share - mean));
  return out;
}

LightAround fromLights(const EmitterList& list, const glm::dvec3& at) {
  LightAround out;
  const glm::dvec3 x = list.grid.gridFromWorld(at);
  for (std::size_t i = 0; i < std::size_t(list.texels[0].x); ++i) {
    Around one{emitterRadiance(list, i)};
    seeLight(list, i, x, one);
    out.add(list.visibility == nullptr ? one.sum : shadowed(one.sum, list.visibility->pointsSeen(at, i)));
  }
  return out;
}

}  // namespace

Harmonics harmonicsOf(const glm::dvec3& w) {
  const double pi = glm::pi<double>();
  const double y0 = 0.5 / std::sqrt(pi), y1 = std::sqrt(0.75 / pi), y2 = std::sqrt(3.75 / pi);
  return {y0,
          y1 * w.y,
          y1 * w.z,
          y1 * w.x,
          y2 * w.x * w.y,
          y2 * w.y * w.z,
          std::sqrt(0.3125 / pi) * (3.0 * w.z * w.z - 1.0),
          y2 * w.x * w.z,
          0.5 * y2 * (w.x * w.x - w.y * w.y)};
}

void LightAround::add(const Arriving& light, const glm::dvec3& colour) {
  if (!(light.fluence > 0.0)) return;
  const double length = std::min(glm::length(light.vectorIrradiance), light.fluence), rho = length / light.fluence;
  const Harmonics y = harmonicsOf(length > 0.0 ? glm::normalize(light.vectorIrradiance) : glm::dvec3(0.0, 0.0, 1.0));
  // The cap's cosine is 2 rho - 1 (MATHS.md 4); the mean of P1 over it is rho, of P2 rho (2 rho - 1).
  const double bands[3] = {light.fluence, length, length * (2.0 * rho - 1.0)};
  for (std::size_t i = 0; i < radiance.size(); ++i) radiance[i] += bands[i == 0 ? 0 : i < 4 ? 1 : 2] * y[i] * colour;
}

void LightAround::addFrom(const glm::dvec3& direction, const glm::dvec3& fluence) {
  const Harmonics y = harmonicsOf(direction);
  for (std::size_t i = 0; i < radiance.size(); ++i) radiance[i] += y[i] * fluence;
}

void LightAround::addTriangle(const glm::dvec3 (&corners)[3], int sides, const glm::dvec3& colour,
                              const glm::dmat3& turn) {
  addCut(*this, {{corners[0], corners[1], corners[2]}}, sides, colour, turn, 0);
}

void LightAround::addPatch(const Patch& patch, const glm::dvec3& at, const glm::dvec3& colour) {
  const glm::dvec3 d = glm::dvec3(patch.position) - at;
  const double r2 = glm::dot(d, d), area = double(patch.area);
  if (patch.triangle && r2 < kNearPatch * area) {
    const auto& t = *patch.triangle;
    return addTriangle({glm::dvec3(t[0]) - at, glm::dvec3(t[1]) - at, glm::dvec3(t[2]) - at}, 1,
                       ownShare(patch) * colour, glm::dmat3(1.0));
  }
  const double r = std::sqrt(r2), towards = -glm::dot(glm::dvec3(patch.normal), d);
  if (!(r > 0.0 && towards > 0.0)) return;
  addFrom(d / r, area * towards / (r * (r2 + kPatchSizeOfArea * area)) * colour);
}

void LightAround::add(const LightAround& other) {
  for (std::size_t i = 0; i < radiance.size(); ++i) radiance[i] += other.radiance[i];
}

MainLight LightAround::mainLight() const {
  const auto bright = [this](std::size_t i) { return glm::dot(kLuminance, radiance[i]); };
  const glm::dvec3 d(bright(3), bright(1), bright(2));
  MainLight out;
  if (!(glm::length(d) > 0.0)) return out;
  out.direction = glm::normalize(d);
  const Harmonics y = harmonicsOf(out.direction);
  double squares = 0.0;
  for (std::size_t i = 0; i < radiance.size(); ++i) {
    out.irradiance += y[i] * radiance[i];
    squares += y[i] * y[i];
  }
  out.irradiance = glm::max(out.irradiance / squares, glm::dvec3(0.0));
  return out;
}

LightAnswer lightAround(const Volume& volume, Lookup lookup, const glm::dvec3& at, bool volumeOnly) {
  LightAnswer out;
  if (volume.direct != nullptr && !volumeOnly) {
    const EmitterList& list = *volume.direct;
    out.light = fromLights(list, at);
    if (list.reflected != nullptr) out.light.add(list.reflected->around(at, list.visibility.get()));
    return out;
  }
  const auto incident = incidentAt(volume, lookup, at);
  out.valid = incident.has_value();
  for (std::size_t i = 0; out.valid && i < 4; ++i) {
    for (int c = 0; c < 3; ++c) out.light.radiance[i][c] = (*incident)[std::size_t(c)][int(i)];
  }
  return out;
}

glm::dvec3 directionAround(int k, int count) {
  const double y = 1.0 - (2.0 * k + 1.0) / count, across = std::sqrt(1.0 - y * y), turn = kGoldenAngle * k;
  return {across * std::cos(turn), y, across * std::sin(turn)};
}

glm::dvec3 directionAbout(const glm::dvec3& n, int k, int count) {
  const double r2 = (k + 0.5) / count, turn = kGoldenAngle * k;
  const glm::dvec3 right =
      glm::normalize(glm::cross(n, std::abs(n.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0)));
  return std::sqrt(r2) * (std::cos(turn) * right + std::sin(turn) * glm::cross(n, right)) + std::sqrt(1.0 - r2) * n;
}

int backFacesAround(const Volume& volume, const glm::dvec3& at) {
  if (volume.direct == nullptr || volume.direct->visibility == nullptr) return 0;
  int backs = 0;
  for (int k = 0; k < kRaysAround; ++k) {
    const auto sight = volume.direct->visibility->sight(at, glm::dvec3(0.0), directionAround(k, kRaysAround));
    backs += sight && sight->hit.surface >= 0 && !sight->hit.front ? 1 : 0;
  }
  return backs;
}

}  // namespace lpv
