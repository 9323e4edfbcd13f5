#pragma once
// Publishing: quantizes a volume relative to the result published before it. Subscribers hold published volumes, and
// deltas are differences between them.

#include "wire/volume_state.h"

namespace lpv::wire {

/// Tolerance classes: 0 exact .. 3 coarsest.
inline constexpr int kToleranceClasses = 4;

/// Largest allowed error of a cell: |L00 - published| and |L1 - published| / sqrt 3 of each colour, relative to that
/// colour's L00 or, if that is smaller, to kDarkest x the layer's largest L00. HALF_FLOAT and FLOAT: 0 (every change of
/// an element is sent), .02, .04, .08. COMPACT: .01, .02, .04, .08.
double toleranceOf(Format format, int toleranceClass);
inline constexpr double kDarkest = 1e-5;

/// The next published volume of a chain of one format and tolerance class. A brick of `previous` is kept while all its
/// cells are within the tolerance of `volume`; class 0 of COMPACT corrects every coefficient that is off by more than
/// half a step. The comparison is with the published state, not with the volume before, so slow drift is sent too.
/// Without a `previous` of the same shape every brick is new.
///
/// HALF_FLOAT's scale is the power of two that maps a layer's largest magnitude to (512, 1024]: values down to 2^-24 of
/// it keep all 11 bits. The scale of `previous` is kept while it is within a factor of 2 of the new one.
/// `volume` must be valid: 1..8 layers of cells x 12 coefficients.
VolumeStatePtr publish(const Volume& volume, Format format, int toleranceClass, const VolumeState* previous);

}  // namespace lpv::wire
