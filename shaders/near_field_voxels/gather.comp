#version 450
// One bounce of light near each visible surface: Thiedemann, Henrich, Grosch & Mueller 2011, Sec. 5; thesis 004, Sec. 3.2.3 and 4.4.6.
// Bits say where a ray ends, and a reflective shadow map how bright it is there. A dispatch takes some of the rays of a pixel and adds them
// to what earlier ones found. Listings 4.45 to 4.49 take one ray a pass, with a buffer of places between it and the light, and blend them.
#pragma lumivox axis ARRIVING 0 1
#pragma lumivox axis RADIANCE none map voxels
#pragma lumivox axis OCCLUSION 0 1
#pragma lumivox axis FETCHES 0 1
#pragma lumivox require ARRIVING || OCCLUSION || FETCHES
#pragma lumivox require ARRIVING || RADIANCE == none
#include "common/cones.glsl"
#include "common/random.glsl"
#include "grid.glsl"
#if RADIANCE == RADIANCE_MAP
#include "back_projection.glsl"
#endif

layout(local_size_x = 8, local_size_y = 8) in;

const int kHitMiddle = 0, kHitEntry = 1, kHitCentre = 2, kHitPrinted = 3;
const int kRotationHash = 0, kRotationTile = 1, kRotationNone = 2;

layout(constant_id = 2) const int hitPoint = 0;
layout(constant_id = 3) const int rotation = 0;
layout(constant_id = 4) const int hammersley = 0;        // 1: that sequence, of the rays of one frame; 0: R2, which goes on and on
layout(constant_id = 5) const int offsetByDiagonal = 0;  // 1: of the start, as printed; 0: by what a plane can touch

layout(std140, binding = 1) uniform Rays {
  vec3 environment;      // W/(sr m^2)
  float spread;          // largest sine of a ray's angle to the normal, squared
  uvec2 seed;
  int every;             // one pixel of so many along each axis is gathered
  int rays;              // of a pixel and frame
  int firstRay;          // that this dispatch takes, and how many
  int raysAtOnce;
  int framesBefore;      // that are in `earlier`
  float offset;          // of the start along the normal; see startOf()
  float start;           // along the ray, voxels
  float reach;           // of light along the ray, from where `start` is 0, voxels
  float occlusionReach;  // of occlusion
  int beyondRadius;      // 1: the environment begins there; 0: behind the grid
  int first;             // 1: no light has been added yet
  int last;              // 1: the mean of the light is written
  int addsRest;          // 1: what rays bring beside light of the map is added; 0: another dispatch did so
  float scale;           // of what arrives
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gGeometricNormal;
layout(binding = 6) uniform sampler2D earlierArriving;   // means over the frames before
layout(binding = 7) uniform sampler2D earlierOcclusion;
#if ARRIVING
layout(binding = 0, rgba32f) uniform image2D arrivingImage;
#endif
#if OCCLUSION
layout(binding = 1, rgba32f) uniform image2D occlusionImage;
#endif
#if FETCHES
layout(binding = 2, rgba32f) uniform image2D fetchImage;
#endif
#if RADIANCE == RADIANCE_VOXELS
layout(binding = 10) uniform sampler3D radianceGrid;
layout(std140, binding = 3) uniform Radiance { float radianceUnit; };
#endif

// Two words to turn the sequence by, in 2^32 parts. A small texture of random numbers, as printed, is a hash of the place in a tile.
uvec2 turnOf(ivec2 at) {
  const int kTile = 4;
  if (rotation == kRotationNone) return uvec2(0u);
  uvec2 place = uvec2(rotation == kRotationTile ? at % kTile : at);
  return hash4(uvec4(place, seed)).xy;
}

// Ray number i of a pixel: a point of the unit square, uniformly.
vec2 pointOf(int i, uvec2 turn) {
  if (hammersley != 0) {
    // (i / n, bits of i mirrored). Every frame turns it elsewhere: it has no further points.
    if (framesBefore > 0) turn += hash4(uvec4(turn, uint(framesBefore), seed.x)).xy;
    float along = (float(i) + 0.5) / float(rays);
    return vec2(fract(along + unitInterval(turn).x), unitInterval(uvec2(bitfieldReverse(uint(i)) + turn.y)).x);
  }
  // R2 (Roberts 2018): multiples of the powers of 1 / 1.32472 in parts of 2^32, so that no ray is too many.
  uint number = uint(framesBefore) * uint(rays) + uint(i);
  return unitInterval(number * uvec2(3242174889u, 2447445413u) + 0x80000000u + turn);
}

// Listing 4.45.
vec3 directionOf(vec2 point, vec3 tangent, vec3 bitangent, vec3 normal) {
  float radius = sqrt(point.x * spread), angle = 2.0 * kPi * point.y;
  float x = radius * cos(angle), y = radius * sin(angle);
  return normalize(x * tangent + y * bitangent + sqrt(max(1.0 - x * x - y * y, 0.0)) * normal);
}

// Where the rays of a surface begin, in voxels. No voxel that a plane touches reaches further from it than the sum of the sides of its
// normal; the sixteenth keeps a plane that lies in the faces of voxels off the next ones.
vec3 startOf(vec3 posWorld, vec3 geometricNormal) {
  vec3 sides = abs(geometricNormal);
  float unit = offsetByDiagonal != 0 ? sqrt(3.0) : sides.x + sides.y + sides.z + 1.0 / 16.0;
  return (posWorld - gridLow) / voxelSize + geometricNormal * (offset * unit);
}

#if RADIANCE != RADIANCE_NONE
vec3 receiver;  // whose rays these are, posWorld

vec3 hitPointOf(BitHit hit) {
  vec3 centre = vec3(hit.voxel) + 0.5, entry = bitOrigin + hit.t * bitDirection;
  if (hitPoint == kHitMiddle) return bitOrigin + 0.5 * (hit.t + max(leavesVoxel(hit.voxel), hit.t)) * bitDirection;
  if (hitPoint == kHitEntry) return entry;
  return hitPoint == kHitCentre ? centre : vec3(entry.xy, centre.z);
}

vec3 radianceOf(BitHit hit) {
#if RADIANCE == RADIANCE_MAP
  vec3 point = gridLow + voxelSize * hitPointOf(hit);
  return radianceAt(point, printedTests != 0 ? receiver - point : -bitDirection);
#else
  vec4 value = texelFetch(radianceGrid, hit.voxel, 0);
  return value.a > 0.0 ? value.rgb * (radianceUnit / value.a) : vec3(0.0);
#endif
}
#endif

struct Sums {
  vec3 light;
  float open, fetches;
};

void follow(vec3 origin, vec3 direction, inout Sums sums) {
  float lightReach = reach - start;
  BitHit hit = firstBit(origin, direction, max(lightReach, occlusionReach - start), resolution);
  sums.fetches += float(hit.fetches);
  bool meets = hit.found && hit.t <= lightReach;
  if (!(hit.found && hit.t <= occlusionReach - start)) sums.open += 1.0;
  bool beyond = beyondRadius != 0 ? !meets : !hit.found && leavesGrid() <= lightReach;
  if (beyond && addsRest != 0) sums.light += environment;
#if RADIANCE != RADIANCE_NONE
  if (meets) sums.light += radianceOf(hit);
#endif
}

#if ARRIVING || OCCLUSION
// The mean over the rays of all frames, when the last of them are in.
vec4 finished(vec4 sum, float factor, vec4 earlier) {
  vec4 mean = sum * (factor / float(rays));
  if (framesBefore > 0) mean = (earlier * float(framesBefore) + mean) / float(framesBefore + 1);
  return mean;
}
#endif

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = textureSize(gPosition, 0);
  if (any(greaterThanEqual(every * at, size))) return;
  ivec2 pixel = min(every * at + every / 2, size - 1);
  vec4 position = texelFetch(gPosition, pixel, 0);
  Sums sums = Sums(vec3(0.0), 0.0, 0.0);
  if (position.w > 0.0) {
    vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
    vec3 tangent = tangentTo(normal), bitangent = cross(normal, tangent);
    vec3 origin = startOf(position.xyz, texelFetch(gGeometricNormal, pixel, 0).xyz);
    uvec2 turn = turnOf(at);
#if RADIANCE != RADIANCE_NONE
    receiver = position.xyz;
#endif
    for (int i = firstRay; i < firstRay + raysAtOnce; ++i) {
      vec3 direction = directionOf(pointOf(i, turn), tangent, bitangent, normal);
      follow(origin + start * direction, direction, sums);
    }
  }
  bool surface = position.w > 0.0;
#if ARRIVING
  vec4 arriving = vec4(sums.light, 0.0);
  if (first == 0) arriving += imageLoad(arrivingImage, at);
  if (last != 0) arriving = vec4(finished(arriving, scale, texelFetch(earlierArriving, at, 0)).rgb, surface ? 1.0 : 0.0);
  imageStore(arrivingImage, at, arriving);
#endif
#if OCCLUSION
  if (addsRest != 0) {
    vec4 open = vec4(sums.open);
    if (firstRay > 0) open += imageLoad(occlusionImage, at);
    if (firstRay + raysAtOnce == rays) open = vec4(vec3(surface ? finished(open, 1.0, texelFetch(earlierOcclusion, at, 0)).x : 1.0), surface ? 1.0 : 0.0);
    imageStore(occlusionImage, at, open);
  }
#endif
#if FETCHES
  if (addsRest != 0) imageStore(fetchImage, at, vec4(sums.fetches) + (firstRay > 0 ? imageLoad(fetchImage, at) : vec4(0.0)));
#endif
}
