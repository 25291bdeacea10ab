// Virtual point lights: from a reflective shadow map (Kaplanyan & Dachsbacher 2010, Sec. 4.1) or from
// illuminated voxels (Doghramachi 2013; thesis Gomes 2015, Sec. 4.3.1, 4.3.2); and the faces that surfaces
// close.
#include <fmt/format.h>

#include <algorithm>
#include <span>

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
namespace packShader = shaders::light_propagation_volumes::pack_voxels;
namespace lightPackedShader = shaders::light_propagation_volumes::light_packed;

constexpr std::uint64_t kSumBytes = 14 * sizeof(std::uint32_t);    // of a cell, virtual_lights.glsl
constexpr std::uint64_t kVoxelBytes = 37 * sizeof(std::uint32_t);  // of a cell, lit_voxel.glsl
constexpr std::uint64_t kPackedBytes = 5 * sizeof(std::uint32_t);  // of a cell, packed_voxels.glsl
constexpr int kLargestVoxelGrid = 96;  // cells along a side whose voxels fit into 128 MiB, which every driver
                                       // can address

std::uint64_t cellCount(const GridPlacement& grid) {
  return static_cast<std::uint64_t>(grid.resolution.x) * static_cast<std::uint64_t>(grid.resolution.y) *
         static_cast<std::uint64_t>(grid.resolution.z);
}

/// Bricks of 4 x 4 x 4 cells that hold anything: marked by passes over surfaces and lights, walked by those
/// over cells. Their number stays on the device (bricks.glsl).
struct BrickList {
  gpu::BufferRef flags, list;
};

BrickList emptyBricks(PassContext& frame, const glm::ivec3& cells) {
  const glm::ivec3 bricks = (cells + kBrick - 1) / kBrick;
  const std::uint64_t count = static_cast<std::uint64_t>(bricks.x) * static_cast<std::uint64_t>(bricks.y) *
                              static_cast<std::uint64_t>(bricks.z);
  BrickList result{frame.buffer(count * sizeof(std::uint32_t), "marked bricks"),
                   frame.buffer((3 + count) * sizeof(std::uint32_t), "list of bricks")};
  result.flags->clear();
  const std::array<std::uint32_t, 3> groups{0, 1, 1};
  result.list->uploadValues(std::span<const std::uint32_t>(groups));
  return result;
}

/// An invocation for each cell of the listed bricks, and a barrier.
void walkBricks(PassContext& frame, const shader::BoundProgram& program,
                const std::vector<gpu::ResourceBinding>& bindings, const BrickList& bricks) {
  frame.shaders().dispatchIndirect(program, bindings, *bricks.list, 0);
  frame.device().barrier();
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
      if (findsFaces()) findFaces(frame, level);
      fillCells(frame, level);
      result.levels.push_back(level);
    }
    light = result;
  }

 protected:
  /// What surfaces close; without it nothing but the packed voxels occludes.
  virtual bool findsFaces() const { return true; }
  /// Virtual lights to the coefficients of the cells.
  virtual void fillCells(PassContext& frame, ShGrid::Level& level) {
    const GridPlacement& grid = level.grid;
    const gpu::BufferRef sums = frame.buffer(cellCount(grid) * kSumBytes, "virtual lights");
    sums->clear();
    const BrickList lit = emptyBricks(frame, grid.resolution);
    addLights(frame, level, *sums, lit);
    for (const gpu::TextureRef& channel : level.coefficients) channel->clear(glm::vec4(0.0f));
    resolveShader::Parameters parameters{};
    parameters.resolution = grid.resolution;
    // A clamped cosine has the mean cosine 2/3; 0 asks for that of the default lobe.
    parameters.meanCosine = lobe == "cosine" ? 2.0f / 3.0f : 0.0f;
    walkBricks(frame, frame.program(resolveShader::kProgram),
               {resolveShader::parameters(parameters), resolveShader::sums(*sums),
                resolveShader::brickList(*lit.list), resolveShader::red(*level.coefficients[0]),
                resolveShader::green(*level.coefficients[1]), resolveShader::blue(*level.coefficients[2])},
               lit);
  }
  /// Adds virtual lights to the sums of the cells, marks their bricks, and a barrier.
  virtual void addLights(PassContext& frame, const ShGrid::Level& level, const gpu::Buffer& sums,
                         const BrickList& lit) = 0;

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
      filled[axis]->clear(glm::vec4(0.0f));
    }
    const BrickList bricks = emptyBricks(frame, faces);
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
         closeShader::partsY(*parts[1]), closeShader::partsZ(*parts[2]),
         closeShader::brickFlags(*bricks.flags), closeShader::brickList(*bricks.list)},
        *fragments->count, sizeof(std::uint32_t));
    frame.device().barrier();
    for (int round = 0; round < 2; ++round) {
      walkBricks(
          frame, frame.program(fillShader::kProgram),
          {fillShader::brickList(*bricks.list), fillShader::partsX(*parts[0]), fillShader::partsY(*parts[1]),
           fillShader::partsZ(*parts[2]), fillShader::filledX(*filled[0]), fillShader::filledY(*filled[1]),
           fillShader::filledZ(*filled[2])},
          bricks);
      std::swap(parts, filled);
    }
    level.closed = cellTexture(frame, faces, gpu::Format::rgba8, "closed faces");
    level.moved = cellTexture(frame, faces, gpu::Format::rgba8, "moved surfaces");
    level.closed->clear(glm::vec4(0.0f));
    level.moved->clear(glm::vec4(0.0f));
    walkBricks(frame, frame.program(resolveClosedShader::kProgram),
               {resolveClosedShader::brickList(*bricks.list), resolveClosedShader::partsX(*parts[0]),
                resolveClosedShader::partsY(*parts[1]), resolveClosedShader::partsZ(*parts[2]),
                resolveClosedShader::closed(*level.closed), resolveClosedShader::moved(*level.moved)},
               bricks);
  }
};

class InjectRsmPass : public Inject {
  In<ReflectiveShadowMap> map{this, "map", Presence::optional,
                              "what the lights see; without it only the environment shines"};

  void addLights(PassContext& frame, const ShGrid::Level& level, const gpu::Buffer& sums,
                 const BrickList& lit) override {
    if (!map.present() || map->lightCount == 0) return;
    const GridPlacement& grid = level.grid;
    using gpu::Sampling;
    const gpu::TextureDescription& layers = map->flux->description();
    for (const int step : {rsmShader::Variant::stepWeigh, rsmShader::Variant::stepAdd}) {
      rsmShader::Variant variant;
      variant.step = step;
      std::vector<gpu::ResourceBinding> bindings{
          rsmShader::parameters({grid.low, grid.voxelSize, grid.resolution}),
          rsmShader::rsmPosition(*map->position, Sampling::nearest),
          rsmShader::rsmNormal(*map->normal, Sampling::nearest),
          rsmShader::rsmFlux(*map->flux, Sampling::nearest),
          rsmShader::moved(*level.moved, Sampling::nearest),
          rsmShader::sums(sums)};
      if (step == rsmShader::Variant::stepWeigh) {
        bindings.push_back(rsmShader::brickFlags(*lit.flags));
        bindings.push_back(rsmShader::brickList(*lit.list));
      }
      frame.dispatch(frame.program(rsmShader::kProgram, variant.key()), bindings,
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
  Param<std::string> voxels{
      this,
      "voxels",
      "mean",
      {"mean", "packed"},
      "what a voxel keeps of its surfaces: means, in the cells in front of them; or, as published (Listings 4.26 to 4.31), what wins an atomic maximum in the voxel that they lie in, lit at its centre: then lobe, albedo, normals, area and two_sided are the printed ones too"};
  Param<bool> asPublished{
      this, "as_published", false,
      "voxels packed, and no closed faces: propagate and gather must be as published too"};

  std::string checkParameters() const override {
    if (resolution > kLargestVoxelGrid)
      return fmt::format("resolution must be at most {} for voxels that are lit", kLargestVoxelGrid);
    return {};
  }

  bool findsFaces() const override { return !asPublished; }
  bool packed() const { return asPublished || voxels == "packed"; }

  void fillCells(PassContext& frame, ShGrid::Level& level) override {
    if (!packed()) return Inject::fillCells(frame, level);
    const GridPlacement& grid = level.grid;
    level.packed = frame.buffer(cellCount(grid) * kPackedBytes, "packed voxels");
    level.packed->clear();
    frame.shaders().dispatchIndirect(
        frame.program(packShader::kProgram),
        {packShader::parameters(
             {fragments->grid.low, fragments->grid.voxelSize, grid.low, grid.voxelSize, grid.resolution}),
         packShader::fragmentCount(*fragments->count), packShader::fragments(*fragments->fragments),
         packShader::words(*level.packed)},
        *fragments->count, sizeof(std::uint32_t));
    frame.device().barrier();
    if (!shadow.present() || shadow->lightCount == 0) {
      for (const gpu::TextureRef& channel : level.coefficients) channel->clear(glm::vec4(0.0f));
      return;
    }
    lightPackedShader::Parameters parameters{};
    parameters.gridLow = grid.low;
    parameters.cellSize = grid.voxelSize;
    parameters.resolution = grid.resolution;
    parameters.largestFlux = largestFlux(frame.sceneDescription(), frame.snapshot());
    parameters.lightCount = shadow->lightCount;
    frame.dispatch(
        frame.program(lightPackedShader::kProgram),
        {lightPackedShader::parameters(parameters), lightPackedShader::words(*level.packed),
         lightPackedShader::lights(*shadow->lights), lightPackedShader::views(*shadow->views),
         lightPackedShader::shadowDepth(*shadow->depth, gpu::Sampling::shadow),
         lightPackedShader::red(*level.coefficients[0]), lightPackedShader::green(*level.coefficients[1]),
         lightPackedShader::blue(*level.coefficients[2])},
        grid.resolution, kCellGroup);
  }

  void addLights(PassContext& frame, const ShGrid::Level& level, const gpu::Buffer& sums,
                 const BrickList& lit) override {
    if (!shadow.present() || shadow->lightCount == 0) return;
    const GridPlacement& grid = level.grid;
    const gpu::BufferRef collected = frame.buffer(cellCount(grid) * kVoxelBytes, "lit voxels");
    collected->clear();
    collectShader::Parameters collect{};
    collect.listLow = fragments->grid.low;
    collect.listVoxel = fragments->grid.voxelSize;
    collect.gridLow = grid.low;
    collect.cellSize = grid.voxelSize;
    collect.resolution = grid.resolution;
    collect.twoSided = twoSided ? 1 : 0;
    for (const int step : {collectShader::Variant::stepWeigh, collectShader::Variant::stepAdd}) {
      collectShader::Variant variant;
      variant.step = step;
      std::vector<gpu::ResourceBinding> bindings{
          collectShader::parameters(collect),
          collectShader::fragmentCount(*fragments->count),
          collectShader::fragments(*fragments->fragments),
          collectShader::voxels(*collected),
          collectShader::moved(*level.moved, gpu::Sampling::nearest),
          collectShader::closed(*level.closed, gpu::Sampling::nearest)};
      if (step == collectShader::Variant::stepWeigh) {
        bindings.push_back(collectShader::brickFlags(*lit.flags));
        bindings.push_back(collectShader::brickList(*lit.list));
      }
      frame.shaders().dispatchIndirect(frame.program(collectShader::kProgram, variant.key()), bindings,
                                       *fragments->count, sizeof(std::uint32_t));
      frame.device().barrier();
    }
    lightShader::Parameters parameters{};
    parameters.gridLow = grid.low;
    parameters.cellSize = grid.voxelSize;
    parameters.resolution = grid.resolution;
    parameters.largestFlux = largestFlux(frame.sceneDescription(), frame.snapshot());
    parameters.lightCount = shadow->lightCount;
    parameters.contrastAlbedo = albedo == "contrast" ? 1 : 0;
    parameters.closestNormal = normals == "closest" ? 1 : 0;
    parameters.wholeFaces = area == "whole" ? 1 : 0;
    walkBricks(
        frame, frame.program(lightShader::kProgram),
        {lightShader::parameters(parameters), lightShader::brickList(*lit.list),
         lightShader::voxels(*collected), lightShader::sums(sums), lightShader::lights(*shadow->lights),
         lightShader::views(*shadow->views), lightShader::shadowDepth(*shadow->depth, gpu::Sampling::shadow)},
        lit);
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
