// The share of a clipmap level's value that comes from the finer level: a ramp of the distance from the finer level's border (thesis 004
// Sec. 3.5.2). All distances are multiples of one half, so that every pass gets the same bits.

// The box of a level, in its voxels: from `first` on and before `end`. `endless`: bits of the sides where the whole store ends: the lower
// sides of x, y, z from bit 0 on, the higher sides from bit 3 on.
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

// Share of the finer level in a voxel of the level above it: 0 at the border of the finer level, so that reads cross it without a jump.
float shareOfFiner(LevelEnds finer, ivec3 voxel) {
  uvec3 bits = uvec3(1u, 2u, 4u);
  ivec3 middle = 2 * voxel + 1;
  vec3 low = mix(vec3(middle - finer.first), vec3(kFarAway), notEqual(finer.endless & bits, uvec3(0u)));
  vec3 high = mix(vec3(finer.end - middle), vec3(kFarAway), notEqual(finer.endless >> 3 & bits, uvec3(0u)));
  vec3 inside = min(low, high);
  float fromBorder = 0.5 * min(inside.x, min(inside.y, inside.z));
  return clamp((fromBorder - 1.0) / max(clipmapRamp, 1e-6), 0.0, 1.0);
}
