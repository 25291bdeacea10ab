#version 450
// Reconstructs the light of all pixels from the cones of some: a joint bilateral filter (Kopf et al. 2007) guided by the g-buffer. It runs
// before the multiplication by the surface's albedo, so that textures stay sharp.
//
// The samples lie `every` pixels apart, and their cones repeat in squares of side `pattern`. A separable box filter as wide as such a
// square runs along the rows and then along the columns. It has ramps of one sample at its ends, so that every place in the pattern has the
// same weight. A pattern of 4 x 4 costs 2 x 5 reads instead of 25. Pixels between samples blend the four samples around them.
#pragma lumivox axis DIFFUSE 0 1
#pragma lumivox axis GLOSSY 0 1
#pragma lumivox require DIFFUSE || GLOSSY

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Parameters {
  ivec2 along;      // the direction of the box, in samples; 0 0: pixels between samples
  int every, pattern;
  float tolerance;  // distance from the surface's plane, m, at which the weight of a sample falls to 1/e
  int finishes;     // 1: writes the mean, for pixels times the albedo; 0: writes the sum and, in w, the sum of the weights
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 2) uniform sampler2D gGeometricNormal;
#if DIFFUSE
layout(binding = 3) uniform sampler2D gDiffuse;
layout(binding = 4) uniform sampler2D gatheredDiffuse;
layout(binding = 0, rgba32f) uniform writeonly image2D diffuseImage;
#endif
#if GLOSSY
layout(binding = 5) uniform sampler2D gSpecular;
layout(binding = 6) uniform sampler2D gatheredGlossy;
layout(binding = 1, rgba32f) uniform writeonly image2D glossyImage;
#endif

// The pixel for which a sample was gathered.
ivec2 pixelOf(ivec2 sampleAt) { return min(every * sampleAt + every / 2, textureSize(gPosition, 0) - 1); }

// Similarity of a pixel's surface to the surface at a position: 1 if they are the same. It is at least kLeast for a pixel with a surface,
// so that pixels similar to no sample get light too.
float alike(ivec2 pixel, vec3 position, vec3 normal) {
  const float kLeast = 1e-4;
  vec4 other = texelFetch(gPosition, pixel, 0);
  if (!(other.w > 0.0)) return 0.0;
  float off = dot(other.xyz - position, normal) / tolerance;
  float facing = max(dot(normal, texelFetch(gGeometricNormal, pixel, 0).xyz), 0.0);
  facing *= facing;  // ^2
  facing *= facing;
  facing *= facing;
  facing *= facing;  // ^16
  return max(exp(-off * off) * facing, kLeast);
}

struct Sums {
  vec4 diffuse, glossy;  // w: sum of the weights of the samples
};

void add(inout Sums sums, ivec2 sampleAt, float weight) {
#if DIFFUSE
  sums.diffuse += weight * texelFetch(gatheredDiffuse, sampleAt, 0);
#endif
#if GLOSSY
  sums.glossy += weight * texelFetch(gatheredGlossy, sampleAt, 0);
#endif
}

// Weighted sum of the samples in a box as wide as the pattern around one sample.
Sums inBox(ivec2 sampleAt, ivec2 count, vec3 position, vec3 normal) {
  Sums sums = Sums(vec4(0.0), vec4(0.0));
  int reach = pattern / 2;
  for (int i = -reach; i <= reach; ++i) {
    ivec2 at = sampleAt + i * along;
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, count))) continue;
    float near = clamp(0.5 + 0.5 * float(pattern) - float(abs(i)), 0.0, 1.0);
    add(sums, at, near * alike(pixelOf(at), position, normal));
  }
  return sums;
}

// Weighted sum of the four samples around a pixel.
Sums between(ivec2 pixel, ivec2 count, vec3 position, vec3 normal) {
  Sums sums = Sums(vec4(0.0), vec4(0.0));
  vec2 place = vec2(pixel - every / 2) / float(every);
  ivec2 low = ivec2(floor(place));
  for (int i = 0; i < 4; ++i) {
    ivec2 at = low + ivec2(i & 1, i >> 1);
    vec2 near = 1.0 - abs(place - vec2(at));
    at = clamp(at, ivec2(0), count - 1);
    if (near.x * near.y > 0.0) add(sums, at, near.x * near.y * alike(pixelOf(at), position, normal));
  }
  return sums;
}

vec4 meanOf(vec4 sum) { return sum.w > 0.0 ? vec4(sum.rgb / sum.w, 1.0) : vec4(0.0); }

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = textureSize(gPosition, 0), count = (size + every - 1) / every;
  bool pixels = along == ivec2(0);
  if (any(greaterThanEqual(at, pixels ? size : count))) return;
  ivec2 pixel = pixels ? at : pixelOf(at);
  vec4 position = texelFetch(gPosition, pixel, 0);
  Sums sums = Sums(vec4(0.0), vec4(0.0));
  if (position.w > 0.0) {
    vec3 normal = texelFetch(gGeometricNormal, pixel, 0).xyz;
    if (pixels)
      sums = between(at, count, position.xyz, normal);
    else
      sums = inBox(at, count, position.xyz, normal);
  }
  bool reflects = finishes != 0 && (pixels || every == 1);
#if DIFFUSE
  vec4 diffuse = finishes != 0 ? meanOf(sums.diffuse) : sums.diffuse;
  if (reflects) diffuse = vec4(diffuse.rgb * texelFetch(gDiffuse, pixel, 0).rgb, 1.0);
  imageStore(diffuseImage, at, diffuse);
#endif
#if GLOSSY
  vec4 glossy = finishes != 0 ? meanOf(sums.glossy) : sums.glossy;
  if (reflects) glossy = vec4(glossy.rgb * texelFetch(gSpecular, pixel, 0).rgb, 1.0);
  imageStore(glossyImage, at, glossy);
#endif
}
