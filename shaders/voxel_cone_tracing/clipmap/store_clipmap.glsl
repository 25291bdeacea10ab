// A clipmap of six directional grids: thesis 004, Sec. 3.5.1. Near the border of a level, reads blend to the next coarser level, so that no
// edge is visible.
#include "clipmap.glsl"
#include "../cones/faces.glsl"

vec2 insideStore(vec3 origin, vec3 direction) { return insideVolume(storeLow, storeExtent, origin, direction); }

vec3 inVoxels(vec3 posWorld, int level) { return (posWorld - clipmapOrigin) / (clipmapVoxel * exp2(float(level))); }

// The finest level, `level` or coarser, that is read at a point. `share`: weight of the next coarser level.
int finestLevel(vec3 at, int level, out float share) {
  share = 0.0;
  for (; level < clipmapLevels - 1; ++level) {
    // Less than one voxel before the border, the filter would read beyond it.
    share = clamp(1.0 - (withinReach(level, inVoxels(at, level)) - 1.0) / clipmapBorder, 0.0, 1.0);
    if (share < 1.0) return level;
  }
  share = 0.0;
  return level;
}

float finestVoxel(vec3 at) {
  float share;
  int level = finestLevel(at, 0, share);
  return clipmapVoxel * exp2(float(level)) * (1.0 + share);
}

bool readsLayers() { return storeLayers != 0; }

// Step limit, m: no step skips a layer of the finer of the two levels that are read.
float longestStep(float size) { return readsLayers() ? storeVoxel * exp2(floor(log2(max(size / storeVoxel, 1.0)))) : kNoLimit; }

// The block from which the voxels of a level around a point are read.
struct ClipmapBlock {
  vec3 first, end, texel, start;
  float period;
};
ClipmapBlock blockAround(vec3 at, int level) {
  // The inner block is used only where all eight filtered voxels lie in it. At its border, inner and own voxels are equal by the ramp.
  vec3 first = mix(vec3(innerFirst[level].xyz) + 0.5, vec3(-1e30), lessThan(reachFirst[max(level, 1) - 1].xyz, vec3(-kFarAway)));
  vec3 end = mix(vec3(innerEnd[level].xyz) - 0.5, vec3(1e30), greaterThan(reachEnd[max(level, 1) - 1].xyz, vec3(kFarAway)));
  bool inner = level > 0 && level < clipmapLevels && all(greaterThanEqual(at, first)) && all(lessThanEqual(at, end));
  ivec4 from = inner ? innerFirst[level] : ownFirst[level];
  return ClipmapBlock(vec3(from.xyz), vec3(inner ? innerEnd[level].xyz : ownEnd[level].xyz),
                      vec3(inner ? innerTexel[level].xyz : ownTexel[level].xyz), vec3(inner ? innerStart[level].xyz : ownStart[level].xyz),
                      float(from.w));
}

// Texel of a point in the volumes. Beyond the block all is empty: `share` is the filter weight inside the block.
vec3 texelAround(ClipmapBlock block, vec3 at, out float share) {
  vec3 nearest = clamp(at, block.first + 0.5, block.end - 0.5), beside = clamp(1.0 - abs(at - nearest), 0.0, 1.0);
  share = beside.x * beside.y * beside.z;
  vec3 address = block.start + (nearest - block.first);
  return block.texel + address - block.period * step(block.period, address);
}

// The faces across x, y and z that a cone sees, each read at its own point.
void facesAround(vec3 atX, vec3 atY, vec3 atZ, ClipmapBlock block, vec3 direction, out vec4 x, out vec4 y, out vec4 z) {
  vec3 size = vec3(textureSize(positiveX, 0));
  float share;
  vec3 texel = texelAround(block, atX, share);
  x = share * seenAlongX(direction, texel / size, 0.0);
  texel = texelAround(block, atY, share);
  y = share * seenAlongY(direction, texel / size, 0.0);
  texel = texelAround(block, atZ, share);
  z = share * seenAlongZ(direction, texel / size, 0.0);
}

// Listing 4.15: all faces at the point itself, filtered along all axes.
vec4 interpolated(vec3 posWorld, vec3 direction, int level) {
  vec3 at = inVoxels(posWorld, level), weights = faceWeights(direction);
  vec4 x, y, z;
  facesAround(at, at, at, blockAround(at, level), direction, x, y, z);
  return weights.x * x + weights.y * y + weights.z * z;
}

vec4 layers(vec3 posWorld, vec3 direction, int level, float stride) {
  vec3 at = inVoxels(posWorld, level), centre = floor(at) + 0.5;
  vec4 x, y, z;
  facesAround(vec3(centre.x, at.yz), vec3(at.x, centre.y, at.z), vec3(at.xy, centre.z), blockAround(at, level), direction, x, y, z);
  if (x.a + y.a + z.a <= 0.0) return vec4(0.0);
  float ignored;
  bool fromWall = level == finestLevel(coneApex, 0, ignored);
  return throughFaces(x, y, z, direction, at, inVoxels(coneApex, level), fromWall, stride / (clipmapVoxel * exp2(float(level))));
}

StoreSample readStore(vec3 at, vec3 direction, float size, float stride) {
  float finest, wanted = max(size / storeVoxel, 1.0);
  int asked = int(floor(log2(wanted))), there = finestLevel(at, asked, finest);
  float blend, level = levelOf(max(wanted, exp2(float(there)) * (1.0 + finest)), storeCoarsest, blend);
  if (readsLayers()) {
    vec4 value = layers(at, direction, int(level), stride);
    if (blend > 0.0) value = mix(value, layers(at, direction, int(level) + 1, stride), blend);
    return StoreSample(value, value.a);
  }
  StoreSample result = StoreSample(interpolated(at, direction, int(level)), 0.0);
  if (blend > 0.0) result.value = mix(result.value, interpolated(at, direction, int(level) + 1), blend);
  if (result.value.a > 0.0) result.opacity = opacityOfStep(result.value.a, stride, level, blend);
  return result;
}
