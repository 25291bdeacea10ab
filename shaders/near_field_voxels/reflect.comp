#version 450
// What visible surfaces reflect of light that was gathered for some of the pixels: blended from the four samples around each by a joint
// bilateral filter (Kopf, Cohen, Lischinski & Uyttendaele 2007), before the albedo, so that textures stay sharp.
#pragma lumivox axis DIFFUSE 0 1
#pragma lumivox axis OCCLUSION 0 1
#pragma lumivox require DIFFUSE || OCCLUSION

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Parameters {
  vec3 eye;
  float pixelAngle;  // width of a pixel at distance 1
  int every;         // pixels from one sample to the next
  float tolerance;   // widths of a sample off a pixel's plane at which another one counts 1/e
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 2) uniform sampler2D gGeometricNormal;
#if DIFFUSE
layout(binding = 3) uniform sampler2D gDiffuse;
layout(binding = 4) uniform sampler2D arriving;
layout(binding = 0, rgba32f) uniform writeonly image2D diffuseImage;
#endif
#if OCCLUSION
layout(binding = 5) uniform sampler2D openShare;
layout(binding = 1, rgba32f) uniform writeonly image2D occlusionImage;
#endif

// How much a sample is of the surface at a place: 1 where it is. Each keeps a little, for pixels like none of them.
float alike(ivec2 pixel, vec3 position, vec3 normal) {
  const float kLeast = 1e-6, kSharpness = 16.0;
  vec4 other = texelFetch(gPosition, pixel, 0);
  if (!(other.w > 0.0)) return 0.0;
  float footprint = float(every) * pixelAngle * distance(position, eye);
  float off = dot(other.xyz - position, normal) / (tolerance * footprint);
  float facing = max(dot(normal, texelFetch(gGeometricNormal, pixel, 0).xyz), 0.0);
  return max(exp(-off * off) * pow(facing, kSharpness), kLeast);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(gPosition, 0);
  if (any(greaterThanEqual(pixel, size))) return;
  vec4 position = texelFetch(gPosition, pixel, 0);
  vec3 normal = texelFetch(gGeometricNormal, pixel, 0).xyz, light = vec3(0.0);
  float open = 0.0, weights = 0.0;
  if (position.w > 0.0) {
    ivec2 count = (size + every - 1) / every;
    vec2 place = vec2(pixel - every / 2) / float(every);
    ivec2 low = ivec2(floor(place));
    for (int i = 0; i < 4; ++i) {
      ivec2 at = low + ivec2(i & 1, i >> 1);
      vec2 near = 1.0 - abs(place - vec2(at));
      at = clamp(at, ivec2(0), count - 1);
      float weight = near.x * near.y;
      // Of the pixel itself no other one is asked: without samples between pixels this is a multiplication.
      if (weight == 0.0) continue;
      if (every > 1) weight *= alike(min(every * at + every / 2, size - 1), position.xyz, normal);
#if DIFFUSE
      light += weight * texelFetch(arriving, at, 0).rgb;
#endif
#if OCCLUSION
      open += weight * texelFetch(openShare, at, 0).r;
#endif
      weights += weight;
    }
  }
#if DIFFUSE
  vec3 reflected = weights > 0.0 ? texelFetch(gDiffuse, pixel, 0).rgb * (light / weights) : vec3(0.0);
  imageStore(diffuseImage, pixel, vec4(reflected, 1.0));
#endif
#if OCCLUSION
  imageStore(occlusionImage, pixel, vec4(weights > 0.0 ? open / weights : 1.0));
#endif
}
