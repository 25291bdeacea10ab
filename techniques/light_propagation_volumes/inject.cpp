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

using namespace shaders::light_propagation_volumes;

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
void walkBricks(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bindings,
                const BrickList& bricks) {
  frame.dispatchIndirect(program, {bindings, shader::StorageSlot{"BrickList"}(bricks.list)}, *bricks.list);
}

class Inject : public Pass {
  enum class Lobe { forward, cosine };
  friend constexpr auto words(Lobe) { return std::array{"forward", "cosine"}; }

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
    OccludedFaces surfaces;
    for (const GridPlacement& grid : placeGrids(frame.snapshot(), levels, resolution, extent)) {
      const ShGrid::Level level{grid, coefficientTextures(frame, grid.resolution, "coefficients")};
      OccludedFaces::Level occluded{grid, nullptr, nullptr, nullptr};
      if (findsFaces()) findFaces(frame, occluded);
      fillCells(frame, level, occluded);
      result.levels.push_back(level);
      surfaces.levels.push_back(occluded);
    }
    light = result;
    faces = surfaces;
  }

 protected:
  /// The faces that surfaces occlude; without them only the packed voxels occlude.
  virtual bool findsFaces() const { return true; }
  /// Virtual lights to the coefficients of the cells.
  virtual void fillCells(PassContext& frame, const ShGrid::Level& level, OccludedFaces::Level& surfaces) {
    const GridPlacement& grid = level.grid;
    const gpu::BufferRef sums = frame.elements(resolve_lights::sums, cellCount(grid), "virtual lights");
    sums->clear();
    const BrickList lit = emptyBricks(frame, grid.resolution);
    addLights(frame, grid, surfaces, sums, lit);
    for (const gpu::TextureRef& channel : level.coefficients) channel->clear(glm::vec4(0.0f));
    // A clamped cosine has the mean cosine 2/3; 0 asks for that of the default lobe.
    const float meanCosine = lobe == Lobe::cosine ? 2.0f / 3.0f : 0.0f;
    walkBricks(frame, frame.program(resolve_lights::kProgram),
               {resolve_lights::parameters({grid.resolution, meanCosine}), resolve_lights::sums(sums),
                images(level.coefficients)},
               lit);
  }
  /// Adds virtual lights to the sums of the cells, marks their bricks, and a barrier.
  virtual void addLights(PassContext& frame, const GridPlacement& grid, const OccludedFaces::Level& surfaces,
                         const gpu::BufferRef& sums, const BrickList& lit) = 0;

  In<VoxelFragments> fragments{this, "fragments",
                               "surface samples; their voxels no larger than the finest cells"};
  Param<int> levels{this, "levels", 2, within(1, 10),
                    "nested grids, each of twice the size of the one inside"};
  Param<int> resolution{this, "resolution", 32, within(8, 128), "cells along a side of each grid"};
  Param<float> extent{
      this, "extent",
      0.0f, within(0.0f, 1e9f),
      "m",  "side of the finest grid, around the camera; 0: as large as lets the coarsest hold the scene"};
  Param<Lobe> lobe{
      this, "lobe", Lobe::forward,
      "what a virtual light sends out: nothing backwards, or, as published, a clamped cosine, of which two bands let a seventh out at the back"};
  Out<ShGrid> light{this, "light", "virtual point lights, W/sr"};
  Out<OccludedFaces> faces{this, "faces", "the faces between the cells that surfaces occlude"};

 private:
  /// The faces that surfaces occlude, and how far these were moved.
  void findFaces(PassContext& frame, OccludedFaces::Level& level) {
    const GridPlacement& grid = level.grid;
    if (fragments->grid.voxelSize > grid.voxelSize * 1.001f)
      frame.warn(
          fmt::format("the fragments have voxels of {} m and the cells {} m: surfaces have holes; voxelize "
                      "with a higher resolution",
                      fragments->grid.voxelSize, grid.voxelSize));
    const glm::ivec3 size = grid.resolution + 1;
    const auto empty = [&](gpu::Format format, const char* label) {
      gpu::TextureRef texture = frame.volume(size, format, label);
      texture->clear(glm::vec4(0.0f));
      return texture;
    };
    Channels parts, filled;  // of the three axes
    for (std::size_t axis = 0; axis < 3; ++axis) {
      parts[axis] = empty(gpu::Format::r32ui, "parts of faces");
      filled[axis] = empty(gpu::Format::r32ui, "parts of faces, corners filled");
    }
    const BrickList bricks = emptyBricks(frame, size);
    forEachFragment(
        frame, frame.program(close::kProgram),
        {close::parameters({fragments->grid.low, fragments->grid.voxelSize, grid.low, grid.voxelSize, size}),
         images(parts, kParts), close::brickFlags(bricks.flags), close::brickList(bricks.list)},
        *fragments);
    for (int round = 0; round < 2; ++round) {
      walkBricks(frame, frame.program(fill_corners::kProgram),
                 {images(parts, kParts), images(filled, kFilled)}, bricks);
      std::swap(parts, filled);
    }
    level.occluded = empty(gpu::Format::rgba8, "occluded faces");
    level.moved = empty(gpu::Format::rgba8, "moved surfaces");
    walkBricks(frame, frame.program(resolve_occluded::kProgram),
               {images(parts, kParts), resolve_occluded::occluded(level.occluded),
                resolve_occluded::moved(level.moved)},
               bricks);
  }
};

class InjectRsmPass : public Inject {
  In<ReflectiveShadowMap> map{this, "map", Presence::optional,
                              "what the lights see; without it only the environment shines"};

  void addLights(PassContext& frame, const GridPlacement& grid, const OccludedFaces::Level& surfaces,
                 const gpu::BufferRef& sums, const BrickList& lit) override {
    if (!map.present() || map->lightCount == 0) return;
    const gpu::TextureDescription& layers = map->flux->description();
    using Variant = inject_rsm::Variant;
    for (const int step : {Variant::stepWeigh, Variant::stepAdd})
      frame.dispatch(
          frame.program(Variant{step}),
          {inject_rsm::parameters({grid.low, grid.voxelSize, grid.resolution}),
           ReflectiveShadowMapBinding(*map), inject_rsm::moved(surfaces.moved, gpu::Sampling::nearest),
           inject_rsm::sums(sums), inject_rsm::brickFlags(lit.flags), inject_rsm::brickList(lit.list)},
          {layers.width, layers.height, layers.depth});
  }
};

class InjectVoxelsPass : public Inject {
  enum class Albedo { mean, contrast };
  friend constexpr auto words(Albedo) { return std::array{"mean", "contrast"}; }
  enum class Normals { all, closest };
  friend constexpr auto words(Normals) { return std::array{"all", "closest"}; }
  enum class Area { covered, whole };
  friend constexpr auto words(Area) { return std::array{"covered", "whole"}; }
  enum class Voxels { mean, packed };
  friend constexpr auto words(Voxels) { return std::array{"mean", "packed"}; }

  In<ShadowMap> shadow{this, "shadow", Presence::optional,
                       "lights and their visibility; without it only the environment shines"};
  Param<Albedo> albedo{this, "albedo", Albedo::mean, "of a voxel; as published: its most contrasting one"};
  Param<Normals> normals{this, "normals", Normals::all,
                         "that a light reaches; as published: only the one closest to its direction"};
  Param<Area> area{this, "area", Area::covered, "of a surface; as published: all of its voxel"};
  Param<bool> twoSided{this, "two_sided", true,
                       "light on the back of a triangle counts; off, as published: only the front"};
  Param<Voxels> voxels{
      this, "voxels", Voxels::mean,
      "what a voxel keeps of its surfaces: means, in the cells in front of them; or, as published (Listings 4.26 to 4.31), what wins an atomic maximum in the voxel that they lie in, lit at its centre: then lobe, albedo, normals, area and two_sided are the printed ones too"};
  Param<bool> asPublished{
      this, "as_published", false,
      "voxels packed, and no occluded faces: propagate and gather must be as published too"};

  std::string checkParameters() const override {
    if (resolution > kLargestVoxelGrid)
      return fmt::format("resolution must be at most {} for voxels that are lit", kLargestVoxelGrid);
    return {};
  }

  bool findsFaces() const override { return !asPublished; }
  bool packed() const { return asPublished || voxels == Voxels::packed; }

  void fillCells(PassContext& frame, const ShGrid::Level& level, OccludedFaces::Level& surfaces) override {
    if (!packed()) return Inject::fillCells(frame, level, surfaces);
    const GridPlacement& grid = level.grid;
    surfaces.packed = frame.elements(pack_voxels::words, cellCount(grid), "packed voxels");
    surfaces.packed->clear();
    forEachFragment(frame, frame.program(pack_voxels::kProgram),
                    {pack_voxels::parameters({fragments->grid.low, fragments->grid.voxelSize, grid.low,
                                              grid.voxelSize, grid.resolution}),
                     pack_voxels::words(surfaces.packed)},
                    *fragments);
    const LightBinding lights(shadow);
    if (lights.count == 0) {
      for (const gpu::TextureRef& channel : level.coefficients) channel->clear(glm::vec4(0.0f));
      return;
    }
    frame.dispatch(
        frame.program(light_packed::kProgram),
        {light_packed::parameters({grid.low, grid.voxelSize, grid.resolution,
                                   largestFlux(frame.sceneDescription(), frame.snapshot()), lights.count}),
         light_packed::words(surfaces.packed), lights, images(level.coefficients)},
        grid.resolution);
  }

  void addLights(PassContext& frame, const GridPlacement& grid, const OccludedFaces::Level& surfaces,
                 const gpu::BufferRef& sums, const BrickList& lit) override {
    const LightBinding lights(shadow);
    if (lights.count == 0) return;
    const gpu::BufferRef collected = frame.elements(collect_voxels::voxels, cellCount(grid), "lit voxels");
    collected->clear();
    using Variant = collect_voxels::Variant;
    for (const int step : {Variant::stepWeigh, Variant::stepAdd})
      forEachFragment(
          frame, frame.program(Variant{step}),
          {collect_voxels::parameters({fragments->grid.low, fragments->grid.voxelSize, grid.low,
                                       grid.voxelSize, grid.resolution, twoSided}),
           collect_voxels::voxels(collected), collect_voxels::moved(surfaces.moved, gpu::Sampling::nearest),
           collect_voxels::occluded(surfaces.occluded, gpu::Sampling::nearest),
           collect_voxels::brickFlags(lit.flags), collect_voxels::brickList(lit.list)},
          *fragments);
    walkBricks(
        frame, frame.program(light_voxels::kProgram),
        {light_voxels::parameters({.gridLow = grid.low,
                                   .cellSize = grid.voxelSize,
                                   .resolution = grid.resolution,
                                   .largestFlux = largestFlux(frame.sceneDescription(), frame.snapshot()),
                                   .lightCount = lights.count,
                                   .contrastAlbedo = albedo == Albedo::contrast,
                                   .closestNormal = normals == Normals::closest,
                                   .wholeFaces = area == Area::whole}),
         light_voxels::voxels(collected), light_voxels::sums(sums), lights},
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
