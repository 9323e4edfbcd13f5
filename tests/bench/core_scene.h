#pragma once
// Scenes for the benches, and a blocking way to run a tick.

#include <string>
#include <vector>

#include "engine/engine.h"
#include "scene/scene.h"

namespace lpv::bench {

/// The engine on the first device; exits with a message when there is none.
Engine& engine();

/// One tick, start to end; exits with a message when it fails.
TickResult tick(TickRequest request);

/// The mesh of 33,446 triangles: Stanford's Lucy where LPV_BENCH_LUCY names the PLY file, else a bumpy sphere with as
/// many triangles. About 1 m high.
MeshPtr statue();

struct NamedMesh {
  std::string name;
  MeshPtr mesh;
};

/// The five that the paper's Table 1 has as lights, statue() the last of them.
std::vector<NamedMesh> paperMeshes();

/// A closed box of 4 x 3 x 4 m as the room, and one light of `mesh` at `position`.
Scene roomWith(const MeshPtr& mesh, const glm::dvec3& position, int cells);

/// A point of that room, the `i`th of many that are spread evenly.
glm::dvec3 spreadInRoom(int i);

/// That room lit by `lights` spheres, which shrink as they become more, so that their area does not grow: GATHER,
/// without shadows and bounces. The first is "light".
Scene roomOfLights(int lights, int cells);

/// `scene` with its light moved.
ScenePtr movedTo(const Scene& scene, const glm::dvec3& position);

/// Seconds of one stage of a report, 0 when it did not run.
double secondsOf(const TickReport& report, Stage stage);

}  // namespace lpv::bench
