// What the camera sees becomes voxels (Mavridis & Papaioannou 2011, Sec. 3.2).
#include "fragment_list.h"
#include "voxelization_shaders.h"

namespace lumivox::voxelization {
namespace {

namespace reprojectShader = shaders::voxelization::reproject;

class ReprojectPass : public GridPass {
  In<GBuffer> gbuffer{this, "gbuffer", "what the camera sees"};
  In<VoxelFragments> base{this, "fragments", Presence::optional,
                          "voxels to which those that the camera sees are added; the grid is theirs then"};
  Out<VoxelFragments> fragments{this, "fragments", "surface samples: first those of the input"};

  Reads readsFrom() const override { return readsSurface(); }

  void run(PassContext& frame) override {
    const gpu::TextureDescription& picture = gbuffer->position->description();
    const VoxelFragments list = listBehind(
        frame, base.present() ? base->grid : placement(frame), base.present() ? &*base : nullptr,
        std::uint64_t{static_cast<unsigned>(picture.width)} * static_cast<unsigned>(picture.height));
    reprojectShader::Variant variant;
    variant.emission = gbuffer->emission != nullptr;
    std::vector<gpu::ResourceBinding> bindings{
        reprojectShader::grid(
            {list.grid.low, list.grid.voxelSize, list.grid.resolution, static_cast<int>(list.capacity)}),
        reprojectShader::count(*list.count),
        reprojectShader::fragments(*list.fragments),
        reprojectShader::position(*gbuffer->position, gpu::Sampling::nearest),
        reprojectShader::normal(*gbuffer->normal, gpu::Sampling::nearest),
        reprojectShader::diffuse(*gbuffer->diffuse, gpu::Sampling::nearest)};
    if (gbuffer->emission != nullptr)
      bindings.push_back(reprojectShader::emission(*gbuffer->emission, gpu::Sampling::nearest));
    frame.dispatch(frame.program(reprojectShader::kProgram, variant.key()), bindings,
                   {picture.width, picture.height, 1}, reprojectShader::kGroupSize);
    finishList(frame, list);
    fragments = list;
  }
};

}  // namespace

void addReproject(TechniqueRegistry& registry) {
  registry.add<ReprojectPass>(
      "reproject",
      "Surface points that the camera sees, alone or added to other voxels (Mavridis & Papaioannou 2011)");
}

}  // namespace lumivox::voxelization
