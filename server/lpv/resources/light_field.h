#pragma once
// GPU memory of one session's grid.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "gpu/readback.h"
#include "lpv/resources/field_grid.h"
#include "lpv/resources/incident_textures.h"
#include "lpv/resources/light_voxels.h"
#include "scene/grid.h"
#include "scene/options.h"

namespace lpv {

/// Coefficients of every cell and channel, with a halo of one zero cell around the grid (shaders/common/field.glsl).
struct FieldBuffer {
  FieldBuffer() = default;
  /// Its content is undefined.
  FieldBuffer(const std::string& label, const glm::ivec3& dims, int channels);
  gpu::Buffer buffer;
  gpu::BufferTexture texels;
};

/// What the memory's size follows from.
struct FieldInputs {
  glm::ivec3 dims{0};
  int channels = 1;
  int groups = 1;
  Transport transport = Transport::kPropagate;
  int guard = 0;
  int apart = 0;

  bool operator==(const FieldInputs&) const = default;
};

/// Everything whose size follows from FieldInputs, and what is in it where later stages add to that.
struct LightField {
  /// With what `transport` needs from the start. Contents are undefined but for `counters`.
  LightField(const Grid& grid, int channels, int groups = 1, Transport transport = Transport::kPropagate, int guard = 0,
             int apart = 0);

  Grid grid;
  int guard;     ///< cells of it on each side that are not part of the product
  int channels;  ///< 1..3 (lights.h, Palette)
  int groups;    ///< of lights: each has channels of its own, one group after the other
  int apart;     ///< 0, or half of the groups: the last, with the light of the others that receivers look at
                 ///< (EmittingLight::lookedAt)
  gpu::Buffer accumulators;  ///< words per cell (shaders/voxelize/accumulators.glsl), or a table of VPLs; all zero
 ///< between lights
  gpu::Buffer vplList;       ///< header and used entries of that table (layout::kVoxelCells)
  gpu::Readback vplHeader;
  gpu::Buffer lobeCounts;                  ///< float per cell: N of eq. 1, negative once divided by
  gpu::Buffer counters;                    ///< layout::Counters
  Transport transport;
  FieldBuffer injected;                    ///< emitted intensity of unit palette radiance, W/sr per W/(sr m^2)
  std::array<FieldBuffer, 2> pingPong;        ///< propagation goes back and forth between them; GATHER sums in one
  std::optional<FieldBuffer> sum;          ///< clamped form only
  int result = 0;  ///< which of `pingPong` holds the transported field (unless `sum` does): PROPAGATE flux through
                   ///< cells, else SH of incident radiance
  bool clamped = false;  ///< the transported field is in `sum`
  /// PROPAGATE: the lights whose voxels, added up, are what `injected` and `lobeCounts` hold; nothing where that is not
  /// known.
  std::optional<std::vector<LightVoxelsPtr>> injectedVoxels;
  gpu::Buffer emitterDistance;  ///< GATHER: float per cell, cells to the nearest VPL near it
  gpu::Buffer receivers, cursors;  ///< GATHER: blocks under way, and how far each has come
  std::optional<IncidentTextures> textures;  ///< the volume as frames read it; made where a frame is
  gpu::Buffer incidentVolume;  ///< layout::kVolumeFloats per cell and group, between the volume stage and its copy

  /// Zeroes what counts degenerate triangles, lit and clamped cells.
  void resetCounters();
  /// The injected field, for transports that do not start from one. Its content is undefined.
  void makeInjected();
  /// The textures and the buffer of the volume, where there are none. Their content is undefined.
  void makeTextures();
  void makeIncidentVolume();

  /// The product's cells among the grid's.
  CellBox inner() const { return {glm::ivec3(guard), grid.dims - guard}; }
  int lookedUpGroups() const { return groups - apart; }
  int allChannels() const { return channels * groups; }

  const FieldBuffer& transported() const { return clamped ? *sum : pingPong[std::size_t(result)]; }
};

}  // namespace lpv
