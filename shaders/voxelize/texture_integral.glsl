// The area integral of a texture over a polygon, exactly: the texture is bilinear between texel centres and tiled, and
// by Green's theorem its integral is that of F dy around the polygon, F(x, y) the integral of the texture along its row
// from texel centre 0 to x. F is a cubic along a straight line within one texel square, for which Simpson's rule is
// exact. Rows are integrated on the CPU once per texture, in double: a hot spot leaves its neighbours their digits.
//
// LPV_VPLS: and where it glows. With the brightness w = r + g + b, the integrals of w, w x, w y, w xx, w yy and w xy are
// those of A0, A1, A0 y, A2, A0 y^2 and A1 y around the polygon, Ak(x, y) the integral of w x^k along the row. They are of
// degree five at most, for which Gauss' three points are exact.
//
// Texel space: x = u width - .5, y = v height - .5, so that integers are texel centres. Colours are shares of the
// brightest texel.

layout(binding = kLightTexture) uniform sampler2D lightTexture;
layout(std430, binding = kRowIntegrals) readonly buffer RowIntegrals { double rowIntegrals[]; };
#if LPV_VPLS
layout(std430, binding = kRowMoments) readonly buffer RowMoments { dvec2 rowMoments[]; };
#endif

/// A line that crosses more texel squares than this sees the texture's mean.
const double kMostSquares = 16384.0lf;
const int kMostSteps = 16384 + 8;
/// Gauss' points of a line are its middle and so far, as a share of its length, to both sides: sqrt(3/20).
const double kGaussPoint = 0.38729833462074168852lf;

int wrapped(int i, int size) { return i - size * int(floor(double(i) / double(size))); }

vec3 storedTexel(int x, int y) {
  const ivec2 size = params.textureSize;
  return texelFetch(lightTexture, ivec2(wrapped(x, size.x), wrapped(y, size.y)), 0).rgb;
}

vec3 texel(int x, int y) { return storedTexel(x, y) * float(params.colourScale); }

/// Integral along row y from texel centre 0 to centre x; like the texels of a TexelSquare not yet a share of the brightest.
dvec3 rowIntegral(int x, int y) {
  const int width = params.textureSize.x;
  const int at = wrapped(x, width);
  const int row = wrapped(y, params.textureSize.y) * (width + 1);
  const int i = 3 * (row + at), whole = 3 * (row + width);
  const double turns = double((x - at) / width);
  return dvec3(rowIntegrals[i], rowIntegrals[i + 1], rowIntegrals[i + 2]) +
         turns * dvec3(rowIntegrals[whole], rowIntegrals[whole + 1], rowIntegrals[whole + 2]);
}

struct TextureIntegral {
  dvec3 colour;
#if LPV_VPLS
  double glow;   // of w,
  dvec2 first;   // w x and w y,
  dvec3 second;  // w xx, w yy and w xy
#endif
};

TextureIntegral noIntegral() {
#if LPV_VPLS
  return TextureIntegral(dvec3(0.0lf), 0.0lf, dvec2(0.0lf), dvec3(0.0lf));
#else
  return TextureIntegral(dvec3(0.0lf));
#endif
}

double brightness(dvec3 c) { return c.r + c.g + c.b; }

#if LPV_VPLS
/// Integrals of w x and w xx along row y from texel centre 0 to centre x.
dvec2 rowMoment(int x, int y) {
  const int width = params.textureSize.x;
  const int at = wrapped(x, width), row = wrapped(y, params.textureSize.y) * (width + 1);
  const dvec2 here = rowMoments[row + at];
  if (x == at) return here;
  // n times round: w (x + k width)^j, summed over k = 0 .. n - 1, and the rest moved on by n widths.
  const dvec2 whole = rowMoments[row + width];
  const double w0 = brightness(rowIntegral(width, y)), rest = brightness(rowIntegral(at, y));
  const double size = double(width), n = double((x - at) / width), before = 0.5lf * n * (n - 1.0lf);
  const double squares = before * (2.0lf * n - 1.0lf) / 3.0lf, moved = n * size;
  return dvec2(n * whole.x + size * before * w0 + here.x + moved * rest,
               n * whole.y + 2.0lf * size * before * whole.x + size * size * squares * w0 + here.y +
                   moved * (2.0lf * here.x + moved * rest));
}
#endif

/// F along one texel square: integrals and colours of its two rows.
struct TexelSquare {
  dvec3 integral0, integral1;
  dvec3 c00, c10, c01, c11;
#if LPV_VPLS
  dvec2 corner, moment0, moment1;
#endif
};

dvec3 rowTo(dvec3 integral, dvec3 left, dvec3 right, double a) {
  return integral + a * left + (0.5lf * a * a) * (right - left);
}

dvec3 integralTo(TexelSquare s, dvec2 p) {
  return mix(rowTo(s.integral0, s.c00, s.c10, p.x), rowTo(s.integral1, s.c01, s.c11, p.x), p.y);
}

#if LPV_VPLS
/// A0, A1, A2 of one row, at `a` into the square.
dvec3 rowMomentsTo(dvec3 integral, dvec2 moment, dvec3 left, dvec3 right, double a, double corner) {
  const double l = brightness(left), rise = brightness(right) - l, aa = a * a;
  const double more = a * l + 0.5lf * aa * rise;  // of w from the corner on, then of w f and of w ff
  const double first = aa * (0.5lf * l + a * rise / 3.0lf), second = aa * a * (l / 3.0lf + 0.25lf * a * rise);
  return dvec3(brightness(integral) + more, moment.x + corner * more + first,
               moment.y + corner * (corner * more + 2.0lf * first) + second);
}

/// What one of Gauss' points adds, in texel space.
void addGlow(dvec3 a, double y, double weight, inout TextureIntegral sum) {
  sum.glow += weight * a.x;
  sum.first += weight * dvec2(a.y, a.x * y);
  sum.second += weight * dvec3(a.z, a.x * y * y, a.y * y);
}

void addSquareMoments(TexelSquare s, dvec2 start, dvec2 end, double weight, inout TextureIntegral sum) {
  for (int i = -1; i <= 1; ++i) {
    const dvec2 p = mix(start, end, 0.5lf + double(i) * kGaussPoint);
    const dvec3 a = mix(rowMomentsTo(s.integral0, s.moment0, s.c00, s.c10, p.x, s.corner.x),
                        rowMomentsTo(s.integral1, s.moment1, s.c01, s.c11, p.x, s.corner.x), p.y);
    addGlow(a, s.corner.y + p.y, weight * (i == 0 ? 8.0lf : 5.0lf) / 18.0lf, sum);
  }
}
#endif

TexelSquare texelSquare(dvec2 corner) {
  const int x = int(corner.x), y = int(corner.y);
  TexelSquare s;
  s.integral0 = rowIntegral(x, y);
  s.integral1 = rowIntegral(x, y + 1);
  s.c00 = dvec3(storedTexel(x, y));
  s.c10 = dvec3(storedTexel(x + 1, y));
  s.c01 = dvec3(storedTexel(x, y + 1));
  s.c11 = dvec3(storedTexel(x + 1, y + 1));
#if LPV_VPLS
  s.corner = corner;
  s.moment0 = rowMoment(x, y);
  s.moment1 = rowMoment(x, y + 1);
#endif
  return s;
}

/// The mean of the texture instead of the texture.
void addEvenLine(dvec2 p, dvec2 q, inout TextureIntegral sum) {
  const double dy = q.y - p.y;
  sum.colour += dvec3(params.textureMean) * (0.5lf * (p.x + q.x) * dy);
#if LPV_VPLS
  const double w = brightness(dvec3(params.textureMean));
  for (int i = -1; i <= 1; ++i) {
    const dvec2 at = mix(p, q, 0.5lf + double(i) * kGaussPoint);
    addGlow(w * at.x * dvec3(1.0lf, at.x / 2.0lf, at.x * at.x / 3.0lf), at.y, dy * (i == 0 ? 8.0lf : 5.0lf) / 18.0lf, sum);
  }
#endif
}

/// Which share of a line's step of d, from p in a square, ends at the square's border.
double shareToBorder(double p, double d, double square) {
  return d == 0.0lf ? 2.0lf : (square + (d > 0.0lf ? 1.0lf : 0.0lf) - p) / d;
}

/// The integral from p to q, texel space.
void addLine(dvec2 p, dvec2 q, inout TextureIntegral sum) {
  const dvec2 d = q - p;
  if (d.y == 0.0lf) return;
  if (abs(d.x) + abs(d.y) > kMostSquares) {
    addEvenLine(p, q, sum);
    return;
  }
  const double unit = d.y * params.colourScale;
  // Where the line leaves the square in x and in y.
  const dvec2 step_ = abs(1.0lf / d);
  dvec2 square = floor(p);
  if (d.x <= 0.0lf && square.x == p.x) square.x -= 1.0lf;  // on a line between squares, going down
  if (d.y <= 0.0lf && square.y == p.y) square.y -= 1.0lf;
  dvec2 next = dvec2(shareToBorder(p.x, d.x, square.x), shareToBorder(p.y, d.y, square.y));
  double from = 0.0lf;
  for (int squares = 0; from < 1.0lf && squares < kMostSteps; ++squares) {
    const double to = min(1.0lf, min(next.x, next.y));
    const TexelSquare s = texelSquare(square);
    const dvec2 start = p + from * d - square, end = p + to * d - square;
    sum.colour += (integralTo(s, start) + 4.0lf * integralTo(s, 0.5lf * (start + end)) + integralTo(s, end)) *
                  (unit * (to - from) / 6.0lf);
#if LPV_VPLS
    addSquareMoments(s, start, end, unit * (to - from), sum);
#endif
    if (next.x <= to) {
      square.x += d.x > 0.0lf ? 1.0lf : -1.0lf;
      next.x += step_.x;
    }
    if (next.y <= to) {
      square.y += d.y > 0.0lf ? 1.0lf : -1.0lf;
      next.y += step_.y;
    }
    from = to;
  }
}

/// The bilinear texture at one point of texel space.
vec3 textureAt(dvec2 p) {
  const dvec2 square = floor(p);
  const vec2 f = vec2(p - square);
  const int x = int(square.x), y = int(square.y);
  return mix(mix(texel(x, y), texel(x + 1, y), f.x), mix(texel(x, y + 1), texel(x + 1, y + 1), f.x), f.y);
}
