// Lookups against the truth: what irradiance they make of exact moments, in double, first of those at the receiver
// itself, then of those at cell centres. Nothing of the product but its lookup CAP is measured: this is what any
// transport could have from so many numbers. Receivers, poses and the truth are accuracy_bench's.
//
//   lookup_bench [--mesh NAME] [--poses N] [--table FILE]
//
// LPV_BENCH_LUCY names the PLY file of Stanford's Lucy; a bumpy sphere of as many triangles takes its place.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <future>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>
#include <iostream>
#include <map>
#include <tuple>

#include "bench/rows.h"
#include "core_scene.h"
#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "reference/receivers.h"
#include "scene/light_around.h"
#include "scene/lookup.h"

namespace {

using namespace lpv;
using reference::Emitter;
using reference::Receiver;

/// L_lm of one colour, in the order of scene/light_around.h.
using Moments = Harmonics;

Moments momentsAt(const std::vector<Emitter>& emitters, const glm::dvec3& at) {
  LightAround light;
  for (const Emitter& e : emitters)
    light.addTriangle({e.corners[0] - at, e.corners[1] - at, e.corners[2] - at}, 1, glm::dvec3(1.0), glm::dmat3(1.0));
  Moments out{};
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = light.radiance[i].x;
  return out;
}

sh::Coefficients twoBands(const Moments& m) { return {m[0], m[1], m[2], m[3]}; }

/// What a band of L makes of irradiance (Ramamoorthi & Hanrahan 2001).
double lobe(std::size_t i) { return glm::pi<double>() * (i == 0 ? 1.0 : i < 4 ? 2.0 / 3.0 : 0.25); }

double convolved(const Moments& m, std::size_t first, std::size_t last, const glm::dvec3& n) {
  const Harmonics y = harmonicsOf(n);
  double sum = 0.0;
  for (std::size_t i = first; i < last; ++i) sum += lobe(i) * m[i] * y[i];
  return sum;
}

double sh2(const Moments& m, const glm::dvec3& n) { return irradianceSh2(twoBands(m), n); }
double cap(const Moments& m, const glm::dvec3& n) { return irradianceCap(twoBands(m), n); }
double sh3(const Moments& m, const glm::dvec3& n) { return std::max(0.0, convolved(m, 0, 9, n)); }

/// ZH3, hallucinated: band 2 about band 1's axis, by a fit of its size to theirs (Roughton et al. 2024, 3.4.3).
double zh3(const Moments& m, const glm::dvec3& n) {
  const glm::dvec3 axis(m[3], m[1], m[2]);
  const double length = glm::length(axis);
  if (!(m[0] > 0.0 && length > 0.0)) return sh2(m, n);
  const double ratio = length / m[0], along = glm::dot(axis, n) / length;
  const double zonal = m[0] * (0.08 * ratio + 0.6 * ratio * ratio);
  const double y = std::sqrt(5.0 / (16.0 * glm::pi<double>())) * (3.0 * along * along - 1.0);
  return std::max(0.0, convolved(m, 0, 4, n) + lobe(4) * zonal * y);
}

/// CAP, and what band 2 has more than the cap's own.
double capAndRest(const Moments& m, const glm::dvec3& n) {
  LightAround own;
  own.add({sh::fluence(twoBands(m)), sh::vectorIrradiance(twoBands(m))}, glm::dvec3(1.0));
  Moments rest{};
  for (std::size_t i = 4; i < rest.size(); ++i) rest[i] = m[i] - own.radiance[i].x;
  return std::max(0.0, cap(m, n) + convolved(rest, 4, 9, n));
}

struct Reading {
  std::string name;
  int coefficients = 4;
  double (*irradiance)(const Moments&, const glm::dvec3&) = nullptr;
};

const std::vector<Reading>& readings() {
  static const std::vector<Reading> all = {{"SH2", 4, sh2},
                                           {"CAP", 4, cap},
                                           {"ZH3 hallucinated", 4, zh3},
                                           {"SH3", 9, sh3},
                                           {"CAP and rest of band 2", 9, capAndRest}};
  return all;
}

/// Moments at cell centres, made as they are asked for.
class Field {
 public:
  Field(const std::vector<Emitter>& emitters, int cells) : emitters_(emitters), cells_(cells) {}

  Moments linear(const glm::dvec3& p) {
    const Place place = placeOf(p);
    Moments out{};
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 high(corner & 1, corner >> 1 & 1, corner >> 2);
      const glm::dvec3 w = glm::mix(1.0 - place.share, place.share, glm::dvec3(high));
      add(out, w.x * w.y * w.z, at(place.low + high));
    }
    return out;
  }
  /// Along each axis by the cubic with the values and slopes at both ends; products of slopes are left out.
  Moments hermite(const glm::dvec3& p) {
    const Place place = placeOf(p);
    Moments out{};
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 high(corner & 1, corner >> 1 & 1, corner >> 2);
      const glm::ivec3 cell = place.low + high;
      glm::dvec3 value, slope;
      for (int axis = 0; axis < 3; ++axis) {
        const double t = place.share[axis];
        value[axis] = high[axis] != 0 ? t * t * (3.0 - 2.0 * t) : 1.0 - t * t * (3.0 - 2.0 * t);
        slope[axis] = high[axis] != 0 ? t * t * (t - 1.0) : t * (1.0 - t) * (1.0 - t);
      }
      add(out, value.x * value.y * value.z, at(cell));
      for (int axis = 0; axis < 3; ++axis) {
        const double w = slope[axis] * value[(axis + 1) % 3] * value[(axis + 2) % 3];
        add(out, w, slopeAt(cell, axis));
      }
    }
    return out;
  }

 private:
  struct Place {
    glm::ivec3 low;
    glm::dvec3 share;
  };
  Place placeOf(const glm::dvec3& p) const {
    const glm::dvec3 centred = glm::clamp(p * double(cells_) - 0.5, glm::dvec3(0.0), glm::dvec3(cells_ - 1));
    const glm::ivec3 low = glm::min(glm::ivec3(glm::floor(centred)), glm::ivec3(cells_ - 2));
    return {low, centred - glm::dvec3(low)};
  }
  static void add(Moments& to, double weight, const Moments& m) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += weight * m[i];
  }
  glm::dvec3 centre(const glm::ivec3& cell) const { return (glm::dvec3(cell) + 0.5) / double(cells_); }
  const Moments& at(const glm::ivec3& cell) {
    const auto [found, isNew] = values_.try_emplace(key(cell));
    if (isNew) found->second = momentsAt(emitters_, centre(cell));
    return found->second;
  }
  /// Per cell.
  const Moments& slopeAt(const glm::ivec3& cell, int axis) {
    const auto [found, isNew] = slopes_.try_emplace(std::tuple_cat(key(cell), std::tuple(axis)));
    if (!isNew) return found->second;
    constexpr double kStep = 0.01;  // cells
    glm::dvec3 step(0.0);
    step[axis] = kStep / cells_;
    add(found->second, 0.5 / kStep, momentsAt(emitters_, centre(cell) + step));
    add(found->second, -0.5 / kStep, momentsAt(emitters_, centre(cell) - step));
    return found->second;
  }
  static std::tuple<int, int, int> key(const glm::ivec3& cell) { return {cell.x, cell.y, cell.z}; }

  const std::vector<Emitter>& emitters_;
  int cells_;
  std::map<std::tuple<int, int, int>, Moments> values_;
  std::map<std::tuple<int, int, int, int>, Moments> slopes_;
};

/// Where moments come from.
struct Source {
  std::string name;
  int cells = 0;           ///< 0: at the receiver
  bool slopes = false;     ///< kept beside the moments
};

std::vector<Source> sources() {
  return {{"at the receiver"}, {"16^3", 16}, {"16^3 with slopes", 16, true}, {"32^3", 32}, {"64^3", 64}};
}

/// KiB of three colours in half floats; 0 without a grid.
double kibOf(const Source& source, int coefficients) {
  return std::pow(source.cells, 3.0) * 3.0 * 2.0 * coefficients * (source.slopes ? 4.0 : 1.0) / 1024.0;
}

struct Receivers {
  std::vector<Receiver> at;
  std::vector<glm::dvec3> truth;
};

/// One light in one pose, in a unit cube: walls, and points two cells and more of 64^3 and of 16^3 from it.
struct Lit {
  std::vector<Emitter> emitters;
  std::array<Receivers, 3> receivers;
};

/// As accuracy_bench places it on 64^3 cells.
Lit litBy(const MeshPtr& mesh, int pose, std::size_t objects) {
  constexpr int kCells = 64;
  Scene scene;
  scene.grid = {glm::dvec3(0.0), 1.0 / kCells, glm::ivec3(kCells)};
  auto lamp = std::make_shared<Light>();
  lamp->name = "lamp";
  lamp->mesh = mesh;
  const glm::dvec3 size = mesh->bounds.extent();
  Transform& t = lamp->transform;
  t.scale = glm::dvec3(0.25 / std::max({size.x, size.y, size.z}));
  t.rotation = glm::angleAxis(0.7 * pose + 0.3, glm::normalize(glm::dvec3(1.0, 2.0 - pose, 0.5 * pose + 0.2)));
  const glm::dvec3 centre = t.rotation * (t.scale * mesh->bounds.centre());
  t.translation = glm::dvec3(0.5) - centre + glm::dvec3(0.37, 0.61, 0.83) * (double(pose) / kCells);
  scene.lights["lamp"] = lamp;
  Lit out;
  out.emitters = reference::emittersOf(scene).triangles;
  for (Emitter& e : out.emitters) e.radiance = glm::dvec3(1.0);
  const Grid coarse{glm::dvec3(0.0), 1.0 / 16, glm::ivec3(16)};
  out.receivers[0].at = reference::wallReceivers(scene.grid);
  out.receivers[1].at = reference::objectReceivers(scene.grid, out.emitters, objects);
  out.receivers[2].at = reference::objectReceivers(coarse, out.emitters, objects);
  for (Receivers& r : out.receivers) r.truth = reference::irradiances(out.emitters, r.at);
  return out;
}

std::vector<Moments> momentsOf(const Lit& lit, const Source& source, const std::vector<Receiver>& receivers) {
  Field field(lit.emitters, source.cells);
  std::vector<Moments> out;
  for (const Receiver& r : receivers) {
    out.push_back(source.cells == 0 ? momentsAt(lit.emitters, r.position)
                  : source.slopes   ? field.hermite(r.position)
                                    : field.linear(r.position));
  }
  return out;
}

struct Row {
  std::string mesh, source, reading;
  double kib = 0.0;
  std::array<reference::Errors, 3> errors;
};

std::vector<glm::dvec3> read(const Reading& reading, const std::vector<Moments>& moments,
                             const std::vector<Receiver>& receivers) {
  std::vector<glm::dvec3> out;
  for (std::size_t i = 0; i < receivers.size(); ++i)
    out.emplace_back(reading.irradiance(moments[i], receivers[i].normal));
  return out;
}

void append(std::vector<glm::dvec3>& to, const std::vector<glm::dvec3>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

std::vector<Row> rowsOf(const std::string& mesh, const std::vector<Lit>& poses, const Source& source) {
  std::vector<Row> rows;
  for (const Reading& reading : readings())
    rows.push_back({mesh, source.name, reading.name, kibOf(source, reading.coefficients), {}});
  for (std::size_t kind = 0; kind < rows[0].errors.size(); ++kind) {
    std::vector<glm::dvec3> truth;
    std::vector<std::vector<glm::dvec3>> seen(rows.size());
    for (const Lit& lit : poses) {
      const Receivers& receivers = lit.receivers[kind];
      const std::vector<Moments> moments = momentsOf(lit, source, receivers.at);
      append(truth, receivers.truth);
      for (std::size_t i = 0; i < rows.size(); ++i) append(seen[i], read(readings()[i], moments, receivers.at));
    }
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].errors[kind] = reference::errors(seen[i], truth);
  }
  return rows;
}

bench::Row rowOf(const Row& r) {
  return {r.mesh,
          "lookup",
          {{"moments", r.source}, {"lookup", r.reading}, {"kib", r.kib}},
          {{"raw_l2", r.errors[0].raw},
           {"worst", r.errors[0].worst},
           {"objects_raw_l2", r.errors[1].raw},
           {"objects_worst", r.errors[1].worst},
           {"objects_of_16_raw_l2", r.errors[2].raw}}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What lookups make of exact moments");
  std::string only, rowsFile;
  int poses = 2;
  app.add_option("--mesh", only, "Only the mesh whose name begins so");
  app.add_option("--poses", poses, "Poses that the errors are taken over");
  app.add_option("--rows", rowsFile, bench::kRowsHelp);
  CLI11_PARSE(app, argc, argv);
  bench::Rows rows(rowsFile, "no device: in double, on the CPU");
  for (const auto& [name, mesh] : bench::paperMeshes()) {
    if (name.rfind(only, 0) != 0) continue;
    std::vector<Lit> lit;
    for (int pose = 0; pose < poses; ++pose) lit.push_back(litBy(mesh, pose, 200));
    std::vector<std::future<std::vector<Row>>> parts;
    for (const Source& source : sources())
      parts.push_back(
          std::async(std::launch::async, [&lit, &name = name, source] { return rowsOf(name, lit, source); }));
    for (auto& part : parts) {
      for (const Row& row : part.get()) rows.add(rowOf(row));
    }
  }
  return 0;
}
