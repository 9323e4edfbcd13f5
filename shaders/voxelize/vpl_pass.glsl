// What the four passes share that make a light's tree out of its table of VPLs, in this order (MATHS.md 3b.1-2):
//   vpl_count.comp    bottom up: bins and number of entries of a level's nodes, from their children's
//   vpl_number.comp   top down: where the entries of a level's nodes begin, and their headers
//   vpl_leaves.comp   the table's VPLs to their places; the table is left empty
//   vpl_merge.comp    bottom up: a level's VPLs out of their children's
// All sums are of integers or in a fixed order: the same bits on every run.
#include "voxelize/vpl_tree.glsl"
#include "transport/vpls.glsl"
#include "voxelize/vpl_table.glsl"

layout(local_size_x = kNodeGroup) in;

/// Of a block of the light's grid, cells of the field.
vec3 centreOf(int level, ivec3 block) { return params.origin + params.cell * (vec3(block) + 0.5) * float(1 << level); }

/// Of the whole pass: a large one comes in several dispatches.
uint thread() { return params.firstThread + gl_GlobalInvocationID.x; }
