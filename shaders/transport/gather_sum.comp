// What some lights send to a block of cells is added to what others do (server/lpv/transport/light_sums.h). Each thread
// has a column of cells.
#include "layout.h"
#include "common/field.glsl"
#include "transport/receiver_block.glsl"

layout(local_size_x = kBlockX, local_size_y = kBlockY) in;

layout(std140, binding = kParams) uniform Block { GatherSumParams params; };
layout(std430, binding = kReceiverBlocks) readonly buffer Blocks { uint blocks[]; };
layout(std430, binding = kFieldOut) buffer Field { vec4 field[]; };
layout(std430, binding = kFieldSum) readonly buffer Added { vec4 added[]; };
layout(std430, binding = kEmitterDistanceBuffer) buffer EmitterDistance { float emitterDistance[]; };
layout(std430, binding = kAddedDistance) readonly buffer AddedDistance { float addedDistance[]; };

void main() {
  const ivec3 first = firstCellOf(blocks[params.firstBlock + gl_WorkGroupID.x]);
  const ivec3 column = first + ivec3(gl_LocalInvocationID.xy, 0);
  if (column.x >= params.dims.x || column.y >= params.dims.y) return;
  for (int z = column.z; z < min(column.z + kBlockZ, params.dims.z); ++z) {
    const ivec3 cell = ivec3(column.xy, z);
    for (uint left = params.layers; left != 0u; left &= left - 1u) {
      for (int channel = 0; channel < params.channels; ++channel) {
        const int i = haloIndex(cell, params.dims, findLSB(left) * params.channels + channel);
        field[i] += added[i];
      }
    }
    const int i = cellIndex(cell, params.dims);
    emitterDistance[i] = min(emitterDistance[i], addedDistance[i]);
  }
}
