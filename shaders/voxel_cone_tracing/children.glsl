// Children of a coarse voxel where a level may not be of half the size of the finer one.
// Part of child `child` that lies in coarse voxel `cell` along one axis, in children. With an even number of children it is 1 for two of
// them; with an odd number a coarse voxel is a little wider than two, and shares children with its neighbours.
float share(int cell, int child, float childrenPerCell) {
  float low = float(cell) * childrenPerCell, high = low + childrenPerCell;
  return clamp(min(high, float(child + 1)) - max(low, float(child)), 0.0, 1.0);
}

// A child seen through `length` of its own width.
vec4 slab(vec4 value, float length) {
  if (length >= 1.0 || value.a <= 0.0) return length >= 1.0 ? value : vec4(0.0);
  float opacity = 1.0 - pow(1.0 - value.a, length);
  return vec4(value.rgb * (opacity / value.a), opacity);
}
