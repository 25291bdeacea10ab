#version 450
// Smooths samples of light that lie 1, 2 or 4 pixels apart and upsamples them to all pixels: a joint bilateral filter guided by the
// g-buffer. It runs along both axes at once; or separably, first along the rows and then along the columns (Pham & van Vliet 2005). The
// first result then has one texel per pixel along x and per sample along y.
#pragma lumivox axis REFLECTS 0 1  // arriving radiance is multiplied by the diffuse albedo, last, so that textures stay sharp
#include "common/joint_bilateral.glsl"
#include "common/sampled_pixels.glsl"

const int kTent = 0, kGaussian = 1, kBilinear = 2;
layout(constant_id = 0) const int kernel = kTent;

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Parameters {
  vec3 eye;
  float pixelAngle;  // width of a pixel at a distance of 1
  ivec2 every;       // pixels from one texel of the input to the next
  ivec2 everyOut;       // the same for the output
  ivec2 along;       // 1: blended along that axis
  int radius;        // pixels blended on either side, as far as samples exist; at least two samples if `every` is not 1
  int spacing;       // pixels from one sample to the next, before any pass
  float tolerance;   // distance from a pixel's plane, in widths of a sample, at which a weight is 1/e
  float power;       // exponent of the cosine between the normals
  float nothing;     // value of pixels without a surface
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 2) uniform sampler2D gGeometricNormal;
#if REFLECTS
layout(binding = 3) uniform sampler2D gDiffuse;
#endif
layout(binding = 4) uniform sampler2D inputImage;
layout(binding = 0, rgba32f) uniform writeonly image2D outputImage;

ivec2 pixelOf(ivec2 texel, ivec2 apart) { return sampledPixel(texel, apart, textureSize(gPosition, 0)); }

// The first and last texels along each axis, and the reach of the kernel in texels.
void windowOf(ivec2 at, ivec2 pixel, out ivec2 first, out ivec2 last, out vec2 reach) {
  for (int axis = 0; axis < 2; ++axis) {
    if (along[axis] == 0) {
      first[axis] = last[axis] = at[axis];
      reach[axis] = 1.0;
    } else if (every[axis] == 1) {
      first[axis] = pixel[axis] - radius;
      last[axis] = pixel[axis] + radius;
      reach[axis] = float(radius + 1);
    } else {
      int beside = firstOfFour(pixel, every)[axis] + 1, sides = kernel == kBilinear ? 1 : max(2, radius / every[axis]);
      first[axis] = beside + 1 - sides;
      last[axis] = beside + sides;
      reach[axis] = float(sides);
    }
  }
}

float weightOf(float away, float reach) {
  const float kDeviation = 0.5;  // standard deviation of the Gaussian, as a share of the reach
  if (kernel == kGaussian) return exp(-0.5 * away * away / (kDeviation * kDeviation * reach * reach));
  return tent(away, reach, 0.0);
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, imageSize(outputImage)))) return;
  ivec2 pixel = pixelOf(at, everyOut);
  vec4 position = texelFetch(gPosition, pixel, 0);
  Blend blend = kNoBlend;
  vec3 value = vec3(nothing);
  if (position.w > 0.0 && along == ivec2(0)) {
    value = texelFetch(inputImage, at, 0).rgb;
  } else if (position.w > 0.0) {
    vec3 normal = texelFetch(gGeometricNormal, pixel, 0).xyz;
    float width = tolerance * float(spacing) * pixelAngle * distance(position.xyz, eye);
    ivec2 first, last;
    vec2 reach;
    windowOf(at, pixel, first, last, reach);
    ivec2 end = textureSize(inputImage, 0) - 1;
    for (int y = max(first.y, 0); y <= min(last.y, end.y); ++y)
      for (int x = max(first.x, 0); x <= min(last.x, end.x); ++x) {
        ivec2 texel = ivec2(x, y), other = pixelOf(texel, every);
        vec4 otherPosition = texelFetch(gPosition, other, 0);
        if (!(otherPosition.w > 0.0)) continue;
        vec2 away = abs(vec2(other - pixel)) / vec2(every);
        float weight = (along.x != 0 ? weightOf(away.x, reach.x) : 1.0) * (along.y != 0 ? weightOf(away.y, reach.y) : 1.0);
        float unlike = kernel == kBilinear ? 0.0
                                           : unlikeSurface(otherPosition.xyz, texelFetch(gGeometricNormal, other, 0).xyz, position.xyz,
                                                           normal, width, power);
        add(blend, texelFetch(inputImage, texel, 0).rgb, weight, unlike);
      }
    if (blend.weights > 0.0) value = blend.sum / blend.weights;
  }
#if REFLECTS
  value *= texelFetch(gDiffuse, pixel, 0).rgb;
#endif
  imageStore(outputImage, at, vec4(value, 1.0));
}
