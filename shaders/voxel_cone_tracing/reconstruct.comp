#version 450
// What the cones of some pixels saw, filtered for all of them: a joint bilateral filter (Kopf et al. 2007) guided by the g-buffer, before
// the light is multiplied by the surface's albedo, so that textures stay sharp.
//
// The samples lie `every` pixels apart, and their cones repeat in squares of side `pattern`. The filter is a box as wide as such a
// square with ramps of one sample at its ends, so that every place in the pattern weighs the same; without a pattern it is linear.
#pragma lumivox axis DIFFUSE 0 1
#pragma lumivox axis GLOSSY 0 1
#pragma lumivox require DIFFUSE || GLOSSY

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Parameters {
  int every, pattern;
  float tolerance;  // m off the surface's plane at which a sample counts 1/e
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

// The mean of the samples around a pixel. Each of them keeps a little weight, for pixels like none of the samples.
vec3 filtered(sampler2D samples, ivec2 pixel, vec3 position, vec3 normal, int side) {
  const float kLeast = 1e-4, kSharpness = 16.0;
  float reach = 0.5 * float(side * every);
  ivec2 count = textureSize(samples, 0), size = textureSize(gPosition, 0);
  ivec2 low = max(ivec2(floor((vec2(pixel) - reach - 0.5 * float(every)) / float(every))), 0);
  ivec2 high = min(ivec2(ceil((vec2(pixel) + reach + 0.5 * float(every)) / float(every))), count - 1);
  vec3 sum = vec3(0.0);
  float weights = 0.0;
  for (int y = low.y; y <= high.y; ++y)
    for (int x = low.x; x <= high.x; ++x) {
      ivec2 at = min(every * ivec2(x, y) + every / 2, size - 1);
      vec2 near = clamp(0.5 + (reach - abs(vec2(at - pixel))) / float(every), 0.0, 1.0);
      vec4 other = texelFetch(gPosition, at, 0);
      if (near.x * near.y <= 0.0 || !(other.w > 0.0)) continue;
      vec3 otherNormal = texelFetch(gGeometricNormal, at, 0).xyz;
      float off = dot(other.xyz - position, normal) / tolerance;
      float alike = exp(-off * off) * pow(max(dot(normal, otherNormal), 0.0), kSharpness);
      float weight = near.x * near.y * max(alike, kLeast);
      vec4 found = texelFetch(samples, ivec2(x, y), 0);  // w is 0 where nothing was gathered
      sum += weight * found.w * found.rgb;
      weights += weight * found.w;
    }
  return weights > 0.0 ? sum / weights : vec3(0.0);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(gPosition, 0)))) return;
  vec4 position = texelFetch(gPosition, pixel, 0);
  vec3 normal = texelFetch(gGeometricNormal, pixel, 0).xyz;
#if DIFFUSE
  vec3 diffuse = position.w > 0.0 ? texelFetch(gDiffuse, pixel, 0).rgb : vec3(0.0);
  if (any(greaterThan(diffuse, vec3(0.0)))) diffuse *= filtered(gatheredDiffuse, pixel, position.xyz, normal, pattern);
  imageStore(diffuseImage, pixel, vec4(diffuse, 1.0));
#endif
#if GLOSSY
  vec3 glossy = position.w > 0.0 ? texelFetch(gSpecular, pixel, 0).rgb : vec3(0.0);
  if (any(greaterThan(glossy, vec3(0.0)))) glossy *= filtered(gatheredGlossy, pixel, position.xyz, normal, 1);
  imageStore(glossyImage, pixel, vec4(glossy, 1.0));
#endif
}
