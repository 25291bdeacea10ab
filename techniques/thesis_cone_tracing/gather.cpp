// Final gathering with cones through one grid, six grids or an octree (thesis Gomes 2015, Sec. 4.2.1
// and 4.2.2, Listings 4.11 to 4.15 and 4.25).
#include <fmt/format.h>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/ports/directional_radiance_grid.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/environment.h"
#include "octree.h"

namespace lumivox::thesis_cone_tracing {
namespace {

namespace gather = shaders::thesis_cone_tracing::gather;

/// The store that cones read.
struct Store : shader::BindingSet {
  int axis = 0;
  float length = 0;  ///< longest useful cone, m
};

Store begun(int axis, const GridPlacement& grid, float unit, int levels) {
  Store result;
  const glm::vec3 extent = glm::vec3(grid.resolution) * grid.voxelSize;
  result.axis = axis;
  result.length = 2.0f * glm::length(extent);
  result.add(shader::BindingSet{gather::store({.storeLow = grid.low,
                                               .storeVoxel = grid.voxelSize,
                                               .storeExtent = extent,
                                               .storeUnit = unit,
                                               .storeCoarsest = static_cast<float>(levels - 1)})});
  return result;
}

Store storeOf(const RadianceGrid& grid) {
  Store result = begun(gather::Variant::storeGrid, grid.grid, grid.unit, grid.radiance->description().levels);
  result.add(shader::BindingSet{gather::radianceGrid(grid.radiance, gpu::Sampling::linearMipsBorder)});
  return result;
}

Store storeOf(const DirectionalRadianceGrid& grid) {
  if (grid.finest != nullptr)
    throw Error(
        "thesis_cone_tracing.gather: the finest level of 'directions' is one grid, and Listing 4.15 reads six at all levels; expected those of thesis_cone_tracing.mipmap_directional");
  constexpr auto kMips = gpu::Sampling::linearMipsBorder;
  Store result = begun(gather::Variant::storeSix, grid.grid, grid.unit, grid.filledLevels);
  result.add(
      shader::BindingSet{gather::positiveX(grid.faces[0], kMips), gather::negativeX(grid.faces[1], kMips),
                         gather::positiveY(grid.faces[2], kMips), gather::negativeY(grid.faces[3], kMips),
                         gather::positiveZ(grid.faces[4], kMips), gather::negativeZ(grid.faces[5], kMips)});
  return result;
}

Store storeOf(const OctreeBricks& octree) {
  // Along each axis an even number of voxels at every level, down to the level of four voxels along the
  // longest side, where a cone ends.
  GridPlacement whole = octree.tree.grid;
  int multiple = 1;
  while (8 * multiple <= whole.longest()) multiple *= 2;
  whole.resolution = (whole.resolution + (multiple - 1)) / multiple * multiple;
  Store result = begun(gather::Variant::storeOctree, whole, 1.0f, octree.filledLevels);
  result.add(shader::BindingSet{gather::brickPool(octree.radiance, gpu::Sampling::linear),
                                OctreeBinding(octree.tree, octree.poolShift)});
  return result;
}

class GatherPass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<RadianceGrid> grid{this,           "grid",     Presence::optional, "one grid, one mip per halving",
                        Needs::nothing, Levels::all};
  In<DirectionalRadianceGrid> directions{
      this,           "directions", Presence::optional, "in place of 'grid': six directional grids",
      Needs::nothing, Levels::all};
  In<OctreeBricks> octree{this,           "octree",   Presence::optional, "in place of 'grid': an octree",
                          Needs::nothing, Levels::all};
  Param<float> coneRatio{this, "cone_ratio",
                         1.15470053837925152902f,  // 2 tan 30 degrees
                         within(0.01f, 8.0f),
                         "diameter of one of the five cones over its height; no number is published"};
  Param<float> reach{
      this, "reach", 0.0f, within(0.0f, 1e9f), "m", "length of a cone; 0: to the end of the grid"};
  Param<float> jitter{
      this, "jitter", 0.0f, within(0.0f, 1.0f),
      "most by which a cone begins further on, in steps, by chance for each pixel and cone: named in Sec. 4.2.1 beside smaller steps"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "indirect light reflected by the diffuse lobe"};
  Out<Image> glossy{this, "glossy", Contributes::indirectGlossy, Needs::glossyMaterial,
                    "indirect light reflected by the Phong lobe"};

  Reads readsFrom() const override { return Reads::camera | Reads::environment; }

  void run(PassContext& frame) override {
    const int stores = grid.present() + directions.present() + octree.present();
    if (stores != 1)
      throw Error(fmt::format(
          "thesis_cone_tracing.gather: {} of light for the cones; expected one of the inputs 'grid', 'directions' and 'octree' to be connected",
          stores == 0 ? "no store" : "several stores"));
    const Store store = grid.present()         ? storeOf(*grid)
                        : directions.present() ? storeOf(*directions)
                                               : storeOf(*octree);
    const gather::Variant variant{.diffuse = diffuse.wanted(),
                                  .glossy = glossy.wanted() && gbuffer->specular != nullptr,
                                  .environment = frame.traits().environment,
                                  .store = store.axis};
    if (variant.diffuse) diffuse = Image{frame.image("indirect diffuse radiance")};
    if (variant.glossy) glossy = Image{frame.image("indirect glossy radiance")};
    frame.dispatch(frame.program(variant, gather::Constants{.environmentMap = environmentMapOf(frame)}),
                   {EnvironmentBinding(frame),
                    gather::cones({.eyeWorld = frame.snapshot().camera.eye,
                                   .coneRatio = coneRatio,
                                   .environment = frame.sceneDescription().environment,
                                   .maxDistance = reach > 0.0f ? reach : store.length,
                                   .jitter = jitter,
                                   .seed = seedWords(frame)}),
                    GBufferBinding(*gbuffer), store, gather::diffuseImage(textureOf(diffuse)),
                    gather::glossyImage(textureOf(glossy))},
                   pixels(frame));
  }
};

}  // namespace

void addGather(TechniqueRegistry& registry) {
  registry.add<GatherPass>("gather", "Final gathering with five cones and one (Listings 4.11 to 4.15, 4.25)");
}

}  // namespace lumivox::thesis_cone_tracing
