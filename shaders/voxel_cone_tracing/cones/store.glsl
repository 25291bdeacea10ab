// The store of light and opacity that cones read, whichever it is. Each kind of store has a file that says
//   vec2 insideStore(vec3 origin, vec3 direction)   where a ray enters it and where it leaves it, m along the ray
//   float finestVoxel(vec3 at)                      its finest voxels there, m
//   float longestStep(float size)                   m, through voxels of `size` m
//   bool readsLayers()                              the opacity of a sample is that of its step through layers of voxels; else that of voxels
//   StoreSample readStore(vec3 at, vec3 direction, float size, float stride)
//                                                   what a step of `stride` m through voxels of `size` m around a point looks like
// C++ side: StoreInput in techniques/voxel_cone_tracing/cones/march.h.
#pragma lumivox axis STORE dense directional octree clipmap
#ifndef LUMIVOX_STORE
#define LUMIVOX_STORE
#include "common/cones.glsl"

struct StoreSample {
  vec4 value;     // rgb radiance / storeUnit, multiplied by the opacity a of some length; all 0 where there is nothing
  float opacity;  // of the step
};

layout(std140, binding = 1) uniform Store {
  vec3 storeLow;                // m
  float storeVoxel;             // finest voxels, m
  vec3 storeExtent;             // m
  float storeCoarsest;          // coarsest level
  float storeUnit;              // W/(sr m^2) that the value 1 stands for
  int storeOpacityOfFinestVoxel;  // 1: what RadianceGrid::Opacity::ofFinestVoxel says
  float storeFirstLevelOfFaces;   // directional: level of the grid that the faces begin with
  int storeLayers;                // of six faces: 1: voxels are read by layers; 0: filtered along all axes
  vec3 storeVoxels;               // of the finest level
};

// The opacity of a step from that of the voxels that were read, `size` m wide, as a blend of those of a level and a share of the next one.
float opacityOfStep(float opacity, float stride, float level, float blend) {
  float through = max(1.0 - opacity, 0.0);
  return storeOpacityOfFinestVoxel != 0 ? stepOpacityOf(through, stride / storeVoxel)
                                        : stepOpacityOf(throughVoxel(through, blend), stride / (exp2(level) * storeVoxel));
}

const float kNoLimit = 1e30;
// Of the cone that is traced.
vec3 coneApex;      // m
float coneTangent;  // of its half angle

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
