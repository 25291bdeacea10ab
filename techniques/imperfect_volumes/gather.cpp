// Looks up light and openness at the visible surfaces: Mavridis & Papaioannou 2011, Sec. 3.4 and 3.5.
#include <fmt/format.h>

#include "lumivox/base/error.h"
#include "lumivox/toolkit/environment.h"
#include "volume.h"

namespace lumivox::imperfect_volumes {

using namespace shaders::imperfect_volumes;

namespace {

class GatherPass : public Pass {
  enum class Negative { clip, closure };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<ShGrid> incoming{this, "incoming", Presence::optional, "light that arrives in each voxel, from 'march'",
                      Needs::anyLight};
  In<ShGrid> visibility{this, "visibility", Presence::optional, "visibility of each voxel, from 'occlude'"};
  In<OccupancyGrid> opacity{this, "opacity", Presence::optional,
                            "with 'blend free': which voxels are occupied"};
  In<AttributeGrid> attributes{
      this, "attributes", Presence::optional,
      "with 'blend free': mean normals of the voxels, which tell at an edge which voxels lie in front of both walls"};
  Neighbours neighbours{this};
  Param<float> occupied{this, "occupied", 0.0f, within(0.0f, 1.0f),
                        "with 'blend free': coverage above which a voxel is occupied"};
  Param<Negative> negative{
      this, "negative", Negative::clip,
      "irradiance that two bands make negative; clip: set to 0; closure: neither side of a surface below 0, with the same difference between them"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::anyLight,
                     "indirect light reflected by the diffuse lobe, W/(sr m^2)"};
  Out<Image> occlusion{this, "occlusion", Contributes::ambientOcclusion, Needs::triangles,
                       "irradiance of the visibility over pi, clamped to 0..1"};
  Out<Image> clipped{
      this, "clipped", Contributes::nothing, Needs::anyLight,
      "magnitude of the radiance that two bands made negative, before its correction, W/(sr m^2)"};

  Reads readsFrom() const override { return Reads::environment; }
  bool uses(const InBase& input) const override {
    return ((&input != &opacity && &input != &attributes) || neighbours.onlyFree()) &&
           (&input != &incoming || diffuse.wanted() || clipped.wanted()) &&
           (&input != &visibility || occlusion.wanted());
  }

  void run(PassContext& frame) override {
    if (diffuse.wanted() || clipped.wanted()) {
      const gpu::TextureRef light = frame.image("indirect diffuse radiance"),
                            cut = frame.image("clipped radiance");
      if (isThere(frame, incoming, "diffuse"))
        gather(frame, incoming, gather::Variant::ofLight,
               {gather::diffuseImage(light), gather::clippedImage(cut)});
      else
        for (const gpu::TextureRef& image : {light, cut}) image->clear(glm::vec4(0.0f));
      diffuse = Image{light};
      clipped = Image{cut};
    }
    if (occlusion.wanted()) {
      const gpu::TextureRef open = frame.image("ambient occlusion");
      if (isThere(frame, visibility, "occlusion"))
        gather(frame, visibility, gather::Variant::ofOpenness, {gather::occlusionImage(open)});
      else
        open->clear(glm::vec4(neutralElement(Contributes::ambientOcclusion)));
      occlusion = Image{open};
    }
  }

  /// Where everything is kept, outputs run even without their inputs.
  static bool isThere(PassContext& frame, const In<ShGrid>& light, const char* output) {
    if (!light.present() && !frame.keepsEverything())
      throw Error(fmt::format("'{}' is made of '{}'; expected it to be connected", output, light.name()));
    return light.present();
  }

  void gather(PassContext& frame, const In<ShGrid>& light, int of, const shader::BindingSet& to) const {
    const auto [volume, unit] = volumeOf(light, neighbours.inWords());
    const char* const input = light.name().c_str();
    const bool free = neighbours.onlyFree();
    if (free && !opacity.present()) throw Error("'blend free' reads 'opacity'; expected it to be connected");
    if (free && !attributes.present())
      throw Error("'blend free' reads 'attributes'; expected it to be connected");
    if (free) requireSameGrid("opacity", opacity->grid, input, volume.grid);
    if (free) requireSameGrid("attributes", attributes->grid, input, volume.grid);
    // A texture must be bound even where none is read.
    const gpu::TextureRef &around = free ? opacity->opacity : volume.coefficients[0],
                          &normals = free ? attributes->normal : volume.coefficients[0];
    frame.dispatch(
        frame.program(gather::Variant{of},
                      neighbours.in(gather::Constants{.closure = negative == Negative::closure,
                                                      .environmentMap = environmentMapOf(frame)})),
        {EnvironmentBinding(frame),
         gather::gathering({.environment = frame.sceneDescription().environment, .unit = unit}),
         volumeBinding(volume.grid, occupied), neighbours.binding(), GBufferBinding(*gbuffer),
         ShLevelBinding(volume, gpu::Sampling::linear), gather::opacityAround(around, gpu::Sampling::nearest),
         gather::normalsAround(normals, gpu::Sampling::nearest), to},
        pixels(frame));
  }
};

}  // namespace

void addGather(TechniqueRegistry& registry) {
  registry.add<GatherPass>(
      "gather",
      "Light and ambient occlusion at the visible surfaces (Mavridis & Papaioannou 2011, Sec. 3.4)");
}

}  // namespace lumivox::imperfect_volumes
