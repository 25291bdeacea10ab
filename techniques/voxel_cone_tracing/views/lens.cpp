// Shows a store through a thin lens: Crassin et al. 2011; thesis Gomes 2015, Sec. 2.4, Fig. 16.
#include "../cones/march.h"
#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/environment.h"
#include "lumivox/toolkit/media.h"

namespace lumivox::voxel_cone_tracing {
namespace {

namespace code = shaders::voxel_cone_tracing::lens;

class LensPass : public Pass {
  // In the order of lens.comp.
  enum class Width { spread, doubleCone };
  enum class Opacity { surfaces, medium };

  StoreInput store{this};
  In<ScatteringGrid> media{this, "media", Presence::optional,
                           "media that attenuate the cones; light that they scatter is left out"};
  Param<Width> width{
      this, "width", Width::spread,
      "diameter of a cone; spread: that of a disc with the combined variance of pixel and lens; double_cone: the sum of the diameters of pixel and lens, as published"};
  Param<Opacity> opacity{
      this, "opacity", Opacity::surfaces,
      "meaning of a voxel's opacity; surfaces: a closed surface blocks all light; medium: a medium, as for the other cones"};
  Param<float> step{this, "step", 0.25f, within(0.05f, 2.0f), "step along a cone as a share of its diameter"};
  Param<float> footprint{this, "footprint", 0.5f, within(0.25f, 1.0f),
                         "size of the voxels that are read, as a share of the cone's diameter"};
  Out<Image> radiance{this, "radiance", Contributes::direct, Needs::nothing,
                      "radiance of the voxels through the lens, W/(sr m^2)"};

  Reads readsFrom() const override { return Reads::camera | Reads::lens | Reads::environment; }

  void run(PassContext& frame) override {
    const StoreBinding input = store.binding();
    if (input.holdsMedia && media.present())
      throw Error(
          "voxel_cone_tracing.lens: the voxels of 'grid' already contain the media, and 'media' would dim what the cones see once more; expected 'media' to be left out, or 'store_media off' in voxel_cone_tracing.inject");
    const MediaBinding bound(frame, media);
    const CameraView& camera = frame.snapshot().camera;
    const auto columns = static_cast<float>(camera.width), rows = static_cast<float>(camera.height);
    const glm::vec3 corner = camera.direction(0.0f, 0.0f);
    radiance = Image{frame.image("radiance through the lens")};
    frame.dispatch(frame.program(code::Variant{.environment = frame.traits().environment,
                                               .medium = bound.axis,
                                               .store = input.axis,
                                               .faces = input.faces},
                                 code::Constants{.widthRule = static_cast<int>(static_cast<Width>(width)),
                                                 .asMedium = opacity == Opacity::medium,
                                                 .environmentMap = environmentMapOf(frame)}),
                   {code::lens({.eyeWorld = camera.eye,
                                .aperture = camera.aperture,
                                .corner = corner,
                                .focus = camera.focus,
                                .perColumn = (camera.direction(columns, 0.0f) - corner) / columns,
                                .pixelWidth = 2.0f * camera.tanHalfFov / rows,
                                .perRow = (camera.direction(0.0f, rows) - corner) / rows,
                                .stepShare = step,
                                .environment = frame.sceneDescription().environment,
                                .footprint = footprint}),
                    bound, input, EnvironmentBinding(frame), code::radianceImage(radiance->texture)},
                   pixels(frame));
  }
};

}  // namespace

void addLens(TechniqueRegistry& registry) {
  registry.add<LensPass>(
      "lens",
      "Depth of field: the voxels as seen through a thin lens (Crassin et al. 2011; thesis Sec. 2.4)");
}

}  // namespace lumivox::voxel_cone_tracing
