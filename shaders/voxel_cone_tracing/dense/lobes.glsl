// Sums over a voxel's lit surfaces: xyz of the normals times the light that they reflect, w of that light.
struct Lobe {
  int sums[4];
};

const float kLobeShare = 0.5;  // both sides of a fragment may be as bright as the brightest
