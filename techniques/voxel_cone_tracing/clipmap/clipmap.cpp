// Levels of voxels around the camera; only what the camera uncovers is filled anew: thesis Gomes 2015, Sec.
// 3.5 (VXGI); Tanner et al. 1998.
#include "clipmap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>

#include "../cones/bounces.h"
#include "../direct_light.h"
#include "../voxel_sums.h"
#include "clipmap_items.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/change_tracking.h"
#include "lumivox/toolkit/counts.h"

namespace lumivox::voxel_cone_tracing {

using namespace shaders::voxel_cone_tracing;

namespace {

bool sameBounds(const Bounds& a, const Bounds& b) {
  return a.low == b.low && a.high == b.high && a.empty == b.empty;
}

/// A range of voxels of one level.
struct LevelRange {
  int level = 0;
  VoxelRange voxels;
  bool onlyChanges = false;  ///< only those in changed cells
};

/// The levels side by side as one grid (clipmap_stack.glsl).
struct ClipmapStack {
  int side = 0, row = 0, rows = 0;

  ClipmapStack(int resolution, int levels) {
    constexpr int kBrick = OccupiedBricks::kSide, kMostAlong = 1024;  // 10 bits: VoxelFragment::voxel
    side = (resolution + kBrick - 1) / kBrick * kBrick;
    row = std::min(kMostAlong / side, levels);
    rows = (levels + row - 1) / row;
    if (side * rows > kMostAlong)
      throw Error(fmt::format(
          "{} levels of {} voxels along a side do not fit into one list of fragments; expected at most {} levels",
          levels, resolution, row * row));
  }
  glm::ivec3 size() const { return {side, side * rows, side * row}; }
};

/// What lit the voxels. The resources are held, so that no others can take their addresses unnoticed.
struct LitBy {
  LightPlacement lights;
  std::vector<std::shared_ptr<const void>> media;
  std::vector<float> numbers;
  bool operator==(const LitBy&) const = default;
};

/// State carried from frame to frame: the voxels and their origin.
struct ClipmapState {
  RadianceClipmap clipmap;
  ClipmapPlacement placement;
  LitBy litBy;
  std::vector<std::shared_ptr<const void>> shadow;
  std::optional<std::vector<Bounds>> moving;  ///< empty: their changes are unknown
  bool filled = false;
};

/// Levels stay valid as long as this key is unchanged.
struct ClipmapKey {
  ClipmapPlacement placement;
  bool operator==(const ClipmapKey& other) const { return placement.sameVoxels(other.placement); }
};

class ClipmapPass : public Pass {
  enum class Coverage { touched, samples };
  enum class Precision { float_, half };

  DirectLight light{this};
  Bounces bounces{this, light, Bounces::Within::frames};
  LightBefore<RadianceClipmap> previous{this};
  Param<int> resolution{this, "resolution", 64, within(8, 512), "voxels along each side of a level"};
  Param<int> levels{
      this, "levels", 3, within(1, 10),
      "number of levels around the camera; each has voxels twice as large as the one inside it"};
  Param<float> extent{
      this, "extent",
      0.0f, within(0.0f, 1e9f),
      "m",  "side of the finest level; 0: so that the coarsest level contains the whole scene"};
  Param<Coverage> coverage{
      this, "coverage", Coverage::touched,
      "coverage of a voxel; touched: each voxel that a triangle touches, as in the other stores; samples: opacity by eight samples of each side of a voxel, and emittance by more where a triangle is small, as published"};
  Param<float> thickness{this, "thickness", 0.5f, within(0.0f, 1.0f),
                         "with 'samples': thickness of a surface seen from the side, in voxels; 0: none"};
  Param<int> supersampling{
      this, "supersampling", 4, within(1, 16),
      "with 'samples': largest number of pixels along a voxel for triangles that few samples hit, rounded down to a power of two; 1: no supersampling"};
  Param<Precision> precision{this, "precision", Precision::float_,
                             "numbers in the voxels; float: 16 bytes a face; half: 8"};
  Out<RadianceClipmap> radiance{this, "radiance",
                                "radiance that the faces of voxels reflect, and opacity; levels as voxelized",
                                Levels::finest};

  ChangeTracking changes_;
  /// Fragments that lists hold: a guess, or what earlier frames needed; for all levels and for parts.
  std::uint64_t roomForAll_ = 0, roomForParts_ = 0;
  /// Rows of tiles of large triangles that a draw may put aside; further rows are drawn directly.
  static constexpr std::uint32_t kRowCapacity = 1u << 16;
  /// Triangles examined before the fragments found are voxelized; bounds their list.
  static constexpr std::uint32_t kTrianglesAtOnce = 1u << 16;
  static constexpr std::uint64_t kRowHeadBytes = 4 * sizeof(std::uint32_t);

 public:
  Reads readsFrom() const override {
    return Reads::geometry | Reads::lights | Reads::materials | Reads::environment | Reads::partOfCamera;
  }
  std::string checkParameters() const override { return bounces.check(); }
  std::vector<float> readsOfCamera(const SceneSnapshot& snapshot) const override {
    std::vector<float> result;
    for (const glm::ivec3& first : placeClipmap(snapshot, resolution, levels, extent).first)
      result.insert(result.end(),
                    {static_cast<float>(first.x), static_cast<float>(first.y), static_cast<float>(first.z)});
    return result;
  }

  void run(PassContext& frame) override {
    const ClipmapPlacement placement = placeClipmap(frame.snapshot(), resolution, levels, extent);
    if (const RadianceClipmap* const lightBefore = previous.get()) {
      radiance = withBounces(frame, placement, *lightBefore);
      return;
    }
    const std::shared_ptr<ClipmapState> state =
        frame.kept("voxels of all levels", ClipmapKey{placement}, [&] { return stateFor(frame, placement); });
    update(frame, *state, placement);
    radiance = state->clipmap;
  }

 private:
  bool isHalf() const { return precision == Precision::half; }
  bool isSampled() const { return coverage == Coverage::samples; }

  // ---- room ----------------------------------------------------------------------------------------------

  gpu::Format format() const { return isHalf() ? gpu::Format::rgba16f : gpu::Format::rgba32f; }

  /// Whether the device has room for the volumes of a layout beside all else. The trial allocation is freed
  /// at once, not given to the pool, where it would wait.
  bool fits(PassContext& frame, const ClipmapLayout& layout) const {
    const gpu::TextureDescription volume{.kind = gpu::TextureKind::d3,
                                         .format = format(),
                                         .width = layout.volume.x,
                                         .height = layout.volume.y,
                                         .depth = layout.volume.z};
    try {
      std::vector<std::unique_ptr<gpu::Texture>> volumes;
      for (int face = 0; face < 6; ++face)
        volumes.push_back(std::make_unique<gpu::Texture>(frame.device(), volume, "clipmap of one side"));
      return true;
    } catch (const Error&) {
      return false;
    }
  }

  std::shared_ptr<ClipmapState> stateFor(PassContext& frame, const ClipmapPlacement& placement) const {
    const ClipmapStack stack(resolution, levels);  // Error for more voxels than a list can number
    const ClipmapLayout layout = layoutOf(placement);
    int largest = resolution;
    if (!fits(frame, layout)) {
      do {
        largest /= 2;
      } while (largest > 1 &&
               !fits(frame, layoutOf(placeClipmap(frame.snapshot(), largest, levels, extent))));
    }
    auto state = std::make_shared<ClipmapState>();
    try {
      // Memory waiting in the pool may be the very memory that is needed.
      for (gpu::TextureRef& face : state->clipmap.faces)
        face = frame.volume(layout.volume, format(), "clipmap of one side");
      state->clipmap.occupied =
          frame.buffer(layout.words * sizeof(std::uint32_t), "occupied voxels of a clipmap");
    } catch (const Error& error) {
      throw Error(fmt::format(
          "room for {} levels of {} voxels along a side takes {}; of sizes halved from it the largest that fits is {} ({})",
          static_cast<int>(levels), static_cast<int>(resolution), formatBytes(layout.bytes(format())),
          largest, error.what()));
    }
    return state;
  }

  // ---- all bounces over frames ---------------------------------------------------------------------------

  /// What the direct light of all voxels depends on.
  struct LitKey {
    ClipmapPlacement placement;
    LitBy litBy;
    std::vector<std::shared_ptr<const void>> shadow;
    std::vector<Bounds> moving;
    std::uint64_t room;
    bool operator==(const LitKey& other) const {
      return placement.sameVoxels(other.placement) && placement.first == other.placement.first &&
             litBy == other.litBy && shadow == other.shadow && room == other.room &&
             std::ranges::equal(moving, other.moving, sameBounds);
    }
  };

  /// All voxels anew: in every frame they reflect other light, so that nothing can stay where it lies.
  RadianceClipmap withBounces(PassContext& frame, const ClipmapPlacement& placement,
                              const RadianceClipmap& lightBefore) {
    if (isSampled())
      throw Error(
          "voxel_cone_tracing.clipmap: 'coverage samples' makes voxels more opaque than their fragments cover, and that share has no light of 'before'; expected 'coverage touched'");
    const ClipmapLayout layout = layoutOf(placement);
    RadianceClipmap result;
    for (gpu::TextureRef& face : result.faces) {
      face = frame.volume(layout.volume, format(), "clipmap of one side");
      face->clear(glm::vec4(0.0f));
    }
    result.occupied = frame.buffer(layout.words * sizeof(std::uint32_t), "occupied voxels of a clipmap");
    result.occupied->clear();
    place(frame, result, placement);
    const float brightest = brightestAfter(frame, brightestOf(frame, placement, 0), bounces.most(true));
    if (isHalf()) result.unit = brightest / kLargestHalf;

    const std::vector<LevelRange> ranges = rangesOf({}, placement, true, false);
    tellChange(result.change, {}, placement.levels(), true, ranges);
    const auto make = [&] { return litVoxels(frame, placement, ranges, nullptr, roomForAll_); };
    const std::optional<std::vector<Bounds>> moving = changes_.moving(frame);
    const LitVoxels voxels =
        moving ? frame.kept("direct light of voxels",
                            LitKey{placement, litBy(frame), shadowMap(), *moving, roomForAll_}, make)
               : make();
    resolve(frame, result, voxels,
            bounces.ofStoreBefore(frame,
                                  {.fragments = voxels.fragments,
                                   .sums = voxels.sums,
                                   .bricks = &voxels.occupied,
                                   .firstOfLevels = placement.first},
                                  storeOf(lightBefore, true), brightest));
    return result;
  }

  // ---- what has changed ----------------------------------------------------------------------------------

  LitBy litBy(PassContext& frame) const {
    // Nearer lights may exceed what a level stores.
    LitBy result{lightPlacement(frame, light.shadow, light.brightest(frame, 1.0f)), {}, {}};
    if (light.media.present() && light.shadow.present())
      for (const ScatteringGrid::Medium& medium : light.media->media) {
        result.media.push_back(medium.density);
        for (const glm::vec3& corner : {medium.bounds.low, medium.bounds.high, medium.grid.low})
          result.numbers.insert(result.numbers.end(), {corner.x, corner.y, corner.z});
      }
    return result;
  }
  std::vector<std::shared_ptr<const void>> shadowMap() const {
    if (!light.shadow.present()) return {};
    return {light.shadow->depth, light.shadow->lights, light.shadow->views};
  }

  /// Ranges to fill anew: newly reached voxels, and in the rest those in changed cells.
  static std::vector<LevelRange> rangesOf(const ClipmapPlacement& before, const ClipmapPlacement& placement,
                                          bool all, bool moves) {
    std::vector<LevelRange> result;
    for (int level = 0; level < placement.levels(); ++level) {
      const VoxelRange range = placement.rangeOf(level);
      const VoxelRange had = all ? VoxelRange{} : before.rangeOf(level).within(range);
      for (const VoxelRange& slab : range.without(had)) result.push_back({level, slab});
      if (moves && !had.empty()) result.push_back({level, had, true});
    }
    return result;
  }

  /// Finds the cells that differ from the frame before, one word each (clipmap_cells.glsl): cells that a
  /// moving object has left or entered, and cells behind it in the shadow map. Empties them.
  gpu::BufferRef emptyChangedCells(PassContext& frame, const RadianceClipmap& clipmap,
                                   const ClipmapPlacement& placement,
                                   const std::vector<Bounds>& moving) const {
    const std::uint64_t cells = cellsOfLevel(placement.resolution),
                        levelCount = static_cast<std::uint64_t>(placement.levels());
    const gpu::BufferRef result =
        frame.elements(clipmap_changed::clipmapCells, cells * levelCount, "changed cells of levels");
    const ItemLists full(frame, 1, cells * levelCount);
    const BoxesInViews boxes(frame, light.shadow, moving);
    const clipmap_changed::Moved moved{
        .boxCount = boxes.count, .lightCount = boxes.lightCount, .texel = boxes.texel};
    frame.dispatchList(frame.program(clipmap_changed::Variant{.lights = light.shadow.present()}),
                       {clipmapBinding(clipmap), clipmap_changed::clipmapCells(result), boxes.bindings(),
                        full.bindings(), clipmap_changed::moved(moved), clipmap_changed::moving(boxes.bounds),
                        clipmap_changed::clipmapOccupied(clipmap.occupied)},
                       cells * levelCount);
    frame.dispatchIndirect(frame.program(clipmap_clear::Variant{.changed = 1}),
                           {writing(clipmap), full.bindings()}, *full.heads, ItemLists::argumentsBytes(0));
    return result;
  }

  void update(PassContext& frame, ClipmapState& state, const ClipmapPlacement& placement) {
    LitBy lit = litBy(frame);
    auto shadow = shadowMap();
    std::optional<std::vector<Bounds>> moving = changes_.moving(frame);
    const bool known = state.filled && moving && state.moving && moving->size() == state.moving->size();
    const bool moves = known && !std::ranges::equal(*moving, *state.moving, sameBounds);
    // Without a known motion another shadow map changes everything.
    const bool all = !known || lit != state.litBy || (shadow != state.shadow && !moves);
    const std::vector<LevelRange> ranges = rangesOf(state.placement, placement, all, moves && !all);
    std::vector<RadianceClipmap::Level> before = state.clipmap.levels;
    place(frame, state.clipmap, placement);
    tellChange(state.clipmap.change, std::move(before), placement.levels(), all, ranges);
    state.clipmap.change.cells = moves && !all ? emptyChangedCells(frame, state.clipmap, placement,
                                                                   boundsAtEither(*moving, *state.moving))
                                               : nullptr;
    if (all) {
      for (const gpu::TextureRef& face : state.clipmap.faces) face->clear(glm::vec4(0.0f));
      state.clipmap.occupied->clear();
    } else {
      for (const LevelRange& range : ranges)
        if (!range.onlyChanges)
          frame.dispatch(frame.program(clipmap_clear::Variant{}),
                         {clipmap_clear::box({range.voxels.first, range.level, range.voxels.end}),
                          writing(state.clipmap)},
                         range.voxels.size());
    }
    if (!ranges.empty())
      resolve(
          frame, state.clipmap,
          litVoxels(frame, placement, ranges, state.clipmap.change.cells, all ? roomForAll_ : roomForParts_),
          nullptr);
    state.placement = placement;
    state.litBy = std::move(lit);
    state.shadow = std::move(shadow);
    state.moving = std::move(moving);
    state.filled = true;
  }

  static void tellChange(RadianceClipmap::Change& change, std::vector<RadianceClipmap::Level> before,
                         int levels, bool all, const std::vector<LevelRange>& ranges) {
    ++change.number;
    change.all = all;
    change.before = std::move(before);
    change.voxelized.assign(static_cast<std::size_t>(levels), {});
    for (const LevelRange& range : ranges) {
      VoxelRange& voxels = change.voxelized[static_cast<std::size_t>(range.level)];
      voxels = voxels.around(range.voxels);
    }
  }

  /// Describes the levels in the port.
  void place(PassContext& frame, RadianceClipmap& result, const ClipmapPlacement& placement) const {
    result.origin = placement.origin;
    result.voxelSize = placement.voxelSize;
    result.around = placement.levels();
    result.levels = layoutOf(placement).levels;
    result.filledLevels = result.around;
    if (isHalf()) result.unit = brightestOf(frame, placement, 0) / kLargestHalf;
  }

  float brightestOf(PassContext& frame, const ClipmapPlacement& placement, int level) const {
    // A level does not resolve anything nearer than half a voxel.
    return light.brightest(frame, 0.5f * std::ldexp(placement.voxelSize, level));
  }

  // ---- voxels --------------------------------------------------------------------------------------------

  shader::BindingSet stackBinding(PassContext& frame, const ClipmapPlacement& placement,
                                  const ClipmapStack& stack) const {
    clipmap_voxelize::ClipmapStack block{.stackOrigin = placement.origin,
                                         .stackVoxel = placement.voxelSize,
                                         .stackSide = stack.side,
                                         .stackRow = stack.row};
    for (int level = 0; level < placement.levels(); ++level) {
      const auto i = static_cast<std::size_t>(level);
      block.stackFirst[i] = {placement.first[i], 0};
      block.stackLimits[i] = {brightestOf(frame, placement, level), std::ldexp(placement.sceneSide, -level),
                              0.0f, 0.0f};
    }
    return {shader::UniformSlot<clipmap_voxelize::ClipmapStack>{"ClipmapStack"}(block)};
  }

  /// Voxels with the sums of the direct light that they reflect.
  struct LitVoxels {
    VoxelFragments fragments;
    VoxelSums sums;
    OccupiedBricks occupied;
  };
  LitVoxels litVoxels(PassContext& frame, const ClipmapPlacement& placement,
                      const std::vector<LevelRange>& ranges, const gpu::BufferRef& changedCells,
                      std::uint64_t& room) {
    const ClipmapStack stack(placement.resolution, placement.levels());
    const shader::BindingSet stackBound = stackBinding(frame, placement, stack);
    if (room == 0) {
      // Surfaces fill about as many voxels of a level as its six sides, twice as many between two layers;
      // slabs are a small part of them.
      const auto side = static_cast<std::uint64_t>(placement.resolution);
      const std::uint64_t most = frame.device().info().maxStorageBytes / VoxelFragments::kFragmentBytes;
      room = 12 * side * side * static_cast<std::uint64_t>(placement.levels()) +
             4 * frame.sceneDescription().triangleCount();
      room = std::clamp<std::uint64_t>(&room == &roomForAll_ ? room : room / 8, 1, most);
    }
    VoxelFragments fragments;
    fragments.grid = {placement.origin, placement.voxelSize, stack.size()};
    fragments.workGroupSize = kCountedGroupSize;
    fragments.capacity = room;
    fragments.coverage = isSampled() ? VoxelFragments::Coverage::sum : VoxelFragments::Coverage::mean;
    fragments.count = countBuffer(frame, "voxel fragment count");
    fragments.fragments = frame.elements(clipmap_voxelize::fragments, room, "voxel fragments of levels");
    gpu::BufferRef sideMasks;
    if (isSampled())
      sideMasks = frame.elements(clipmap_voxelize::sideMasks, room, "samples of voxels' sides");
    voxelize(frame, fragments, sideMasks, stackBound, ranges, changedCells);
    finishGuessed(frame, fragments.count, fragments.capacity, 0, room);

    LitVoxels lit{fragments, {}, {}};
    lit.sums = claimSums(frame, fragments, stack.size(), true, lit.occupied);
    lit.sums.kind = inject::Variant::placesClipmap;
    lit.sums.sideMasks = sideMasks;
    lit.sums.places.add(stackBound);
    const gpu::BufferRef radiances = radiancesOf(frame, fragments, lit.sums);
    light.reflect(frame, fragments, lit.sums, 0.0f, radiances);
    addUp(frame, fragments, lit.sums, radiances);
    return lit;
  }

  /// Writes voxels from their sums, and what they reflect beside it unless that is null.
  void resolve(PassContext& frame, const RadianceClipmap& clipmap, const LitVoxels& lit,
               const gpu::BufferRef& reflected) const {
    frame.dispatchIndirect(
        frame.program(clipmap_resolve::Variant{.sampled = isSampled(), .reflected = reflected != nullptr}),
        {clipmap_resolve::parameters({.brickCount = lit.sums.brickCount, .unit = clipmap.unit}),
         clipmap_resolve::brickList(lit.occupied.bricks), clipmap_resolve::brickCount(lit.occupied.count),
         clipmap_resolve::reflected(reflected), lit.sums.bindings(), writing(clipmap)},
        *lit.occupied.count, OccupiedBricks::argumentsBytes(0));
  }

  /// Voxelizes all ranges at once, draw by draw.
  void voxelize(PassContext& frame, const VoxelFragments& list, const gpu::BufferRef& sideMasks,
                const shader::BindingSet& stack, const std::vector<LevelRange>& ranges,
                const gpu::BufferRef& changedCells) const {
    clipmap_voxelize::Boxes boxes{};
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      boxes.boxFirst[i] = {ranges[i].voxels.first, ranges[i].level};
      boxes.boxEnd[i] = {ranges[i].voxels.end, ranges[i].onlyChanges};
    }
    int mostScale = 1;
    while (2 * mostScale <= supersampling) mostScale *= 2;
    const gpu::BufferRef rows = frame.buffer(
        kRowHeadBytes + kRowCapacity * clipmap_voxelize::rows.elementBytes, "rows of large triangles");
    const auto boxCount = static_cast<std::uint32_t>(ranges.size());
    std::uint32_t most = 0;
    for (const SceneDraw& draw : frame.scene().draws()) most = std::max(most, draw.indexCount / 3);
    const gpu::BufferRef few =
        frame.buffer(kRowHeadBytes + std::uint64_t{boxCount} * std::min(most, kTrianglesAtOnce) *
                                         clipmap_voxelize::few.elementBytes,
                     "triangles of few voxels");
    const shader::BindingSet lists{stack,
                                   clipmap_voxelize::boxes(boxes),
                                   clipmap_voxelize::count(list.count),
                                   clipmap_voxelize::fragments(list.fragments),
                                   clipmap_voxelize::sideMasks(sideMasks),
                                   clipmap_voxelize::rows(rows),
                                   clipmap_voxelize::few(few),
                                   clipmap_voxelize::clipmapCells(changedCells)};
    for (const SceneDraw& draw : frame.scene().draws())
      for (std::uint32_t first = 0; first < draw.indexCount; first += 3 * kTrianglesAtOnce) {
        const std::array<std::uint32_t, 4> none{0, 0, 1, 1};
        rows->uploadValues(std::span<const std::uint32_t>(none));
        few->uploadValues(std::span<const std::uint32_t>(none));
        const std::uint32_t triangles = std::min((draw.indexCount - first) / 3, kTrianglesAtOnce);
        const SceneBinding scene(frame, draw);
        auto variant =
            scene.in(clipmap_voxelize::Variant{.sampled = isSampled(), .changed = changedCells != nullptr});
        const shader::BindingSet bindings{
            scene, lists,
            clipmap_voxelize::part({.firstIndex = static_cast<int>(draw.firstIndex + first),
                                    .triangleCount = static_cast<int>(triangles),
                                    .capacity = static_cast<int>(list.capacity),
                                    .rowCapacity = static_cast<int>(kRowCapacity),
                                    .mostScale = mostScale,
                                    .thickness = thickness})};
        frame.dispatch(frame.program(variant), bindings,
                       {static_cast<int>(triangles), static_cast<int>(boxCount), 1});
        variant.stage = clipmap_voxelize::Variant::stageSmall;
        frame.dispatchIndirect(frame.program(variant), bindings, *few, sizeof(std::uint32_t));
        variant.stage = clipmap_voxelize::Variant::stageLarge;
        frame.dispatchIndirect(frame.program(variant), bindings, *rows, sizeof(std::uint32_t));
      }
  }
};

}  // namespace

void addClipmap(TechniqueRegistry& registry) {
  registry.add<ClipmapPass>("clipmap",
                            "Levels of voxels around the camera, lit (3D clipmap: thesis Sec. 3.5)");
}

}  // namespace lumivox::voxel_cone_tracing
