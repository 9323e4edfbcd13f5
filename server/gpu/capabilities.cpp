#include "gpu/capabilities.h"

#include <spdlog/spdlog.h>

#include <cstdlib>
#include <cstring>

#include "gpu/gl.h"

namespace lpv::gpu {

namespace {

std::string text(GLenum name) {
  const auto* chars = reinterpret_cast<const char*>(glGetString(name));
  return chars == nullptr ? std::string() : std::string(chars);
}

std::int64_t integer(GLenum name) {
  GLint64 value = 0;
  glGetInteger64v(name, &value);
  return value;
}

/// No query tells. LPV_EXACT_FILTER=0 in the environment: as on a GPU, for tests.
bool filterIsExact(bool software) {
  const char* asked = std::getenv("LPV_EXACT_FILTER");
  return software && (asked == nullptr || std::strcmp(asked, "0") != 0);
}

bool hasWord(const std::string& where, const char* word) { return where.find(word) != std::string::npos; }

}  // namespace

Capabilities probeCapabilities() {
  Capabilities c;
  c.renderer = text(GL_RENDERER);
  c.vendor = text(GL_VENDOR);
  c.version = text(GL_VERSION);
  c.software = hasWord(c.renderer, "llvmpipe") || hasWord(c.renderer, "softpipe") || hasWord(c.renderer, "SWR");
  c.exactFilter = filterIsExact(c.software);
  c.robust = integer(GL_RESET_NOTIFICATION_STRATEGY) == GL_LOSE_CONTEXT_ON_RESET;
  c.maxStorageBytes = integer(GL_MAX_SHADER_STORAGE_BLOCK_SIZE);
  c.maxTextureBufferTexels = integer(GL_MAX_TEXTURE_BUFFER_SIZE);
  c.max3dTextureEdge = int(integer(GL_MAX_3D_TEXTURE_SIZE));
  c.uniformAlignment = int(integer(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT));
  GLint groups = 0;
  glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &groups);
  c.maxComputeGroups = groups;
  spdlog::info("OpenGL {} on {} ({}): {}, storage block {} MiB, texture buffer {} texels, 3D edge {}", c.version,
               c.renderer, c.vendor, c.robust ? "robust" : "not robust", c.maxStorageBytes >> 20,
               c.maxTextureBufferTexels, c.max3dTextureEdge);
  return c;
}

}  // namespace lpv::gpu
