#pragma once
// What is seen of a square lamp from points whose answer is known: penumbra, bars, a thin wall, the foot of a box.

#include <string>
#include <vector>

#include "reference/receivers.h"
#include "scene/scene.h"

namespace lpv::bench {

struct VisibilityTask {
  std::string name;
  Scene scene;  ///< with the light "lamp", a quad; its grid is set by withGrid
  std::vector<reference::Receiver> receivers;
  std::vector<double> truth;  ///< share of the lamp's area that each sees: double precision, 2,304 points of the lamp
};

/// A lamp of 1 m, 2.4 m over a floor, and a turned box in the air between: receivers in full light, penumbra and umbra.
VisibilityTask penumbra();
/// Bars 5 cm wide and `depth` m deep with gaps of 5 cm, 1 m before a wall, and a lamp of `lamp` m 1.5 m behind them.
VisibilityTask bars(double lamp, double depth = 0.05);
/// Points of a floor so far behind a wall that is one polygon, which stands askew by `degrees` between them and the
/// lamp: all see nothing.
VisibilityTask behindWall(double metres, double degrees);
/// Points of a floor so far from the foot of a box of .8 x .5 x .8 m, turned by `degrees`, under a lamp.
VisibilityTask atFoot(double metres, double degrees);

inline constexpr double kTaskEdge = 4.0;  ///< metres: edge of the tasks' grids
inline constexpr int kGridPlaces = 4;
/// The grid of `cells`^3 in one of kGridPlaces places, which differ by parts of a cell.
Grid taskGrid(int cells, int place);

/// Points of the lamp's area for a receiver, jittered in n x n strata, world space; the same for the same seed.
std::vector<glm::dvec3> lampPoints(const Scene& scene, int n, std::uint32_t seed);
glm::dvec3 lampNormal(const Scene& scene);

}  // namespace lpv::bench
