// Gathers light from the grids at surfaces and along reflected rays: thesis Gomes 2015, Sec. 4.3.4 and 4.3.5.
#include <fmt/format.h>

#include "nested_grids.h"

namespace lumivox::light_propagation_volumes {

using namespace shaders::light_propagation_volumes;

namespace {

constexpr float kBlendCells = 4.0f;  // width of the seam between two grids, Listing 4.36
// Listing 4.36: of two grids of 32 cells the finer one counts alone up to 12 cells from the eye and not at
// all from 16 on.
constexpr float kInnerReach = 12.0f / 32.0f, kOuterReach = 16.0f / 32.0f;

float longestSide(const GridPlacement& grid) {
  return grid.voxelSize * static_cast<float>(grid.longest());
}

class GatherPass : public Pass {
  enum class Negative { closure, clip };
  enum class Lookup { reachable, filtered };
  enum class Lobe { arriving, normal };
  enum class Seam { border, radial };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<ShGrid> light{this, "light", "all light that passed each cell"};
  In<OccludedFaces> faces{this, "faces", Presence::optional,
                          "occluded faces; needed with 'lookup reachable'"};
  Param<float> blend{this, "blend", kBlendCells, within(0.5f, 64.0f),
                     "cells over which a grid is blended into the coarser one"};
  Param<float> offset{this, "offset", 1.0f, within(0.0f, 4.0f),
                      "distance of the look-up from the surface along its normal, in cells"};
  Param<float> exponent{
      this, "exponent", 1.0f, within(0.1f, 10.0f),
      "exponent of the radiance before it is multiplied by the albedo, an artistic choice (Listing 4.36); 1 conserves energy"};
  Param<Negative> negative{
      this, "negative", Negative::closure,
      "irradiance that two bands make negative; closure: neither side of a surface below 0, with the same difference between them; clip: set to 0",
      published(Negative::clip)};
  Param<Lookup> lookup{
      this, "lookup", Lookup::reachable,
      "cells that are read; reachable: those with an open way from the surface, at the offset; filtered: trilinear at the surface, through walls, half a cell too low along z (Listing 4.35)",
      published(Lookup::filtered)};
  Param<Lobe> lobe{
      this, "lobe", Lobe::arriving,
      "arriving: light that comes in through the cell; normal: the lobe around the normal itself, as light per face of a cell (Listing 4.35)",
      published(Lobe::normal)};
  Param<Seam> seam{
      this, "seam", Seam::border,
      "where grids are blended; border: before the finer grid's border; radial: from 12/32 to 16/32 of its side around the eye (Listing 4.36)",
      published(Seam::radial)};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "indirect light reflected by the diffuse lobe, W/(sr m^2)"};
  Out<Image> clipped{
      this, "clipped", Contributes::nothing, Needs::nothing,
      "magnitude of the radiance that two bands made negative, before its correction, W/(sr m^2)"};

  void run(PassContext& frame) override {
    const NestedGrids grids = fluxIn(light);
    const bool filtered = lookup == Lookup::filtered;
    if (!filtered) requireFaces(grids, faces);
    diffuse = Image{frame.image("indirect diffuse radiance")};
    clipped = Image{frame.image("clipped radiance")};
    const gather::Constants constants{.filtered = filtered,
                                      .closure = negative == Negative::closure,
                                      .ownLobe = lobe == Lobe::normal,
                                      .radialBlend = seam == Seam::radial};
    forEachLevel(grids, [&](std::size_t i) {
      const ShGrid::Level& level = grids[i];
      const bool known = faces.present() && i < faces->levels.size();
      const float side = longestSide(level.grid);
      frame.dispatch(frame.program(gather::Variant{}, constants),
                     {gather::parameters({.blend = blend,
                                          .offset = offset,
                                          .exponent = exponent,
                                          .first = i + 1 == grids.size(),
                                          .last = i == 0,
                                          .eye = frame.snapshot().camera.eye,
                                          .innerReach = kInnerReach * side,
                                          .outerReach = kOuterReach * side}),
                      GBufferBinding(*gbuffer), sampled(level, gpu::Sampling::linear),
                      facesOf(known ? faces->levels[i] : OccludedFaces::Level{}, level),
                      gather::diffuseImage(diffuse->texture), gather::clippedImage(clipped->texture)},
                     pixels(frame));
    });
    if (frame.inspects()) tellShare(frame, *diffuse->texture, *clipped->texture);
  }

  /// Reports the share of light that two bands made negative.
  static void tellShare(PassContext& frame, const gpu::Texture& light, const gpu::Texture& cut) {
    const auto sum = [](const gpu::Texture& texture) {
      const std::vector<float> values = texture.downloadFloats();
      double total = 0.0;
      for (std::size_t i = 0; i < values.size(); ++i) total += i % 4 == 3 ? 0.0 : values[i];
      return total;
    };
    const double all = sum(light), negative = sum(cut);
    if (all > 0.0)
      frame.note(
          fmt::format("{:.2g} % of the light of the image was negative in two bands before its correction",
                      100.0 * negative / all));
  }
};

class ReflectPass : public Pass {
  In<AttributeGrid> surfaces{this, "surfaces", "surfaces of the reflection grid"};
  In<ShGrid> light{this, "light", "all light that passed each cell"};
  Param<float> fade{this, "fade", 0.0f, within(0.0f, 1024.0f),
                    "voxels before the border over which the grid fades out"};
  PublishedForm asPublished{
      this,
      "Listing 4.34: albedo times the mean of all light in the finest cells, half a voxel off along z, fading out with the distance to the eye, in place of the light through the face in front of a surface; 'fade' is ignored"};
  Out<RadianceGrid> radiance{this,
                             "radiance",
                             Contributes::nothing,
                             Needs::glossyMaterial,
                             "light that leaves the surfaces, and their opacity; the finest level only",
                             Levels::finest};

  Reads readsFrom() const override { return asPublished ? Reads::camera : Reads::nothing; }

  void run(PassContext& frame) override {
    const NestedGrids grids = fluxIn(light);
    const glm::ivec3& size = surfaces->grid.resolution;
    RadianceGrid result;
    result.grid = surfaces->grid;
    result.radiance = frame.volume(size, gpu::Format::rgba32f, "reflection grid",
                                   gpu::fullLevelCount(size.x, size.y, size.z));
    result.filledLevels = 1;
    radiance = result;
    if (asPublished)
      reflectAsPublished(frame, grids, result);
    else
      reflectCrossing(frame, grids, result);
  }

  void reflectAsPublished(PassContext& frame, NestedGrids grids, const RadianceGrid& result) {
    frame.dispatch(frame.program(reflect_published::kProgram),
                   {reflect_published::parameters({.fadeDistance = 0.5f * longestSide(result.grid),
                                                   .reflectionLow = result.grid.low,
                                                   .voxelSize = result.grid.voxelSize,
                                                   .centre = frame.snapshot().camera.eye}),
                    sampled(grids.front(), gpu::Sampling::linear),
                    reflect_published::surfaceAlbedo(surfaces->albedo, gpu::Sampling::nearest),
                    reflect_published::radianceImage(result.radiance)},
                   result.grid.resolution);
  }

  void reflectCrossing(PassContext& frame, NestedGrids grids, const RadianceGrid& result) {
    forEachLevel(grids, [&](std::size_t i) {
      frame.dispatch(frame.program(reflect::kProgram),
                     {reflect::parameters({.blend = kBlendCells,
                                           .reflectionLow = result.grid.low,
                                           .voxelSize = result.grid.voxelSize,
                                           .first = i + 1 == grids.size(),
                                           .last = i == 0,
                                           .fades = fade > 0.0f,
                                           .fadeWidth = fade}),
                      sampled(grids[i], gpu::Sampling::linear),
                      reflect::surfaceAlbedo(surfaces->albedo, gpu::Sampling::nearest),
                      reflect::surfaceNormal(surfaces->normal, gpu::Sampling::nearest),
                      reflect::radianceImage(result.radiance)},
                     result.grid.resolution);
    });
  }
};

class TracePass : public Pass {
  enum class Fade { falls, grows, none };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<RadianceGrid> grid{this, "grid", "the reflection grid with its mips", Levels::all};
  Param<float> reach{
      this, "reach", 0.0f, within(0.0f, 1e9f), "m", "length of a cone; 0: the longest side of the grid"};
  Param<Fade> fade{
      this, "fade", Fade::falls,
      "weight of samples along a cone; falls: to 0 at its reach; grows: from 0 at its start (Listing 4.37); none: constant. With falls and grows the whole reflection also fades to 0 at half a side of the grid from the eye",
      published(Fade::grows)};
  Out<Image> glossy{this, "glossy", Contributes::indirectGlossy, Needs::glossyMaterial,
                    "indirect light reflected by the glossy lobe, W/(sr m^2)"};

  Reads readsFrom() const override { return Reads::camera; }

  void run(PassContext& frame) override {
    // The texture may be larger than the grid, in whole mips.
    const gpu::TextureDescription& texture = grid->radiance->description();
    const GridPlacement place{
        grid->grid.low, grid->grid.voxelSize, {texture.width, texture.height, texture.depth}};
    const float side = longestSide(place);
    const int fading = fade == Fade::grows ? 2 : fade == Fade::falls ? 1 : 0;
    glossy = Image{frame.image("indirect glossy radiance")};
    frame.dispatch(
        frame.program(trace::Variant{}, trace::Constants{.fade = fading}),
        {trace::parameters({.gridLow = place.low,
                            .voxelSize = place.voxelSize,
                            .gridExtent = glm::vec3(place.resolution) * place.voxelSize,
                            .reach = reach > 0.0f ? reach + 0.0f : side,
                            .eyeWorld = frame.snapshot().camera.eye,
                            .fadeDistance = 0.5f * side,
                            .unit = grid->unit}),
         GBufferBinding(*gbuffer), trace::radianceGrid(grid->radiance, gpu::Sampling::linearMipsBorder),
         trace::glossyImage(glossy->texture)},
        pixels(frame));
  }
};

}  // namespace

void addGather(TechniqueRegistry& registry) {
  registry.add<GatherPass>("gather", "Indirect diffuse light at the visible surfaces (thesis Sec. 4.3.5)");
  registry.add<ReflectPass>("reflect",
                            "The reflection grid, lit from the propagated light (thesis Sec. 4.3.4)");
  registry.add<TracePass>("trace",
                          "Glossy light by one cone through the reflection grid (thesis Sec. 4.3.5)");
}

}  // namespace lumivox::light_propagation_volumes
