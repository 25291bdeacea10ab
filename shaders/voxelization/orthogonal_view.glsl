// Orthogonal projection of the geometry along an axis of the grid, one pixel per column of voxels, for slicing and depth peeling.
// Positions are in voxels, permuted so that z is the view axis.
#define SCENE_VERTICES
#include "common/scene.glsl"
#include "common/voxel.glsl"
#include "view_axis.glsl"

// Depth peeling compares depths that different programs computed for the same triangle: they must be equal to the bit.
invariant gl_Position;
layout(location = 0) out vec3 posView;
layout(location = 1) out vec3 normalWorld;
#if TEXTURES || MASKS
layout(location = 2) out vec2 texcoord;
#endif

void main() {
  posView = permute((vertexPosWorld() - gridLow) / voxelSize, axis);
  normalWorld = vertexNormalWorld();
#if TEXTURES || MASKS
  texcoord = vertexTexcoord();
#endif
  // Row 0 is the top of a render target: y is flipped, so that pixel (x, y) is column (x, y).
  gl_Position = vec4(2.0 * posView.x / side - 1.0, 1.0 - 2.0 * posView.y / side, (posView.z - depthLow) / (depthHigh - depthLow), 1.0);
}
