#version 450
// Direct light at the visible surfaces, where a cone to each light takes the place of a shadow map: Crassin et al. 2011; thesis 004 Sec.
// 2.4, Fig. 15.
#pragma lumivox axis LIGHTS 0 1
#pragma lumivox axis GLOSSY 0 1
#pragma lumivox axis EMISSION 0 1
#pragma lumivox axis MEDIUM none even varying
#pragma lumivox require MEDIUM == none || LIGHTS
#include "common/direct_light.glsl"
#if LIGHTS
#include "surfaces.glsl"
#endif

layout(local_size_x = 8, local_size_y = 8) in;

const int kLarger = 0, kEye = 1, kLight = 2;
layout(constant_id = 0) const int radiusOf = kLarger;
layout(constant_id = 1) const int asMedium = 0;

layout(std140, binding = 2) uniform Shadows {
  float stepShare;   // step along a cone as a share of its diameter
  float offset;      // start of a cone along the normal, in voxels
  float startShare;  // start of a cone along its axis, in voxels
  float clearance;   // largest voxels that are read as a share of their height over the surface, and over that of an area light
  float footprint;   // voxels that are read as a share of the cone's diameter
  float pixelWidth;  // of a pixel, per metre of distance along its ray
};

layout(binding = 0, rgba32f) uniform writeonly image2D radianceImage;

#if LIGHTS
// The cone starts at the surface and ends at the light. Its diameter is the larger of two: that of the cone whose base is the light's disc,
// and the impact of the eye's cone on the surface, which the thesis gives to all of it (`radius eye`).
float visibleShare(LightSample light, vec3 posWorld, vec3 geometricNormal, vec3 toLight) {
  float voxel = finestVoxel(posWorld);
  vec3 apex = posWorld + geometricNormal * (offset * voxel), direction = toLight;
  float reach = 1e30, lightRatio = 0.0, cosLight = 1.0;
  if (light.kind != kLightDirectional) {
    vec3 way = light.position - apex;
    reach = length(way);
    if (reach == 0.0) return 1.0;
    direction = way / reach;
    lightRatio = 2.0 * sqrt(light.patchRadiusSquared) / reach;
  }
  float lightVoxel = finestVoxel(light.kind == kLightDirectional ? apex : light.position);
  float lightReach = 1e30;  // where the voxels of the light's own surface begin
  if (light.kind == kLightArea) {
    cosLight = dot(-direction, light.direction);
    if (cosLight <= 0.0) return 0.0;  // the raised start may lie behind a light that the surface itself sees
    lightReach = reach - offset * lightVoxel / cosLight;
  }
  float eyeDiameter = radiusOf == kLight ? 0.0 : pixelWidth * length(posWorld - eyeWorld);
  if (radiusOf == kEye) lightRatio = 0.0;
  float cosSurface = max(dot(geometricNormal, direction), 0.0);
  vec2 inside = insideStore(apex, direction);
  float distance = max(startShare * voxel, inside.x), end = min(min(reach, lightReach), inside.y);
  float through = 1.0;
  while (distance < end && through > 1.0 - kOpaque) {
    float diameter = max(lightRatio * distance, eyeDiameter);
    float height = offset * voxel + cosSurface * distance;
    if (light.kind == kLightArea) height = min(height, cosLight * (reach - distance));
    float wanted = min(footprint * diameter, clearance * height);
    float stride = min(stepShare * max(wanted / footprint, voxel), end - distance);
    StoreSample found = readStore(apex + direction * (distance + 0.5 * stride), direction, wanted, stride);
    if (found.value.a > 0.0) through *= asMedium != 0 ? 1.0 - found.opacity : throughSurfaces(found);
    distance += stride;
  }
  return through > 1.0 - kOpaque ? through : 0.0;
}
#endif

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(radianceImage)))) return;
  imageStore(radianceImage, pixel, vec4(directLight(pixel), 1.0));
}
