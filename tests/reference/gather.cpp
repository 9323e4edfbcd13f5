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
  return {pair.area,   pair.directed.direction, pair.areaRadiance, brightest, brightest * pair.areaCentroid / pair.area,
          std::nullopt};
}

/// The bin of a part: that of its direction of emission, or of its normal where directions cancel.
int binOf(const FluxPair& pair, const glm::dvec3& direction, const glm::dvec3& normal) {
  return normalBin(unitOr(direction / pair.area, normal));
}

void merge(Vpls54& into, const Vpls54& from) {
  for (const auto& [bin, vpl] : from) into[bin] += vpl;
}

/// One receiver: all VPLs, all colours.
std::array<Coefficients, 3> incidentFrom(const std::vector<Vpl>& vpls, const glm::dvec3& x, double cellEdge) {
  std::array<Coefficients, 3> sum{};
  for (const Vpl& vpl : vpls) {
    const VplMoments m = momentsOf(vpl, x, cellEdge);
    const glm::dvec3& d = m.vectorIrradiance;
    const Coefficients moments(m.fluence, d.y, d.z, d.x);
    for (int colour = 0; colour < 3; ++colour) sum[std::size_t(colour)] += vpl.radiance()[colour] * moments;
  }
  for (Coefficients& c : sum) c *= basis(glm::dvec3(1.0));  // (Y00, Y1 three times)
  return sum;
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
  spread.reset();
  return *this;
}

std::vector<CellVpls> cellVpls(const Grid& grid, const std::vector<Emitter>& emitters) {
  std::map<Key, CellVpls> cells;
  for (const FluxPair& pair : fluxPairs(grid, emitters)) {
    Vpl vpl = vplOf(pair);
    if (!(vpl.weight > 0.0)) continue;
    const Emitter& e = emitters[pair.emitter];
    CellVpls& cell = cells[keyOf(pair.cell)];
    cell.cell = pair.cell;
    cell.bins[binOf(pair, vpl.areaNormal, e.normal())] += vpl;
    if (!e.twoSided) continue;
    vpl.areaNormal = -vpl.areaNormal;
    cell.bins[binOf(pair, vpl.areaNormal, -e.normal())] += vpl;
  }
  std::vector<CellVpls> out;
  for (auto& [key, cell] : cells) out.push_back(std::move(cell));
  return out;
}

VplTree::VplTree(const std::vector<CellVpls>& leaves) {
  for (const CellVpls& leaf : leaves) root_.push_back({leaf.cell, 1, leaf.bins, {}});
  while (root_.size() > 1) root_ = parentsOf(std::move(root_));
  for (Node& node : root_) settle(node);
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

void VplTree::settle(Node& node) {
  for (auto& [bin, vpl] : node.bins) vpl.spread = spreadOf(vpl);
  for (Node& child : node.children) settle(child);
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
  const double size = glm::length(vpl.areaNormal);
  if (vpl.area <= size) return 0.0;
  // Twice the power over 2 pi: the integral of sqrt(size^2 u^2 + e^2) over u in [-1, 1], which grows with e.
  const auto power = [&](double e) {
    return std::hypot(size, e) + (size > 0.0 ? e * e / size * std::asinh(size / e) : e);
  };
  double low = 0.0;
  double high = vpl.area;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (power(middle) > vpl.area ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

double intensityOf(const Vpl& vpl, const glm::dvec3& w) {
  const double facing = -glm::dot(vpl.areaNormal, w);
  return 0.5 * std::max(0.0, facing + std::hypot(facing, vpl.spread ? *vpl.spread : spreadOf(vpl)));
}

VplMoments momentsOf(const Vpl& vpl, const glm::dvec3& x, double cellEdge) {
  const glm::dvec3 d = vpl.position() - x;
  const double r = glm::length(d);
  const glm::dvec3 w = d / std::max(r, 1e-3 * cellEdge);
  const double fluence = intensityOf(vpl, w) / std::max(r * r, cellEdge * cellEdge / 4.0);
  return {fluence, fluence * w};
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
