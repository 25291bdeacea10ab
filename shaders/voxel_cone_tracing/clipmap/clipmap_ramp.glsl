// How much a level of a clipmap takes from the finer one, by a ramp of the distance from the border of the finer level (thesis 004 Sec. 3.5.2).
// All numbers here are halves of whole ones, so that whoever asks gets the same bits.

// Where a level ends, in its voxels: from the first on and before the end. `endless`: bits of axes along which the whole store ends there, and
// those of the higher sides from bit 3 on.
struct LevelEnds {
  ivec3 first, end;
  uint endless;
};
LevelEnds endsOf(int level) {
  uvec3 bits = uvec3(1u, 2u, 4u), none = uvec3(0u);
  uvec3 low = mix(none, bits, lessThan(reachFirst[level].xyz, vec3(-kFarAway)));
  uvec3 high = mix(none, bits, greaterThan(reachEnd[level].xyz, vec3(kFarAway)));
  return LevelEnds(ownFirst[level].xyz, ownEnd[level].xyz, low.x | low.y | low.z | (high.x | high.y | high.z) << 3);
}

// Of a voxel of the level above. Where the finer level begins, nothing is of it: reading goes on there without a leap.
float shareOfFiner(LevelEnds finer, ivec3 voxel) {
  uvec3 bits = uvec3(1u, 2u, 4u);
  ivec3 middle = 2 * voxel + 1;
  vec3 low = mix(vec3(middle - finer.first), vec3(kFarAway), notEqual(finer.endless & bits, uvec3(0u)));
  vec3 high = mix(vec3(finer.end - middle), vec3(kFarAway), notEqual(finer.endless >> 3 & bits, uvec3(0u)));
  vec3 inside = min(low, high);
  float fromBorder = 0.5 * min(inside.x, min(inside.y, inside.z));
  return clamp((fromBorder - 1.0) / max(clipmapRamp, 1e-6), 0.0, 1.0);
}
