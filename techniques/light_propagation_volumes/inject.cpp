// Injects virtual point lights from a reflective shadow map (Kaplanyan & Dachsbacher 2010, Sec. 4.1) or from
// illuminated voxels (Doghramachi 2013; thesis Gomes 2015, Sec. 4.3.1, 4.3.2), and finds the faces that
// surfaces occlude.
#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "lumivox/base/error.h"
#include "lumivox/toolkit/light_bounds.h"
#include "nested_grids.h"

namespace lumivox::light_propagation_volumes {

using namespace shaders::light_propagation_volumes;

namespace {

constexpr int kLargestVoxelGrid = 96;  // cells along a side whose voxels fit into 128 MiB, which every driver
                                       // can address

/// Occupied bricks of 4 x 4 x 4 cells. Passes over surfaces and lights mark them; passes over cells walk
/// them. Their number stays on the device (bricks.glsl).
struct BrickList {
  gpu::BufferRef flags, list;
  BrickList(PassContext& frame, const glm::ivec3& cells) {
    const std::uint64_t count = GridPlacement{.resolution = (cells + kBrick - 1) / kBrick}.voxelCount();
    flags = frame.emptyElements(close::brickFlags, count, "marked bricks");
    list = frame.buffer((3 + count) * sizeof(std::uint32_t), "list of bricks");
    const std::array<std::uint32_t, 3> groups{0, 1, 1};
    list->uploadValues(std::span<const std::uint32_t>(groups));
  }
  shader::BindingSet bindings() const {
    return {shader::StorageSlot{"BrickFlags"}(flags), shader::StorageSlot{"BrickList"}(list)};
  }
};

/// Dispatches an invocation for each cell of the listed bricks, then a barrier.
void walkBricks(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bindings,
                const BrickList& bricks) {
  frame.dispatchIndirect(program, {bindings, bricks.bindings()}, *bricks.list);
}

class Inject : public Pass {
  enum class Lobe { forward, cosine };

 public:
  Reads readsFrom() const override { return Reads::partOfCamera | Reads::geometry | Reads::lights; }
  /// The grids move with the camera by whole cells, and stay in the scene.
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
  /// Whether the faces that surfaces occlude are found; without them only packed voxels occlude.
  virtual bool findsFaces() const { return true; }
  /// Turns virtual lights into the coefficients of cells.
  virtual void fillCells(PassContext& frame, const ShGrid::Level& level, OccludedFaces::Level& surfaces) {
    const GridPlacement& grid = level.grid;
    const gpu::BufferRef sums =
        frame.emptyElements(resolve_lights::sums, grid.voxelCount(), "virtual lights");
    const BrickList lit(frame, grid.resolution);
    addLights(frame, grid, surfaces, sums, lit);
    for (const gpu::TextureRef& channel : level.coefficients) channel->clear(glm::vec4(0.0f));
    // A clamped cosine has the mean cosine 2/3; 0 stands for the default lobe's.
    const float meanCosine = lobe == Lobe::cosine ? 2.0f / 3.0f : 0.0f;
    walkBricks(frame, frame.program(resolve_lights::kProgram),
               {cellsBinding(grid), resolve_lights::parameters({meanCosine}), resolve_lights::sums(sums),
                images(level.coefficients)},
               lit);
  }
  /// Adds virtual lights to the sums of the cells and marks their bricks; a barrier follows.
  virtual void addLights(PassContext& frame, const GridPlacement& grid, const OccludedFaces::Level& surfaces,
                         const gpu::BufferRef& sums, const BrickList& lit) = 0;

  In<VoxelFragments> fragments{this, "fragments",
                               "surface samples; their voxels no larger than the finest cells"};
  Param<int> levels{this, "levels", 2, within(1, 10),
                    "number of nested grids, each twice as large as the one inside it"};
  Param<int> resolution{this, "resolution", 32, within(8, 128), "cells along a side of each grid"};
  Param<float> extent{
      this,
      "extent",
      0.0f,
      within(0.0f, 1e9f),
      "m",
      "side of the finest grid, which follows the camera; 0: such that the coarsest grid contains the scene"};
  Param<Lobe> lobe{
      this, "lobe", Lobe::forward,
      "emission of a virtual light; forward: none backwards; cosine: a clamped cosine, of which two bands send a seventh backwards",
      published(Lobe::cosine)};
  Out<ShGrid> light{this, "light", "virtual point lights, W/sr"};
  Out<OccludedFaces> faces{this, "faces", "shares of the faces between cells that surfaces occlude"};

 private:
  /// Finds the faces that surfaces occlude, and how far these were moved.
  void findFaces(PassContext& frame, OccludedFaces::Level& level) {
    const GridPlacement& grid = level.grid;
    if (fragments->grid.voxelSize > grid.voxelSize * 1.001f)
      frame.warn(
          fmt::format("the fragments have voxels of {} m and the cells {} m: surfaces have holes; voxelize "
                      "with a higher resolution",
                      fragments->grid.voxelSize, grid.voxelSize));
    GridPlacement walls = grid;
    walls.resolution += 1;
    const auto empty = [&](gpu::Format format, const char* label) {
      return frame.emptyVolume(walls.resolution, format, label);
    };
    Channels parts, filled;  // for the three axes
    for (std::size_t axis = 0; axis < 3; ++axis) {
      parts[axis] = empty(gpu::Format::r32ui, "parts of faces");
      filled[axis] = empty(gpu::Format::r32ui, "parts of faces, corners filled");
    }
    const BrickList bricks(frame, walls.resolution);
    forEachFragment(frame, frame.program(close::kProgram),
                    {cellsBinding(walls), close::parameters({fragments->grid.low, fragments->grid.voxelSize}),
                     images(parts, kParts), bricks.bindings()},
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
    // The grids bound virtual content; captured walls lie beyond them.
    if (map->captured)
      throw Error(
          "a captured map, most of which lies outside of the grids around the virtual content; expected a map of "
          "lights");
    const gpu::TextureDescription& layers = map->flux->description();
    using Variant = inject_rsm::Variant;
    for (const int step : {Variant::stepWeigh, Variant::stepAdd})
      frame.dispatch(
          frame.program(Variant{step}),
          {cellsBinding(grid), ReflectiveShadowMapBinding(*map),
           inject_rsm::moved(surfaces.moved, gpu::Sampling::nearest), inject_rsm::sums(sums), lit.bindings()},
          {layers.width, layers.height, layers.depth});
  }
};

class InjectVoxelsPass : public Inject {
  enum class Albedo { mean, contrast };
  enum class Normals { all, closest };
  enum class Area { covered, whole };
  enum class Voxels { mean, packed };

  In<ShadowMap> shadow{this, "shadow", Presence::optional,
                       "lights and their visibility; without it only the environment shines"};
  Param<Albedo> albedo{
      this, "albedo", Albedo::mean,
      "albedo of a voxel; mean: the mean of its surfaces; contrast: the albedo with the most contrast",
      published(Albedo::contrast)};
  Param<Normals> normals{
      this, "normals", Normals::all,
      "normals of a voxel that reflect a light; all: all that the light reaches; closest: only the normal closest to the light's direction",
      published(Normals::closest)};
  Param<Area> area{
      this, "area", Area::covered,
      "area of a surface in its voxel; covered: the part of a face that it covers; whole: a whole face",
      published(Area::whole)};
  Param<bool> twoSided{this, "two_sided", true,
                       "light on the back of a triangle counts; off: only on the front", published(false)};
  Param<Voxels> voxels{
      this, "voxels", Voxels::mean,
      "what a voxel stores; mean: means of its surfaces, in the cells in front of them; packed: the winners of an atomic maximum in the surfaces' own voxel, lit at its centre (Listings 4.26 to 4.31); lobe, albedo, normals, area and two_sided are then as printed too",
      published(Voxels::packed)};
  PublishedForm asPublished{this, "no occluded faces (propagate and gather must be as published too)"};

  std::string checkParameters() const override {
    if (resolution > kLargestVoxelGrid)
      return fmt::format("resolution must be at most {} for voxels that are lit", kLargestVoxelGrid);
    return {};
  }

  void run(PassContext& frame) override {
    if (fragments->reflected != nullptr)
      throw Error(
          "light_propagation_volumes.inject_voxels: input 'fragments' brings along direct light that the image has, and voxels are lit as a whole, by what their surfaces have in common; expected fragments without it ('direct' of voxelization.reproject left out)");
    Inject::run(frame);
  }

  bool findsFaces() const override { return !asPublished; }
  bool packed() const { return voxels == Voxels::packed; }

  void fillCells(PassContext& frame, const ShGrid::Level& level, OccludedFaces::Level& surfaces) override {
    if (!packed()) return Inject::fillCells(frame, level, surfaces);
    const GridPlacement& grid = level.grid;
    surfaces.packed = frame.emptyElements(pack_voxels::words, grid.voxelCount(), "packed voxels");
    forEachFragment(
        frame, frame.program(pack_voxels::kProgram),
        {cellsBinding(grid), pack_voxels::parameters({fragments->grid.low, fragments->grid.voxelSize}),
         pack_voxels::words(surfaces.packed)},
        *fragments);
    const LightBinding lights(shadow);
    if (lights.count == 0) {
      for (const gpu::TextureRef& channel : level.coefficients) channel->clear(glm::vec4(0.0f));
      return;
    }
    frame.dispatch(
        frame.program(light_packed::kProgram),
        {cellsBinding(grid),
         light_packed::parameters({largestFlux(frame.sceneDescription(), frame.snapshot()), lights.count}),
         light_packed::words(surfaces.packed), lights, images(level.coefficients)},
        grid.resolution);
  }

  void addLights(PassContext& frame, const GridPlacement& grid, const OccludedFaces::Level& surfaces,
                 const gpu::BufferRef& sums, const BrickList& lit) override {
    const LightBinding lights(shadow);
    if (lights.count == 0) return;
    const gpu::BufferRef collected =
        frame.emptyElements(collect_voxels::voxels, grid.voxelCount(), "lit voxels");
    using Variant = collect_voxels::Variant;
    for (const int step : {Variant::stepWeigh, Variant::stepAdd})
      forEachFragment(frame, frame.program(Variant{step}),
                      {cellsBinding(grid), lit.bindings(), collect_voxels::voxels(collected),
                       collect_voxels::parameters({fragments->grid.low, fragments->grid.voxelSize, twoSided}),
                       collect_voxels::moved(surfaces.moved, gpu::Sampling::nearest),
                       collect_voxels::occluded(surfaces.occluded, gpu::Sampling::nearest)},
                      *fragments);
    walkBricks(
        frame, frame.program(light_voxels::kProgram),
        {cellsBinding(grid),
         light_voxels::parameters({.largestFlux = largestFlux(frame.sceneDescription(), frame.snapshot()),
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
