// Makes voxels from the surfaces that the camera sees (Mavridis & Papaioannou 2011, Sec. 3.2).
#include <fmt/format.h>

#include "lumivox/base/error.h"
#include "voxelizer.h"

namespace lumivox::voxelization {

using namespace shaders::voxelization;

namespace {

class ReprojectPass : public GridPass {
  In<GBuffer> gbuffer{this, "gbuffer", "what the camera sees"};
  In<VoxelFragments> base{this, "fragments", Presence::optional,
                          "voxels to which the visible surface points are added; their grid is used"};
  // Sec. 3.2: the points carry the direct light that the deferred renderer has computed.
  In<Image> direct{
      this,
      "direct",
      Presence::optional,
      "direct light at the visible surfaces, stored in their fragments, so that injection does not light them again; without it injection lights them like all others",
      Needs::nothing,
      Contributes::direct};
  Out<VoxelFragments> fragments{this, "fragments", "surface samples: first those of the input"};

  void run(PassContext& frame) override {
    const gpu::TextureDescription& image = gbuffer->position->description();
    VoxelFragments list =
        listBehind(frame, base.present() ? base->grid : placement(frame), base.present() ? &*base : nullptr,
                   std::uint64_t{static_cast<unsigned>(image.width)} * static_cast<unsigned>(image.height));
    if (direct.present()) {
      requireFits(list, image);
      list.reflected =
          frame.elements(reproject::reflected, list.capacity, "direct light that fragments reflect");
      list.reflected->clear(VoxelFragments::kNotKnown);
    }
    const reproject::Variant variant{gbuffer->emission != nullptr, direct.present(),
                                     gbuffer->specular != nullptr};
    frame.dispatch(frame.program(variant),
                   {appending(list), GBufferBinding(*gbuffer), reproject::reflected(list.reflected),
                    reproject::direct(textureOf(direct), gpu::Sampling::nearest)},
                   {image.width, image.height, 1});
    finishCount(frame, list.count, list.capacity);
    fragments = list;
  }

  void requireFits(const VoxelFragments& list, const gpu::TextureDescription& image) const {
    const gpu::TextureDescription& light = direct->texture->description();
    if (light.width != image.width || light.height != image.height)
      throw Error(fmt::format("input 'direct' has {} x {} texels; expected {} x {}, those of the g-buffer",
                              light.width, light.height, image.width, image.height));
    if (list.reflected != nullptr)
      throw Error(
          "input 'fragments' already contains direct light; expected input 'direct' at one "
          "reprojection only");
  }
};

}  // namespace

void addReproject(TechniqueRegistry& registry) {
  registry.add<ReprojectPass>(
      "reproject",
      "Surface points that the camera sees, alone or added to other voxels (Mavridis & Papaioannou 2011)");
}

}  // namespace lumivox::voxelization
