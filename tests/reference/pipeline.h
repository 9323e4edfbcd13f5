#pragma once
// A scene from its lights to its volume, as a session's options ask, in double.

#include "reference/field.h"
#include "scene/scene.h"
#include "scene/volume.h"

namespace lpv::reference {

/// SH of emitted intensity per cell of all enabled lights: dense samples where the method says so, else COUNT or FLUX.
Field injectedField(const Scene& scene);

/// SH of incident radiance by PROPAGATE: iterations and clampFaces of the options, then the product's clamp of moments.
Field transportedField(const Scene& scene);

/// transportedField rounded to float: one layer, the default group.
Volume transportedVolume(const Scene& scene);

}  // namespace lpv::reference
