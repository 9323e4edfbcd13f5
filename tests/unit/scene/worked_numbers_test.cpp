// Section 8 of MATHS.md against what the code computes: every row of its tables has a computation here, every
// computation a row, and both agree to the last digit printed. Broken by: a digit of a value changed; a row left out; a
// row too many.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "reference/direct_texels.h"
#include "reference/gather.h"
#include "reference/ground_truth.h"
#include "reference/inject.h"
#include "reference/meshes.h"
#include "reference/propagate.h"
#include "reference/receivers.h"
#include "reference/sh.h"
#include "reference/volume.h"
#include "reference/vpls.h"
#include "scene/emitter_list.h"
#include "scene/error_goal.h"
#include "scene/lookup.h"
#include "scene/scene.h"
#include "scene/sh.h"
#include "scene/workload.h"
#include "shaders/layout.h"

namespace lpv {
namespace {

using reference::Field;
using reference::Vpl;
using Values = std::map<std::string, double>;

const glm::dvec3 kX(1, 0, 0), kZ(0, 0, 1);

/// n^3 cells about the origin, `edge` metres each.
Grid cube(int n, double edge) { return {glm::dvec3(-0.5 * n * edge), edge, glm::ivec3(n)}; }

Light lightOf(const MeshPtr& mesh) {
  Light light;
  light.mesh = mesh;
  light.radiance = glm::dvec3(2.0);
  return light;
}

// --- 1

void addConventions(Values& out) {
  out["Y00"] = sh::kY0;
  out["Y1 factor"] = sh::kY1;
  out["c0"] = sh::kLobe0;
  out["c1"] = sh::kLobe1;
  const Expected<Grid> grid = fitGrid({}, {glm::dvec3(0.0), {2.0, 1.0, 0.5}});
  out["fitted cell edge"] = grid->cell;
  out["fitted cells along y"] = grid->dims.y;
  Light light = lightOf(reference::quad());
  light.power = glm::dvec3(10.0);
  out["radiance of 10 W"] = emittedRadiance(light).x;
}

// --- 2

void addInjection(Values& out) {
  const Grid grid = cube(8, 0.5);
  Light light = lightOf(reference::quad());
  light.transform.translation = {0.125, 0.125, 0.0};
  const std::vector<reference::Emitter> emitters = reference::emittersOf(grid, light).triangles;
  const reference::Counted counted = reference::injectCount(grid, emitters);
  const Field flux = reference::injectFlux(grid, emitters);
  const glm::ivec3 corner(3, 3, 4);
  double lit = 0.0, lobes = 0.0;
  for (const std::uint32_t n : counted.lobes) {
    lit += n > 0 ? 1.0 : 0.0;
    lobes += n;
  }
  const double power = reference::powerOf(emitters).x;
  out["lit cells"] = lit;
  out["lobes in all cells"] = lobes;
  out["COUNT L00 of the corner cell"] = counted.intensity.at(corner)[0].x;
  out["COUNT power / true power"] = reference::injectedPower(counted.intensity).x / power;
  out["FLUX L00 of the corner cell"] = flux.at(corner)[0].x;
  out["FLUX L10 of the corner cell"] = flux.at(corner)[0].z;
  out["FLUX power / true power"] = reference::injectedPower(flux).x / power;
  out["FLUX fixed-point unit"] = std::ldexp(1.0, -layout::kFluxBits);
  for (const int degrees : {90, 120})
    out["lobes over " + std::to_string(degrees) + " degrees"] = reference::lobesOver(glm::radians(double(degrees)));
}

// --- 3a

void addPropagation(Values& out) {
  const reference::FaceSolidAngles angles = reference::faceSolidAngles();
  out["solid angle of the far face"] = angles.front;
  out["solid angle of a side face"] = angles.side;
  const reference::Stencil s = reference::stencil();
  out["a00"] = s.a00;
  out["a01"] = s.a01;
  out["a10"] = s.a10;
  out["a11"] = s.a11;
  out["b"] = s.b;
  out["share of band 1 that a step keeps"] = 2.0 * s.a11 + 4.0 * s.b;

  Field lobe(glm::ivec3(5));
  lobe.at(glm::ivec3(2)) = {reference::lobe(kZ), {}, {}};
  const Field next = reference::stepStencil(lobe);
  out["u0 one cell ahead"] = next.at({2, 2, 3})[0].x;
  out["uz one cell ahead"] = next.at({2, 2, 3})[0].z;
  out["u0 one cell behind"] = next.at({2, 2, 1})[0].x;
  const reference::Product product = reference::productOf(next, 0.5);
  out["L00 one cell ahead"] = product.incident.at({2, 2, 3})[0].x;
  out["L10 one cell ahead"] = product.incident.at({2, 2, 3})[0].z;
  out["L00 one cell behind"] = product.incident.at({2, 2, 1})[0].x;
  double clamped = 0.0;
  for (const auto& cell : reference::stepFaces(lobe, true).cells) clamped += cell[0].x;
  out["band 0 after one clamped step"] = clamped / reference::lobe(kZ).x;
}

// --- 3b

Vpl vplOf(double area, const glm::dvec3& areaNormal) {
  Vpl vpl;
  vpl.area = vpl.weight = area;
  vpl.areaNormal = areaNormal;
  return vpl;
}

void addSpread(Values& out) {
  const double tilt = glm::radians(15.0);
  out["spread of two squares tilted by 15 degrees"] = reference::spreadOf(vplOf(2.0, {0, 0, 2.0 * std::cos(tilt)}));
  out["spread of two squares at right angles"] = reference::spreadOf(vplOf(2.0, {1, 0, 1}));
  const Vpl merged = vplOf(1.0, 0.8 * kZ);
  out["spread"] = reference::spreadOf(merged);
  out["I in front"] = reference::intensityOf(merged, -kZ);
  out["I at the side"] = reference::intensityOf(merged, kX);
  out["I behind"] = reference::intensityOf(merged, kZ);
}

/// A square of one cell facing +z in the middle of the cell.
Vpl squareIn(const glm::ivec3& cell) {
  Vpl vpl = vplOf(1.0, kZ);
  vpl.areaRadiance = glm::dvec3(1.0);
  vpl.weightedPosition = glm::dvec3(cell) + 0.5;
  vpl.settleInCell(1.0);
  return vpl;
}

/// The same square as two triangles, its middle in the origin.
std::array<std::array<glm::dvec3, 3>, 2> square() {
  const glm::dvec3 a(-0.5, -0.5, 0), b(0.5, -0.5, 0), c(0.5, 0.5, 0), d(-0.5, 0.5, 0);
  return {{{a, b, c}, {a, c, d}}};
}

/// phi and D on the axis of that square, `height` cells above it: the VPL's, and the closed form's.
reference::VplMoments momentsAt(double height) {
  return reference::momentsOf(squareIn(glm::ivec3(0)), glm::dvec3(0.5) + height * kZ, 1.0);
}

reference::Moments exactMomentsAt(double height) {
  reference::Moments sum;
  for (const auto& corners : square()) {
    const reference::Moments part = reference::triangleMoments(corners, height * kZ);
    sum.fluence += part.fluence;
    sum.vectorIrradiance += part.vectorIrradiance;
  }
  return sum;
}

void addKernel(Values& out) {
  for (const auto& [name, height] : {std::pair("2 cells", 2.0), {"1 cell", 1.0}}) {
    out[std::string("phi at ") + name] = momentsAt(height).fluence;
    out[std::string("exact phi at ") + name] = exactMomentsAt(height).fluence;
    out[std::string("D at ") + name] = glm::length(momentsAt(height).vectorIrradiance);
    out[std::string("exact D at ") + name] = glm::length(exactMomentsAt(height).vectorIrradiance);
  }
  // Flat and seen along its normal, all of the second order of phi is -3/2 tr(covariance) / r^4.
  out["regularisation at 2 cells"] = (0.25 - momentsAt(2.0).fluence) / (1.5 / 6.0 / 16.0);
  out["phi at 1/4 cell"] = momentsAt(0.25).fluence;
  out["D at 1/4 cell"] = glm::length(momentsAt(0.25).vectorIrradiance);
  const auto stored = reference::incidentFrom({squareIn(glm::ivec3(0))}, glm::dvec3(0.5) + 0.25 * kZ, 1.0);
  out["D stored at 1/4 cell"] = glm::length(sh::vectorIrradiance(stored[0]));
  out["exact D at 1/4 cell"] = glm::length(exactMomentsAt(0.25).vectorIrradiance);
}

void addTree(Values& out) {
  constexpr int kUp = 40;  // the bin of +z
  const auto tree = [&](const glm::ivec3& a, const glm::ivec3& b) {
    return reference::VplTree({{a, {{kUp, squareIn(a)}}}, {b, {{kUp, squareIn(b)}}}});
  };
  out["bin of +z"] = reference::normalBin(kZ);
  const std::vector<Vpl> one = tree({0, 0, 0}, {1, 0, 0}).seenFrom(glm::ivec3(8), glm::ivec3(11), 0.0);
  out["merged A"] = one.at(0).area;
  out["merged p.x"] = one.at(0).position().x;
  out["merged covariance xx"] = one.at(0).extent()[0][0];
  out["merged covariance yy"] = one.at(0).extent()[1][1];
  const reference::VplTree away = tree({8, 0, 0}, {9, 0, 0});
  out["VPLs with opening ratio 2.749"] = double(away.seenFrom(glm::ivec3(0), glm::ivec3(3), 2.749).size());
  out["VPLs with opening ratio 2.75"] = double(away.seenFrom(glm::ivec3(0), glm::ivec3(3), 2.75).size());
}

// --- 3c

/// The square of one cell as the only entry of a tree, or as two triangles, read by the near field; cells of 1 m.
EmitterList emitterOf(bool polygons) {
  reference::DirectLight light;
  light.radiance = glm::dvec3(1.0);
  if (polygons) {
    for (const auto& corners : square()) light.triangles.push_back(corners);
  } else {
    light.root.vpls = {{glm::dvec3(0.0), 1.0, kZ, squareIn(glm::ivec3(0)).extent(), glm::dvec3(1.0)}};
  }
  EmitterList lights;
  lights.grid = cube(8, 1.0);
  lights.grid.origin = glm::dvec3(0.0);
  lights.always = true;
  lights.texels = reference::directTexels({light}, kFastOpeningRatio);
  return lights;
}

double farFrom(double cells) {
  EmitterList lights;
  lights.grid = cube(1, 1.0);
  lights.emitterDistance = {float(cells)};
  return lights.farFromEmitters(glm::dvec3(0.0));
}

void addNearField(Values& out) {
  const EmitterList vpl = emitterOf(false), polygons = emitterOf(true);
  const glm::dvec3 x = 2.0 * kZ;
  out["E of the VPL, facing"] = vpl.irradiance(x, -kZ).x;
  out["E of the polygons, facing"] = polygons.irradiance(x, -kZ).x;
  out["E of the VPL, horizon through it"] = vpl.irradiance(x, kX).x;
  out["E of the polygons, horizon through it"] = polygons.irradiance(x, kX).x;
  out["share of the volume at 2.25 cells"] = farFrom(2.25);
  out["share of the volume at 2.5 cells"] = farFrom(2.5);
}

// --- 4

void addLookup(Values& out) {
  /// SH of incident radiance of fluence 1 with |D| = rho towards +z.
  const auto incident = [](double rho) { return sh::fromBands(sh::kY0, sh::kY1 * rho * kZ); };
  const auto tilted = [](double degrees) {
    return glm::dvec3(std::sin(glm::radians(degrees)), 0.0, std::cos(glm::radians(degrees)));
  };
  out["SH2, rho .75, 0 degrees"] = irradianceSh2(incident(0.75), tilted(0.0));
  out["CAP, rho .75, 0 degrees"] = irradianceCap(incident(0.75), tilted(0.0));
  out["CAP, rho .75, 60 degrees"] = irradianceCap(incident(0.75), tilted(60.0));
  out["CAP, rho .75, 90 degrees"] = irradianceCap(incident(0.75), tilted(90.0));
  out["CAP, rho .75, 120 degrees"] = irradianceCap(incident(0.75), tilted(120.0));
  out["CAP, rho .3, 0 degrees"] = irradianceCap(incident(0.3), tilted(0.0));
}

// --- 5

void addTruth(Values& out) {
  double e = 0.0, phi = 0.0;
  for (const auto& corners : square()) {
    const glm::dvec3 seen[3] = {corners[0] - kZ, corners[1] - kZ, corners[2] - kZ};
    e += triangleIrradiance(seen, -kZ, 1);
    phi += reference::triangleSolidAngle(seen[0], seen[1], seen[2]);
  }
  out["E of the unit square"] = e;
  out["phi of the unit square"] = phi;
  const reference::Errors errors =
      reference::errors({glm::dvec3(1.2), glm::dvec3(2.2)}, {glm::dvec3(1.0), glm::dvec3(2.0)});
  out["raw relative L2"] = errors.raw;
  out["shape L2"] = errors.shape;
  out["worst"] = errors.worst;
}

void addExpectations(Values& out) {
  LightingSettings options;
  options.k = kFastOpeningRatio;
  out["expected, 32 cells, opening ratio 1.5"] = expectedError(options, 32);
  options.k = 1.0;
  out["expected, 32 cells, opening ratio 1"] = expectedError(options, 32);
  options.k = 6.0;
  out["expected, 64 cells, opening ratio 6"] = expectedError(options, 64);
  options.lookup = Lookup::kSh2;
  out["expected with SH2"] = expectedError(options, 64);
  options = {};
  options.maxError = 0.02;
  options.grid.automatic = true;
  out["cells chosen for a goal of .02"] = resolved(options).grid.longest;
  out["opening ratio chosen for a goal of .02"] = resolved(options).k;
  options.maxError = 0.013;
  options.k = 6.0;
  out["left for the grouping"] = groupingGoal(options, 64);

  Workload workload(LightingSettings{}, cube(32, 0.125));
  workload.add(lightOf(reference::quad()));
  out["columns met"] = workload.columns;
  out["lit cells estimated"] = workload.litCells;
  out["root of the tree's entries"] = workload.rootsOfEntries;
}

Values computed() {
  Values out;
  addConventions(out);
  addInjection(out);
  addPropagation(out);
  addSpread(out);
  addKernel(out);
  addTree(out);
  addNearField(out);
  addLookup(out);
  addTruth(out);
  addExpectations(out);
  return out;
}

// --- the document

struct Row {
  double value = 0.0;
  double lastDigit = 0.0;  ///< one unit of the last digit printed; 0 for a whole number
};

Row rowOf(const std::string& text) {
  const std::size_t exponentAt = text.find('e'), point = text.find('.');
  const double exponent = exponentAt == std::string::npos ? 0.0 : std::stod(text.substr(exponentAt + 1));
  const std::size_t digits = std::min(exponentAt, text.size());
  const double decimals = point == std::string::npos ? 0.0 : double(digits - point - 1);
  const bool whole = point == std::string::npos && exponentAt == std::string::npos;
  return {std::stod(text), whole ? 0.0 : std::pow(10.0, exponent - decimals)};
}

/// The cells of a table's line without the blanks around them; none of another line.
std::vector<std::string> cellsOf(const std::string& line) {
  if (line.empty() || line.front() != '|') return {};
  std::vector<std::string> cells;
  std::istringstream rest(line.substr(1));
  for (std::string cell; std::getline(rest, cell, '|');) {
    const std::size_t first = cell.find_first_not_of(' '), last = cell.find_last_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

/// The rows of section 8 by name.
std::map<std::string, Row> printed() {
  std::map<std::string, Row> rows;
  std::ifstream file(LPV_MATHS_MD);
  EXPECT_TRUE(file.is_open()) << LPV_MATHS_MD;
  bool within = false;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("## ", 0) == 0) within = line.rfind("## 8.", 0) == 0;
    const std::vector<std::string> cells = cellsOf(line);
    if (!within || cells.empty() || cells[0] == "name" || cells[0].rfind("---", 0) == 0) continue;
    EXPECT_EQ(cells.size(), 2U) << line;
    if (cells.size() != 2) continue;
    EXPECT_TRUE(rows.emplace(cells[0], rowOf(cells[1])).second) << cells[0] << " is there twice";
  }
  return rows;
}

TEST(WorkedNumbers, AreWhatTheCodeComputes) {
  const Values values = computed();
  const std::map<std::string, Row> rows = printed();
  for (const auto& [name, row] : rows) {
    const auto value = values.find(name);
    if (value == values.end()) {
      ADD_FAILURE() << "no computation for the row " << name;
      continue;
    }
    const double within = std::max(0.5 * row.lastDigit, 1e-12 * std::abs(row.value));
    EXPECT_LE(std::abs(value->second - row.value), within * (1.0 + 1e-6))
        << name << ": printed " << row.value << ", computed " << std::setprecision(15) << value->second;
  }
  for (const auto& [name, value] : values)
    EXPECT_EQ(rows.count(name), 1U) << "no row for | " << name << " | " << std::setprecision(13) << value << " |";
}

}  // namespace
}  // namespace lpv
