#version 450
// Opacity by multisampling (3D clipmaps; thesis 004 Sec. 3.5.2): the samples of a pixel that a triangle covers lie in one to three voxels
// of the column; the number of samples in a voxel gives its coverage by the triangle.
// TARGET list: one fragment per voxel, with this coverage. TARGET masks: the samples, as bits of the voxel's three sides; samples are also
// projected into the other two planes, with the surface thickened along its dominant axis.
// The pixels of TARGET list may be smaller than a voxel (adaptive supersampling, Sec. 3.5.2): each covers its share of the voxel's side.
#pragma lumivox axis TEXTURES 0 1
#pragma lumivox axis MASKS 0 1
#pragma lumivox axis TARGET list masks
#define SCENE_MATERIALS
#include "common/scene.glsl"
#include "common/voxel.glsl"
#include "sample_grid.glsl"

#if TARGET == TARGET_LIST
#include "fragment_list.glsl"
#else
layout(binding = 0, r32ui) uniform uimage3D sampleMasks;
#endif
#include "common/column_sample.glsl"
#include "common/covered_samples.glsl"

layout(location = 0) flat in mat3 corners;
layout(location = 3) flat in mat3 cornerNormals;
layout(location = 6) flat in int dominantAxis;
#if TEXTURES || MASKS
layout(location = 7) flat in vec2 cornerTexcoords[3];
#else
const vec2 cornerTexcoords[3] = vec2[3](vec2(0.0), vec2(0.0), vec2(0.0));
#endif

void main() {
  uint covered = uint(gl_SampleMaskIn[0]) & ((1u << sampleCount) - 1u);
  ivec2 pixel = ivec2(gl_FragCoord.xy), column = pixel / scale;
  vec2 corner = vec2(pixel - column * scale);  // corner of the pixel in its column, in pixels
  vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
  if (covered == 0u || normal.z == 0.0) discard;
  MaterialData material = materials[materialIndex];
  ColumnSample s = sampleColumn(corners, cornerNormals, cornerTexcoords, material, fragmentOf(material), column);
  if (isHole(s)) discard;
  vec2 blueCoverage = unpackHalf2x16(s.fragment.albedoBCoverage);

  vec2 slope = -normal.xy / normal.z;
  float depths[kMostSamples];
  float nearest = 1e9, farthest = -1e9;
  for (int i = 0; i < sampleCount; ++i) {
    depths[i] = corners[0].z + dot(slope, vec2(column) + (corner + samples[i].xy) / float(scale) - corners[0].xy);
    if ((covered >> i & 1u) == 0u) continue;
    nearest = min(nearest, depths[i]);
    farthest = max(farthest, depths[i]);
  }
  ivec3 size = permute(resolution, dominantAxis);
  if (any(greaterThanEqual(column, size.xy))) discard;
  int last = int(clamp(floor(farthest), -1.0, float(size.z - 1)));
  for (int depth = int(clamp(floor(nearest), 0.0, float(size.z))); depth <= last; ++depth) {
    uint inside = 0u;
    for (int i = 0; i < sampleCount; ++i) inside |= int(floor(depths[i])) == depth ? covered & 1u << i : 0u;
    if (inside == 0u) continue;
    ivec3 voxel = ivec3(column, depth);
#if TARGET == TARGET_LIST
    VoxelFragment fragment = fragmentAt(s, voxel, dominantAxis);
    float share = float(bitCount(inside)) / float(sampleCount * scale * scale);
    fragment.albedoBCoverage = packHalves(vec2(blueCoverage.x, blueCoverage.y * share));
    uint index = atomicAdd(fragmentCount, 1u);
    if (index < uint(capacity)) fragments[index] = fragment;
#else
    if (blueCoverage.y >= kMaskThreshold) imageAtomicOr(sampleMasks, unpermute(voxel, dominantAxis), sideMasks(inside, depths, float(depth), dominantAxis));
#endif
  }
}
