#pragma once
// Triangles on which pairs could go wrong (MATHS.md 6.8).

#include <functional>
#include <string>
#include <vector>

#include "gpu/voxelize/pair_rig.h"

namespace lpv::test {

/// Triangles about `size` cells large, corners on multiples of `lattice` cells (0: anywhere), around a grid.
std::vector<Triangle> randomTriangles(int count, const glm::ivec3& dims, float size, float lattice, std::uint32_t seed);

struct PairFamily {
  std::string name;
  std::function<std::vector<Triangle>(int count, const glm::ivec3& dims, std::uint32_t seed)> make;
};
const std::vector<PairFamily>& pairFamilies();

/// Compares family after family, grid after grid, each until it has its part of `decisions`.
PairVerdict compareFamilies(PairRig& rig, std::uint64_t decisions, const std::vector<glm::ivec3>& grids);

}  // namespace lpv::test
