// Pieces of folds: what small triangles look like from near (server/scene/patches.h: Folds). Words of kFoldTriangles: for
// each surface where its triangles begin, 0 for none of them, and how far it is from a piece of the front to that of the
// back, 0 where that is not lit; then for each triangle its first piece, above kPieceBits, and how many it has.

layout(std430, binding = kFoldTriangles) readonly buffer FoldTriangles { uint foldTriangles[]; };
layout(std430, binding = kPieceLights) readonly buffer PieceLights { vec4 pieceLights[]; };

const int kNoPiece = -1;

/// The nearest piece to a place of what is seen; `patchCount`: of patches, which come before the pieces.
int pieceAt(Sight sight, vec3 place, int patchCount) {
  const int surface = int(texelFetch(occluders, sight.instance + 6).x) - 1;
  if (sight.at >= 1.0 || surface < 0) return kNoPiece;
  const uint begin = foldTriangles[2 * surface], toBack = foldTriangles[2 * surface + 1];
  if (begin == 0u || (!sight.front && toBack == 0u)) return kNoPiece;
  const uint word = foldTriangles[begin + uint(sight.triangle)];
  const int first = int(word >> kPieceBits), end = first + int(word & ((1u << kPieceBits) - 1u));
  int nearest = kNoPiece;
  float least = 1e30;
  for (int i = first; i < end; ++i) {
    const vec3 d = patches[patchCount + i].place.xyz - place;
    if (dot(d, d) >= least) continue;
    least = dot(d, d);
    nearest = i;
  }
  return nearest == kNoPiece || sight.front ? nearest : nearest + int(toBack);
}
