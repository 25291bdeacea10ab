#version 450
// Crassin et al. 2011, Sec. 7: final gathering with a few wide cones, and one narrow cone for glossy light.
// Thesis 004, Sec. 4.2.1, Listings 4.11 to 4.13.
#pragma lumivox axis DIFFUSE 0 1
#pragma lumivox axis GLOSSY 0 1
#pragma lumivox require DIFFUSE || GLOSSY
// LOBES: voxels of the dense grid emit by a directional lobe instead of equally to all sides.
#pragma lumivox axis LOBES 0 1
#pragma lumivox require !LOBES || STORE == dense
#include "store.glsl"
#include "common/cone_march.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const int coneCount = 6;
layout(constant_id = 1) const int publishedCones = 0;
layout(constant_id = 3) const int glossyCones = 1;
// Not uniforms: a fourth uniform block whose values decide a branch crashes a second driver (docs/gpu.md).
layout(constant_id = 5) const int every = 1;    // every n-th pixel along each axis is gathered
layout(constant_id = 6) const int pattern = 1;  // cones differ between the pixels of a square of this side
layout(constant_id = 7) const int arrivingDiffuse = 0;  // 1: writes arriving light, for reconstruct.comp; 0: reflected light
layout(constant_id = 8) const int arrivingGlossy = 0;   // the same

layout(std140, binding = 0) uniform Parameters {
  vec3 eyeWorld;
  float coneRatio;  // diameter of one of the five cones over its height
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gGeometricNormal;
#if DIFFUSE
layout(binding = 3) uniform sampler2D gDiffuse;
layout(binding = 0, rgba32f) uniform writeonly image2D diffuseImage;
#endif
#if GLOSSY
layout(binding = 5) uniform sampler2D gSpecular;
layout(binding = 1, rgba32f) uniform writeonly image2D glossyImage;
#endif

void main() {
  ivec2 gathered = ivec2(gl_GlobalInvocationID.xy), size = textureSize(gPosition, 0);
  if (any(greaterThanEqual(every * gathered, size))) return;
  ivec2 pixel = min(every * gathered + every / 2, size - 1);
  vec4 position = texelFetch(gPosition, pixel, 0);
  vec3 diffuse = vec3(0.0), glossy = vec3(0.0);
  bool mirrors = false;
  int diffuseCones = 0, lobes = 0;  // number of cones of each sum
  if (position.w > 0.0) {
    vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
    vec3 apex = position.xyz;
    apex += texelFetch(gGeometricNormal, pixel, 0).xyz * (offset * finestVoxel(apex));
#if DIFFUSE
    vec3 albedo = texelFetch(gDiffuse, pixel, 0).rgb;
    if (arrivingDiffuse != 0) albedo = vec3(1.0);
    vec2 place = placeInStratum(gl_GlobalInvocationID.xy, pattern);
    if (any(greaterThan(albedo, vec3(0.0)))) diffuseCones = publishedCones != 0 ? kPublishedCones : coneCount;
#endif
#if GLOSSY
    vec4 specular = texelFetch(gSpecular, pixel, 0);
    mirrors = any(greaterThan(specular.rgb, vec3(0.0)));
    vec3 mirror = reflect(normalize(position.xyz - eyeWorld), normal);
    if (mirrors) lobes = glossyCones;
#endif
    // One call of the march for all cones: it is inlined at every call, and is nearly all of the code.
    for (int i = 0; i < diffuseCones + lobes; ++i) {
      Cone cone;
      uint number = uint(i);
#if DIFFUSE
      if (i < diffuseCones) {
        if (publishedCones != 0)
          cone = publishedCone(i, normal, 0.5 * coneRatio);
        else
          cone = diffuseCone(i, coneCount, normal, place);
      }
#endif
#if GLOSSY
      if (i >= diffuseCones) {
        cone = glossyCone(i - diffuseCones, glossyCones, normal, mirror, specular.w);
        number = kGlossyCone + uint(i - diffuseCones);
      }
#endif
      if (cone.weight <= 0.0) continue;
      vec3 arriving = cone.weight * traceCone(apex, cone.direction, cone.tanHalfAngle, cone.cosTheta, number);
#if DIFFUSE
      if (i < diffuseCones) diffuse += arriving;
#endif
#if GLOSSY
      if (i >= diffuseCones) glossy += arriving;
#endif
    }
#if DIFFUSE
    // Cosine-weighted mean of the arriving radiance over the hemisphere.
    if (diffuseCones > 0) diffuse = albedo * (diffuse / (publishedCones != 0 ? kPublishedWeights : float(coneCount)));
#endif
#if GLOSSY
    // Mean over the lobe of the arriving radiance times the cosine: the reflection integral divided by the specular albedo.
    if (lobes > 0) glossy = (arrivingGlossy != 0 ? vec3(1.0) : specular.rgb) * (glossy / float(lobes));
#endif
  }
#if DIFFUSE
  imageStore(diffuseImage, gathered, vec4(diffuse, 1.0));
#endif
#if GLOSSY
  imageStore(glossyImage, gathered, vec4(glossy, arrivingGlossy != 0 && !mirrors ? 0.0 : 1.0));  // 0: no sample
#endif
}
