// Virtual point lights: from a reflective shadow map (Kaplanyan & Dachsbacher 2010, Sec. 4.1) or from
// illuminated voxels (Doghramachi 2013; thesis Gomes 2015, Sec. 4.3.1, 4.3.2); and the faces that surfaces
// close.
#include <fmt/format.h>

#include <algorithm>

#include "light_propagation_volumes_shaders.h"
#include "nested_grids.h"

namespace lumivox::light_propagation_volumes {
namespace {

namespace closeShader = shaders::light_propagation_volumes::close;
namespace fillShader = shaders::light_propagation_volumes::fill_corners;
namespace resolveClosedShader = shaders::light_propagation_volumes::resolve_closed;
namespace rsmShader = shaders::light_propagation_volumes::inject_rsm;
namespace collectShader = shaders::light_propagation_volumes::collect_voxels;
namespace lightShader = shaders::light_propagation_volumes::light_voxels;
namespace resolveShader = shaders::light_propagation_volumes::resolve_lights;

constexpr std::uint64_t kSumBytes = 14 * sizeof(std::uint32_t);    // of a cell, virtual_lights.glsl
constexpr std::uint64_t kVoxelBytes = 37 * sizeof(std::uint32_t);  // of a cell, lit_voxel.glsl
constexpr int kLargestVoxelGrid = 96;  // cells along a side whose voxels fit into 128 MiB, which every driver
                                       // can address

std::uint64_t cellCount(const GridPlacement& grid) {
  return static_cast<std::uint64_t>(grid.resolution.x) * static_cast<std::uint64_t>(grid.resolution.y) *
         static_cast<std::uint64_t>(grid.resolution.z);
}

class Inject : public Pass {
 public:
  Reads readsFrom() const override { return Reads::partOfCamera | Reads::geometry | Reads::lights; }
  /// The grids move with the camera, but by whole cells and not out of the scene.
  std::vector<float> readsOfCamera(const SceneSnapshot& snapshot) const override {
    std::vector<float> places;
    for (const GridPlacement& grid : placeGrids(snapshot, levels, resolution, extent)) {
      places.insert(places.end(), {grid.low.x, grid.low.y, grid.low.z, grid.voxelSize});
      for (int axis = 0; axis < 3; ++axis) places.push_back(static_cast<float>(grid.resolution[axis]));
    }
    return places;
  }

  void run(PassContext& frame) override {
    ShGrid result;
    for (const GridPlacement& grid : placeGrids(frame.snapshot(), levels, resolution, extent)) {
      ShGrid::Level level{grid, coefficientTextures(frame, grid.resolution, "coefficients"), nullptr,
                          nullptr};
      findFaces(frame, level);
      const gpu::BufferRef sums = frame.buffer(cellCount(grid) * kSumBytes, "virtual lights");
      sums->clear();
      addLights(frame, level, *sums);
      resolveShader::Parameters parameters{};
      parameters.resolution = grid.resolution;
      // A clamped cosine has the mean cosine 2/3; 0 asks for that of the default lobe.
      parameters.meanCosine = lobe == "cosine" ? 2.0f / 3.0f : 0.0f;
      frame.dispatch(
          frame.program(resolveShader::kProgram),
          {resolveShader::parameters(parameters), resolveShader::sums(*sums),
           resolveShader::red(*level.coefficients[0]), resolveShader::green(*level.coefficients[1]),
           resolveShader::blue(*level.coefficients[2])},
          grid.resolution, kCellGroup);
      result.levels.push_back(level);
    }
    light = result;
  }

 protected:
  /// Adds virtual lights to the sums of the cells, and a barrier.
  virtual void addLights(PassContext& frame, const ShGrid::Level& level, const gpu::Buffer& sums) = 0;

  In<VoxelFragments> fragments{this, "fragments",
                               "surface samples; their voxels no larger than the finest cells"};
  Param<int> levels{this, "levels", 2, {1, 10}, "nested grids, each of twice the size of the one inside"};
  Param<int> resolution{this, "resolution", 32, {8, 128}, "cells along a side of each grid"};
  Param<float> extent{
      this, "extent",
      0.0f, {0.0f, 1e9f},
      "m",  "side of the finest grid, around the camera; 0: as large as lets the coarsest hold the scene"};
  Param<std::string> lobe{
      this,
      "lobe",
      "forward",
      {"forward", "cosine"},
      "what a virtual light sends out: nothing backwards, or, as published, a clamped cosine, of which two bands let a seventh out at the back"};
  Out<ShGrid> light{this, "light", "virtual point lights, W/sr, and closed faces"};

 private:
  /// The faces that surfaces close, and how far these were moved.
  void findFaces(PassContext& frame, ShGrid::Level& level) {
    const GridPlacement& grid = level.grid;
    if (fragments->grid.voxelSize > grid.voxelSize * 1.001f)
      frame.warn(
          fmt::format("the fragments have voxels of {} m and the cells {} m: surfaces have holes; voxelise "
                      "with a higher resolution",
                      fragments->grid.voxelSize, grid.voxelSize));
    const glm::ivec3 faces = grid.resolution + 1;
    std::array<gpu::TextureRef, 3> parts, filled;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      parts[axis] = cellTexture(frame, faces, gpu::Format::r32ui, "parts of faces");
      parts[axis]->clear(glm::vec4(0.0f));
      filled[axis] = cellTexture(frame, faces, gpu::Format::r32ui, "parts of faces, corners filled");
    }
    closeShader::Parameters parameters{};
    parameters.listLow = fragments->grid.low;
    parameters.listVoxel = fragments->grid.voxelSize;
    parameters.gridLow = grid.low;
    parameters.cellSize = grid.voxelSize;
    parameters.resolution = faces;
    frame.shaders().dispatchIndirect(
        frame.program(closeShader::kProgram),
        {closeShader::parameters(parameters), closeShader::fragmentCount(*fragments->count),
         closeShader::fragments(*fragments->fragments), closeShader::partsX(*parts[0]),
         closeShader::partsY(*parts[1]), closeShader::partsZ(*parts[2])},
        *fragments->count, sizeof(std::uint32_t));
    frame.device().barrier();
    for (int round = 0; round < 2; ++round) {
      frame.dispatch(
          frame.program(fillShader::kProgram),
          {fillShader::partsX(*parts[0]), fillShader::partsY(*parts[1]), fillShader::partsZ(*parts[2]),
           fillShader::filledX(*filled[0]), fillShader::filledY(*filled[1]), fillShader::filledZ(*filled[2])},
          faces, kCellGroup);
      std::swap(parts, filled);
    }
    level.closed = cellTexture(frame, faces, gpu::Format::rgba8, "closed faces");
    level.moved = cellTexture(frame, faces, gpu::Format::rgba8, "moved surfaces");
    frame.dispatch(frame.program(resolveClosedShader::kProgram),
                   {resolveClosedShader::partsX(*parts[0]), resolveClosedShader::partsY(*parts[1]),
                    resolveClosedShader::partsZ(*parts[2]), resolveClosedShader::closed(*level.closed),
                    resolveClosedShader::moved(*level.moved)},
                   faces, kCellGroup);
  }
};

class InjectRsmPass : public Inject {
  In<ReflectiveShadowMap> map{this, "map", Presence::optional,
                              "what the lights see; without it only the environment shines"};

  void addLights(PassContext& frame, const ShGrid::Level& level, const gpu::Buffer& sums) override {
    if (!map.present() || map->lightCount == 0) return;
    const GridPlacement& grid = level.grid;
    using gpu::Sampling;
    const gpu::TextureDescription& layers = map->flux->description();
    for (const int step : {rsmShader::Variant::stepWeigh, rsmShader::Variant::stepAdd}) {
      rsmShader::Variant variant;
      variant.step = step;
      frame.dispatch(frame.program(rsmShader::kProgram, variant.key()),
                     {rsmShader::parameters({grid.low, grid.voxelSize, grid.resolution}),
                      rsmShader::rsmPosition(*map->position, Sampling::nearest),
                      rsmShader::rsmNormal(*map->normal, Sampling::nearest),
                      rsmShader::rsmFlux(*map->flux, Sampling::nearest),
                      rsmShader::moved(*level.moved, Sampling::nearest), rsmShader::sums(sums)},
                     {layers.width, layers.height, layers.depth}, kImageGroup);
    }
  }
};

class InjectVoxelsPass : public Inject {
  In<ShadowMap> shadow{this, "shadow", Presence::optional,
                       "lights and their visibility; without it only the environment shines"};
  Param<std::string> albedo{
      this, "albedo", "mean", {"mean", "contrast"}, "of a voxel; as published: its most contrasting one"};
  Param<std::string> normals{this,
                             "normals",
                             "all",
                             {"all", "closest"},
                             "that a light reaches; as published: only the one closest to its direction"};
  Param<std::string> area{
      this, "area", "covered", {"covered", "whole"}, "of a surface; as published: all of its voxel"};
  Param<bool> twoSided{this, "two_sided", true,
                       "light on the back of a triangle counts; off, as published: only the front"};
  Param<bool> asPublished{this, "as_published", false,
                          "the printed settings of albedo, normals, area and two_sided"};

  std::string checkParameters() const override {
    if (resolution > kLargestVoxelGrid)
      return fmt::format("resolution must be at most {} for voxels that are lit", kLargestVoxelGrid);
    return {};
  }

  void addLights(PassContext& frame, const ShGrid::Level& level, const gpu::Buffer& sums) override {
    if (!shadow.present() || shadow->lightCount == 0) return;
    const GridPlacement& grid = level.grid;
    const gpu::BufferRef voxels = frame.buffer(cellCount(grid) * kVoxelBytes, "lit voxels");
    voxels->clear();
    collectShader::Parameters collect{};
    collect.listLow = fragments->grid.low;
    collect.listVoxel = fragments->grid.voxelSize;
    collect.gridLow = grid.low;
    collect.cellSize = grid.voxelSize;
    collect.resolution = grid.resolution;
    collect.twoSided = twoSided && !asPublished ? 1 : 0;
    for (const int step : {collectShader::Variant::stepWeigh, collectShader::Variant::stepAdd}) {
      collectShader::Variant variant;
      variant.step = step;
      frame.shaders().dispatchIndirect(
          frame.program(collectShader::kProgram, variant.key()),
          {collectShader::parameters(collect), collectShader::fragmentCount(*fragments->count),
           collectShader::fragments(*fragments->fragments), collectShader::voxels(*voxels),
           collectShader::moved(*level.moved, gpu::Sampling::nearest),
           collectShader::closed(*level.closed, gpu::Sampling::nearest)},
          *fragments->count, sizeof(std::uint32_t));
      frame.device().barrier();
    }
    lightShader::Parameters parameters{};
    parameters.gridLow = grid.low;
    parameters.cellSize = grid.voxelSize;
    parameters.resolution = grid.resolution;
    parameters.largestFlux = largestFlux(frame.sceneDescription(), frame.snapshot());
    parameters.lightCount = shadow->lightCount;
    parameters.contrastAlbedo = asPublished || albedo == "contrast" ? 1 : 0;
    parameters.closestNormal = asPublished || normals == "closest" ? 1 : 0;
    parameters.wholeFaces = asPublished || area == "whole" ? 1 : 0;
    frame.dispatch(
        frame.program(lightShader::kProgram),
        {lightShader::parameters(parameters), lightShader::voxels(*voxels), lightShader::sums(sums),
         lightShader::lights(*shadow->lights), lightShader::views(*shadow->views),
         lightShader::shadowDepth(*shadow->depth, gpu::Sampling::shadow)},
        grid.resolution, kCellGroup);
  }
};

}  // namespace

void addInject(TechniqueRegistry& registry) {
  registry.add<InjectRsmPass>(
      "inject_rsm",
      "Virtual point lights from reflective shadow maps (Kaplanyan & Dachsbacher 2010, Sec. 4.1)");
  registry.add<InjectVoxelsPass>("inject_voxels",
                                 "Virtual point lights from illuminated voxels (Doghramachi 2013)");
}

}  // namespace lumivox::light_propagation_volumes
