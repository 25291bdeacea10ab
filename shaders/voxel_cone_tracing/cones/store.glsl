// The store of radiance and opacity that cones read. Each kind of store has a file that defines
//   vec2 insideStore(vec3 origin, vec3 direction)   distances along a ray at which it enters and leaves the store, m
//   float finestVoxel(vec3 at)                      size of the finest voxels at a point, m
//   float longestStep(float size)                   step limit through voxels of `size` m, m
//   bool readsLayers()                              true: value.a of a sample is the opacity of its step through layers; false: of voxels
//   StoreSample readStore(vec3 at, vec3 direction, float size, float stride)
//                                                   a step of `stride` m through voxels of `size` m around a point
// C++ side: StoreInput in techniques/voxel_cone_tracing/cones/march.h.
#pragma lumivox axis STORE dense directional octree clipmap
#ifndef LUMIVOX_STORE
#define LUMIVOX_STORE
#include "common/cones.glsl"

struct StoreSample {
  vec4 value;     // rgb radiance / storeUnit, pre-multiplied by the opacity a of some length; all 0 where the store is empty
  float opacity;  // of the step
};

layout(std140, binding = 1) uniform Store {
  vec3 storeLow;                // m
  float storeVoxel;             // size of the finest voxels, m
  vec3 storeExtent;             // m
  float storeCoarsest;          // coarsest level
  float storeUnit;              // radiance of the value 1, W/(sr m^2)
  int storeOpacityOfFinestVoxel;  // 1: opacities are per length of a finest voxel (RadianceGrid::Opacity::ofFinestVoxel)
  float storeFirstLevelOfFaces;   // directional: the grid's level that is the first level with faces
  int storeLayers;                // for six faces: 1: voxels are read by layers; 0: filtered along all axes
  vec3 storeVoxels;               // resolution of the finest level
};

// The opacity of a step of `stride` m, from the opacity read at `level`, blended with the next level by `blend`.
float opacityOfStep(float opacity, float stride, float level, float blend) {
  float through = max(1.0 - opacity, 0.0);
  return storeOpacityOfFinestVoxel != 0 ? stepOpacityOf(through, stride / storeVoxel)
                                        : stepOpacityOf(throughVoxel(through, blend), stride / (exp2(level) * storeVoxel));
}

const float kNoLimit = 1e30;
// The cone that is being traced.
vec3 coneApex;      // m
float coneTangent;  // tangent of its half angle

#if STORE == STORE_DENSE
#include "../dense/store_dense.glsl"
#elif STORE == STORE_DIRECTIONAL
#include "../dense/store_directional.glsl"
#elif STORE == STORE_OCTREE
#include "../octree/store_octree.glsl"
#elif STORE == STORE_CLIPMAP
#include "../clipmap/store_clipmap.glsl"
#endif

#endif
