#version 450
// One bounce of light near each visible surface: Thiedemann, Henrich, Grosch & Mueller 2011, Sec. 5; thesis 004, Sec. 3.2.3 and 4.4.6.
// Binary voxels give the hit point of a ray, and a reflective shadow map its radiance. A dispatch traces some of the rays of each pixel and
// adds them to the sums of earlier dispatches. Deviates: Listings 4.45 to 4.49 trace one ray per pass, store hit points in a buffer before
// lighting them, and blend the passes.
#pragma lumivox axis ARRIVING 0 1
#pragma lumivox axis RADIANCE none map voxels faces
#pragma lumivox axis OCCLUSION 0 1
#pragma lumivox axis FETCHES 0 1
#pragma lumivox axis MAP_LOBES 0 1
#pragma lumivox require !MAP_LOBES || RADIANCE == map
#pragma lumivox axis PLANES 0 1
#pragma lumivox require !PLANES || BIT_RULE != printed
#pragma lumivox require ARRIVING || OCCLUSION || FETCHES
#pragma lumivox require !FETCHES || (!PLANES && RADIANCE != faces)
#pragma lumivox require ARRIVING || RADIANCE == none
#include "common/cones.glsl"
#include "common/environment.glsl"
#include "common/random.glsl"
#include "common/bit_rays.glsl"
#if PLANES
#include "common/voxel_planes.glsl"
#endif
#if RADIANCE == RADIANCE_MAP
#include "common/back_projection.glsl"
#endif

layout(local_size_x = 8, local_size_y = 8) in;

const int kHitMiddle = 0, kHitEntry = 1, kHitCentre = 2, kHitPrinted = 3;
const int kRotationHash = 0, kRotationTile = 1, kRotationNone = 2;

layout(constant_id = 2) const int hitPoint = 0;
layout(constant_id = 3) const int rotation = 0;
layout(constant_id = 4) const int hammersley = 0;        // 1: Hammersley points, for the rays of one frame; 0: R2, an infinite sequence
layout(constant_id = 5) const int offsetByDiagonal = 0;  // unit of `offset`: 1: a voxel's diagonal, as printed; 0: reachOfPlane()

layout(std140, binding = 1) uniform Rays {
  vec3 environment;      // W/(sr m^2)
  float spread;          // largest sine of a ray's angle to the normal, squared
  uvec2 seed;
  int every;             // every n-th pixel along each axis is gathered
  int rays;              // per pixel and frame
  int firstRay;          // first ray of this dispatch; raysAtOnce: its number of rays
  int raysAtOnce;
  int framesBefore;      // number of frames in the earlier sums
  int portion;           // number of the sequence's portion, of `rays` points each, that this frame takes
  float offset;          // of the ray's origin along the normal; see startOf()
  float start;           // of the ray's origin along the ray, voxels
  float reach;           // search distance of light along the ray, measured from start 0, voxels
  float occlusionReach;  // the same for occlusion
  int beyondRadius;      // 1: the environment begins at `reach`; 0: behind the grid
  int first;             // 1: no light of this frame has been added yet
  int last;              // 1: the mean of the light is written
  int addsRest;          // 1: adds environment, occlusion and fetches; 0: another dispatch added them
  float scale;           // factor on the arriving light
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gGeometricNormal;
// Sums over all rays of the earlier frames and this one. The sum of the light has a compensation of its rounding error (Kahan 1965), so
// that several frames of few rays equal one frame of many rays, to the bit.
layout(binding = 6) uniform sampler2D earlierLight;
layout(binding = 11) uniform sampler2D earlierLost;
layout(binding = 7) uniform sampler2D earlierOpen;
#if ARRIVING
layout(binding = 0, rgba32f) uniform writeonly image2D arrivingImage;
layout(binding = 3, rgba32f) uniform image2D lightSum;
layout(binding = 4, rgba32f) uniform image2D lostSum;
#endif
#if OCCLUSION
layout(binding = 1, rgba32f) uniform writeonly image2D occlusionImage;
layout(binding = 5, rgba32f) uniform image2D openSum;
#endif
#if FETCHES
layout(binding = 2, rgba32f) uniform image2D fetchImage;
#endif
#if RADIANCE == RADIANCE_VOXELS
layout(binding = 10) uniform sampler3D radianceGrid;
layout(std140, binding = 3) uniform Radiance { float radianceUnit; };
#elif RADIANCE == RADIANCE_FACES
layout(binding = 10) uniform sampler3D positiveX;  // by the outward normals of the faces
layout(binding = 13) uniform sampler3D negativeX;
layout(binding = 15) uniform sampler3D positiveY;
layout(binding = 16) uniform sampler3D negativeY;
layout(binding = 17) uniform sampler3D positiveZ;
layout(binding = 18) uniform sampler3D negativeZ;
layout(std140, binding = 3) uniform Radiance { float radianceUnit; };
#endif

// Random shift of the sequence, in units of 2^-32. A hash of the position in a tile replaces the printed small texture of random numbers.
uvec2 turnOf(ivec2 at) {
  const int kTile = 4;
  if (rotation == kRotationNone) return uvec2(0u);
  uvec2 place = uvec2(rotation == kRotationTile ? at % kTile : at);
  return hash4(uvec4(place, seed)).xy;
}

// Ray number i of a pixel: a point of the unit square, uniformly.
vec2 pointOf(int i, uvec2 turn) {
  if (hammersley != 0) {
    // (i / n, reversed bits of i). The sequence has only the points of one frame, so every frame shifts it differently.
    if (portion > 0) turn += hash4(uvec4(turn, uint(portion), seed.x)).xy;
    float along = (float(i) + 0.5) / float(rays);
    return vec2(fract(along + unitInterval(turn).x), unitInterval(uvec2(bitfieldReverse(uint(i)) + turn.y)).x);
  }
  // With accumulation, each frame continues the sequence.
  return unitInterval(wordsOfR2(uint(portion) * uint(rays) + uint(i), turn));
}

// The origin of a surface's rays, in voxels.
vec3 startOf(vec3 posWorld, vec3 geometricNormal) {
  float unit = offsetByDiagonal != 0 ? sqrt(3.0) : reachOfPlane(geometricNormal);
  return (posWorld - gridLow) / voxelSize + geometricNormal * (offset * unit);
}

#if RADIANCE != RADIANCE_NONE
vec3 receiver;  // posWorld of the surface that gathers

vec3 hitPointOf(BitHit hit) {
#if PLANES
  return bitOrigin + hit.t * bitDirection;
#else
  vec3 centre = vec3(hit.voxel) + 0.5, entry = bitOrigin + hit.t * bitDirection;
  if (hitPoint == kHitMiddle) return bitOrigin + 0.5 * (hit.t + max(leavesVoxel(hit.voxel), hit.t)) * bitDirection;
  if (hitPoint == kHitEntry) return entry;
  return hitPoint == kHitCentre ? centre : vec3(entry.xy, centre.z);
#endif
}

vec3 radianceOf(BitHit hit) {
#if RADIANCE == RADIANCE_MAP
  vec3 point = gridLow + voxelSize * hitPointOf(hit);
  return radianceAt(point, printedTests != 0 ? receiver - point : -bitDirection);
#else
#if RADIANCE == RADIANCE_VOXELS
  vec4 value = texelFetch(radianceGrid, hit.voxel, 0);
#else
  // The three faces that the ray sees, by the weights with which cones blend them (thesis, Listing 4.15).
  vec3 along = abs(bitDirection);
  vec4 value = along.x * (bitDirection.x < 0.0 ? texelFetch(positiveX, hit.voxel, 0) : texelFetch(negativeX, hit.voxel, 0)) +
               along.y * (bitDirection.y < 0.0 ? texelFetch(positiveY, hit.voxel, 0) : texelFetch(negativeY, hit.voxel, 0)) +
               along.z * (bitDirection.z < 0.0 ? texelFetch(positiveZ, hit.voxel, 0) : texelFetch(negativeZ, hit.voxel, 0));
#endif
  return value.a > 0.0 ? value.rgb * (radianceUnit / value.a) : vec3(0.0);
#endif
}
#endif

struct Sums {
  vec3 light, lost;
  float open, fetches;
};

void addLight(inout Sums sums, vec3 light) {
  precise vec3 before = sums.light;
  precise vec3 added = light - sums.lost;
  precise vec3 after = before + added;
  precise vec3 rest = (after - before) - added;
  sums.light = after;
  sums.lost = rest;
}

void follow(vec3 origin, vec3 direction, inout Sums sums) {
  float lightReach = reach - start;
  BitHit hit = firstBit(origin, direction, max(lightReach, occlusionReach - start), resolution);
  sums.fetches += float(hit.fetches);
  bool meets = hit.found && hit.t <= lightReach;
  if (!(hit.found && hit.t <= occlusionReach - start)) sums.open += 1.0;
  bool beyond = beyondRadius != 0 ? !meets : !hit.found && leavesGrid() <= lightReach;
  // A ray stands for the share 1 / rays of the projected solid angle of all, pi times the spread: a cone of that width.
  if (beyond && addsRest != 0) addLight(sums, environmentAlong(environment, direction, sqrt(spread / float(rays))));
#if RADIANCE != RADIANCE_NONE
  if (meets) addLight(sums, radianceOf(hit));
#endif
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = textureSize(gPosition, 0);
  if (any(greaterThanEqual(every * at, size))) return;
  ivec2 pixel = min(every * at + every / 2, size - 1);
  vec4 position = texelFetch(gPosition, pixel, 0);
  Sums sums = Sums(vec3(0.0), vec3(0.0), 0.0, 0.0);
#if ARRIVING
  if (first == 0) {
    sums.light = imageLoad(lightSum, at).rgb;
    sums.lost = imageLoad(lostSum, at).rgb;
  } else if (framesBefore > 0) {
    sums.light = texelFetch(earlierLight, at, 0).rgb;
    sums.lost = texelFetch(earlierLost, at, 0).rgb;
  }
#endif
  if (position.w > 0.0) {
    vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
    vec3 tangent = tangentTo(normal), bitangent = cross(normal, tangent);
    vec3 origin = startOf(position.xyz, texelFetch(gGeometricNormal, pixel, 0).xyz);
    uvec2 turn = turnOf(at);
#if RADIANCE != RADIANCE_NONE
    receiver = position.xyz;
#endif
    for (int i = firstRay; i < firstRay + raysAtOnce; ++i) {
      vec3 direction = cosineDirection(pointOf(i, turn), spread, tangent, bitangent, normal);
      follow(origin + start * direction, direction, sums);
    }
  }
  bool surface = position.w > 0.0;
  float allRays = float(framesBefore + 1) * float(rays);
#if ARRIVING
  imageStore(lightSum, at, vec4(sums.light, 1.0));
  imageStore(lostSum, at, vec4(sums.lost, 1.0));
  if (last != 0) imageStore(arrivingImage, at, vec4(sums.light * (scale / allRays), surface ? 1.0 : 0.0));
#endif
#if OCCLUSION
  if (addsRest != 0) {
    float open = sums.open;  // integers: exact
    if (firstRay > 0) open += imageLoad(openSum, at).x;
    else if (framesBefore > 0) open += texelFetch(earlierOpen, at, 0).x;
    imageStore(openSum, at, vec4(open));
    if (firstRay + raysAtOnce == rays)
      imageStore(occlusionImage, at, vec4(vec3(surface ? open * (1.0 / allRays) : 1.0), surface ? 1.0 : 0.0));
  }
#endif
#if FETCHES
  if (addsRest != 0) imageStore(fetchImage, at, vec4(sums.fetches) + (firstRay > 0 ? imageLoad(fetchImage, at) : vec4(0.0)));
#endif
}
