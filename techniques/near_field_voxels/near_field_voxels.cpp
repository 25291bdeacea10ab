// Near-field voxels: Thiedemann, Henrich, Grosch & Mueller 2011, "Voxel-based global illumination"; thesis
// Gomes 2015, Sec. 3.2 and 4.4.6. Rays through one bit a voxel.
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "near_field_voxels_shaders.h"

namespace lumivox::near_field_voxels {
namespace {

using namespace shaders::near_field_voxels;

/// In the order of BIT_RULE in bit_grid.glsl.
enum class Method { hierarchy, stacks, plain };

class ProbePass : public Pass {
  In<BinaryGrid> bits{this, "bits", "one bit a voxel"};
  In<Image> origins{this, "origins",
                    "start of a ray in world space, and in w how far it goes, m; below 0: none"};
  In<Image> directions{this, "directions", "its direction, of unit length"};
  Param<Method> method{
      this, "method", Method::hierarchy,
      "how the first voxel of a ray is found: from coarse texels to fine ones; by the stacks alone; one voxel after another. All find the same one"};
  Out<Image> hits{this, "hits", Contributes::nothing, Needs::nothing,
                  "the voxel that a ray meets first, -1 where it meets none; in w the way to it, m"};
  Out<Image> fetches{this, "fetches", Contributes::nothing, Needs::nothing,
                     "in r: texels of the stacks that were read"};

  void run(PassContext& frame) override {
    const gpu::TextureDescription& rays = origins->texture->description();
    const gpu::TextureDescription images{
        .format = gpu::Format::rgba32f, .width = rays.width, .height = rays.height};
    hits = Image{frame.texture(images, "voxels that rays meet")};
    fetches = Image{frame.texture(images, "texels that rays read")};
    const GridPlacement& grid = bits->grid;
    frame.dispatch(
        frame.program(probe::Variant{.bitRule = static_cast<int>(static_cast<Method>(method))}),
        {probe::grid({.gridLow = grid.low, .voxelSize = grid.voxelSize, .resolution = grid.resolution}),
         probe::origins(origins->texture, gpu::Sampling::nearest),
         probe::directions(directions->texture, gpu::Sampling::nearest),
         probe::bitStacks(bits->stacks, gpu::Sampling::nearest), probe::voxelImage(hits->texture),
         probe::fetchImage(fetches->texture)},
        {rays.width, rays.height, 1});
  }
};

}  // namespace
}  // namespace lumivox::near_field_voxels

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::near_field_voxels;
  registry.describe("Near-field voxels: rays through one bit a voxel",
                    "Thiedemann et al. 2011; thesis Gomes 2015, Sec. 3.2");
  registry.add<ProbePass>("probe", "Rays that are given through bits (thesis Gomes 2015, Sec. 3.2.2)");
}
