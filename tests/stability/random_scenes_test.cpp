// Random scenes from a seed, LPV_STABILITY_SCENES of them (12, as with LPV_SHORT): properties that hold for every one.
// LPV_STABILITY_FIRST: the first seed (1).
// What fails is made smaller, light by light, before it is shown.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>

#include "reference/shadowed.h"
#include "reference/texel.h"
#include "reference/textures.h"
#include "stability/judge.h"

namespace lpv::stability {
namespace {

/// 1 to 4 lights of any shape, turned, stretched, mirrored, within the middle half of a unit cube.
Scene randomScene(Transport transport, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const std::vector<MeshPtr> meshes = {reference::quad(),           reference::pyramid(),
                                       reference::tube(),           reference::sphereOf(8, 6),
                                       reference::bumpySphere(300), reference::slivers(20, 1e-3, seed)};
  Scene scene = emptyScene(transport, 16);
  const int lights = 1 + int(random() % 4);
  for (int i = 0; i < lights; ++i) {
    Transform t;
    t.translation = {uniform(0.3, 0.7), uniform(0.3, 0.7), uniform(0.3, 0.7)};
    t.rotation = rotationFromEulerDegrees({uniform(-180, 180), uniform(-90, 90), uniform(-180, 180)});
    for (int axis = 0; axis < 3; ++axis) t.scale[axis] = uniform(0.05, 0.2) * (random() % 2 == 0 ? 1.0 : -1.0);
    Light& light = addLight(scene, "light" + std::to_string(i), meshes[random() % meshes.size()], t);
    light.radiance = glm::dvec3(std::exp(uniform(-3, 3)), std::exp(uniform(-3, 3)), std::exp(uniform(-3, 3)));
    light.twoSided = random() % 3 == 0;
  }
  return scene;
}

/// What is wrong with a scene; nothing where a property holds.
using Property = std::function<std::optional<std::string>(const Scene&)>;

/// The scene without every light that it fails without.
Scene shrunk(Scene scene, const Property& property) {
  for (bool smaller = true; smaller && scene.lights.size() > 1;) {
    smaller = false;
    for (const auto& [name, light] : scene.lights) {
      Scene less = scene;
      less.lights.erase(name);
      if (!property(less)) continue;
      scene = std::move(less);
      smaller = true;
      break;
    }
  }
  return scene;
}

std::string describe(const std::string& name, const Mesh& mesh, const Transform& transform) {
  const glm::dvec3 &p = transform.translation, &s = transform.scale;
  const glm::dquat& q = transform.rotation;
  std::ostringstream out;
  out << "  " << name << ": " << mesh.triangles.size() << " triangles at " << p.x << ' ' << p.y << ' ' << p.z
      << ", turned (w x y z) " << q.w << ' ' << q.x << ' ' << q.y << ' ' << q.z << ", scale " << s.x << ' ' << s.y
      << ' ' << s.z;
  return out.str();
}

std::string describe(const Scene& scene) {
  std::ostringstream out;
  for (const auto& [name, light] : scene.lights) {
    const glm::dvec3& r = light->radiance;
    out << describe(name, *light->mesh, light->transform) << ", radiance " << r.x << ' ' << r.y << ' ' << r.z
        << (light->twoSided ? ", two-sided\n" : "\n");
  }
  for (const auto& [name, surface] : scene.surfaces) out << describe(name, *surface->mesh, surface->transform) << '\n';
  return out.str();
}

/// The scene with a texture on every light, which are rectangles then.
Scene withTextures(Scene scene, std::uint32_t seed) {
  for (auto& [name, light] : scene.lights) {
    auto copy = std::make_shared<Light>(*light);
    copy->mesh = reference::quad();
    copy->texture = reference::noise(3 + int(seed % 5), 2 + int(seed % 3), seed);
    light = copy;
    ++seed;
  }
  return scene;
}

/// And with one to three turned boxes in the way of its lights.
Scene withBoxes(Scene scene, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  scene.options.visibility = Visibility::kOn;
  const int boxes = 1 + int(random() % 3);
  for (int i = 0; i < boxes; ++i) {
    auto box = std::make_shared<Surface>();
    box->name = "box" + std::to_string(i);
    box->mesh = reference::box(glm::dvec3(-0.5), glm::dvec3(0.5));
    box->transform.translation = {uniform(0.2, 0.8), uniform(0.2, 0.8), uniform(0.2, 0.8)};
    box->transform.rotation = rotationFromEulerDegrees({uniform(-180, 180), uniform(-90, 90), uniform(-180, 180)});
    for (int axis = 0; axis < 3; ++axis) box->transform.scale[axis] = uniform(0.03, 0.25);
    scene.surfaces[box->name] = box;
  }
  return scene;
}

/// Every triangle in pieces, each with what the texture is at its middle.
std::vector<glm::dvec3> truthOfTextures(const Scene& scene, const std::vector<reference::Receiver>& receivers) {
  constexpr int kPieces = 24;
  std::vector<reference::Emitter> parts;
  for (const auto& [name, light] : scene.lights) {
    Light plain = *light;
    plain.texture = nullptr;
    plain.mesh = reference::quadOf(kPieces);
    for (reference::Emitter& e : reference::emittersOf(scene.grid, plain).triangles) {
      e.radiance *= reference::bilinear(*light->texture, e.uvAt(glm::dvec3(1.0 / 3.0)));
      parts.push_back(e);
    }
  }
  return reference::irradiances(parts, receivers);
}

/// What is not within a box.
std::vector<reference::Receiver> outside(const std::vector<reference::Receiver>& receivers, const Scene& scene) {
  std::vector<reference::Receiver> out;
  for (const reference::Receiver& r : receivers) {
    const bool within = std::any_of(scene.surfaces.begin(), scene.surfaces.end(), [&r](const auto& named) {
      const glm::dvec3 there = glm::inverse(named.second->transform.worldFromObject()) * glm::dvec4(r.position, 1.0);
      return glm::all(glm::lessThan(glm::abs(there), glm::dvec3(0.51)));
    });
    if (!within) out.push_back(r);
  }
  return out;
}

class RandomScenes : public test::EngineTest {
 protected:
  using Change = std::function<Scene(Scene, std::uint32_t seed)>;
  static Scene asItIs(Scene scene, std::uint32_t) { return scene; }

  void expect(Transport transport, const Property& property, const Change& change = asItIs) {
    const char* given = std::getenv("LPV_SHORT") == nullptr ? std::getenv("LPV_STABILITY_SCENES") : nullptr;
    const char* begin = std::getenv("LPV_STABILITY_FIRST");
    const std::uint32_t count = given != nullptr ? std::uint32_t(std::atoi(given)) : 12;
    const std::uint32_t first = begin != nullptr ? std::uint32_t(std::atoi(begin)) : 1;
    for (std::uint32_t seed = first; seed < first + count; ++seed) {
      const Scene scene = change(randomScene(transport, seed), seed);
      if (!property(scene)) continue;
      const Scene least = shrunk(scene, property);
      ADD_FAILURE() << "seed " << seed << ": " << *property(least) << "\n" << describe(least);
      return;
    }
  }
  std::vector<glm::dvec3> irradiances(const Scene& scene, const std::vector<reference::Receiver>& receivers) {
    return seen(*lit(*engine_, scene), scene.options.lookup, receivers);
  }
};

std::optional<std::string> unless(double value, double bound, const char* what) {
  if (value <= bound) return std::nullopt;
  return std::string(what) + ": " + std::to_string(value) + ", allowed is " + std::to_string(bound);
}

TEST_F(RandomScenes, AreWhatTheClosedFormSaysWithDirect) {
  expect(Transport::kDirect, [this](const Scene& scene) {
    const auto receivers = receiversOf(scene);
    return unless(reference::errors(irradiances(scene, receivers), truth(scene, receivers)).raw, 0.003, "raw error");
  });
}

TEST_F(RandomScenes, AreNearTheClosedFormWithGather) {
  expect(Transport::kGather, [this](const Scene& scene) {
    const auto receivers = receiversOf(scene);
    return unless(reference::errors(irradiances(scene, receivers), truth(scene, receivers)).raw, 0.05, "raw error");
  });
}

// Broken by: a texture's mean in the place of its texels.
TEST_F(RandomScenes, WithTexturesAreWhatTheirTexelsSend) {
  expect(
      Transport::kGather,
      [this](const Scene& scene) {
        const auto receivers = receiversOf(scene);
        const auto want = truthOfTextures(scene, receivers);
        return unless(reference::errors(irradiances(scene, receivers), want).raw, 0.05, "raw error");
      },
      withTextures);
}

// Probes; lights are in 40,000 pieces, since boxes stand in lights as well as beside them: with 6,000 the truth itself
// is off by a tenth. Ours are 256 places of a light: one that is nearly hidden, or that its own far side hides,
// scatters by as much. Broken by: no shadows.
TEST_F(RandomScenes, ShadowsAreTheReferences) {
  expect(
      Transport::kDirect,
      [this](const Scene& scene) {
        const auto receivers =
            outside(reference::objectReceivers(scene.grid, reference::emittersOf(scene).triangles, 40), scene);
        const double triangles = double(reference::emittersOf(scene).triangles.size());
        const int pieces = int(std::clamp(std::sqrt(40000.0 / triangles), 2.0, 60.0));  // a side of each
        const auto want = reference::ShadowedLights(scene, pieces).irradiances(receivers);
        return unless(reference::errors(irradiances(scene, receivers), want).raw, 0.2, "raw error");
      },
      withBoxes);
}

// Broken by: light of one light that depends on the others.
TEST_F(RandomScenes, AddUpWithDirect) {
  expect(Transport::kDirect, [this](const Scene& scene) -> std::optional<std::string> {
    const auto receivers = receiversOf(scene);
    std::vector<glm::dvec3> sum(receivers.size(), glm::dvec3(0.0));
    for (const auto& [name, light] : scene.lights) {
      Scene alone = scene;
      alone.lights = {{name, light}};
      const auto one = irradiances(alone, receivers);
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += one[i];
    }
    return unless(reference::errors(irradiances(scene, receivers), sum).raw, 1e-6, "more or less than the sum");
  });
}

// Broken by: lengths in metres where cells are meant.
TEST_F(RandomScenes, AreTheSameAtEveryScale) {
  expect(Transport::kGather, [this](const Scene& scene) -> std::optional<std::string> {
    Scene large = scene;
    large.grid.origin *= 1024.0;
    large.grid.cell *= 1024.0;
    for (auto& [name, light] : large.lights) {
      auto copy = std::make_shared<Light>(*light);
      copy->transform.translation *= 1024.0;
      copy->transform.scale *= 1024.0;
      light = copy;
    }
    const VolumePtr a = lit(*engine_, scene), b = lit(*engine_, large);
    for (std::size_t i = 0; i < a->layers.size(); ++i) {
      if (a->layers[i].coefficients != b->layers[i].coefficients) return "other numbers at 1024 times the size";
    }
    return std::nullopt;
  });
}

// Broken by: a place of the grid that is better than another.
TEST_F(RandomScenes, AreTheSameWhereverTheGridIs) {
  expect(Transport::kGather, [this](const Scene& scene) -> std::optional<std::string> {
    Scene there = scene;
    const glm::dvec3 away(64.1, -1e4, 16.3);
    there.grid.origin += away;
    for (auto& [name, light] : there.lights) {
      auto copy = std::make_shared<Light>(*light);
      copy->transform.translation += away;
      light = copy;
    }
    const auto receivers = receiversOf(scene);
    auto moved = receivers;
    for (reference::Receiver& r : moved) r.position += away;
    return unless(reference::errors(irradiances(there, moved), irradiances(scene, receivers)).raw, 1e-6, "elsewhere");
  });
}

// Broken by: light that is taken away where more is added.
TEST_F(RandomScenes, NoLightTakesFluenceAway) {
  expect(Transport::kGather, [this](const Scene& scene) -> std::optional<std::string> {
    Scene one = scene;
    for (auto& [name, light] : one.lights) {
      auto copy = std::make_shared<Light>(*light);
      copy->group = "all";
      light = copy;
    }
    const VolumePtr all = lit(*engine_, one);
    one.lights.erase(one.lights.begin());
    if (one.lights.empty()) return isSound(*all) ? std::nullopt : std::optional<std::string>("not sound");
    const VolumePtr less = lit(*engine_, one);
    for (std::size_t i = 0; i < all->layers[0].coefficients.size(); i += 4) {
      const float with = all->layers[0].coefficients[i], without = less->layers[0].coefficients[i];
      if (with < without * (1.0F - 1e-5F)) return "fluence " + std::to_string(without) + " -> " + std::to_string(with);
    }
    return std::nullopt;
  });
}

}  // namespace
}  // namespace lpv::stability
