// Where in the grid a pixel's surface is.

/// `at`: in pixels, .5 at the middle of the first; `depth`: as stored.
vec3 gridPosition(FrameParams frame, vec2 at, float depth) {
  const vec2 uv = at * frame.pixelSize;
  const vec3 ray = frame.rayOrigin + uv.x * frame.rayRight + uv.y * frame.rayDown;
  return frame.eye + frame.depthScale / (depth + frame.depthOffset) * ray;
}

/// Where rays from a pixel's place begin: off its surface, and past what its depth may be off. Rasterizers know depths to a
/// part of the largest one, 1, of a triangle that comes near to the camera: on an H200 floors shadowed themselves up to 5e-7.
/// 10 m away, with the near plane at 1 cm, this is 15 mm, half a pixel.
const float kDepthError = 1.5e-6;
vec3 rayStart(FrameParams frame, vec3 place, vec3 n, float depth) {
  return place + (kShadowOffset + kDepthError / (depth + frame.depthOffset) * abs(dot(place - frame.eye, n))) * n;
}

/// A pixel as lists have it.
uint packedPixel(ivec2 pixel) { return uint(pixel.x) | uint(pixel.y) << 16; }
ivec2 unpackedPixel(uint packed_) { return ivec2(packed_ & 0xffffu, packed_ >> 16); }
