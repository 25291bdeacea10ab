// Sums of the normals of a voxel's lit surfaces and of the light that they reflect.
struct Lobe {
  int sums[4];
};

const float kLobeShare = 0.5;  // both sides of a fragment may be as bright as the brightest
