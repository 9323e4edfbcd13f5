// A pixel whose edges and textures were looked at several times. Samples are lit as the pixel itself, or as up to two of the
// pixels around it. In single frames, a sample unlike the pixel itself is lit where it is, or at an earlier one of the
// pixel that is like it. Of each rgb: their mean albedo; a: packedSubpixels().

const int kPixelsAround = 9;
const int kOwnPixel = 0;
const int kNoPixel = 15;

/// The pixel itself, those beside it, those across its corners.
ivec2 pixelAround(int code) {
  if (code == kOwnPixel) return ivec2(0);
  const int k = code - 1, sign_ = (k & 1) != 0 ? 1 : -1;
  if (k < 4) return k < 2 ? ivec2(sign_, 0) : ivec2(0, sign_);
  return ivec2(sign_, k < 6 ? 1 : -1);
}

/// Exact in 16 bits of float.
float packedSubpixels(int count, int code) { return float(count * 16 + code); }
int countOf(vec4 subpixels) { return int(subpixels.a) >> 4; }
int codeOf(vec4 subpixels) { return int(subpixels.a) & 15; }

/// Where a pixel's place apart is: pictures of the places lie side by side, each as wide as the picture of the pixels.
ivec2 placeApart(ivec2 pixel, int place, int width) { return ivec2(pixel.x + place * width, pixel.y); }
