#include "reference/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <sstream>

namespace lpv::reference {
namespace {

using Pixels = std::vector<glm::dvec3>;
using Bytes = std::vector<glm::u8vec3>;

TEST(Compare, NamesTheDifference) {
  const Pixels truth = {glm::dvec3(1.0), glm::dvec3(1.0)};
  const Pixels tested = {glm::dvec3(1.0), {1.0, 1.0, 1.6}};
  const PictureDifference d = compare(tested, truth, 0.5);
  EXPECT_NEAR(d.max, 0.6, 1e-15);
  EXPECT_NEAR(d.mean, 0.1, 1e-15);
  EXPECT_NEAR(d.nrmse, std::sqrt(0.36 / 6.0), 1e-15);
  EXPECT_EQ(d.shareBeyond, 0.5);
  EXPECT_EQ(compare(tested, truth, 0.5, {true, false}).max, 0.0);
}

TEST(Compare, DoesNotTakeNaNOrAnotherSizeForAgreement) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isinf(compare(Pixels{glm::dvec3(nan)}, Pixels{glm::dvec3(1.0)}, 0.1).max));
  EXPECT_THROW(compare(Pixels(3), Pixels(4), 0.1), std::invalid_argument);
  Field broken(glm::ivec3(1));
  broken.cells[0][1].z = nan;
  EXPECT_TRUE(std::isinf(largestDifference(broken, Field(glm::ivec3(1)))));
}

TEST(Compare, ShapeForgivesOneScale) {
  Field truth(glm::ivec3(2));
  Field scaled(glm::ivec3(2));
  for (std::size_t i = 0; i < truth.cells.size(); ++i) {
    truth.cells[i][0].x = 1.0 + double(i);
    scaled.cells[i][0].x = 3.0 * truth.cells[i][0].x;
  }
  EXPECT_NEAR(relativeL2(scaled, truth), 2.0, 1e-14);
  EXPECT_NEAR(shapeL2(scaled, truth), 0.0, 1e-14);
}

TEST(Compare, WritesThreePicturesSideBySide) {
  const std::string path = testing::TempDir() + "lpv_compare_test.ppm";
  writeDifference(path, 1, 2, Bytes(2, {9, 9, 9}), Bytes{{9, 9, 9}, {7, 9, 99}}, 4.0);
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  std::string expected = "P6\n3 2\n255\n";
  for (const int v : {9, 9, 9, 9, 9, 9, 0, 0, 0, 9, 9, 9, 7, 9, 99, 8, 0, 255}) expected += char(v);
  EXPECT_EQ(text.str(), expected);
  std::remove(path.c_str());
}

}  // namespace
}  // namespace lpv::reference
