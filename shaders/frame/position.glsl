// Where in the grid a pixel's surface is.

/// `at`: in pixels, .5 at the middle of the first; `depth`: as stored.
vec3 gridPosition(FrameParams frame, vec2 at, float depth) {
  const vec2 uv = at * frame.pixelSize;
  const vec3 ray = frame.rayOrigin + uv.x * frame.rayRight + uv.y * frame.rayDown;
  return frame.eye + frame.depthScale / (depth + frame.depthOffset) * ray;
}

/// Where rays from a pixel's place begin: off its surface, and past what its depth may be off. Rasterizers know depths to a
/// part of the largest one, 1, of a triangle that comes near to the camera; an H200 was off by 1e-7, and floors shadowed
/// themselves. From 10 m away, near plane at 1 cm, that is 5 mm, a fifth of a pixel.
const float kDepthError = 5e-7;
vec3 rayStart(FrameParams frame, vec3 place, vec3 n, float depth) {
  return place + (kShadowOffset + kDepthError / (depth + frame.depthOffset) * abs(dot(place - frame.eye, n))) * n;
}

/// A pixel as lists have it.
uint packedPixel(ivec2 pixel) { return uint(pixel.x) | uint(pixel.y) << 16; }
ivec2 unpackedPixel(uint packed_) { return ivec2(packed_ & 0xffffu, packed_ >> 16); }
