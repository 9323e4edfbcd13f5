#include "unit/session/session_same.h"

#include <gtest/gtest.h>

#include <vector>

namespace lpv::test {
namespace {

void expectSame(const Light& a, const Light& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.mesh->hash, b.mesh->hash);
  EXPECT_EQ(a.mesh->positions, b.mesh->positions);
  EXPECT_EQ(a.transform, b.transform);
  EXPECT_EQ(a.radiance, b.radiance);
  EXPECT_EQ(a.power, b.power);
  EXPECT_EQ(a.texture ? a.texture->hash : "", b.texture ? b.texture->hash : "");
  EXPECT_EQ(a.twoSided, b.twoSided);
  EXPECT_EQ(a.enabled, b.enabled);
  EXPECT_EQ(a.group, b.group);
}

void expectSame(const Surface& a, const Surface& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.mesh->hash, b.mesh->hash);
  EXPECT_EQ(a.transform, b.transform);
  EXPECT_EQ(a.albedo, b.albedo);
  EXPECT_EQ(a.albedoTexture ? a.albedoTexture->hash : "", b.albedoTexture ? b.albedoTexture->hash : "");
  EXPECT_EQ(a.normalTexture ? a.normalTexture->hash : "", b.normalTexture ? b.normalTexture->hash : "");
  EXPECT_EQ(a.glossTexture ? a.glossTexture->hash : "", b.glossTexture ? b.glossTexture->hash : "");
  EXPECT_EQ(a.normalScale, b.normalScale);
  EXPECT_EQ(a.roughness, b.roughness);
  EXPECT_EQ(a.metalness, b.metalness);
  EXPECT_EQ(a.twoSided, b.twoSided);
}

template <typename T>
void expectSame(const std::vector<Versioned<T>>& a, const std::vector<Versioned<T>>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].revision, b[i].revision) << a[i].object->name;
    expectSame(*a[i].object, *b[i].object);
  }
}

}  // namespace

void expectSame(const Changes& a, const Changes& b) {
  EXPECT_EQ(a.snapshot, b.snapshot);
  EXPECT_EQ(a.revision, b.revision);
  expectSame(a.lights, b.lights);
  expectSame(a.surfaces, b.surfaces);
  EXPECT_EQ(a.cameras, b.cameras);
  ASSERT_EQ(a.deleted.size(), b.deleted.size());
  for (std::size_t i = 0; i < a.deleted.size(); ++i) {
    EXPECT_EQ(a.deleted[i].name, b.deleted[i].name);
    EXPECT_EQ(a.deleted[i].revision, b.deleted[i].revision);
    EXPECT_EQ(a.deleted[i].kind, b.deleted[i].kind);
  }
  EXPECT_EQ(a.options.has_value(), b.options.has_value());
  EXPECT_EQ(a.grid, b.grid);
}

}  // namespace lpv::test
