// The rays of a camera, one through the centre of each pixel.
// C++ side: VoxelLook in framework/include/lumivox/toolkit/voxel_view.h.
#ifndef LUMIVOX_VOXEL_RAYS
#define LUMIVOX_VOXEL_RAYS

layout(std140, binding = 0) uniform VoxelRays {
  vec3 eye;            // m
  float pixelWidth;    // at a depth of 1 m
  vec3 corner;         // direction through the upper left corner of the image, 1 along the view axis
  float cut;           // near limit along the view axis, m: nearer voxels are not visible
  vec3 perColumn;      // from one pixel's direction to the next
  float above;         // cubes and lobes whose values are all at most this far from 0 are not drawn
  vec3 perRow;
  int shading;         // of blended voxels: 0 none, 1 by sides, 2 by sides with edges
  float gain;          // factor on the emission of blended voxels
  float background;    // behind them
};

// `perDepth`: distance along the ray per distance along the view axis.
vec3 rayOf(ivec2 pixel, out float perDepth) {
  vec3 direction = corner + (float(pixel.x) + 0.5) * perColumn + (float(pixel.y) + 0.5) * perRow;
  perDepth = length(direction);
  return direction / perDepth;
}

vec4 beforeBackground(vec4 seen) { return vec4(gain * seen.rgb + (1.0 - seen.a) * background, 1.0); }

#endif
