#pragma once
// GATHER in double (MATHS.md 3b): a tree of merged virtual point lights (VPLs), summed at every cell centre.
//
// A VPL is everything that emits within one block of the tree about normals of one bin; a block of one cell is a leaf.
// A node's VPLs are the sums of its children's, bin by bin, with the second moments of where they emit.

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <map>
#include <vector>

#include "reference/emitter.h"
#include "reference/field.h"
#include "scene/grid.h"

namespace lpv::reference {

/// Squares of the cube about the origin, 3 x 3 on each face.
inline constexpr int kNormalBins = 54;

/// The square that n points at: face = 2 x axis of the largest |component| (the lower axis where two are equal) + 1
/// where it is negative; on the face u and v are the components of axis + 1 and axis + 2 over the largest, cut at -1/3
/// and 1/3 (the middle has its edges): face x 9 + iv x 3 + iu.
int normalBin(const glm::dvec3& n);

/// Sums over parts of emitters. A part that emits from both sides is two, each with its own normal.
struct Vpl {
  double area = 0.0;                 ///< A, m^2
  glm::dvec3 areaNormal{0.0};        ///< N, m^2: area x unit direction of emission
  glm::dvec3 areaRadiance{0.0};      ///< W/sr: radiance x texture over the area
  double weight = 0.0;               ///< area x brightest channel, W/sr
  glm::dvec3 weightedPosition{0.0};  ///< weight x centroid of what glows, world
  glm::dmat3 weightedSquare{0.0};    ///< weight x (extent + centroid centroid^T)
  bool settles = false;              ///< of a light without texture that is not thin

  Vpl& operator+=(const Vpl& other);
  /// Takes what is there for a flat square in a cell of that edge, facing N: where its parts lie is not kept. What
  /// has a texture or is thin keeps it.
  void settleInCell(double cellEdge);
  glm::dmat3 extent() const;  ///< covariance of where light leaves, m^2
  glm::dvec3 position() const { return weightedPosition / weight; }  ///< p; there is none for a VPL that emits nothing
  glm::dvec3 radiance() const { return areaRadiance / area; }  ///< c
};

/// VPLs by bin.
using Vpls54 = std::map<int, Vpl>;

/// What one cell emits, and where.
struct CellVpls {
  glm::ivec3 cell{0};
  Vpls54 bins;
};

/// Every cell that emits, in memory order: the exact pairs of FLUX merged per (cell, bin). Parts that emit nothing are
/// left out.
std::vector<CellVpls> cellVpls(const Grid& grid, const std::vector<Emitter>& emitters);

/// Blocks of 1, 2, 4, .. cells along an edge, aligned to the grid's origin, up to one that holds the grid.
class VplTree {
 public:
  explicit VplTree(const std::vector<CellVpls>& leaves);  ///< settled in their cells

  /// The VPLs that the receivers of one block sum, `low` and `high` their outermost cells: those of the nodes with edge
  /// L whose block's centre is more than k L from the box spanned by the receivers' centres, and of the leaves where
  /// no node above was. k may be infinite: leaves only.
  std::vector<Vpl> seenFrom(const glm::ivec3& low, const glm::ivec3& high, double k) const;

 private:
  struct Node {
    glm::ivec3 block{0};  ///< in units of `edge`
    int edge = 1;  ///< cells
    Vpls54 bins;
    std::vector<Node> children;
  };
  static std::vector<Node> parentsOf(std::vector<Node> nodes);
  static void collect(const Node& node, const std::array<glm::dvec3, 2>& box, double k, std::vector<Vpl>& out);

  std::vector<Node> root_;  ///< one, or none where nothing emits
};

/// Receivers share their choice of nodes in blocks of this many cells along an edge, aligned to the grid's origin.
inline constexpr int kReceiverBlock = 4;

/// How far t = N.w spreads where directions were merged, as an area h: I(w) is the mean of max(0, t) over [t - h, t +
/// h]. Has the power pi A: by bisection of the integral's closed form; 0 where all directions are alike, A where they
/// cancel.
double spreadOf(const Vpl& vpl);
/// What it sends to a receiver that sees it in direction w (a departure from MATHS.md 3b.4, see
/// shaders/transport/vpls.glsl).
double intensityOf(const Vpl& vpl, const glm::dvec3& w);

/// Fluence and vector irradiance at x of one VPL of radiance 1 (MATHS.md 3b.4), expanded to second order in where it
/// emits: K + s / 2 extent : grad grad K with the kernels K of a flat emitter, N.d / r^3 and N.d d / r^4 (signs aside),
/// s = dI / dt, damped by 1 / (1 + (2.5 trace(extent) / r^2)^4). r is never less than half a cell there.
struct VplMoments {
  double fluence = 0.0;
  glm::dvec3 vectorIrradiance{0.0};
};
VplMoments momentsOf(const Vpl& vpl, const glm::dvec3& x, double cellEdge);

/// Irradiance at x on a surface with normal n of a VPL's flux (one side's, or both sides'): what of the VPL's extent is
/// above n's horizon counts.
double irradianceOf(const glm::dvec3& flux, const Vpl& vpl, const glm::dvec3& x, const glm::dvec3& n, double cellEdge);

/// SH of incident radiance at x of one light's VPLs, per colour: phi >= 0 and |D| <= phi, which a series cut off does
/// not know of.
std::array<Coefficients, 3> incidentFrom(const std::vector<Vpl>& vpls, const glm::dvec3& x, double cellEdge);

/// SH of incident radiance at every cell centre.
Field gather(const Grid& grid, const std::vector<Emitter>& emitters, double k);

}  // namespace lpv::reference
