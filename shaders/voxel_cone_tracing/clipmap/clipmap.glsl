// A clipmap: levels around the camera with equal size in voxels, each twice as coarse as the previous level. Above the coarsest of them
// are levels made by halving it (thesis 004, Sec. 3.5.1, Fig. 50 and 51). The coordinates of a level's voxels are integers that count from
// clipmapOrigin and do not depend on the camera. A voxel's address is the remainder of its coordinates by the level's period: in voxels,
// frac(world / size) (toroidal addressing, Fig. 52 and 53). When a level moves, the voxels that it newly reaches replace those that it
// leaves; all others keep their addresses.
//
// All voxels lie in one volume per face. Each block has a border with copies of the voxels of its opposite side, so that it can be
// filtered. Voxels of a level that also lie in the finer level are stored twice: as voxelized ("own"),
// and as filtered from the finer level ("inner").
// C++ side: RadianceClipmap in techniques/voxel_cone_tracing/clipmap/radiance_clipmap.h.
const int kMostLevels = 20;

layout(std140, binding = 4) uniform Clipmap {
  vec3 clipmapOrigin;   // corner of voxel (0,0,0) of all levels, m
  float clipmapVoxel;   // size of the finest voxels, m
  int clipmapLevels;    // number of levels around the camera
  int clipmapAll;       // number of levels, with those above
  float clipmapBorder;  // width before a level's border over which reads blend to the next level, voxels
  float clipmapRamp;    // width over which a level blends from voxelized to filtered voxels, voxels
  // Per level. First, end: its voxels from `first` on and before `end`; w of first: period of addresses; w of end: first word of its
  // occupancy bits. Texel: of the address (0,0,0). Start: the address of the first voxel, the remainder of its coordinates.
  ivec4 ownFirst[kMostLevels];
  ivec4 ownEnd[kMostLevels];
  ivec4 ownTexel[kMostLevels];  // of the address (0,0,0)
  ivec4 ownStart[kMostLevels];
  ivec4 innerFirst[kMostLevels];
  ivec4 innerEnd[kMostLevels];
  ivec4 innerTexel[kMostLevels];
  ivec4 innerStart[kMostLevels];
  // The box in which the level is read, in voxels; far away on sides where the whole store ends.
  vec4 reachFirst[kMostLevels];
  vec4 reachEnd[kMostLevels];
};

const float kFarAway = 1e29;

bool isInner(int level, ivec3 voxel) {
  return all(greaterThanEqual(voxel, innerFirst[level].xyz)) && all(lessThan(voxel, innerEnd[level].xyz));
}

// Distance, in voxels, from a point to the nearest border of a level at which another level takes over.
float withinReach(int level, vec3 at) {
  vec3 inside = min(at - reachFirst[level].xyz, reachEnd[level].xyz - at);
  return min(inside.x, min(inside.y, inside.z));
}

// Position of a voxel in the volumes and among the occupancy bits.
struct ClipmapPlace {
  ivec3 texel, address;
  int period;
  uint word, bit;
};
// The place of a voxel that is less than a period away from the first voxel.
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
