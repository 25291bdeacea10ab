// A layer of a view. C++ side: LayeredReflectiveShadowMap::Layer.
struct Layer {
  float middle, halfWidth;  // of its interval of depths, m
  int view;
  int facing;               // the side of a cube that its normals look to, +x -x +y -y +z -z; -1: any
  int slot;
};
