// A layer of a view. C++ side: LayeredReflectiveShadowMap::Layer.
struct Layer {
  float middle, halfWidth;  // of its depth interval, m
  int view;
  int facing;               // cube side to which its normals point, in the order +x -x +y -y +z -z; -1: any
  int slot;
};
