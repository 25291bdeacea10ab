#include "direct_light.h"

#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/light_bounds.h"
#include "lumivox/toolkit/media.h"

namespace lumivox::voxel_cone_tracing {

namespace inject = shaders::voxel_cone_tracing::inject;

DirectLight::DirectLight(Pass* pass)
    : shadow(pass, "shadow", Presence::optional,
             "lights and their visibility; without it the voxels are dark but opaque"),
      media(pass, "media", Presence::optional, "media that attenuate light between lights and surfaces"),
      mediumSteps(pass, "medium_steps", 16, within(1, 1024),
                  "largest number of steps through a heterogeneous medium towards a light"),
      ambient(
          pass, "ambient", 0.0f, within(0.0f, 1e9f),
          "irradiance that all surfaces receive besides that of the lights, W/m^2, so that cones also see unlit surfaces (thesis Fig. 66)"),
      samples(
          pass, "light_samples", 1, within(1, 256),
          "lit points of a fragment's plane in its voxel, so that a shadow's edge within a voxel is resolved"),
      twoSided(pass, "two_sided", true,
               "light on the back of a triangle counts; off, as published: only on the front"),
      emission(
          pass, "emission", false,
          "voxels store emitted light too, for passes that show the voxels themselves, as 'lens' does; cones of 'gather' would take direct light of lamps for indirect light"),
      lobes(
          pass, "lobes", Lobes::diffuse,
          "what Phong lobes reflect is stored in the voxels; diffuse: all of it, as if it left to all sides; none: nothing, since the paper's fragments are diffuse",
          published(Lobes::none)) {}

bool DirectLight::glossy(PassContext& frame) const {
  return lobes == Lobes::diffuse && frame.traits().glossy;
}

float DirectLight::brightest(PassContext& frame, float nearest) const {
  // What a surface reflects, and its emission.
  return (emission ? 2.0f : 1.0f) * largestRadiance(frame.sceneDescription(), frame.snapshot(), nearest) +
         ambient / glm::pi<float>();
}

void DirectLight::reflect(PassContext& frame, const VoxelFragments& fragments, const VoxelSums& sums,
                          float mostRadiance, const gpu::BufferRef& radiances) const {
  const LightBinding lights(shadow);
  const MediaBinding bound(frame, media, shadow.present());
  const inject::Variant variant{.directions = sums.directional,
                                .lights = shadow.present(),
                                .shadows = shadow.present(),
                                .medium = bound.axis,
                                .reflected = fragments.reflected != nullptr,
                                .places = sums.kind,
                                .changed = sums.changed != nullptr};
  forEachTaken(
      frame, frame.program(variant),
      {inject::grid({.gridLow = fragments.grid.low,
                     .voxelSize = fragments.grid.voxelSize,
                     .lightCount = lights.count,
                     .mostRadiance = mostRadiance,
                     .twoSided = twoSided,
                     .mediumSteps = mediumSteps,
                     .brickCount = sums.brickCount,
                     .ambient = ambient,
                     .lightSamples = samples,
                     .emissive = emission,
                     .glossy = glossy(frame)}),
       inject::radiances(radiances), inject::reflected(fragments.reflected), sums.bindings(), lights, bound},
      fragments, sums);
}

}  // namespace lumivox::voxel_cone_tracing
