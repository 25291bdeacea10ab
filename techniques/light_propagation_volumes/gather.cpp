// What the surfaces receive from the grids, and what they give on to reflections: thesis Gomes 2015,
// Sec. 4.3.4 and 4.3.5.
#include <fmt/format.h>

#include <algorithm>

#include "light_propagation_volumes_shaders.h"
#include "nested_grids.h"

namespace lumivox::light_propagation_volumes {
namespace {

namespace gatherShader = shaders::light_propagation_volumes::gather;
namespace traceShader = shaders::light_propagation_volumes::trace;
namespace reflectShader = shaders::light_propagation_volumes::reflect;
namespace publishedReflectShader = shaders::light_propagation_volumes::reflect_published;

constexpr float kBlendCells = 4.0f;  // width of the seam between two grids, Listing 4.36
// Listing 4.36: the finer of two grids of 32 cells counts alone up to 12 of them from the eye, and not at all
// from 16 on.
constexpr float kInnerReach = 12.0f / 32.0f, kOuterReach = 16.0f / 32.0f;

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
  Param<std::string> lookup{
      this,
      "lookup",
      "reachable",
      {"reachable", "filtered"},
      "cells that can be reached from the surface, at the offset; or, as published (Listing 4.35), filtered at the surface whatever lies between, half a cell too low along z"};
  Param<std::string> lobe{
      this,
      "lobe",
      "arriving",
      {"arriving", "normal"},
      "what counts is light that comes in; or, as published (Listing 4.35), the lobe around the normal itself, light per face of a cell"};
  Param<std::string> seam{
      this,
      "seam",
      "border",
      {"border", "radial"},
      "grids are blended before the finer one's border; or, as published (Listing 4.36), from 12/32 to 16/32 of its side around the eye"};
  Param<bool> asPublished{
      this, "as_published", false,
      "Listings 4.35 and 4.36: the printed settings of lookup, lobe, seam and negative; the exponent has no printed value"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::nothing,
                     "indirect light reflected by the diffuse lobe, W/(sr m^2)"};
  Out<Image> clipped{
      this, "clipped", Contributes::nothing, Needs::nothing,
      "radiance that two bands made negative, before it was mended, as positive values, W/(sr m^2)"};

  void run(PassContext& frame) override {
    const bool filtered = asPublished || lookup == "filtered";
    if (!filtered) requireFaces(*light);
    Image result{frame.image(gpu::Format::rgba32f, "indirect diffuse radiance")};
    Image cut{frame.image(gpu::Format::rgba32f, "clipped radiance")};
    gatherShader::Constants constants;
    constants.filtered = filtered ? 1 : 0;
    constants.ownLobe = asPublished || lobe == "normal" ? 1 : 0;
    constants.radialBlend = asPublished || seam == "radial" ? 1 : 0;
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
      parameters.eye = frame.snapshot().camera.eye;
      const glm::ivec3& cells = level.grid.resolution;
      const float side = level.grid.voxelSize * static_cast<float>(std::max({cells.x, cells.y, cells.z}));
      parameters.innerReach = kInnerReach * side;
      parameters.outerReach = kOuterReach * side;
      frame.dispatch(frame.program(gatherShader::kProgram, {}, constants.values()),
                     {gatherShader::parameters(parameters),
                      gatherShader::gPosition(*gbuffer->position, Sampling::nearest),
                      gatherShader::gNormal(*gbuffer->normal, Sampling::nearest),
                      gatherShader::gGeometricNormal(*gbuffer->geometricNormal, Sampling::nearest),
                      gatherShader::gDiffuse(*gbuffer->diffuse, Sampling::nearest),
                      gatherShader::red(*level.coefficients[0], Sampling::linear),
                      gatherShader::green(*level.coefficients[1], Sampling::linear),
                      gatherShader::blue(*level.coefficients[2], Sampling::linear),
                      gatherShader::closed(facesOrUnread(level.closed, level), Sampling::nearest),
                      gatherShader::moved(facesOrUnread(level.moved, level), Sampling::nearest),
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
  Param<bool> asPublished{
      this, "as_published", false,
      "Listing 4.34: albedo times the mean of all light in the finest cells, half a voxel off along z, fading out with the distance to the eye; in place of what crosses the face before a surface, and of fade"};
  Out<RadianceGrid> radiance{this, "radiance", Contributes::nothing, Needs::glossyMaterial,
                             "light that leaves the surfaces, and their opacity; the finest level only"};

  Reads readsFrom() const override { return asPublished ? Reads::camera : Reads::nothing; }

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
    if (asPublished)
      reflectAsPublished(frame, result);
    else
      reflectCrossing(frame, result);
    radiance = result;
  }

  void reflectAsPublished(PassContext& frame, const RadianceGrid& result) {
    const ShGrid::Level& level = light->levels.front();
    const glm::ivec3& voxels = result.grid.resolution;
    publishedReflectShader::Parameters parameters{};
    parameters.gridLow = level.grid.low;
    parameters.cellSize = level.grid.voxelSize;
    parameters.resolution = level.grid.resolution;
    parameters.fadeDistance =
        0.5f * result.grid.voxelSize * static_cast<float>(std::max({voxels.x, voxels.y, voxels.z}));
    parameters.reflectionLow = result.grid.low;
    parameters.voxelSize = result.grid.voxelSize;
    parameters.centre = frame.snapshot().camera.eye;
    using gpu::Sampling;
    frame.dispatch(frame.program(publishedReflectShader::kProgram),
                   {publishedReflectShader::parameters(parameters),
                    publishedReflectShader::red(*level.coefficients[0], Sampling::linear),
                    publishedReflectShader::green(*level.coefficients[1], Sampling::linear),
                    publishedReflectShader::blue(*level.coefficients[2], Sampling::linear),
                    publishedReflectShader::surfaceAlbedo(*surfaces->albedo, Sampling::nearest),
                    publishedReflectShader::radianceImage(*result.radiance)},
                   voxels, kCellGroup);
  }

  void reflectCrossing(PassContext& frame, const RadianceGrid& result) {
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
  }
};

class TracePass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<RadianceGrid> grid{this, "grid", "the reflection grid with its mips"};
  Param<float> reach{this, "reach", 0.0f, {0.0f, 1e9f}, "m", "of a cone; 0: the longest side of the grid"};
  Param<std::string> fade{
      this,
      "fade",
      "falls",
      {"falls", "grows", "none"},
      "of samples along a cone: to nothing at its reach; or, as published (Listing 4.37), from nothing at its start; with both the whole reflection falls to nothing half a side of the grid from the eye"};
  Param<bool> asPublished{this, "as_published", false, "Listing 4.37 to the letter: fade grows"};
  Out<Image> glossy{this, "glossy", Contributes::indirectGlossy, Needs::glossyMaterial,
                    "indirect light reflected by the glossy lobe, W/(sr m^2)"};

  Reads readsFrom() const override { return Reads::camera; }

  void run(PassContext& frame) override {
    const GridPlacement& place = grid->grid;
    // The texture may be larger than the grid: rows of whole mips.
    const gpu::TextureDescription& description = grid->radiance->description();
    const glm::vec3 cells(description.width, description.height, description.depth);
    const float side = place.voxelSize * std::max({cells.x, cells.y, cells.z});
    traceShader::Parameters parameters{};
    parameters.gridLow = place.low;
    parameters.voxelSize = place.voxelSize;
    parameters.gridExtent = cells * place.voxelSize;
    parameters.reach = reach > 0.0f ? static_cast<float>(reach) : side;
    parameters.eyeWorld = frame.snapshot().camera.eye;
    parameters.fadeDistance = 0.5f * side;
    parameters.unit = grid->unit;
    traceShader::Constants constants;
    constants.fade = asPublished || fade == "grows" ? 2 : fade == "falls" ? 1 : 0;
    const Image result{frame.image(gpu::Format::rgba32f, "indirect glossy radiance")};
    using gpu::Sampling;
    frame.dispatch(
        frame.program(traceShader::kProgram, {}, constants.values()),
        {traceShader::parameters(parameters), traceShader::gPosition(*gbuffer->position, Sampling::nearest),
         traceShader::gNormal(*gbuffer->normal, Sampling::nearest),
         traceShader::gSpecular(*gbuffer->specular, Sampling::nearest),
         traceShader::radianceGrid(*grid->radiance, Sampling::linearMipsBorder),
         traceShader::glossyImage(*result.texture)},
        {frame.snapshot().camera.width, frame.snapshot().camera.height, 1}, kImageGroup);
    glossy = result;
  }
};

}  // namespace

void addGather(TechniqueRegistry& registry) {
  registry.add<GatherPass>("gather", "Indirect diffuse light at the visible surfaces (thesis Sec. 4.3.5)");
  registry.add<ReflectPass>("reflect",
                            "The reflection grid, lit from the propagated light (thesis Sec. 4.3.4)");
  registry.add<TracePass>("trace", "Glossy light by one printed cone through it (thesis Sec. 4.3.5)");
}

}  // namespace lumivox::light_propagation_volumes
