// What the surfaces receive from the grids, and what they give on to reflections: thesis Gomes 2015,
// Sec. 4.3.4 and 4.3.5.
#include <fmt/format.h>

#include <algorithm>

#include "light_propagation_volumes_shaders.h"
#include "nested_grids.h"

namespace lumivox::light_propagation_volumes {
namespace {

namespace gatherShader = shaders::light_propagation_volumes::gather;
namespace reflectShader = shaders::light_propagation_volumes::reflect;

constexpr float kBlendCells = 4.0f;  // width of the seam between two grids, Listing 4.36

class GatherPass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<ShGrid> light{this, "light", "all light that passed each cell"};
  Param<float> blend{this,          "blend", kBlendCells,
                     {0.5f, 64.0f}, "",      "cells over which a grid is blended into the coarser one"};
  Param<float> offset{this,         "offset", 1.0f,
                      {0.0f, 4.0f}, "",       "of the lookup from the surface along its normal, in cells"};
  Param<float> exponent{
      this, "exponent",
      1.0f, {0.1f, 10.0f},
      "",   "of the radiance before the albedo, a matter of taste (Listing 4.36); 1 conserves energy"};
  Param<std::string> negative{
      this,
      "negative",
      "closure",
      {"closure", "clip"},
      "two bands can make irradiance negative: keep what the two sides of a surface differ by, and neither below 0; or cut off"};
  Param<bool> asPublished{
      this, "as_published", false,
      "Listing 4.35: filtered half a cell away without regard to walls, negative values cut off"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "indirect light reflected by the diffuse lobe, W/(sr m^2)"};
  Out<Image> clipped{
      this, "clipped", Contributes::nothing, Needs::nothing,
      "radiance that two bands made negative, before it was mended, as positive values, W/(sr m^2)"};

  void run(PassContext& frame) override {
    requireFaces(*light);
    Image result{frame.image(gpu::Format::rgba32f, "indirect diffuse radiance")};
    Image cut{frame.image(gpu::Format::rgba32f, "clipped radiance")};
    gatherShader::Constants constants;
    constants.published = asPublished ? 1 : 0;
    constants.closure = negative == "closure" && !asPublished ? 1 : 0;
    using gpu::Sampling;
    for (std::size_t i = light->levels.size(); i-- > 0;) {
      const ShGrid::Level& level = light->levels[i];
      gatherShader::Parameters parameters{};
      parameters.gridLow = level.grid.low;
      parameters.cellSize = level.grid.voxelSize;
      parameters.resolution = level.grid.resolution;
      parameters.blend = blend;
      parameters.offset = offset;
      parameters.exponent = exponent;
      parameters.first = i + 1 == light->levels.size() ? 1 : 0;
      parameters.last = i == 0 ? 1 : 0;
      frame.dispatch(frame.program(gatherShader::kProgram, {}, constants.values()),
                     {gatherShader::parameters(parameters),
                      gatherShader::gPosition(*gbuffer->position, Sampling::nearest),
                      gatherShader::gNormal(*gbuffer->normal, Sampling::nearest),
                      gatherShader::gGeometricNormal(*gbuffer->geometricNormal, Sampling::nearest),
                      gatherShader::gDiffuse(*gbuffer->diffuse, Sampling::nearest),
                      gatherShader::red(*level.coefficients[0], Sampling::linear),
                      gatherShader::green(*level.coefficients[1], Sampling::linear),
                      gatherShader::blue(*level.coefficients[2], Sampling::linear),
                      gatherShader::closed(*level.closed, Sampling::nearest),
                      gatherShader::moved(*level.moved, Sampling::nearest),
                      gatherShader::diffuseImage(*result.texture), gatherShader::clippedImage(*cut.texture)},
                     {frame.snapshot().camera.width, frame.snapshot().camera.height, 1}, kImageGroup);
    }
    if (frame.inspects()) tellShare(frame, *result.texture, *cut.texture);
    diffuse = result;
    clipped = cut;
  }

  /// How much two bands made negative, of all that reaches the picture.
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
          fmt::format("{:.2g} % of the light of the picture was negative in two bands before it was mended",
                      100.0 * negative / all));
  }
};

class ReflectPass : public Pass {
  In<AttributeGrid> surfaces{this, "surfaces", "surfaces of the reflection grid"};
  In<ShGrid> light{this, "light", "all light that passed each cell"};
  Param<float> fade{
      this, "fade", 0.0f, {0.0f, 1024.0f}, "", "voxels before the border over which the grid fades out"};
  Out<RadianceGrid> radiance{this, "radiance", Contributes::nothing, Needs::glossyMaterial,
                             "light that leaves the surfaces, and their opacity; the finest level only"};

  void run(PassContext& frame) override {
    RadianceGrid result;
    result.grid = surfaces->grid;
    gpu::TextureDescription description;
    description.kind = gpu::TextureKind::d3;
    description.format = gpu::Format::rgba32f;
    description.width = result.grid.resolution.x;
    description.height = result.grid.resolution.y;
    description.depth = result.grid.resolution.z;
    description.levels = gpu::fullLevelCount(description.width, description.height, description.depth);
    result.radiance = frame.texture(description, "reflection grid");
    result.filledLevels = 1;
    using gpu::Sampling;
    for (std::size_t i = light->levels.size(); i-- > 0;) {
      const ShGrid::Level& level = light->levels[i];
      reflectShader::Parameters parameters{};
      parameters.gridLow = level.grid.low;
      parameters.cellSize = level.grid.voxelSize;
      parameters.resolution = level.grid.resolution;
      parameters.blend = kBlendCells;
      parameters.reflectionLow = result.grid.low;
      parameters.voxelSize = result.grid.voxelSize;
      parameters.first = i + 1 == light->levels.size() ? 1 : 0;
      parameters.last = i == 0 ? 1 : 0;
      parameters.fades = fade > 0.0f ? 1 : 0;
      parameters.fadeWidth = fade;
      frame.dispatch(frame.program(reflectShader::kProgram),
                     {reflectShader::parameters(parameters),
                      reflectShader::red(*level.coefficients[0], Sampling::linear),
                      reflectShader::green(*level.coefficients[1], Sampling::linear),
                      reflectShader::blue(*level.coefficients[2], Sampling::linear),
                      reflectShader::surfaceAlbedo(*surfaces->albedo, Sampling::nearest),
                      reflectShader::surfaceNormal(*surfaces->normal, Sampling::nearest),
                      reflectShader::radianceImage(*result.radiance)},
                     result.grid.resolution, kCellGroup);
    }
    radiance = result;
  }
};

}  // namespace

void addGather(TechniqueRegistry& registry) {
  registry.add<GatherPass>("gather", "Indirect diffuse light at the visible surfaces (thesis Sec. 4.3.5)");
  registry.add<ReflectPass>("reflect",
                            "The reflection grid, lit from the propagated light (thesis Sec. 4.3.4)");
}

}  // namespace lumivox::light_propagation_volumes
