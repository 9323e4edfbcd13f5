#include "gpu/voxelize/pair_families.h"

#include <cmath>
#include <limits>
#include <random>

namespace lpv::test {

namespace {

constexpr float kUnit = 1.0F / 256.0F;  // the lattice, cells

/// Changes every triangle of a random set.
template <typename Change>
std::vector<Triangle> changed(std::vector<Triangle> triangles, std::uint32_t seed, Change change) {
  std::mt19937 random(seed + 1);
  for (std::size_t i = 0; i < triangles.size(); ++i) change(triangles[i], int(i), random);
  return triangles;
}

float uniform(std::mt19937& random) { return std::uniform_real_distribution<float>(0.0F, 1.0F)(random); }

float longest(const glm::ivec3& dims) { return float(std::max({dims.x, dims.y, dims.z})); }

/// Slivers of widths 1e-1 .. 1e-10 of a cell, 12 cells long.
std::vector<Triangle> slivers(int count, const glm::ivec3& dims, std::uint32_t seed) {
  return changed(randomTriangles(count, dims, 12.0F, 0.0F, seed), seed, [](Triangle& t, int i, std::mt19937& random) {
    const glm::vec3 beside(uniform(random), uniform(random), uniform(random));
    t[2] = glm::mix(t[0], t[1], uniform(random)) + std::pow(10.0F, -1.0F - float(i % 10)) * beside;
  });
}

/// Within axis-aligned planes: on cell faces, one unit beside them, and halfway.
std::vector<Triangle> facePlanes(int count, const glm::ivec3& dims, std::uint32_t seed) {
  return changed(randomTriangles(count, dims, 6.0F, 0.25F, seed), seed, [&](Triangle& t, int i, std::mt19937& random) {
    const int axis = i % 3;
    const float beside = std::array{0.0F, 0.0F, kUnit, -kUnit, 0.5F}[std::size_t(i) % 5];
    const float layer = float(int(random() % unsigned(dims[axis] + 3))) - 1.0F;
    for (glm::vec3& p : t) p[axis] = layer + beside;
  });
}

/// One edge along a cell edge, the third corner anywhere on half cells.
std::vector<Triangle> edgesOnCellEdges(int count, const glm::ivec3& dims, std::uint32_t seed) {
  return changed(randomTriangles(count, dims, 8.0F, 0.5F, seed), seed, [](Triangle& t, int i, std::mt19937&) {
    t[0] = glm::round(t[0]);
    const float length = glm::round(8.0F * t[1].x) / 8.0F;
    t[1] = t[0];
    t[1][i % 3] += length == 0.0F ? 1.0F : length;
  });
}

/// x + y + z = k and x - y + 2 z = k through cell corners, then a unit beside.
std::vector<Triangle> diagonals(int count, const glm::ivec3& dims, std::uint32_t seed) {
  return changed(randomTriangles(count, dims, 7.0F, 1.0F, seed), seed, [&](Triangle& t, int i, std::mt19937& random) {
    const float k = float(int(random() % unsigned(dims.x + dims.y)));
    for (glm::vec3& p : t) {
      p.z = i % 2 == 0 ? k - p.x - p.y : 2.0F * p.x - p.y - 0.5F * k;
      if (i % 4 >= 2) p.z += kUnit * float(int(random() % 3) - 1);
    }
  });
}

/// Normals with two largest components alike: planes that hold a direction (1, -1, *) or (1, 1, *).
std::vector<Triangle> axisTies(int count, const glm::ivec3& dims, std::uint32_t seed) {
  return changed(randomTriangles(count, dims, 6.0F, kUnit, seed), seed, [](Triangle& t, int i, std::mt19937& random) {
    const float side = random() % 2 == 0 ? 1.0F : -1.0F;
    const int a = i % 3, b = (i + 1) % 3;
    for (int k = 1; k < 3; ++k) t[std::size_t(k)][b] = t[0][b] + side * (t[std::size_t(k)][a] - t[0][a]);
  });
}

/// Corners of one line of the lattice, moved by less than the snap can tell: segments; every fourth one is a point.
std::vector<Triangle> segmentsAndPoints(int count, const glm::ivec3& dims, std::uint32_t seed) {
  return changed(randomTriangles(count, dims, 4.0F, 0.125F, seed), seed, [](Triangle& t, int i, std::mt19937& random) {
    const glm::vec3 step = i % 4 == 0 ? glm::vec3(0.0F) : t[1] - t[0];
    t[1] = t[0] + step;
    t[2] = t[0] - 2.0F * step;
    for (glm::vec3& p : t) p += 0.4F * kUnit * (glm::vec3(uniform(random), uniform(random), uniform(random)) - 0.5F);
  });
}

/// Corners halfway between lattice points, and one float before and after: which way they snap decides.
std::vector<Triangle> ulps(int count, const glm::ivec3& dims, std::uint32_t seed) {
  return changed(randomTriangles(count, dims, 4.0F, 1.0F, seed), seed, [](Triangle& t, int, std::mt19937& random) {
    for (glm::vec3& p : t) {
      for (int k = 0; k < 3; ++k) {
        p[k] -= 0.5F * kUnit;
        const auto by = random() % 3;
        if (by > 0) p[k] = std::nextafter(p[k], by == 1 ? -1e9F : 1e9F);
      }
    }
  });
}

/// Half of them wholly outside, many just so.
std::vector<Triangle> outside(int count, const glm::ivec3& dims, std::uint32_t seed) {
  return changed(randomTriangles(count, dims, 3.0F, 0.5F, seed), seed, [&](Triangle& t, int i, std::mt19937&) {
    for (glm::vec3& p : t) p[i % 3] += i % 2 == 0 ? 0.6F * float(dims[i % 3]) : -0.6F * float(dims[i % 3]);
  });
}

PairFamily plain(const std::string& name, float size, float lattice) {
  return {name, [=](int count, const glm::ivec3& dims, std::uint32_t seed) {
            return randomTriangles(count, dims, size, lattice, seed);
          }};
}

}  // namespace

std::vector<Triangle> randomTriangles(int count, const glm::ivec3& dims, float size, float lattice,
                                      std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  const auto point = [&] { return glm::vec3(uniform(random), uniform(random), uniform(random)); };
  std::vector<Triangle> out;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 centre = (glm::vec3(dims) + 2.0F) * point() - 1.0F;
    Triangle t;
    for (glm::vec3& p : t) {
      p = centre + size * (point() - 0.5F);
      if (lattice > 0.0F) p = glm::round(p / lattice) * lattice;
    }
    out.push_back(t);
  }
  return out;
}

const std::vector<PairFamily>& pairFamilies() {
  static const std::vector<PairFamily> families = {
      plain("small", 0.7F, 0.0F),
      plain("on cell corners", 6.0F, 1.0F),
      plain("on half cells", 5.0F, 0.5F),
      plain("on the lattice", 3.0F, kUnit),
      plain("a few units", 0.02F, 0.0F),
      plain("less than a unit", 1e-3F, 0.0F),
      {"slivers", slivers},
      {"in face planes", facePlanes},
      {"edges on cell edges", edgesOnCellEdges},
      {"diagonal and slope-two planes", diagonals},
      {"axis ties", axisTies},
      {"segments and points", segmentsAndPoints},
      {"a float beside the tie of the snap", ulps},
      {"outside", outside},
      // Last, as they make up for what tiny triangles leave undone.
      plain("middling", 4.0F, 0.0F),
      plain("large", 20.0F, 0.0F),
      {"bigger than the grid", [](int count, const glm::ivec3& dims, std::uint32_t seed) {
         return randomTriangles(count, dims, 3.0F * longest(dims), 0.0F, seed);
       }}};
  return families;
}

PairVerdict compareFamilies(PairRig& rig, std::uint64_t decisions, const std::vector<glm::ivec3>& grids) {
  PairVerdict total;
  std::uint64_t turns = grids.size() * pairFamilies().size();
  for (const glm::ivec3& dims : grids) {
    for (const PairFamily& family : pairFamilies()) {
      // Of what is still to be done: tiny triangles make few decisions each and are cut off at some point.
      const std::uint64_t part = (decisions - std::min(decisions, total.decisions)) / turns-- + 1;
      PairVerdict verdict;
      int count = 32;  // then more and more at once, as a triangle makes from one to millions of decisions
      for (std::uint32_t seed = 1; verdict.decisions < part && seed <= 12 + part / 40000; ++seed) {
        verdict += rig.compare(family.make(count, dims, seed * 2654435761U), dims);
        count = std::min(2 * count, 8000);
      }
      EXPECT_EQ(verdict.missing, 0U) << family.name << ", of " << verdict.pairs;
      EXPECT_EQ(verdict.extra, 0U) << family.name << ", beside " << verdict.pairs;
      EXPECT_GT(verdict.pairs, 0U) << family.name;
      total += verdict;
    }
  }
  return total;
}

}  // namespace lpv::test
