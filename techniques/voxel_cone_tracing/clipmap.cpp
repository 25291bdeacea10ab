// Levels of voxels around the camera, of which only what the camera uncovers is filled anew: thesis Gomes
// 2015, Sec. 3.5 (VXGI); Tanner et al. 1998.
#include "clipmap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include "direct_light.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/toolkit/bindings.h"
#include "voxel_sums.h"

namespace lumivox::voxel_cone_tracing {

using namespace shaders::voxel_cone_tracing;

namespace {

/// A range of voxels of one level.
struct LevelRange {
  int level = 0;
  VoxelRange voxels;
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

/// Where an object is that moves or deforms.
struct MovingObject {
  glm::mat4 toWorld{1.0f};
  bool deforms = false;
  Bounds bounds;  ///< m
};

/// What the voxels were lit by: resources that are held, so that no others can take their place unseen.
struct LitBy {
  std::vector<std::shared_ptr<const void>> resources;
  std::vector<float> numbers;
  bool operator==(const LitBy&) const = default;
};

/// What is carried from frame to frame: the voxels, and of what they are.
struct ClipmapState {
  RadianceClipmap clipmap;
  ClipmapPlacement placement;
  LitBy litBy;
  std::vector<MovingObject> moving;
  bool filled = false;
};

/// What the levels hold as long as it stays the same.
struct ClipmapKey {
  ClipmapPlacement placement;
  bool operator==(const ClipmapKey& other) const { return placement.sameVoxels(other.placement); }
};

/// Adds the voxels of a range that are in no range of its level yet.
void addTo(std::vector<LevelRange>& ranges, int level, const VoxelRange& added) {
  std::vector<VoxelRange> rest{added};
  for (const LevelRange& before : ranges) {
    if (before.level != level) continue;
    std::vector<VoxelRange> next;
    for (const VoxelRange& part : rest)
      for (const VoxelRange& left : part.without(before.voxels)) next.push_back(left);
    rest = std::move(next);
  }
  for (const VoxelRange& part : rest)
    if (!part.empty()) ranges.push_back({level, part});
}

class ClipmapPass : public Pass {
  enum class Coverage { touched, samples };
  enum class Precision { float_, half };

  DirectLight light{this};
  Param<int> resolution{this, "resolution", 64, within(8, 512), "voxels along each side of a level"};
  Param<int> levels{this, "levels", 3, within(1, 10),
                    "around the camera, each with voxels of twice the size"};
  Param<float> extent{
      this, "extent",
      0.0f, within(0.0f, 1e9f),
      "m",  "side of the finest level; 0: so that the coarsest level contains the whole scene"};
  Param<Coverage> coverage{
      this, "coverage", Coverage::touched,
      "what triangles cover: each voxel that they touch, as in the other stores; or, as published, opacity by eight samples of each side of a voxel and emittance by more where a triangle is small"};
  Param<float> thickness{
      this, "thickness", 0.5f, within(0.0f, 1.0f),
      "with 'samples', how thick a surface is seen from the side, in voxels; 0: as thin as it is"};
  Param<int> supersampling{this, "supersampling", 4, within(1, 16),
                           "with 'samples', most pixels along a voxel for triangles that few samples meet; "
                           "the largest power of two that is no more; 1: none"};
  Param<Precision> precision{this, "precision", Precision::float_, "of the voxels: 16 or 8 bytes a face"};
  Out<RadianceClipmap> radiance{this, "radiance",
                                "radiance that the faces of voxels reflect, and opacity; levels as voxelized",
                                Levels::finest};

  /// Fragments that lists are made for: a guess, or what earlier frames needed; of all levels, and of parts.
  std::uint64_t roomForAll_ = 0, roomForParts_ = 0;
  /// Rows of tiles of large triangles that a draw may put aside; what does not fit is done without.
  static constexpr std::uint32_t kRowCapacity = 1u << 16;
  static constexpr std::uint64_t kRowHeadBytes = 4 * sizeof(std::uint32_t);
  static constexpr int kGroup = 64;  ///< invocations of passes over the list
  static constexpr std::size_t kMostBoxes = std::tuple_size_v<decltype(clipmap_voxelize::Boxes::boxFirst)>;

 public:
  Reads readsFrom() const override {
    return Reads::geometry | Reads::lights | Reads::materials | Reads::environment | Reads::partOfCamera;
  }
  std::vector<float> readsOfCamera(const SceneSnapshot& snapshot) const override {
    std::vector<float> result;
    for (const glm::ivec3& first : placeClipmap(snapshot, resolution, levels, extent).first)
      result.insert(result.end(),
                    {static_cast<float>(first.x), static_cast<float>(first.y), static_cast<float>(first.z)});
    return result;
  }

  void run(PassContext& frame) override {
    const ClipmapPlacement placement = placeClipmap(frame.snapshot(), resolution, levels, extent);
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

  /// Whether the device has room for the volumes of a layout beside all that there is. What is asked for is
  /// given back at once, and not to the pool, where it would wait.
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
    const ClipmapStack stack(resolution, levels);  // Error for more than a list can number
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
      // What does not fit beside what waits in the pool may be the very thing that waits.
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

  // ---- what has changed ----------------------------------------------------------------------------------

  LitBy litBy(PassContext& frame) const {
    LitBy result;
    if (light.shadow.present())
      result.resources = {light.shadow->depth, light.shadow->lights, light.shadow->views};
    if (light.media.present() && light.shadow.present())
      for (const ScatteringGrid::Medium& medium : light.media->media) {
        result.resources.push_back(medium.density);
        for (const glm::vec3& corner : {medium.bounds.low, medium.bounds.high, medium.grid.low})
          result.numbers.insert(result.numbers.end(), {corner.x, corner.y, corner.z});
      }
    // Nearer lights may send more than a level takes.
    result.numbers.push_back(light.brightest(frame, 1.0f));
    return result;
  }

  static std::vector<MovingObject> movingObjects(PassContext& frame) {
    std::vector<MovingObject> result;
    const Scene& scene = frame.sceneDescription();
    int before = -1;
    for (const SceneDraw& draw : frame.scene().draws()) {
      if (!draw.moving || std::exchange(before, draw.object) == draw.object) continue;
      const Object& object = scene.objects[static_cast<std::size_t>(draw.object)];
      const ObjectState& there = frame.snapshot().objects[static_cast<std::size_t>(draw.object)];
      MovingObject moving{there.toWorld, !there.positions.empty(), {}};
      const auto* const positions =
          moving.deforms ? there.positions.data() : scene.positions.data() + object.firstVertex;
      for (std::uint32_t i = 0; i < object.vertexCount; ++i)
        moving.bounds.grow(glm::vec3(there.toWorld * glm::vec4(positions[i], 1.0f)));
      result.push_back(moving);
    }
    return result;
  }

  /// The voxels that have to be filled anew: everything; or what the levels reach anew, and what moving
  /// objects have left or come to.
  static std::vector<LevelRange> changed(const ClipmapState& before, const ClipmapPlacement& placement,
                                         bool all, const std::vector<MovingObject>& moving) {
    std::vector<LevelRange> result;
    for (int level = 0; level < placement.levels(); ++level) {
      const VoxelRange range = placement.rangeOf(level);
      const VoxelRange had = all ? VoxelRange{} : before.placement.rangeOf(level);
      for (const VoxelRange& slab : range.without(had)) result.push_back({level, slab});
      if (all) continue;
      for (std::size_t i = 0; i < moving.size(); ++i) {
        if (!moving[i].deforms && moving[i].toWorld == before.moving[i].toWorld) continue;
        for (const Bounds& bounds : {moving[i].bounds, before.moving[i].bounds})
          addTo(result, level, rangeOf(bounds, placement, level).within(range));
      }
    }
    return result;
  }

  /// The voxels of a level that bounds reach, and one more to each side for rounding.
  static VoxelRange rangeOf(const Bounds& bounds, const ClipmapPlacement& placement, int level) {
    if (bounds.empty) return {};
    const double size = std::ldexp(static_cast<double>(placement.voxelSize), level);
    const glm::dvec3 origin(placement.origin), most(1 << 29);
    const glm::dvec3 low = glm::floor((glm::dvec3(bounds.low) - origin) / size) - 1.0,
                     high = glm::floor((glm::dvec3(bounds.high) - origin) / size) + 2.0;
    return {glm::ivec3(glm::clamp(low, -most, most)), glm::ivec3(glm::clamp(high, -most, most))};
  }

  void update(PassContext& frame, ClipmapState& state, const ClipmapPlacement& placement) {
    LitBy lit = litBy(frame);
    std::vector<MovingObject> moving = movingObjects(frame);
    bool all = !state.filled || lit != state.litBy || moving.size() != state.moving.size();
    std::vector<LevelRange> ranges = changed(state, placement, all, moving);
    if (ranges.size() > kMostBoxes) ranges = changed(state, placement, all = true, moving);
    std::vector<RadianceClipmap::Level> before = state.clipmap.levels;
    place(frame, state.clipmap, placement);
    tellChange(state.clipmap.change, std::move(before), placement.levels(), all, ranges);
    if (all) {
      for (const gpu::TextureRef& face : state.clipmap.faces) face->clear(glm::vec4(0.0f));
      state.clipmap.occupied->clear();
    } else {
      for (const LevelRange& range : ranges)
        frame.dispatch(
            frame.program(clipmap_clear::kProgram),
            {clipmap_clear::box({range.voxels.first, range.level, range.voxels.end}), writing(state.clipmap)},
            range.voxels.size());
    }
    if (!ranges.empty()) fill(frame, state.clipmap, placement, ranges, all ? roomForAll_ : roomForParts_);
    state.placement = placement;
    state.litBy = std::move(lit);
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

  /// What the port says of the levels.
  void place(PassContext& frame, RadianceClipmap& result, const ClipmapPlacement& placement) const {
    result.origin = placement.origin;
    result.voxelSize = placement.voxelSize;
    result.around = placement.levels();
    result.levels = layoutOf(placement).levels;
    result.filledLevels = result.around;
    if (isHalf()) result.unit = brightestOf(frame, placement, 0) / kLargestHalf;
  }

  float brightestOf(PassContext& frame, const ClipmapPlacement& placement, int level) const {
    // A level cannot say anything of what lies nearer than half a voxel.
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

  void fill(PassContext& frame, const RadianceClipmap& clipmap, const ClipmapPlacement& placement,
            const std::vector<LevelRange>& ranges, std::uint64_t& room) {
    const ClipmapStack stack(placement.resolution, placement.levels());
    const shader::BindingSet stackBound = stackBinding(frame, placement, stack);
    if (room == 0) {
      // Surfaces fill about as many voxels of a level as six of its sides, twice where they lie between two
      // layers, and slabs are a small part of it.
      const auto side = static_cast<std::uint64_t>(placement.resolution);
      const std::uint64_t most = frame.device().info().maxStorageBytes / VoxelFragments::kFragmentBytes;
      room = 12 * side * side * static_cast<std::uint64_t>(placement.levels()) +
             4 * frame.sceneDescription().triangleCount();
      room = std::clamp<std::uint64_t>(&room == &roomForAll_ ? room : room / 8, 1, most);
    }
    VoxelFragments fragments;
    fragments.grid = {placement.origin, placement.voxelSize, stack.size()};
    fragments.workGroupSize = kGroup;
    fragments.capacity = room;
    fragments.coverage = isSampled() ? VoxelFragments::Coverage::sum : VoxelFragments::Coverage::mean;
    fragments.count = frame.buffer(5 * sizeof(std::uint32_t), "voxel fragment count");
    fragments.count->clear();
    fragments.fragments = frame.elements(clipmap_voxelize::fragments, room, "voxel fragments of levels");
    gpu::BufferRef sideMasks;
    if (isSampled())
      sideMasks = frame.elements(clipmap_voxelize::sideMasks, room, "samples of voxels' sides");
    voxelize(frame, fragments, sideMasks, stackBound, ranges);
    finish(frame, fragments.count, room);

    OccupiedBricks occupied;
    VoxelSums sums = claimSums(frame, fragments, stack.size(), true, occupied);
    sums.kind = inject::Variant::placesClipmap;
    sums.sideMasks = sideMasks;
    sums.places.add(stackBound);
    const gpu::BufferRef radiances = radiancesOf(frame, fragments, sums);
    light.reflect(frame, fragments, sums, 0.0f, radiances);
    addUp(frame, fragments, sums, radiances);
    frame.dispatchIndirect(
        frame.program(clipmap_resolve::Variant{.sampled = isSampled()}),
        {clipmap_resolve::parameters({.brickCount = sums.brickCount, .unit = clipmap.unit}),
         clipmap_resolve::brickList(occupied.bricks), clipmap_resolve::brickCount(occupied.count),
         sums.bindings(), writing(clipmap)},
        *occupied.count, OccupiedBricks::argumentsBytes(0));
  }

  /// All ranges at once, a draw at a time.
  void voxelize(PassContext& frame, const VoxelFragments& list, const gpu::BufferRef& sideMasks,
                const shader::BindingSet& stack, const std::vector<LevelRange>& ranges) const {
    clipmap_voxelize::Boxes boxes{};
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      boxes.boxFirst[i] = {ranges[i].voxels.first, ranges[i].level};
      boxes.boxEnd[i] = {ranges[i].voxels.end, 0};
    }
    int mostScale = 1;
    while (2 * mostScale <= supersampling) mostScale *= 2;
    const gpu::BufferRef rows = frame.buffer(
        kRowHeadBytes + kRowCapacity * clipmap_voxelize::rows.elementBytes, "rows of large triangles");
    for (const SceneDraw& draw : frame.scene().draws()) {
      const std::array<std::uint32_t, 4> noRows{0, 0, 1, 1};
      rows->uploadValues(std::span<const std::uint32_t>(noRows));
      const int triangles = static_cast<int>(draw.indexCount / 3);
      const SceneBinding scene(frame, draw);
      auto variant = scene.in(clipmap_voxelize::Variant{.sampled = isSampled()});
      const shader::BindingSet bindings{
          scene,
          stack,
          clipmap_voxelize::part({.firstIndex = static_cast<int>(draw.firstIndex),
                                  .triangleCount = triangles,
                                  .capacity = static_cast<int>(list.capacity),
                                  .rowCapacity = static_cast<int>(kRowCapacity),
                                  .mostScale = mostScale,
                                  .thickness = thickness}),
          clipmap_voxelize::boxes(boxes),
          clipmap_voxelize::count(list.count),
          clipmap_voxelize::fragments(list.fragments),
          clipmap_voxelize::sideMasks(sideMasks),
          clipmap_voxelize::rows(rows)};
      frame.dispatch(frame.program(variant), bindings, {triangles, static_cast<int>(ranges.size()), 1});
      variant.large = 1;
      frame.dispatchIndirect(frame.program(variant), bindings, *rows, sizeof(std::uint32_t));
    }
  }

  /// Where a frame wanted more than there was room for, it is rendered again with an eighth more than that.
  static void finish(PassContext& frame, const gpu::BufferRef& count, std::uint64_t& room) {
    frame.dispatch(
        frame.program(clipmap_finish::kProgram),
        {clipmap_finish::room({static_cast<std::uint32_t>(room), kGroup}), clipmap_finish::count(count)},
        {1, 1, 1});
    constexpr std::uint64_t kWantedOffset = 4 * sizeof(std::uint32_t);
    frame.judgeLater(count, kWantedOffset, [&room, had = room](PassContext&, std::uint32_t wanted) {
      if (wanted > 0x7fffffffu) throw Error(fmt::format("{} fragments do not fit into one list", wanted));
      if (wanted <= had) return true;
      room = wanted + wanted / 8;
      return false;
    });
  }
};

class ClipmapFilterPass : public Pass {
  In<RadianceClipmap> radiance{this, "radiance", "levels as voxelized"};
  Param<float> ramp{
      this, "ramp", 0.25f, within(0.0f, 1.0f),
      "share of the way from the border of the finer level to its middle over which a level goes over from what was voxelized to what the finer one makes of it; 0: with a leap"};
  Param<float> border{
      this, "border", 0.25f, within(0.0f, 1.0f),
      "share of that way over which cones go on to the next coarser level; 0: within a voxel"};
  Out<RadianceClipmap> mips{
      this, "mips", "the same, where levels have the finer one's voxels, and with those above", Levels::all};

  /// The change up to which the blocks of these volumes are made.
  struct Made {
    gpu::BufferRef of;
    std::uint64_t number = 0;
  };

  void run(PassContext& frame) override {
    RadianceClipmap result = *radiance;
    const auto half = 0.5f * static_cast<float>(result.levels.front().own.period);
    result.ramp = 0.5f * half * ramp;  // in voxels of the coarser level
    result.border = std::max(half * border, 1.0f);
    const std::shared_ptr<Made> made = frame.kept("what is made of levels", result.occupied, [&] {
      return std::make_shared<Made>(Made{result.occupied, 0});
    });
    const bool all = result.change.all || made->number + 1 != result.change.number;
    made->number = result.change.number;
    // What differs from before, as it is read, level by level.
    VoxelRange changed = result.change.voxelized.front();
    const int count = static_cast<int>(result.levels.size());
    for (int level = 1; level < count; ++level) {
      const auto i = static_cast<std::size_t>(level);
      const RadianceClipmap::Level& there = result.levels[i];
      const bool above = level >= result.around;
      const RadianceClipmap::Block& block = above ? there.own : there.inner;
      const VoxelRange addresses{block.voxels.first, block.voxels.first + block.period};
      const std::size_t moving = std::min(i, static_cast<std::size_t>(result.around)) - 1;
      // Where the finer level has moved its border has, and with it the ramp.
      const bool anew = all || movedBy(result, moving) > 0;
      VoxelRange touched = coarserTouching(changed);
      if (!above) touched = touched.around(result.change.voxelized[i]);
      const VoxelRange part = (anew ? addresses : touched).within(addresses);
      changed = touched;
      if (anew) changed = changed.around(block.voxels);
      if (anew && !all && !above) changed = changed.around(result.change.before[i].inner.voxels);
      if (part.empty()) continue;
      // Behind the ramp only what the finer voxels have changed differs.
      float settled = RadianceClipmap::kEndless;
      if (!all && !above && sameSides(result, moving))
        settled = result.ramp + 2.0f + static_cast<float>(movedBy(result, moving));
      frame.dispatch(
          frame.program(clipmap_filter::Variant{.above = above}),
          {clipmap_filter::level({part.first, level, part.end, settled, touched.first, 0, touched.end}),
           facesOf(result.faces, gpu::Sampling::nearest), writing(result)},
          part.size());
    }
    result.filledLevels = count;
    mips = result;
  }

  /// Voxels by which a level has moved, along the axis along which it is the most.
  static int movedBy(const RadianceClipmap& clipmap, std::size_t level) {
    if (clipmap.change.before.empty()) return 0;
    const glm::ivec3 way =
        glm::abs(clipmap.levels[level].own.voxels.first - clipmap.change.before[level].own.voxels.first);
    return std::max({way.x, way.y, way.z});
  }
  /// Whether the store ends at the same sides of a level as before.
  static bool sameSides(const RadianceClipmap& clipmap, std::size_t level) {
    const RadianceClipmap::Level &a = clipmap.levels[level], &b = clipmap.change.before[level];
    const auto ends = [](const glm::vec3& reach) {
      return glm::greaterThan(glm::abs(reach), glm::vec3(0.5f * RadianceClipmap::kEndless));
    };
    return ends(a.reachFirst) == ends(b.reachFirst) && ends(a.reachEnd) == ends(b.reachEnd);
  }
};

}  // namespace

void addClipmap(TechniqueRegistry& registry) {
  registry.add<ClipmapPass>("clipmap",
                            "Levels of voxels around the camera, lit (3D clipmap: thesis Sec. 3.5)");
  registry.add<ClipmapFilterPass>("clipmap_filter",
                                  "Levels of a clipmap from their finer ones (thesis Sec. 3.5)");
}

}  // namespace lumivox::voxel_cone_tracing
