// Wrong options are refused by name.
#include "scene/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <vector>

namespace lpv {
namespace {

using testing::HasSubstr;

struct Refusal {
  const char* field;
  const char* words;
  std::function<void(LightingSettings&)> change;
};

void expectCode(const std::vector<Refusal>& refusals, Code code) {
  for (const Refusal& r : refusals) {
    LightingSettings options;
    r.change(options);
    const Status status = checkOptions(options);
    EXPECT_EQ(status.code(), code) << r.field << ": " << status.message();
    EXPECT_EQ(status.field(), r.field);
    EXPECT_THAT(status.message(), HasSubstr(r.words));
  }
}

TEST(CheckOptions, TakesWhatThisVersionDoes) {
  EXPECT_TRUE(checkOptions({}).ok());
  LightingSettings gather;
  gather.quality = Quality::kAccurate;
  gather.k = 2.0;
  gather.method = InjectionMethod::kRaster;
  EXPECT_TRUE(checkOptions(gather).ok()) << checkOptions(gather).message();
  gather.transport = Transport::kDirect;
  EXPECT_TRUE(checkOptions(gather).ok()) << checkOptions(gather).message();
  gather.visibility = Visibility::kOn;
  for (const int bounces : {kAutoBounces, 1, kMaxBounces}) {
    gather.bounces = bounces;
    EXPECT_TRUE(checkOptions(gather).ok()) << checkOptions(gather).message();
  }
  gather.haze = kMaxHaze;
  gather.hazeAbsorption = 1.0;
  gather.hazeAnisotropy = -kMaxHazeAnisotropy;
  EXPECT_TRUE(checkOptions(gather).ok()) << checkOptions(gather).message();
  LightingSettings options = LightingSettings::paper();
  options.lookup = Lookup::kNearest;
  options.iterations = kMaxIterations;
  options.clampFaces = true;
  options.visibility = Visibility::kOff;
  options.grid.dims = {8, 9, 10};
  EXPECT_TRUE(checkOptions(options).ok()) << checkOptions(options).message();
  options.injection = Injection::kFlux;
  options.denseSamples = 100;
  for (const InjectionMethod method : {InjectionMethod::kCompute, InjectionMethod::kRaster, InjectionMethod::kDense}) {
    options.method = method;
    EXPECT_TRUE(checkOptions(options).ok()) << checkOptions(options).message();
  }
}

TEST(CheckOptions, NamesWhatDoesNotGoTogether) {
  expectCode({{"haze", "PROPAGATE",
               [](LightingSettings& o) {
                 o.transport = Transport::kPropagate;
                 o.followTransport();
                 o.haze = 0.1;
               }},
              {"haze", "visibility OFF",
               [](LightingSettings& o) {
                 o.visibility = Visibility::kOff;
                 o.haze = 0.1;
               }},
              {"bounces", "PROPAGATE",
               [](LightingSettings& o) {
                 o.transport = Transport::kPropagate;
                 o.followTransport();
                 o.bounces = 1;
               }},
              {"visibility", "PROPAGATE",
               [](LightingSettings& o) {
                 o.transport = Transport::kPropagate;
                 o.followTransport();
                 o.visibility = Visibility::kOn;
               }},
              {"injection", "FLUX", [](LightingSettings& o) { o.injection = Injection::kCount; }},
              {"method", "DENSE",
               [](LightingSettings& o) {
                 o.transport = Transport::kDirect;
                 o.method = InjectionMethod::kDense;
                 o.denseSamples = 10;
               }}},
             Code::kInvalidArgument);
}

// Broken by: a lookup that stays.
TEST(FollowTransport, TakesInjectionAndLookupAlong) {
  LightingSettings options;
  options.transport = Transport::kPropagate;
  options.followTransport();
  EXPECT_EQ(options.injection, Injection::kCount);
  EXPECT_EQ(options.lookup, Lookup::kSh2);
  EXPECT_EQ(options, LightingSettings::paper());
  for (const Transport transport : {Transport::kGather, Transport::kDirect}) {
    options = LightingSettings::paper();
    options.transport = transport;
    options.followTransport();
    EXPECT_EQ(options.injection, Injection::kFlux);
    EXPECT_EQ(options.lookup, Lookup::kCap);
    EXPECT_TRUE(checkOptions(options).ok());
  }
}

TEST(DistanceRule, ComesFromQualityUnlessGiven) {
  LightingSettings options;
  EXPECT_EQ(options.openingRatio(), kFastOpeningRatio);
  options.quality = Quality::kAccurate;
  EXPECT_EQ(options.openingRatio(), kAccurateOpeningRatio);
  options.k = 3.5;
  EXPECT_EQ(options.openingRatio(), 3.5);
}

TEST(CheckOptions, NamesValuesOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expectCode({{"iterations", "-1", [](LightingSettings& o) { o.iterations = -1; }},
              {"iterations", "1000", [](LightingSettings& o) { o.iterations = 1001; }},
              {"bounces", "-2", [](LightingSettings& o) { o.bounces = -2; }},
              {"bounces", "33", [](LightingSettings& o) { o.bounces = 33; }},
              {"haze", "-0.5", [](LightingSettings& o) { o.haze = -0.5; }},
              {"haze", "nan", [=](LightingSettings& o) { o.haze = nan; }},
              {"haze_absorption", "1.5", [](LightingSettings& o) { o.hazeAbsorption = 1.5; }},
              {"haze_anisotropy", "0.95", [](LightingSettings& o) { o.hazeAnisotropy = 1.0; }},
              {"haze_anisotropy", "-0.95", [](LightingSettings& o) { o.hazeAnisotropy = -0.96; }},
              {"k", "0.5", [](LightingSettings& o) { o.k = 0.5; }},
              {"k", "nan", [=](LightingSettings& o) { o.k = nan; }},
              {"max_error", "2.0", [](LightingSettings& o) { o.maxError = 2.0; }},
              {"dense_samples", "0", [](LightingSettings& o) { o.method = InjectionMethod::kDense; }}},
             Code::kInvalidArgument);
}

TEST(IterationsFor, DefaultsToTheLongestDimension) {
  Grid grid;
  grid.dims = {12, 40, 7};
  LightingSettings options;
  EXPECT_EQ(options.iterationsFor(grid), 40);
  options.iterations = 5;
  EXPECT_EQ(options.iterationsFor(grid), 5);
}

}  // namespace
}  // namespace lpv
