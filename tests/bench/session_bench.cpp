// What a session does under its lock while one light of a large scene moves at 60 Hz: CPU time of the calling thread
// for each edit and each snapshot, at the largest scene that the limits allow by default and at ten times that.
//   session_bench [EDITS]      1200 by default: 20 s of a light that moves
// An edit is Session::apply on a session without readers: no tick begins, so that nearly all of it is under the lock. A
// snapshot is Document::takeUpdate, which is what a tick does under the lock before it copies the scene without it.

#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "session/document/scene_copy.h"
#include "unit/session/session_rig.h"

namespace lpv::bench {
namespace {

double threadSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/// CPU time of `work`, microseconds.
template <typename Work>
double microsecondsOf(const Work& work) {
  const double begun = threadSeconds();
  work();
  return 1e6 * (threadSeconds() - begun);
}

double quantile(std::vector<double> sample, double share) {
  std::sort(sample.begin(), sample.end());
  return sample[std::min(sample.size() - 1, std::size_t(share * double(sample.size())))];
}

void print(const char* what, int lights, int surfaces, const std::vector<double>& microseconds) {
  std::printf("%-9s %6d lights %6d surfaces: median %8.1f us, p99 %8.1f us\n", what, lights, surfaces,
              quantile(microseconds, 0.5), quantile(microseconds, 0.99));
}

Limits limitsFor(int lights, int surfaces) {
  Limits limits = test::Rig::quick();
  limits.maxLights = lights;
  limits.maxSurfaces = surfaces;
  limits.maxOperationsPerEdit = lights + surfaces;
  return limits;
}

Edit room(int lights, int surfaces) {
  std::vector<Operation> all;
  for (int i = 0; i < lights; ++i) all.push_back(test::createLight("light" + std::to_string(i)));
  for (int i = 0; i < surfaces; ++i) all.push_back(test::createSurface("surface" + std::to_string(i)));
  return test::editOf(std::move(all));
}

Edit move(int step) { return test::editOf({test::moveLight("light7", glm::dvec3(1e-4 * step, 0.0, 0.0))}); }

void measureEdits(int lights, int surfaces, int edits) {
  test::Rig rig(limitsFor(lights, surfaces));
  const auto session = rig.session();
  if (!session->apply({}, room(lights, surfaces)).status.ok()) std::abort();
  std::vector<double> took;
  for (int i = 0; i < edits; ++i) {
    Edit edit = move(i);
    took.push_back(microsecondsOf([&] {
      if (!session->apply({}, std::move(edit)).status.ok()) std::abort();
    }));
  }
  print("edit", lights, surfaces, took);
}

void measureSnapshots(int lights, int surfaces, int edits) {
  const Limits limits = limitsFor(lights, surfaces);
  const Blobs blobs(limits);
  Document document(LightingSettings(), limits, test::nameOfContent);
  if (!document.apply(room(lights, surfaces), blobs)) std::abort();
  SceneCopy copy;
  copy.apply(document.takeUpdate());
  std::vector<double> took;
  for (int i = 0; i < edits; ++i) {
    if (!document.apply(move(i), blobs)) std::abort();
    SceneUpdate update;
    took.push_back(microsecondsOf([&] { update = document.takeUpdate(); }));
    copy.apply(update);
  }
  print("snapshot", lights, surfaces, took);
}

}  // namespace
}  // namespace lpv::bench

int main(int argc, char** argv) {
  const int edits = argc > 1 ? std::max(1, std::atoi(argv[1])) : 1200;
  for (const int scale : {1, 10}) {
    lpv::bench::measureEdits(scale * 1024, scale * 4096, edits);
    lpv::bench::measureSnapshots(scale * 1024, scale * 4096, edits);
  }
  return 0;
}
