// The area integral of a texture over a polygon, exactly: the texture is bilinear between texel centres and tiled, and
// by Green's theorem its integral is that of F dy around the polygon, F(x, y) the integral of the texture along its row
// from texel centre 0 to x. F is a cubic along a straight line within one texel square, for which Simpson's rule is
// exact. Rows are integrated on the CPU once per texture, in double: a hot spot leaves its neighbours their digits.
//
// Texel space: x = u width - .5, y = v height - .5, so that integers are texel centres. Colours are shares of the
// brightest texel.

layout(binding = kLightTexture) uniform sampler2D lightTexture;
layout(std430, binding = kRowIntegrals) readonly buffer RowIntegrals { double rowIntegrals[]; };

/// A line that crosses more texel squares than this sees the texture's mean.
const double kMostSquares = 16384.0lf;
const int kMostSteps = 16384 + 8;

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

/// F along one texel square: integrals and colours of its two rows.
struct TexelSquare {
  dvec3 integral0, integral1;
  dvec3 c00, c10, c01, c11;
};

dvec3 rowTo(dvec3 integral, dvec3 left, dvec3 right, double a) {
  return integral + a * left + (0.5lf * a * a) * (right - left);
}

dvec3 integralTo(TexelSquare s, dvec2 p) {
  return mix(rowTo(s.integral0, s.c00, s.c10, p.x), rowTo(s.integral1, s.c01, s.c11, p.x), p.y);
}

/// The integral of F dy from p to q, texel space.
dvec3 lineIntegral(dvec2 p, dvec2 q) {
  const dvec2 d = q - p;
  if (d.y == 0.0lf) return dvec3(0.0lf);
  if (abs(d.x) + abs(d.y) > kMostSquares) return dvec3(params.textureMean) * (0.5lf * (p.x + q.x) * d.y);
  dvec3 sum = dvec3(0.0lf);
  // Where the line leaves the square in x and in y.
  const dvec2 step_ = abs(1.0lf / d);
  const bvec2 forward = bvec2(d.x > 0.0lf, d.y > 0.0lf);
  dvec2 square = floor(p);
  dvec2 next;
  for (int k = 0; k < 2; ++k) {
    if (!forward[k] && square[k] == p[k]) square[k] -= 1.0lf;  // on a line between squares, going down
    next[k] = d[k] == 0.0lf ? 2.0lf : (square[k] + (forward[k] ? 1.0lf : 0.0lf) - p[k]) / d[k];
  }
  double from = 0.0lf;
  for (int squares = 0; from < 1.0lf && squares < kMostSteps; ++squares) {
    const double to = min(1.0lf, min(next.x, next.y));
    const int x = int(square.x), y = int(square.y);
    TexelSquare s;
    s.integral0 = rowIntegral(x, y);
    s.integral1 = rowIntegral(x, y + 1);
    s.c00 = dvec3(storedTexel(x, y));
    s.c10 = dvec3(storedTexel(x + 1, y));
    s.c01 = dvec3(storedTexel(x, y + 1));
    s.c11 = dvec3(storedTexel(x + 1, y + 1));
    const dvec2 start = p + from * d - square, end = p + to * d - square;
    sum += (integralTo(s, start) + 4.0lf * integralTo(s, 0.5lf * (start + end)) + integralTo(s, end)) * ((to - from) / 6.0lf);
    for (int k = 0; k < 2; ++k) {
      if (next[k] > to) continue;
      square[k] += forward[k] ? 1.0lf : -1.0lf;
      next[k] += step_[k];
    }
    from = to;
  }
  return sum * (d.y * params.colourScale);
}

/// The bilinear texture at one point of texel space.
vec3 textureAt(dvec2 p) {
  const dvec2 square = floor(p);
  const vec2 f = vec2(p - square);
  const int x = int(square.x), y = int(square.y);
  return mix(mix(texel(x, y), texel(x + 1, y), f.x), mix(texel(x, y + 1), texel(x + 1, y + 1), f.x), f.y);
}
