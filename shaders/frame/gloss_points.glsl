// What the reflections of a band of a picture have met so far (frame/gloss_rays.comp): in a row of kGlossPlaces pictures
// beside each other, each with a place for every pixel of the band.

struct GlossPoint {
  vec4 lights;  // rgb: radiance that the lobe reflects of the lights, a sum over turns; a: turns. Of the first picture
  vec4 met;     // rgb: of the place below: what the lobe and the albedo there make of radiance 1, over its chance to be
                // the one; a: the sum of all chances
  vec4 place;   // of one place on a surface that rays have met, grid space; a: how far from the pixel's, 0: none yet
  vec4 normal;  // there, unit, towards where the ray came from; a: of the first picture, the sum over turns of the squares
                // of the brightest of what `lights` sums
};

layout(std430, binding = kGlossPoints) buffer GlossPoints { GlossPoint glossPoints[]; };

int pictureWidth(FrameParams frame) { return int(1.0 / frame.pixelSize.x + 0.5); }
int glossIndex(FrameParams frame, ivec2 pixel) { return pixel.y * kGlossPlaces * pictureWidth(frame) + pixel.x; }

/// Of the mean over turns of the brightest of what the lobe reflects of lights. `first`: of the pixel's first picture.
float varianceOf(GlossPoint first) {
  const float turns = first.lights.a, mean = max(max(first.lights.r, first.lights.g), first.lights.b) / max(turns, 1.0);
  return max(first.normal.a / max(turns, 1.0) - mean * mean, 0.0) / max(turns - 1.0, 1.0);
}

/// Whether E is found at the place that a pixel of one of the pictures has. `at`: in the first one.
bool isAsked(GlossParams params, ivec2 at, int picture) {
  return params.spacing == 1 || (picture == 0 && all(equal((at + ivec2(0, params.bandRow + params.firstRow) + kGlossReach) % params.spacing, ivec2(0))));
}
