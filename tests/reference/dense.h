#pragma once
// The paper's baseline (4.1): samples spread over every triangle, each a VPL in its nearest cell, in COUNT's
// accumulators (eq. 1, i = 1..N, times s^2).
//
// Random numbers. `triangle` is the index in its mesh's list, triangles of no area included, `sample` 0, 1, ...; all
// arithmetic modulo 2^32:
//   h  = triangle * 0x9E3779B9 ^ sample * 0x85EBCA6B
//   r1 = real(fmix32(h)),  r2 = real(fmix32(h + 0x68BC21EB)),  real(x) = (x >> 8) * 2^-24 + 2^-25, inside (0, 1)
//   fmix32(x): x ^= x >> 16, x *= 0x85EBCA6B, x ^= x >> 13, x *= 0xC2B2AE35, x ^= x >> 16 (MurmurHash3, Appleby)
//
// A sample lies at P = (1 - sqrt r1) A + sqrt r1 (1 - r2) B + sqrt r1 r2 C (Turk 1990), A, B, C the unsnapped corners
// in the mesh's order, also under a mirrored transform. Its cell is the one that holds P in grid space (half-open, the
// grid's outer upper faces belong to the last cells): the one with the nearest centre. Samples outside the grid are
// dropped. Direction and texture (bilinear, level 0) are those at P.

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "reference/inject.h"

namespace lpv::reference {

std::uint32_t fmix32(std::uint32_t x);

/// (r1, r2), each in (0, 1).
glm::dvec2 hashedPair(std::uint32_t triangle, std::uint32_t sample);
using SampleSource = std::function<glm::dvec2(std::uint32_t triangle, std::uint32_t sample)>;

/// Barycentric coordinates, in the order A, B, C, of the sample for (r1, r2).
glm::dvec3 turk(const glm::dvec2& r);

/// `samples` VPLs per triangle; two-sided triangles count each twice.
Counted injectDense(const Grid& grid, const std::vector<Emitter>& emitters, std::uint32_t samples,
                    const SampleSource& source = hashedPair);

}  // namespace lpv::reference
