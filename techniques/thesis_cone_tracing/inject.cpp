// Injects direct light into dense grids (thesis Gomes 2015, Sec. 4.2.1): a running average in 8 bits whose
// last channel counts fragments (Listings 4.8 and 4.9), and a pass that turns counts into opacities (Listing
// 4.10).
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "drawn.h"
#include "lumivox/base/error.h"
#include "lumivox/pipeline/ports/directional_radiance_grid.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/light_bounds.h"
#include "thesis_cone_tracing_shaders.h"
#include "voxel_averages.h"

namespace lumivox::thesis_cone_tracing {

using namespace shaders::thesis_cone_tracing;

namespace {

class InjectPass : public Pass {
  // In the order of the shader's axis.
  enum class Grids { one, six };

  In<VoxelFragments> fragments{this, "fragments", "surface samples"};
  In<ShadowMap> shadow{this, "shadow", Presence::optional,
                       "lights and their visibility; without it the grid is dark but opaque"};
  Param<Grids> grids{this, "grids", Grids::one,
                     "grids of averages; one: for isotropic voxels; six: for six directional grids"};
  Param<float> white{
      this, "white", 0.0f, within(0.0f, 1e12f),
      "radiance of the largest byte, at which brighter voxels are clamped, W/(sr m^2); 0: that of the brightest fragment, which near a point light leaves all others dark"};
  Param<float> ambient{this, "ambient", 0.0f, within(0.0f, 1e9f),
                       "irradiance that all surfaces receive besides that of the lights, W/m^2 (Fig. 66)"};
  Out<VoxelAverages> averages{this, "averages",
                              "running averages, which depend on the order of the fragments"};

  Reads readsFrom() const override { return Reads::lights | Reads::materials; }

  void run(PassContext& frame) override {
    if (fragments->reflected != nullptr)
      throw Error(
          "thesis_cone_tracing.inject: input 'fragments' brings along direct light that the image has, and Listing 4.8 lights every fragment; expected fragments without it ('direct' of voxelization.reproject left out)");
    VoxelAverages result;
    // The same number of voxels along all axes.
    result.grid = fragments->grid;
    result.grid.resolution = glm::ivec3(fragments->grid.longest());
    result.unit = white > 0.0f ? white
                               : largestRadiance(frame.sceneDescription(), frame.snapshot(),
                                                 0.5f * fragments->grid.voxelSize) +
                                     ambient / glm::pi<float>();
    const int count = grids == Grids::six ? 6 : 1;
    for (int i = 0; i < count; ++i)
      result.grids.push_back(
          frame.emptyVolume(result.grid.resolution, gpu::Format::r32ui, "averages of voxels"));
    std::array<gpu::TextureRef, 6> grid;
    std::ranges::copy(result.grids, grid.begin());
    const LightBinding lights(shadow);
    forEachFragment(
        frame,
        frame.program(inject::Variant{.grids = static_cast<int>(static_cast<Grids>(grids)),
                                      .lights = shadow.present()}),
        {inject::grid({.gridLow = result.grid.low,
                       .voxelSize = result.grid.voxelSize,
                       .lightCount = lights.count,
                       .largest = result.unit,
                       .ambient = ambient}),
         inject::averages(grid[0]), inject::averages1(grid[1]), inject::averages2(grid[2]),
         inject::averages3(grid[3]), inject::averages4(grid[4]), inject::averages5(grid[5]), lights},
        *fragments);
    averages = result;
  }
};

/// The corrected grids of `averages`, which must be so many.
std::vector<gpu::TextureRef> corrected(PassContext& frame, const VoxelAverages& averages,
                                       std::size_t expected, bool drawn) {
  if (averages.grids.size() != expected)
    throw Error(fmt::format(
        "thesis_cone_tracing: averages of {} grids, but expected those of {}; set 'grids {}' in thesis_cone_tracing.inject",
        averages.grids.size(), expected, expected == 1 ? "one" : "six"));
  const glm::ivec3 size = averages.grid.resolution;
  std::vector<gpu::TextureRef> result;
  for (const gpu::TextureRef& grid : averages.grids) {
    result.push_back(frame.volume(size, gpu::Format::rgba8, "radiance grid in 8 bits",
                                  gpu::fullLevelCount(size.x, size.y, size.z)));
    forEachVoxel(
        frame, {correct_opacity::kProgram, correct_opacity_drawn::kProgram},
        {correct_opacity::correction({size}), correct_opacity::averages(grid, gpu::Sampling::nearest),
         correct_opacity::radianceImage(result.back())},
        size, drawn);
  }
  return result;
}

class CorrectOpacityPass : public Pass {
  In<VoxelAverages> averages{this, "averages", "those of one grid"};
  Param<bool> drawn{this, "drawn", false, kDrawnMeaning};
  Out<RadianceGrid> radiance{this, "radiance", "the finest level; every voxel with a fragment is opaque",
                             Levels::finest};

  void run(PassContext& frame) override {
    RadianceGrid result;
    result.grid = averages->grid;
    result.unit = averages->unit;
    result.radiance = corrected(frame, *averages, 1, drawn).front();
    result.filledLevels = 1;
    radiance = result;
  }
};

class CorrectOpacityDirectionalPass : public Pass {
  In<VoxelAverages> averages{this, "averages", "those of six grids"};
  Param<bool> drawn{this, "drawn", false, kDrawnMeaning};
  Out<DirectionalRadianceGrid> radiance{
      this, "radiance", "the finest level; every voxel with a fragment is opaque", Levels::finest};

  void run(PassContext& frame) override {
    DirectionalRadianceGrid result;
    result.grid = averages->grid;
    result.unit = averages->unit;
    std::ranges::copy(corrected(frame, *averages, result.faces.size(), drawn), result.faces.begin());
    radiance = result;
  }
};

}  // namespace

void addInject(TechniqueRegistry& registry) {
  registry.add<InjectPass>("inject", "Direct light into running averages of 8 bits (Listings 4.8 and 4.9)");
  registry.add<CorrectOpacityPass>("correct_opacity",
                                   "Opacities in place of the counts of fragments (Listing 4.10)");
  registry.add<CorrectOpacityDirectionalPass>(
      "correct_opacity_directional",
      "Opacities in place of the counts of fragments, for six directional grids (Sec. 4.2.1, Table 1)");
}

}  // namespace lumivox::thesis_cone_tracing
