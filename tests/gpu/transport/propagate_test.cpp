// Propagation against the 30-face form in double (K&D 2010; MATHS.md 3a, 6.6).

#include "reference/propagate.h"

#include <cmath>

#include "gpu/support/stage_rig.h"
#include "lpv/transport/propagate.h"
#include "reference/compare.h"

namespace lpv {
namespace {

class PropagateTest : public test::GlTest {};

const Palette kRedGreenBlue{3, {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}, {}};

/// The GPU's sum of `injected` and its steps; `box` as given, else the whole grid.
reference::Field propagate(const reference::Field& injected, int iterations, bool clampFaces, CellBox box = {}) {
  LightField field(test::unitGrid(injected.dims), 3);
  const std::vector<glm::vec4> halo = test::haloOf(injected);
  const gpu::Buffer upload = test::bufferOf(halo);
  glCopyNamedBufferSubData(upload.id(), field.injected.buffer.id(), 0, 0, GLsizeiptr(upload.size()));
  // What an earlier tick left behind must not matter.
  for (FieldBuffer& step : field.pingPong) step.buffer.fill(0x42280000U);
  if (box.empty()) box = {glm::ivec3(0), injected.dims};
  Propagator propagator;
  StageClock clock;
  test::finish(propagator.run(field, box, iterations, clampFaces, {&clock}));
  return test::fieldOf(field.transported(), field, kRedGreenBlue);
}

/// Units of every piece while the device is known to take 1 s for `unitsPerSecond`, and a piece may take 3 ms.
std::vector<double> pieceSizes(const reference::Field& injected, int iterations, double unitsPerSecond,
                               reference::Field* out) {
  LightField field(test::unitGrid(injected.dims), 3);
  const gpu::Buffer upload = test::bufferOf(test::haloOf(injected));
  glCopyNamedBufferSubData(upload.id(), field.injected.buffer.id(), 0, 0, GLsizeiptr(upload.size()));
  Propagator propagator;
  StageClock clock;
  for (int i = 0; i < 2; ++i) clock.add(Stage::kPropagate, 1.0, unitsPerSecond);
  std::vector<double> sizes;
  GpuTask pieces = propagator.run(field, {glm::ivec3(0), injected.dims}, iterations, false, {&clock, 0.003});
  for (pieces.resume(); !pieces.done(); pieces.resume()) {
    if (pieces.pause().kind == Pause::Kind::kPiece) sizes.push_back(pieces.pause().units);
  }
  *out = test::fieldOf(field.transported(), field, kRedGreenBlue);
  return sizes;
}

double sumOfBand0(const reference::Field& field) {
  double sum = 0.0;
  for (const auto& cell : field.cells) sum += cell[0].x + cell[1].x + cell[2].x;
  return sum;
}

// A piece takes what the device can do in its time, down to one layer of cells, and where it is cut changes no bit.
// Broken by: whole iterations as pieces; slabs that overlap, or leave layers out; reading a step that is half written.
TEST_F(PropagateTest, PiecesAreCutToTheirTime) {
  const glm::ivec3 dims(12, 10, 17);
  const reference::Field injected = test::randomField(dims, 0);
  constexpr double kLayer = 12 * 10 * 3;
  reference::Field whole, part;
  EXPECT_EQ(pieceSizes(injected, 5, 1e9, &whole).size(), 1U) << "a fast device does it at once";
  for (const double layers : {0.5, 1.0, 3.0, 6.0, 40.0}) {
    const std::vector<double> sizes = pieceSizes(injected, 5, layers * kLayer / 0.003, &part);
    double sum = 0.0;
    for (const double units : sizes) {
      EXPECT_LE(units, std::max(1.0, layers) * kLayer * (1.0 + 1e-9)) << layers;
      sum += units;
    }
    EXPECT_EQ(sum, 5 * 17 * kLayer) << layers;
    for (std::size_t i = 0; i < whole.cells.size(); ++i) ASSERT_EQ(part.cells[i], whole.cells[i]) << layers;
  }
}

// Broken by: the sign of a01 or a10; b for a11; x and y exchanged; a halo index off by one; steps not cleared.
TEST_F(PropagateTest, StencilIsTheThirtyFaceForm) {
  for (const glm::ivec3 dims : {glm::ivec3(11, 6, 9), glm::ivec3(1, 1, 1), glm::ivec3(8, 4, 4), glm::ivec3(3, 17, 2)}) {
    const reference::Field injected = test::randomField(dims, 1);
    for (const int iterations : {1, 2, 7}) {
      const reference::Field want = reference::propagateFaces(injected, iterations);
      EXPECT_LE(reference::relativeL2(propagate(injected, iterations, false), want), 1e-6)
          << dims.x << " " << iterations;
    }
  }
}

// Broken by: clamping the sum of faces instead of each; no clamp.
TEST_F(PropagateTest, ClampedFormIsKaplanyansClampPerFace) {
  const reference::Field injected = test::randomField({9, 7, 8}, 2, 1);
  for (const int iterations : {1, 2, 7}) {
    const reference::Field want = reference::propagateFaces(injected, iterations, true);
    EXPECT_LE(reference::relativeL2(propagate(injected, iterations, true), want), 1e-5) << iterations;
  }
}

// Every step keeps the sum of band 0 until light reaches the border: n steps hold (n + 1) times it.
// Broken by: a00 = 0.166.
TEST_F(PropagateTest, EnergyIsKeptUntilTheBorder) {
  const reference::Field injected = test::randomField({15, 15, 15}, 3, 6);
  const double before = sumOfBand0(injected);
  for (const int iterations : {1, 3, 6})
    EXPECT_NEAR(sumOfBand0(propagate(injected, iterations, false)) / ((iterations + 1) * before), 1.0, 1e-6);
  EXPECT_LT(sumOfBand0(propagate(injected, 60, false)), 0.8 * 61 * before);
}

// Light goes one cell per step: computing only the grown box loses nothing. Broken by: growing too late.
TEST_F(PropagateTest, TheGrowingBoxLosesNothing) {
  reference::Field injected({14, 13, 12});
  injected.at({9, 3, 6}) = test::randomField({1, 1, 1}, 4).cells[0];
  injected.at({10, 4, 6}) = test::randomField({1, 1, 1}, 5).cells[0];
  const CellBox box{{9, 3, 6}, {11, 5, 7}};
  for (const bool clampFaces : {false, true}) {
    for (const int iterations : {1, 4, 15}) {
      const reference::Field want = propagate(injected, iterations, clampFaces);
      EXPECT_EQ(reference::largestDifference(propagate(injected, iterations, clampFaces, box), want), 0.0)
          << iterations;
    }
  }
}

// Double against single precision over a long run (MATHS.md 6.6), and nothing that is not a number.
TEST_F(PropagateTest, AThousandStepsStayFiniteAndClose) {
  const reference::Field injected = test::randomField({8, 8, 8}, 6);
  const reference::Field got = propagate(injected, 1000, false), want = reference::propagateStencil(injected, 1000);
  for (const auto& cell : got.cells) {
    for (const auto& c : cell) ASSERT_TRUE(std::isfinite(c.x + c.y + c.z + c.w));
  }
  EXPECT_LE(reference::relativeL2(got, want), 1e-4);
}

}  // namespace
}  // namespace lpv
