// The passes of voxel cone tracing by chapters: cones (cones/); the stores that they read, which are dense
// grids (dense/), an octree (octree/) and a clipmap (clipmap/); and views of any grid (views/).
#include "lumivox/plugin/technique.h"

namespace lumivox::voxel_cone_tracing {

void addInject(TechniqueRegistry& registry);
void addFilter(TechniqueRegistry& registry);
void addFilterDirectional(TechniqueRegistry& registry);
void addGather(TechniqueRegistry& registry);
void addSoftShadows(TechniqueRegistry& registry);
void addLobes(TechniqueRegistry& registry);
void addLens(TechniqueRegistry& registry);
void addLook(TechniqueRegistry& registry);
void addClipmap(TechniqueRegistry& registry);
void addClipmapFilter(TechniqueRegistry& registry);
void addOctree(TechniqueRegistry& registry);
void addOctreeFilter(TechniqueRegistry& registry);
void addOctreeSplat(TechniqueRegistry& registry);

}  // namespace lumivox::voxel_cone_tracing

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::voxel_cone_tracing;
  registry.describe(
      "Voxel cone tracing through dense grids, a sparse octree or a clipmap, with one value a voxel or six faces",
      "Crassin et al. 2011; thesis Gomes 2015, Sec. 4.2.1");
  addInject(registry);
  addFilter(registry);
  addFilterDirectional(registry);
  addLobes(registry);
  addClipmap(registry);
  addClipmapFilter(registry);
  addOctree(registry);
  addOctreeFilter(registry);
  addOctreeSplat(registry);
  addGather(registry);
  addSoftShadows(registry);
  addLens(registry);
  addLook(registry);
}
