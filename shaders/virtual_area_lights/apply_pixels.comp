#version 450
// The light that points at every stride-th pixel reflect, interpolated: of the four points around a pixel, those on its surface count. Light is
// interpolated, not the place from which it comes: captured normals are noisy, and noise of a pixel's own normal would not cancel in quotients.
layout(local_size_x = 8, local_size_y = 8) in;
#include "pixel_points.glsl"

layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gDiffuse;
layout(binding = 3) uniform sampler2D pointPosition;
layout(binding = 4) uniform sampler2D pointNormal;
layout(binding = 5) uniform sampler2D pointRadius;
layout(binding = 6) uniform sampler2D diffuseLight;
layout(binding = 0, rgba32f) uniform writeonly image2D diffuseImage;

// Weight of a point for a surface, from 1 on the same plane to almost 0 on another surface.
float alike(ivec2 texel, vec3 posWorld, vec3 normal) {
  const float kLeast = 1e-4;  // so that a surface between four points of others is not black
  vec3 other = texelFetch(pointNormal, texel, 0).xyz;
  if (other == vec3(0.0)) return 0.0;
  float apart = abs(dot(other, posWorld - texelFetch(pointPosition, texel, 0).xyz)) / texelFetch(pointRadius, texel, 0).x;
  float facing = max(0.0, dot(other, normal));
  return kLeast + facing * facing * max(0.0, 1.0 - apart);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(gPosition, 0);
  if (any(greaterThanEqual(pixel, size))) return;
  vec4 position = texelFetch(gPosition, pixel, 0);
  vec3 normal = texelFetch(gNormal, pixel, 0).xyz, diffuse = vec3(0.0);
  if (position.w > 0.0) {
    vec2 place = (vec2(pixel) - float(stride / 2)) / float(stride);
    ivec2 first = ivec2(floor(place));
    vec2 share = place - vec2(first);
    vec3 light = vec3(0.0);
    float weights = 0.0;
    for (int corner = 0; corner < 4; ++corner) {
      ivec2 step = ivec2(corner & 1, corner >> 1), point = clamp(first + step, ivec2(0), pixelPoints - 1);
      ivec2 texel = pointTexel(uint(point.x + pixelPoints.x * point.y));
      vec2 near = mix(1.0 - share, share, vec2(step));
      float weight = max(near.x * near.y, 1e-3) * alike(texel, position.xyz, normal);
      light += weight * texelFetch(diffuseLight, texel, 0).rgb;
      weights += weight;
    }
    if (weights > 0.0) diffuse = texelFetch(gDiffuse, pixel, 0).rgb * light / weights;
  }
  imageStore(diffuseImage, pixel, vec4(diffuse, 1.0));
}
