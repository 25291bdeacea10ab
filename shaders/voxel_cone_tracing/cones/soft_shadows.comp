#version 450
// Direct light at the visible surfaces, with a cone to each light instead of a shadow map: Crassin et al. 2011; thesis 004
// Sec. 2.4, Fig. 15.
#pragma lumivox axis LIGHTS 0 1
#pragma lumivox axis GLOSSY 0 1
#pragma lumivox axis EMISSION 0 1
#pragma lumivox axis MEDIUM none even varying
#pragma lumivox require MEDIUM == none || LIGHTS
#include "common/environment.glsl"
#include "common/environment_view.glsl"
// The environment in a pixel, as wide as the pixel.
vec3 environmentSeen(vec3 constant, ivec2 pixel) {
  vec3 direction = directionOfPixel(pixel);
  return environmentAlong(constant, direction, 0.5 * length(viewPerRow.xyz) / length(direction));
}
#include "common/direct_light.glsl"
#include "surfaces.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const int kLarger = 0, kEye = 1, kLight = 2;
layout(constant_id = 0) const int radiusOf = kLarger;
layout(constant_id = 1) const int asMedium = 0;

layout(std140, binding = 2) uniform Shadows {
  float stepShare;   // step along a cone as a share of its diameter
  float offset;      // start of a cone along the normal, in voxels
  float startShare;  // start of a cone along its axis, in voxels
  float clearance;   // largest size of the voxels read, as a share of their height over the surface and over the surface of an area light
  float footprint;   // size of the voxels read, as a share of the cone's diameter
  float pixelWidth;  // of a pixel, per metre of distance along its ray
};

layout(binding = 0, rgba32f) uniform writeonly image2D radianceImage;

#if LIGHTS
// C++ side: techniques/voxel_cone_tracing/cones/light_discs.h.
struct LightDisc {
  vec4 centreRadius;  // m
  vec4 normal;        // mean normal of an area light, shorter than 1 if the light is curved; 0 for other lights
};
layout(std430, binding = 6) readonly buffer Discs { LightDisc discs[]; };
layout(std430, binding = 7) readonly buffer DiscOfSample { uint discOfSample[]; };

const float kFar = 1e30;  // m; distance of lights without a position

// A cone and its end.
struct ShadowCone {
  vec3 direction;
  float reach;       // m, to the light
  float lightRatio;  // diameter of the light over the reach
  // Height per metre before the end: over the plane of an area light, the sphere around a curved one, or a point; 0: no limit by the light.
  float rise;
  float end;         // m, where this height is 0
};

ShadowCone coneTo(LightDisc disc, LightSample light, vec3 posWorld, float height, vec3 geometricNormal, vec3 toLight) {
  if (light.kind == kLightDirectional) return ShadowCone(toLight, kFar, 0.0, 0.0, kFar);
  vec3 way = disc.centreRadius.xyz - posWorld;
  // If the centre of the light lies below the surface's plane, the cone goes to the light sample instead.
  if (dot(way, geometricNormal) <= 0.0) way = light.position - posWorld;
  // The cone begins at this height over the surface, but not above a light that is lower.
  way -= min(height, max(dot(way, geometricNormal), 0.0)) * geometricNormal;
  float reach = length(way), radius = disc.centreRadius.w;
  if (reach == 0.0) return ShadowCone(toLight, 0.0, 0.0, 0.0, 0.0);
  // A light without extent has a rise of 1 too: it may lie on a surface, whose voxels must not occlude it.
  ShadowCone cone = ShadowCone(way / reach, reach, 2.0 * radius / reach, 1.0, reach);
  if (light.kind == kLightArea) {
    const float kFlat = 0.9;
    float flatness = length(disc.normal.xyz);
    cone.rise = flatness > kFlat ? max(dot(-cone.direction, disc.normal.xyz) / flatness, 0.0) : 1.0;
    if (flatness <= kFlat) cone.end = max(reach - radius, 0.0);
  }
  return cone;
}

// Visible fraction of a light. The cone's diameter is the larger of two: of the cone whose base is the light's disc, and of the eye's cone
// at the surface, a constant width that the thesis uses alone (`radius eye`).
float traceShadow(LightDisc disc, LightSample light, vec3 posWorld, vec3 geometricNormal, vec3 toLight) {
  float voxel = finestVoxel(posWorld), eyeDiameter = radiusOf == kLight ? 0.0 : pixelWidth * length(posWorld - eyeWorld);
  vec3 apex = posWorld + geometricNormal * (offset * voxel);
  ShadowCone cone = coneTo(disc, light, posWorld, offset * voxel, geometricNormal, toLight);
  if (radiusOf == kEye) cone.lightRatio = 0.0;
  float cosSurface = max(dot(geometricNormal, cone.direction), 0.0);
  vec2 inside = insideStore(apex, cone.direction);
  float distance = max(startShare * voxel, inside.x), end = min(cone.end, inside.y);
  if (cone.rise > 0.0) end = min(end, cone.end - offset * finestVoxel(apex + cone.direction * cone.reach) / cone.rise);
  Covering covering = kOpen;
  while (distance < end && covering.through > 1.0 - kOpaque) {
    float height = offset * voxel + cosSurface * distance;
    if (cone.rise > 0.0) height = min(height, cone.rise * (cone.end - distance));
    float wanted = max(min(footprint * max(cone.lightRatio * distance, eyeDiameter), clearance * height), voxel);
    float stride = min(min(stepShare * wanted / footprint, longestStep(wanted)), end - distance);
    StoreSample found = readStore(apex + cone.direction * (distance + 0.5 * stride), cone.direction, wanted, stride);
    if (asMedium != 0)
      coverByMedium(covering, found);
    else
      cover(covering, found, wanted, stride);
    distance += stride;
  }
  return covering.through > 1.0 - kOpaque ? covering.through : 0.0;
}

// The samples of one light follow each other and share one cone.
uint lastDisc = ~0u;
float lastShare = 1.0;

float visibleShare(int i, LightSample light, vec3 posWorld, vec3 geometricNormal, vec3 toLight) {
  uint disc = discOfSample[i];
  if (disc != lastDisc) {
    lastDisc = disc;
    lastShare = traceShadow(discs[disc], light, posWorld, geometricNormal, toLight);
  }
  return lastShare;
}
#endif

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(radianceImage)))) return;
  imageStore(radianceImage, pixel, vec4(directLight(pixel), 1.0));
}
