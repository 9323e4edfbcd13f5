// Textures of surfaces that are seen askew.

const float kMostTaps = 16.0;

/// The mean over a pixel's footprint: samples along its longer axis, each as wide as the shorter one. Where it is as wide as
/// long, the one sample that textureGrad() takes. Not by the sampler's own anisotropy, which devices do in ways of their own:
/// llvmpipe's blurs what is magnified. `share`: of the pixel, across and down, that one of its samples stands for.
vec4 textureAskew(sampler2D image, vec2 uv, float share) {
  const vec2 size = vec2(textureSize(image, 0)), dx = share * dFdx(uv), dy = share * dFdy(uv);
  const float x = length(dx * size), y = length(dy * size), longer = max(x, y), shorter = max(min(x, y), longer / kMostTaps);
  const float taps = clamp(ceil(longer / max(shorter, 1e-6) - 0.01), 1.0, kMostTaps), lod = log2(max(shorter, 1e-6));
  if (taps <= 1.0 || longer <= 1.0) return textureGrad(image, uv, dx, dy);
  const vec2 along = x > y ? dx : dy;
  vec4 sum = vec4(0.0);
  for (float i = 0.5; i < taps; i += 1.0) sum += textureLod(image, uv + (i / taps - 0.5) * along, lod);
  return sum / taps;
}
