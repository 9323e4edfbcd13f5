// Options of later versions are refused by name, wrong ones as wrong.
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
  std::function<void(SessionOptions&)> change;
};

void expectCode(const std::vector<Refusal>& refusals, Code code) {
  for (const Refusal& r : refusals) {
    SessionOptions options;
    r.change(options);
    const Status status = checkOptions(options);
    EXPECT_EQ(status.code(), code) << r.field << ": " << status.message();
    EXPECT_EQ(status.field(), r.field);
    EXPECT_THAT(status.message(), HasSubstr(r.words));
  }
}

TEST(CheckOptions, TakesWhatThisVersionDoes) {
  EXPECT_TRUE(checkOptions({}).ok());
  SessionOptions gather;
  gather.quality = Quality::kAccurate;
  gather.k = 2.0;
  gather.method = InjectionMethod::kRaster;
  EXPECT_TRUE(checkOptions(gather).ok()) << checkOptions(gather).message();
  gather.transport = Transport::kDirect;
  EXPECT_TRUE(checkOptions(gather).ok()) << checkOptions(gather).message();
  SessionOptions options = SessionOptions::paper();
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

// When a feature is built, its line here moves to the test above.
TEST(CheckOptions, NamesFeaturesOfLaterVersions) {
  expectCode({{"visibility", "ON", [](SessionOptions& o) { o.visibility = Visibility::kOn; }},
              {"bounces", "2", [](SessionOptions& o) { o.bounces = 2; }},
              {"haze", "haze", [](SessionOptions& o) { o.haze = 0.1; }}},
             Code::kUnimplemented);
}

TEST(CheckOptions, NamesWhatDoesNotGoTogether) {
  expectCode({{"injection", "FLUX", [](SessionOptions& o) { o.injection = Injection::kCount; }},
              {"method", "DENSE",
               [](SessionOptions& o) {
                 o.transport = Transport::kDirect;
                 o.method = InjectionMethod::kDense;
                 o.denseSamples = 10;
               }}},
             Code::kInvalidArgument);
}

// Broken by: a lookup that stays.
TEST(FollowTransport, TakesInjectionAndLookupAlong) {
  SessionOptions options;
  options.transport = Transport::kPropagate;
  options.followTransport();
  EXPECT_EQ(options.injection, Injection::kCount);
  EXPECT_EQ(options.lookup, Lookup::kSh2);
  EXPECT_EQ(options, SessionOptions::paper());
  for (const Transport transport : {Transport::kGather, Transport::kDirect}) {
    options = SessionOptions::paper();
    options.transport = transport;
    options.followTransport();
    EXPECT_EQ(options.injection, Injection::kFlux);
    EXPECT_EQ(options.lookup, Lookup::kCap);
    EXPECT_TRUE(checkOptions(options).ok());
  }
}

TEST(DistanceRule, ComesFromQualityUnlessGiven) {
  SessionOptions options;
  EXPECT_EQ(options.distanceRule(), kFastRule);
  options.quality = Quality::kAccurate;
  EXPECT_EQ(options.distanceRule(), kAccurateRule);
  options.k = 3.5;
  EXPECT_EQ(options.distanceRule(), 3.5);
}

// A wrong value is wrong in every version: INVALID_ARGUMENT comes before UNIMPLEMENTED.
TEST(CheckOptions, NamesValuesOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expectCode({{"iterations", "-1", [](SessionOptions& o) { o.iterations = -1; }},
              {"iterations", "1000", [](SessionOptions& o) { o.iterations = 1001; }},
              {"bounces", "-1", [](SessionOptions& o) { o.bounces = -1; }},
              {"haze", "-0.5", [](SessionOptions& o) { o.haze = -0.5; }},
              {"haze", "nan", [=](SessionOptions& o) { o.haze = nan; }},
              {"k", "0.5", [](SessionOptions& o) { o.k = 0.5; }},
              {"k", "nan", [=](SessionOptions& o) { o.k = nan; }},
              {"max_error", "2.0", [](SessionOptions& o) { o.maxError = 2.0; }},
              {"dense_samples", "0", [](SessionOptions& o) { o.method = InjectionMethod::kDense; }}},
             Code::kInvalidArgument);
}

TEST(IterationsFor, DefaultsToTheLongestDimension) {
  Grid grid;
  grid.dims = {12, 40, 7};
  SessionOptions options;
  EXPECT_EQ(options.iterationsFor(grid), 40);
  options.iterations = 5;
  EXPECT_EQ(options.iterationsFor(grid), 5);
}

}  // namespace
}  // namespace lpv
