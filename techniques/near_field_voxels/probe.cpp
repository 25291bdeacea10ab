// Traces given rays, for tests and measurements.
#include "lumivox/toolkit/ray_stop.h"
#include "near_field_voxels_shaders.h"
#include "passes.h"

namespace lumivox::near_field_voxels {

namespace {

namespace probe = shaders::near_field_voxels::probe;

class ProbePass : public Pass {
  In<BinaryGrid> bits{this, "bits", "one bit a voxel"};
  In<Image> origins{this, "origins",
                    "start of a ray in world space; w: its length, m, or below 0 for no ray"};
  In<Image> directions{this, "directions", "its direction, of unit length"};
  RayMethod method{this};
  RayStop stop{this};
  Out<Image> hits{this, "hits", Contributes::nothing, Needs::nothing,
                  "the first voxel that a ray hits, -1 without a hit; w: distance to it, m"};
  Out<Image> fetches{this, "fetches", Contributes::nothing, Needs::nothing,
                     "in r: texels of the stacks that were read"};

  bool uses(const InBase& input) const override { return !stop.isInput(input) || stop.atPlanes(); }
  std::string checkParameters() const override {
    return stop.check(method.axis() == probe::Variant::bitRulePrinted, "method", "printed");
  }

  void run(PassContext& frame) override {
    const gpu::TextureDescription& rays = origins->texture->description();
    const gpu::TextureDescription images{
        .format = gpu::Format::rgba32f, .width = rays.width, .height = rays.height};
    hits = Image{frame.texture(images, "voxels that rays meet"), false};
    fetches = Image{frame.texture(images, "texels that rays read"), false};
    const VoxelPlanes planes = stop.planes(frame, *bits, "near_field_voxels.probe");
    frame.dispatch(
        frame.program(probe::Variant{.planes = stop.atPlanes(), .bitRule = method.axis()}),
        {method.binding(frame, *bits), planes, probe::origins(origins->texture, gpu::Sampling::nearest),
         probe::directions(directions->texture, gpu::Sampling::nearest), probe::voxelImage(hits->texture),
         probe::fetchImage(fetches->texture)},
        {rays.width, rays.height, 1});
  }
};

}  // namespace

void addProbe(TechniqueRegistry& registry) {
  registry.add<ProbePass>("probe", "Given rays through bits (thesis Gomes 2015, Sec. 3.2.2)");
}

}  // namespace lumivox::near_field_voxels
