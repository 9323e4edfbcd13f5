#pragma once
// From a volume to what is sent of it.

#include "wire/volume_state.h"

namespace lpv::wire {

/// Tolerance classes: 0 exact .. 3 coarsest.
inline constexpr int kToleranceClasses = 4;

/// How far a cell's light may be from what is held: |L00 - held| and |L1 - held| / sqrt 3 of each colour, relative to
/// that colour's L00 or, where that is less, to kDarkest of the layer's largest. HALF_FLOAT and FLOAT: 0 (every change
/// of an element is sent), .02, .04, .08. COMPACT: .01, .02, .04, .08.
double toleranceOf(Format format, int toleranceClass);
inline constexpr double kDarkest = 1e-5;

/// The next state of a chain of results of one format and tolerance class. Each brick is compared with what is held,
/// `previous`, and stays as it is while no cell is further from the truth than the tolerance; class 0 of COMPACT
/// corrects every coefficient that is half a step off. So light that drifts slowly is sent too. Without a `previous`
/// of the same shape, everything is new.
///
/// HALF_FLOAT's scale is a power of two for which a layer's largest magnitude lies in (512, 1024]: 24 binary orders
/// below it keep the full 11 bits. Scales of `previous` stay while the largest is at most twice above or below that.
/// The volume is a valid one: 1..8 layers, each with cells x 12 coefficients.
VolumeStatePtr publish(const Volume& volume, Format format, int toleranceClass, const VolumeState* previous);

}  // namespace lpv::wire
