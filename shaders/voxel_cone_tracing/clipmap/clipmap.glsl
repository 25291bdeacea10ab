// A clipmap: levels of equal size in voxels around the camera, each twice as coarse as the one before, and above the coarsest of them those
// that halving it makes (thesis 004, Sec. 3.5.1, Fig. 50 and 51). A voxel of a level has whole numbers that count from clipmapOrigin and do
// not depend on the camera, and its address is their remainder by the level's period, frac(world / size) in voxels (toroidal addressing,
// Fig. 52 and 53): what a level that moves no longer reaches makes room for what it reaches anew, and all else stays where it is.
//
// All voxels lie in one volume for each face, with a copy of the other side's voxels around each block, so that it can be filtered.
// The voxels of a level that the finer one has too are kept twice: as they were voxelized, and as the finer level makes them ("inner").
// C++ side: RadianceClipmap in techniques/voxel_cone_tracing/clipmap/radiance_clipmap.h.
const int kMostLevels = 20;

layout(std140, binding = 4) uniform Clipmap {
  vec3 clipmapOrigin;   // corner of voxel (0,0,0) of all levels, m
  float clipmapVoxel;   // finest voxels, m
  int clipmapLevels;    // around the camera
  int clipmapAll;       // and those above
  float clipmapBorder;  // voxels of a level over which reading goes on to the next one, before its border
  float clipmapRamp;    // voxels over which a level goes over from what was voxelized to what the finer one makes of it
  // Of each level: its voxels from the first on and before the end; w: period of addresses, and where the bits of its occupied voxels begin.
  // Start: the address of the first voxel, the remainder of its number.
  ivec4 ownFirst[kMostLevels];
  ivec4 ownEnd[kMostLevels];
  ivec4 ownTexel[kMostLevels];  // of the address (0,0,0)
  ivec4 ownStart[kMostLevels];
  ivec4 innerFirst[kMostLevels];
  ivec4 innerEnd[kMostLevels];
  ivec4 innerTexel[kMostLevels];
  ivec4 innerStart[kMostLevels];
  // Where the level is read, in voxels; far away on sides beyond which the whole store ends.
  vec4 reachFirst[kMostLevels];
  vec4 reachEnd[kMostLevels];
};

const float kFarAway = 1e29;

bool isInner(int level, ivec3 voxel) {
  return all(greaterThanEqual(voxel, innerFirst[level].xyz)) && all(lessThan(voxel, innerEnd[level].xyz));
}

// Voxels from a voxel's middle to the nearest border of a level at which another one takes over.
float withinReach(int level, vec3 at) {
  vec3 inside = min(at - reachFirst[level].xyz, reachEnd[level].xyz - at);
  return min(inside.x, min(inside.y, inside.z));
}

// A voxel in the volumes and among the bits.
struct ClipmapPlace {
  ivec3 texel, address;
  int period;
  uint word, bit;
};
// Of a voxel less than a period from the first one.
ClipmapPlace placeIn(ivec4 first, ivec4 end, ivec4 texel, ivec4 start, ivec3 voxel) {
  ClipmapPlace place;
  place.period = first.w;
  place.address = start.xyz + (voxel - first.xyz);
  place.address -= mix(ivec3(0), ivec3(place.period), greaterThanEqual(place.address, ivec3(place.period)));
  place.texel = texel.xyz + place.address;
  uint index = uint((place.address.z * place.period + place.address.y) * place.period + place.address.x);
  place.word = uint(end.w) + (index >> 5);
  place.bit = 1u << (index & 31u);
  return place;
}
ClipmapPlace ownPlace(int level, ivec3 voxel) { return placeIn(ownFirst[level], ownEnd[level], ownTexel[level], ownStart[level], voxel); }
ClipmapPlace innerPlace(int level, ivec3 voxel) {
  return placeIn(innerFirst[level], innerEnd[level], innerTexel[level], innerStart[level], voxel);
}
