#version 450
// Traces cones through opacities in voxels, with light from layers of reflective shadow maps: thesis 004, Sec. 3.3, Fig. 44. A dispatch
// adds some cones of every pixel, with the light of some of the lights.
#pragma lumivox axis LOBE diffuse glossy
#pragma lumivox require MEDIUM == none
#include "store_layers.glsl"
#include "common/cone_march.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const int coneCount = 6;  // of the lobe
layout(constant_id = 6) const int pattern = 1;    // cones differ between the pixels of a square of this side

layout(std140, binding = 0) uniform Parameters {
  vec3 eyeWorld;
  int firstCone, conesAtOnce;
  int first, last;  // dispatch of the lobe
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gGeometricNormal;
#if LOBE == LOBE_GLOSSY
layout(binding = 5) uniform sampler2D gSpecular;
#endif
layout(binding = 0, rgba32f) uniform image2D sumImage;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(gPosition, 0)))) return;
  vec4 position = texelFetch(gPosition, pixel, 0);
  vec3 sum = first != 0 ? vec3(0.0) : imageLoad(sumImage, pixel).rgb;
  bool reflects = position.w > 0.0;
#if LOBE == LOBE_GLOSSY
  vec4 specular = texelFetch(gSpecular, pixel, 0);
  reflects = reflects && any(greaterThan(specular.rgb, vec3(0.0)));
#endif
  if (reflects) {
    vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
    vec3 apex = position.xyz + texelFetch(gGeometricNormal, pixel, 0).xyz * (offset * storeVoxel);
#if LOBE == LOBE_GLOSSY
    vec3 mirror = reflect(normalize(position.xyz - eyeWorld), normal);
#else
    vec2 place = placeInStratum(gl_GlobalInvocationID.xy, pattern);
#endif
    for (int i = firstCone; i < firstCone + conesAtOnce; ++i) {
#if LOBE == LOBE_GLOSSY
      Cone cone = glossyCone(i, coneCount, normal, mirror, specular.w);
      uint number = kGlossyCone + uint(i);
#else
      Cone cone = diffuseCone(i, coneCount, normal, place);
      uint number = uint(i);
#endif
      if (cone.weight > 0.0) sum += cone.weight * traceCone(apex, cone.direction, cone.tanHalfAngle, cone.cosTheta, number);
    }
  }
  if (last != 0) {
    sum /= float(coneCount);
#if LOBE == LOBE_GLOSSY
    sum *= specular.rgb;
#endif
  }
  imageStore(sumImage, pixel, vec4(sum, 1.0));
}
