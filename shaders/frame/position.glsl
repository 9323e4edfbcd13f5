// Where in the grid a pixel's surface is.

/// `at`: in pixels, .5 at the middle of the first; `depth`: as stored.
vec3 gridPosition(FrameParams frame, vec2 at, float depth) {
  const vec2 uv = at * frame.pixelSize;
  const vec3 ray = frame.rayOrigin + uv.x * frame.rayRight + uv.y * frame.rayDown;
  return frame.eye + frame.depthScale / (depth + frame.depthOffset) * ray;
}

/// A pixel as lists have it.
uint packedPixel(ivec2 pixel) { return uint(pixel.x) | uint(pixel.y) << 16; }
ivec2 unpackedPixel(uint packed_) { return ivec2(packed_ & 0xffffu, packed_ >> 16); }
