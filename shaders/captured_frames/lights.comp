#version 450
// Pixels of a captured frame as lights on surfaces (Lensing and Broll 2013, Sec. 5): position and normal from depth, area from both, flux from
// the colour, which is the radiance of a Lambert emitter.
#pragma lumivox axis COUNTED 0 1  // pixels are counted by what became of them
layout(local_size_x = 8, local_size_y = 8) in;
#include "common/constants.glsl"
#include "camera.glsl"
#include "edge.glsl"

const int kSaturatedDropped = 1, kSaturatedScaled = 2;  // in the order of the parameter `saturated`
const float kFlyingCosine = 0.1;  // surfaces more grazing than this are edges that the sensor has smeared
// What became of a pixel.
const uint kLit = 0u, kNoSurface = 1u, kSaturated = 2u, kSeenLater = 3u;

layout(std140, binding = 0) uniform Parameters {
  int layer;             // frame; smaller ones are newer
  int saturated;
  float saturatedScale;
  float brightest;       // radiance of lamps, W/(sr m^2); 0: none is so bright
};
layout(binding = 0) uniform sampler2DArray capturedColour;
layout(binding = 1) uniform sampler2DArray filteredDepth;
layout(binding = 2) uniform sampler2D capturedRays;
layout(binding = 3) uniform sampler2DArray newerPosition;  // positionImage and normalImage, of which newer layers are done
layout(binding = 4) uniform sampler2DArray newerNormal;
layout(std430, binding = 0) readonly buffer Poses { CapturedPose poses[]; };
layout(std430, binding = 1) buffer Counts { uint counts[]; };
layout(binding = 0, rgba32f) uniform writeonly image2DArray positionImage;
layout(binding = 1, rgba32f) uniform writeonly image2DArray normalImage;
layout(binding = 2, rgba32f) uniform writeonly image2DArray fluxImage;

// The point of a pixel in the camera's space; z is 0 where there is none.
vec3 pointAt(ivec2 pixel, ivec2 size) {
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, size))) return vec3(0.0);
  vec3 ray = texelFetch(capturedRays, pixel, 0).xyz;
  float depth = ray.z > 0.0 ? texelFetch(filteredDepth, ivec3(pixel, layer), 0).r : 0.0;
  return vec3(ray.xy * depth, depth);
}

// The step along an axis of the image on one surface: between the neighbours, or to the one that is no edge; 0 without any.
vec3 stepBetween(vec3 before, vec3 here, vec3 after) {
  bool hasBefore = before.z > 0.0 && abs(before.z - here.z) <= kEdge * here.z, hasAfter = after.z > 0.0 && abs(after.z - here.z) <= kEdge * here.z;
  return (hasAfter ? after : here) - (hasBefore ? before : here);
}

// Whether a newer frame shows a surface in this place: its light is there already.
bool isSeenLater(vec3 posWorld) {
  for (int newer = 0; newer < layer; ++newer) {
    CapturedPose pose = poses[newer];
    vec3 path = posWorld - pose.eye.xyz;
    float depth = dot(path, pose.forward.xyz);
    if (depth <= 0.0) continue;
    vec2 ray = vec2(dot(path, pose.right.xyz), dot(path, pose.down.xyz)) / depth;
    ivec2 pixel = ivec2(floor(focal * distortedRay(ray, radial, tangential) + centre + 0.5));
    if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, textureSize(newerPosition, 0).xy))) continue;
    vec4 other = texelFetch(newerPosition, ivec3(pixel, newer), 0);
    // From the plane of the pixel: along the view a slanted surface leaves it within the pixel.
    float apart = dot(texelFetch(newerNormal, ivec3(pixel, newer), 0).xyz, posWorld - other.xyz);
    if (other.w > 0.0 && abs(apart) <= 2.0 * depthDeviation(depth)) return true;
  }
  return false;
}

// What becomes of the pixel; its light is returned where it is one.
uint lightOf(ivec2 pixel, ivec2 size, out vec4 position, out vec4 normalArea, out vec4 flux) {
  position = vec4(0.0);
  normalArea = vec4(0.0);
  flux = vec4(0.0, 0.0, 0.0, float(layer));
  vec3 here = pointAt(pixel, size);
  vec4 colour = texelFetch(capturedColour, ivec3(pixel, layer), 0);
  if (here.z <= 0.0 || colour.w == 0.0) return kNoSurface;
  vec3 right = stepBetween(pointAt(pixel - ivec2(1, 0), size), here, pointAt(pixel + ivec2(1, 0), size));
  vec3 down = stepBetween(pointAt(pixel - ivec2(0, 1), size), here, pointAt(pixel + ivec2(0, 1), size));
  vec3 across = cross(down, right);
  float length2 = dot(across, across);
  if (!(length2 > 0.0)) return kNoSurface;
  vec3 normal = across * inversesqrt(length2);
  vec4 ray = texelFetch(capturedRays, pixel, 0);
  float facing = -dot(normal, vec3(ray.xy, 1.0));
  if (facing < kFlyingCosine * length(vec3(ray.xy, 1.0))) return kNoSurface;
  CapturedPose pose = poses[layer];
  mat3 toWorld = mat3(pose.right.xyz, pose.down.xyz, pose.forward.xyz);
  vec3 posWorld = pose.eye.xyz + toWorld * here;
  if (isSeenLater(posWorld)) return kSeenLater;
  bool isSaturated = colour.w > 1.5 || (brightest > 0.0 && max(colour.r, max(colour.g, colour.b)) >= brightest);
  // The rays of a pixel fill the area ray.z at depth 1, and z^2 of it at depth z; a surface at a slant fills more.
  float area = here.z * here.z * ray.z / facing;
  vec3 radiance = colour.rgb * (isSaturated && saturated == kSaturatedScaled ? saturatedScale : 1.0);
  position = vec4(posWorld, 1.0);
  normalArea = vec4(toWorld * normal, area);
  if (isSaturated && saturated == kSaturatedDropped) return kSaturated;
  flux.rgb = kPi * area * radiance;
  return isSaturated ? kSaturated : kLit;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(filteredDepth, 0).xy;
  if (any(greaterThanEqual(pixel, size))) return;
  vec4 position, normalArea, flux;
  uint became = lightOf(pixel, size, position, normalArea, flux);
  imageStore(positionImage, ivec3(pixel, layer), position);
  imageStore(normalImage, ivec3(pixel, layer), normalArea);
  imageStore(fluxImage, ivec3(pixel, layer), flux);
#if COUNTED
  atomicAdd(counts[became], 1u);
#endif
}
