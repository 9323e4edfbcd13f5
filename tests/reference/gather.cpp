#include "reference/gather.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "reference/inject.h"
#include "reference/sh.h"

namespace lpv::reference {
namespace {

/// Order of cells and blocks in maps: z first, as in memory.
using Key = std::array<int, 3>;
Key keyOf(const glm::ivec3& c) { return {c.z, c.y, c.x}; }

int third(double u) {
  if (u < -1.0 / 3.0) return 0;
  return u <= 1.0 / 3.0 ? 1 : 2;
}

Vpl vplOf(const FluxPair& pair) {
  const double brightest = std::max({pair.areaRadiance.x, pair.areaRadiance.y, pair.areaRadiance.z});
  const double weight = pair.glow.amount > 0.0 ? brightest / pair.glow.amount : 0.0;
  return {.area = pair.area,
          .areaNormal = pair.directed.direction,
          .areaRadiance = pair.areaRadiance,
          .weight = brightest,
          .weightedPosition = weight * pair.glow.first,
          .weightedSquare = weight * pair.glow.second};
}

/// The bin of a part: that of its direction of emission, or of its normal where directions cancel.
int binOf(const FluxPair& pair, const glm::dvec3& direction, const glm::dvec3& normal) {
  return normalBin(unitOr(direction / pair.area, normal));
}

void merge(Vpls54& into, const Vpls54& from) {
  for (const auto& [bin, vpl] : from) into[bin] += vpl;
}

}  // namespace

int normalBin(const glm::dvec3& n) {
  const glm::dvec3 size = glm::abs(n);
  int axis = size.y > size.x ? 1 : 0;
  if (size.z > size[axis]) axis = 2;
  const int iu = third(n[(axis + 1) % 3] / size[axis]);
  const int iv = third(n[(axis + 2) % 3] / size[axis]);
  const int face = 2 * axis + (n[axis] < 0.0 ? 1 : 0);
  return face * 9 + iv * 3 + iu;
}

Vpl& Vpl::operator+=(const Vpl& other) {
  area += other.area;
  areaNormal += other.areaNormal;
  areaRadiance += other.areaRadiance;
  weight += other.weight;
  weightedPosition += other.weightedPosition;
  weightedSquare += other.weightedSquare;
  settles = settles || other.settles;
  return *this;
}

void Vpl::settleInCell(double cellEdge) {
  const glm::dvec3 n = areaNormal / area;
  const double square = std::min(area, cellEdge * cellEdge) / 12.0;
  const glm::dmat3 flat = glm::dmat3(1.0) - glm::outerProduct(n, n);
  weightedSquare = weight * (square * flat + glm::outerProduct(position(), position()));
}

glm::dmat3 Vpl::extent() const { return weightedSquare / weight - glm::outerProduct(position(), position()); }

std::vector<CellVpls> cellVpls(const Grid& grid, const std::vector<Emitter>& emitters) {
  std::map<Key, CellVpls> cells;
  for (const FluxPair& pair : fluxPairs(grid, emitters)) {
    Vpl vpl = vplOf(pair);
    if (!(vpl.weight > 0.0)) continue;
    const Emitter& e = emitters[pair.emitter];
    vpl.settles = !e.texture && !e.thin;
    CellVpls& cell = cells[keyOf(pair.cell)];
    cell.cell = pair.cell;
    cell.bins[binOf(pair, vpl.areaNormal, e.normal())] += vpl;
    if (!e.twoSided) continue;
    vpl.areaNormal = -vpl.areaNormal;
    cell.bins[binOf(pair, vpl.areaNormal, -e.normal())] += vpl;
  }
  std::vector<CellVpls> out;
  for (auto& [key, cell] : cells) {
    for (auto& [bin, vpl] : cell.bins) {
      if (vpl.settles) vpl.settleInCell(grid.cell);
    }
    out.push_back(std::move(cell));
  }
  return out;
}

VplTree::VplTree(const std::vector<CellVpls>& leaves) {
  for (const CellVpls& leaf : leaves) root_.push_back({leaf.cell, 1, leaf.bins, {}});
  while (root_.size() > 1) root_ = parentsOf(std::move(root_));
}

std::vector<VplTree::Node> VplTree::parentsOf(std::vector<Node> nodes) {
  std::map<Key, Node> parents;
  for (Node& child : nodes) {
    const glm::ivec3 block = child.block / 2;
    Node& parent = parents[keyOf(block)];
    parent.block = block;
    parent.edge = 2 * child.edge;
    merge(parent.bins, child.bins);
    parent.children.push_back(std::move(child));
  }
  std::vector<Node> out;
  for (auto& [key, parent] : parents) out.push_back(std::move(parent));
  return out;
}

void VplTree::collect(const Node& node, const std::array<glm::dvec3, 2>& box, double k, std::vector<Vpl>& out) {
  const glm::dvec3 centre = (glm::dvec3(node.block) + 0.5) * double(node.edge);
  const double away = glm::length(centre - glm::clamp(centre, box[0], box[1]));
  if (node.edge == 1 || away > k * node.edge) {
    for (const auto& [bin, vpl] : node.bins) out.push_back(vpl);
    return;
  }
  for (const Node& child : node.children) collect(child, box, k, out);
}

std::vector<Vpl> VplTree::seenFrom(const glm::ivec3& low, const glm::ivec3& high, double k) const {
  std::vector<Vpl> out;
  for (const Node& root : root_) collect(root, {glm::dvec3(low) + 0.5, glm::dvec3(high) + 0.5}, k, out);
  return out;
}

double spreadOf(const Vpl& vpl) {
  const double n = glm::length(vpl.areaNormal), area = vpl.area;
  if (area <= n) return 0.0;
  // Power over pi is n + h^2 / (3 n) up to h = n, h + n^2 / (3 h) beyond.
  if (area <= 4.0 / 3.0 * n) return std::sqrt(3.0 * n * (area - n));
  return 0.5 * (area + std::sqrt(area * area - 4.0 / 3.0 * n * n));
}

namespace {

/// Mean of max(0, t) over [t - h, t + h], and its derivative by t.
struct Positive {
  double value = 0.0, slope = 0.0;
};

Positive positivePart(double t, double h) {
  if (t >= h) return {t, t > 0.0 ? 1.0 : 0.0};
  if (t <= -h) return {};
  return {(t + h) * (t + h) / (4.0 * h), (t + h) / (2.0 * h)};
}

/// A : grad grad of f at d, by the product rule, f a product of (a.d), d_k or 1, and r^-power.
struct Second {
  const glm::dmat3& a;  ///< symmetric
  const glm::dvec3& d;
  double r = 0.0;

  /// r^-power: its value, its gradient, its A : grad grad.
  double radial(int power) const { return std::pow(r, -power); }
  glm::dvec3 radialGradient(int power) const { return -double(power) * std::pow(r, -power - 2) * d; }
  double radialSecond(int power) const {
    const double trace = a[0][0] + a[1][1] + a[2][2];
    return power * std::pow(r, -power - 2) * ((power + 2) * glm::dot(d, a * d) / (r * r) - trace);
  }
  /// A : grad grad of (n.d) r^-power.
  double ofLinear(const glm::dvec3& n, int power) const {
    return 2.0 * glm::dot(n, a * radialGradient(power)) + glm::dot(n, d) * radialSecond(power);
  }
  /// The same of (n.d) d r^-power, component by component.
  glm::dvec3 ofQuadratic(const glm::dvec3& n, int power) const {
    glm::dvec3 out;
    for (int k = 0; k < 3; ++k) {
      glm::dvec3 e(0.0);
      e[k] = 1.0;
      const double product = glm::dot(n, d) * d[k], productSecond = 2.0 * glm::dot(n, a * e);
      const glm::dvec3 productGradient = n * d[k] + glm::dot(n, d) * e;
      out[k] = productSecond * radial(power) + 2.0 * glm::dot(productGradient, a * radialGradient(power)) +
               product * radialSecond(power);
    }
    return out;
  }
};

}  // namespace

double intensityOf(const Vpl& vpl, const glm::dvec3& w) {
  return positivePart(-glm::dot(vpl.areaNormal, w), spreadOf(vpl)).value;
}

VplMoments momentsOf(const Vpl& vpl, const glm::dvec3& x, double cellEdge) {
  const glm::dvec3 d = vpl.position() - x;
  const double r = glm::length(d);
  const glm::dvec3 w = d / std::max(r, 1e-3 * cellEdge);
  const Positive sent = positivePart(-glm::dot(vpl.areaNormal, w), spreadOf(vpl));
  const double kept = std::max(r, cellEdge / 2.0), fluence = sent.value / (kept * kept);
  const glm::dmat3 extent = vpl.extent();
  const double share = 2.5 * (extent[0][0] + extent[1][1] + extent[2][2]) / (kept * kept);
  const double weight = -0.5 * sent.slope / (1.0 + std::pow(share, 4.0));
  // Inside half a cell the powers of r are those of half a cell.
  const Second second{extent, d, kept};
  return {fluence + weight * second.ofLinear(vpl.areaNormal, 3),
          fluence * w + weight * second.ofQuadratic(vpl.areaNormal, 4)};
}

double irradianceOf(const glm::dvec3& flux, const Vpl& vpl, const glm::dvec3& x, const glm::dvec3& n, double cellEdge) {
  const glm::dvec3 d = vpl.position() - x;
  const double height = glm::dot(n, d), spread = std::sqrt(std::max(0.0, 3.0 * glm::dot(n, vpl.extent() * n)));
  const double above = positivePart(height, spread).value - height;
  if (height < -spread) return 0.0;
  return std::max(0.0, glm::dot(n, flux) + glm::length(flux) * above / std::max(glm::length(d), 1e-3 * cellEdge));
}

std::array<Coefficients, 3> incidentFrom(const std::vector<Vpl>& vpls, const glm::dvec3& x, double cellEdge) {
  std::array<Coefficients, 3> sum{};
  for (const Vpl& vpl : vpls) {
    const VplMoments m = momentsOf(vpl, x, cellEdge);
    const glm::dvec3& d = m.vectorIrradiance;
    const Coefficients moments(m.fluence, d.y, d.z, d.x);
    for (int colour = 0; colour < 3; ++colour) sum[std::size_t(colour)] += vpl.radiance()[colour] * moments;
  }
  for (Coefficients& c : sum) {
    const double fluence = std::max(0.0, c.x), flux = std::sqrt(c.y * c.y + c.z * c.z + c.w * c.w);
    const double possible = flux > fluence ? fluence / flux : 1.0;
    c = Coefficients(fluence, possible * c.y, possible * c.z, possible * c.w);
    c *= basis(glm::dvec3(1.0));  // (Y00, Y1 three times)
  }
  return sum;
}

Field gather(const Grid& grid, const std::vector<Emitter>& emitters, double k) {
  const VplTree tree(cellVpls(grid, emitters));
  Field incident(grid.dims);
  forEachCell((grid.dims + kReceiverBlock - 1) / kReceiverBlock, [&](const glm::ivec3& block) {
    const glm::ivec3 low = block * kReceiverBlock;
    const glm::ivec3 high = glm::min(low + kReceiverBlock, grid.dims) - 1;
    const std::vector<Vpl> vpls = tree.seenFrom(low, high, k);
    forEachCell(high - low + 1, [&](const glm::ivec3& cell) {
      incident.at(low + cell) = incidentFrom(vpls, grid.cellCentre(low + cell), grid.cell);
    });
  });
  return incident;
}

}  // namespace lpv::reference
