// Injects direct light: Crassin et al. 2011, Sec. 6; thesis Gomes 2015, Sec. 4.2.1. Stores the mean radiance
// that the fragments of each occupied voxel reflect, equal for all sides or by the six faces, independent of
// their order.
#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "../cones/bounces.h"
#include "../cones/march.h"
#include "../direct_light.h"
#include "../octree/octree.h"
#include "../voxel_sums.h"
#include "levels.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/change_tracking.h"
#include "lumivox/toolkit/media.h"
#include "lumivox/toolkit/volume_room.h"

namespace lumivox::voxel_cone_tracing {
namespace {

using namespace shaders::voxel_cone_tracing;

/// Injection into grids; members of a pass.
class Injection {
 public:
  /// Geometry gives the bounds of what moves.
  static constexpr Reads kReads = Reads::geometry | Reads::lights | Reads::materials | Reads::environment;

  explicit Injection(Pass* pass)
      : fragments_(pass, "fragments", "surface samples"),
        light_(pass),
        storeMedia_(
            pass, "store_media", false,
            "voxels store media beside surfaces and scatter light isotropically, so that one set of cones sees both, and 'gather' needs no 'media' (thesis Sec. 4.5)"),
        precision_(pass, "precision", Precision::float_,
                   "numbers in the grid; float: 16 bytes a voxel; half: 8") {}
  const DirectLight& light() const { return light_; }

  /// Makes so many grids whose finest level is that of the fragments, evenly halved. Where they do not fit,
  /// none is made, and the Error says what would fit.
  std::vector<gpu::TextureRef> rooms(PassContext& frame, int count, const char* label,
                                     bool coarserLevels) const {
    return roomFor(frame, placement().resolution, count, format(), label, coarserLevels,
                   count == 1 ? "a grid" : "six directional grids");
  }

  /// A grid that is changed in place, and its sources.
  struct KeptGrid {
    std::vector<gpu::TextureRef> textures;
    ChangedBricks changed{std::make_shared<ChangedBricks::Levels>(), 0, {}};
    // Of the frame before.
    gpu::BufferRef bricks;  ///< occupied voxels
    LitMoment moment;
  };

  /// Kept while static geometry and the lights on it stay the same; null where that is unknown.
  template <class MakeRooms>
  std::shared_ptr<KeptGrid> keptGrid(PassContext& frame, bool furtherBounces, MakeRooms&& makeRooms) {
    // Every bounce changes all of the light.
    const std::optional<StaticLight> key = furtherBounces ? std::nullopt : staticLight(frame);
    if (!key) return nullptr;
    return frame.kept("voxels of static geometry in unchanged light", *key, [&] {
      auto result = std::make_shared<KeptGrid>();
      result->textures = makeRooms();
      return result;
    });
  }

  /// Fills the finest levels, one texture for all sides or six for the faces, and their properties in the
  /// port. `kept`: that of the same textures, or null. `before`: the light of the frame before, or null.
  template <class Grid>
  void fill(PassContext& frame, Grid& result, std::span<const gpu::TextureRef> textures, Bounces& bounces,
            const Grid* before, KeptGrid* kept, const FaceRule& faces = {}) {
    result.grid = placement();
    result.holdsMedia = storesMedia();
    // Every bounce adds less than the one before.
    const float brightest = brightestOf(frame, result.unit, bounces.most(before != nullptr));

    const bool onlyChanges = kept != nullptr && kept->bricks != nullptr;
    ChangedCells changed;
    if (onlyChanges) changed = changes_.since(frame, *fragments_, light_.shadow, kept->moment);
    const auto claim = [&] {
      LitVoxels voxels;
      voxels.sums =
          onlyChanges
              ? claimChanged(frame, *fragments_, result.grid.resolution, textures.size() > 1, changed,
                             kept->bricks, voxels.occupied, kept->changed.bricks)
              : claimSums(frame, *fragments_, result.grid.resolution, textures.size() > 1, voxels.occupied);
      voxels.sums.faces = faces;
      return voxels;
    };
    const LitVoxels lit = litVoxels(frame, brightest, before != nullptr, nullptr, claim);
    // Media lie beside the surfaces' bricks.
    if (!result.holdsMedia) result.occupied = lit.occupied;
    const auto resolveWith = [&](const gpu::BufferRef& reflected, const OccupiedBricks& bricks) {
      resolve(frame, lit.sums, reflected, brightest, result.unit, result.holdsMedia, bricks, textures);
    };
    const ReflectingVoxels voxels{*fragments_, lit.sums, &lit.occupied};
    const OccupiedBricks& bricks = onlyChanges ? kept->changed.bricks : lit.occupied;
    // All light of the frame before is reflected once: then there are the direct light and every bounce of
    // it.
    resolveWith(before == nullptr ? nullptr
                                  : bounces.ofStoreBefore(frame, voxels, storeWithLayers(*before), brightest),
                bricks);
    for (int bounce = 1; bounce < bounces.count(); ++bounce) {
      if constexpr (std::is_same_v<Grid, RadianceGrid>) {
        fillLevels(frame, result, Opacity::facing);
      } else {
        fillLevels(frame, result);
      }
      resolveWith(bounces.ofStore(frame, voxels, storeWithLayers(result), brightest), bricks);
    }
    result.filledLevels = 1;
    if constexpr (std::is_same_v<Grid, RadianceGrid>) result.bounces = bounces.most(before != nullptr);
    if (kept == nullptr) return;
    if (!onlyChanges) kept->moment = changes_.momentOfAll(frame, *fragments_);
    kept->bricks = lit.sums.bricks;
    ++kept->changed.number;
    result.changed = kept->changed;
  }

  /// Makes the bricks of result.tree, and fills those of the leaves.
  void fill(PassContext& frame, RadianceOctree& result, Bounces& bounces, const RadianceOctree* before) {
    if (storesMedia())
      throw Error(
          "voxel_cone_tracing: 'store_media' fills voxels in which no surface lies, and an octree has none there; expected 'store_media off' or a dense grid");
    const bool reflects = bounces.count() > 1 || before != nullptr;
    const float brightest = brightestOf(frame, result.unit, bounces.most(before != nullptr));
    // Every bounce changes all of the light.
    if (!reflects) result.still = stillIn(frame, result);
    makePool(frame, result, format(), bytesOfSums(result.faces > 1, reflects));
    const LitVoxels lit = litVoxels(frame, brightest, before != nullptr, result.tree.ranks, [&] {
      return LitVoxels{leafSums(frame, result), {}};
    });
    const ReflectingVoxels voxels{.fragments = *fragments_, .sums = lit.sums, .tree = &result.tree};
    resolveLeaves(frame, result, lit.sums, addsUp(),
                  before == nullptr
                      ? nullptr
                      : bounces.ofStoreBefore(frame, voxels, storeWithLayers(*before), brightest));
    for (int bounce = 1; bounce < bounces.count(); ++bounce) {
      fillLevels(frame, result);
      resolveLeaves(frame, result, lit.sums, addsUp(),
                    bounces.ofStore(frame, voxels, storeWithLayers(result), brightest));
    }
    result.filledLevels = 1;
  }

  bool isHalf() const { return precision_ == Precision::half; }
  gpu::Format format() const { return isHalf() ? gpu::Format::rgba16f : gpu::Format::rgba32f; }

 private:
  enum class Precision { float_, half };

  In<VoxelFragments> fragments_;
  DirectLight light_;
  Param<bool> storeMedia_;
  Param<Precision> precision_;

  ChangeTracking changes_;

  /// Empty where more than moving shadows changes the light on static geometry.
  std::optional<StaticLight> staticLight(PassContext& frame) {
    float unit = 1.0f;
    if (light_.media.present()) return std::nullopt;
    return changes_.staticLight(frame, *fragments_, light_.shadow, brightestOf(frame, unit));
  }

  /// Static geometry in the light of one time.
  struct StillOctree {
    std::shared_ptr<const RadianceOctree> octree;
    LitMoment moment;
  };
  std::optional<StaticLight> before_;  ///< that of the frame before: only unchanged light is worth keeping

  /// Lit static geometry, and in `octree` the changes since then; null where these are unknown, or where it
  /// or the lights have moved in this frame.
  std::shared_ptr<const RadianceOctree> stillIn(PassContext& frame, RadianceOctree& octree) {
    const std::optional<StaticLight> key = octree.tree.still ? staticLight(frame) : std::nullopt;
    if (std::exchange(before_, key) != key || !key) return nullptr;
    const StillOctree& still = frame.kept("light of static geometry", *key, [&] {
      RadianceOctree lit;
      lit.tree = *octree.tree.still;
      lit.faces = octree.faces;
      const float brightest = brightestOf(frame, lit.unit);
      makePool(frame, lit, format(), bytesOfSums(lit.faces > 1, false));
      const VoxelSums sums = leafSums(frame, lit);
      average(frame, staticOf(*fragments_), sums, brightest);
      resolveLeaves(frame, lit, sums, addsUp());
      return StillOctree{std::make_shared<const RadianceOctree>(lit),
                         changes_.momentOfStatic(frame, *fragments_)};
    });
    LitMoment moment = still.moment;
    octree.changed = changes_.since(frame, *fragments_, light_.shadow, moment);
    return still.octree;
  }

  static const shader::StorageSlot& sumsSlot(bool directional) {
    return directional ? add::directionalSums : add::sums;
  }
  /// Bytes that fill a voxel: its sums and, where it reflects light of the frame before, those of that light.
  static std::uint64_t bytesOfSums(bool directional, bool reflects) {
    const std::uint64_t sums = sumsSlot(directional).elementBytes;
    return reflects ? 2 * (sums + Bounces::bytesOfVoxel(directional)) : sums;
  }
  static VoxelSums leafSums(PassContext& frame, const RadianceOctree& result) {
    VoxelSums sums;
    sums.kind = inject::Variant::placesOctree;
    sums.directional = result.faces > 1;
    sums.voxels = frame.emptyElements(sumsSlot(sums.directional), 8 * result.tree.leafRoom, "sums of voxels");
    sums.places = OctreeBinding(result.tree, result.poolShift);
    if (result.still == nullptr) return sums;
    sums.changed = &result.changed;
    sums.places.add(stillBinding(result));
    return sums;
  }

  GridPlacement placement() const {
    GridPlacement grid = fragments_->grid;
    grid.resolution = evenlyHalved(grid.resolution);
    return grid;
  }
  bool storesMedia() const { return storeMedia_ && light_.media.present(); }
  /// The most that a voxel can reflect, and the unit of half floats.
  float brightestOf(PassContext& frame, float& unit, int bounces = 1) const {
    // A grid does not resolve anything nearer than half a voxel.
    const float brightest =
        brightestAfter(frame, light_.brightest(frame, 0.5f * fragments_->grid.voxelSize), bounces);
    if (isHalf()) unit = brightest / kLargestHalf;
    return brightest;
  }
  bool addsUp() const { return fragments_->coverage == VoxelFragments::Coverage::sum; }

  /// Fills the sums of occupied voxels.
  void average(PassContext& frame, const VoxelFragments& list, const VoxelSums& sums, float brightest) {
    const gpu::BufferRef radiances = radiancesOf(frame, list, sums);
    light_.reflect(frame, list, sums, brightest, radiances);
    addUp(frame, list, sums, radiances);
  }

  /// Voxels with the sums of the direct light that they reflect; of a grid also which they are.
  struct LitVoxels {
    VoxelSums sums;
    OccupiedBricks occupied;
  };
  struct LitKey {
    gpu::BufferRef fragments, count, reflected, places, lights;
    gpu::TextureRef depth;
    float brightest;
    bool operator==(const LitKey&) const = default;
  };
  /// Adds up the direct light in the places that claim() makes. `stays`: kept while the fragments, their
  /// places and the lights' views are the same. A list with moving fragments stays the same buffer while they
  /// move.
  template <class Claim>
  LitVoxels litVoxels(PassContext& frame, float brightest, bool stays, const gpu::BufferRef& places,
                      Claim&& claim) {
    const auto lit = [&] {
      LitVoxels result = claim();
      average(frame, *fragments_, result.sums, brightest);
      return result;
    };
    if (!stays || fragments_->still != nullptr || light_.media.present()) return lit();
    const ShadowMap shadow = light_.shadow.present() ? *light_.shadow : ShadowMap{};
    const LitKey key{fragments_->fragments, fragments_->count, fragments_->reflected, places, shadow.lights,
                     shadow.depth,          brightest};
    return frame.kept("direct light of voxels", key, lit);
  }

  static StoreBinding storeWithLayers(const RadianceGrid& store) { return storeOf(store); }
  template <class Store>
  static StoreBinding storeWithLayers(const Store& store) {
    return storeOf(store, true);
  }

  /// Resolves the sums, and what the voxels reflect beside it unless that is null, into the finest levels: of
  /// these bricks only, or of all voxels where media lie in them.
  void resolve(PassContext& frame, const VoxelSums& sums, const gpu::BufferRef& reflected, float mostRadiance,
               float unit, bool holdsMedia, const OccupiedBricks& bricks,
               std::span<const gpu::TextureRef> textures) {
    const LightBinding lights(light_.shadow);
    const MediaBinding bound(frame, light_.media, holdsMedia);
    const auto& program = frame.program(resolve::Variant{.directions = sums.directional,
                                                         .lights = holdsMedia && light_.shadow.present(),
                                                         .medium = bound.axis,
                                                         .changed = sums.changed != nullptr,
                                                         .reflected = reflected != nullptr});
    const GridPlacement grid = placement();
    shader::BindingSet bindings{resolve::parameters({.brickCount = sums.brickCount,
                                                     .unit = unit,
                                                     .resolution = grid.resolution,
                                                     .coverageSum = addsUp(),
                                                     .gridLow = grid.low,
                                                     .voxelSize = grid.voxelSize,
                                                     .lightCount = lights.count,
                                                     .mediumSteps = light_.mediumSteps,
                                                     .mostRadiance = mostRadiance}),
                                resolve::brickList(bricks.bricks),
                                resolve::brickCount(bricks.count),
                                resolve::reflected(reflected),
                                sums.bindings(),
                                lights,
                                bound};
    if (sums.directional) {
      bindings.add(
          shader::BindingSet{resolve::positiveXImage(textures[0]), resolve::negativeXImage(textures[1]),
                             resolve::positiveYImage(textures[2]), resolve::negativeYImage(textures[3]),
                             resolve::positiveZImage(textures[4]), resolve::negativeZImage(textures[5])});
    } else {
      bindings.add(resolve::radianceImage(textures[0]));
    }
    if (holdsMedia) {
      frame.dispatch(program, bindings, grid.resolution);
      return;
    }
    if (sums.changed == nullptr)
      for (const gpu::TextureRef& texture : textures) texture->clear(glm::vec4(0.0f), 0);
    frame.dispatchIndirect(program, bindings, *bricks.count, OccupiedBricks::argumentsBytes(0));
  }
};

class InjectPass : public Pass {
  Injection injection{this};
  Bounces bounces{this, injection.light()};
  LightBefore<RadianceGrid> before{this};
  Param<bool> mips{
      this, "mips", true,
      "allocate the coarser levels that 'filter' fills; 'filter_directional' does not need them"};
  Out<RadianceGrid> radiance{this, "radiance", "reflected radiance and opacity; the finest level only",
                             Levels::finest};

  Reads readsFrom() const override { return Injection::kReads; }
  int indirectBounces() const override { return bounces.count(); }
  std::string checkParameters() const override { return bounces.check(); }

  void run(PassContext& frame) override {
    if (bounces.count() > 1 && !mips)
      throw Error(
          "voxel_cone_tracing.inject: further bounces are gathered through coarser levels, for which there is no room; expected 'mips on' or 'bounces 1'");
    const auto rooms = [&] { return injection.rooms(frame, 1, "radiance grid", mips); };
    const auto kept = injection.keptGrid(frame, bounces.most(before.get() != nullptr) > 1, rooms);
    RadianceGrid result;
    result.radiance = (kept != nullptr ? kept->textures : rooms()).front();
    injection.fill(frame, result, {&result.radiance, 1}, bounces, before.get(), kept.get());
    radiance = result;
  }
};

class InjectDirectionalPass : public Pass {
  enum class OpaqueAlong { facing, all };

  Injection injection{this};
  Bounces bounces{this, injection.light()};
  LightBefore<DirectionalRadianceGrid> before{this};
  Param<float> backWeight{
      this, "back_weight", FaceRule{}.backWeight, within(0.0f, 1.0f),
      "weight of a fragment's back in the mean of a face, where fronts have the weight 1; small, so that the dark inside of a thin wall does not darken its lit face; 0: the backs of sheets are dark"};
  Param<OpaqueAlong> opaqueAlong{
      this, "opaque_along", OpaqueAlong::facing,
      "axes along which a fragment makes its voxel opaque; facing: each as far as the fragment faces it; all: all axes, as in one grid"};
  Out<DirectionalRadianceGrid> radiance{
      this, "radiance", "radiance that the faces of voxels reflect, and opacity; the finest level only",
      Levels::finest};

  Reads readsFrom() const override { return Injection::kReads; }
  int indirectBounces() const override { return bounces.count(); }
  std::string checkParameters() const override { return bounces.check(); }

  void run(PassContext& frame) override {
    const auto rooms = [&] { return injection.rooms(frame, 6, "radiance grid of one side", true); };
    const auto kept = injection.keptGrid(frame, bounces.most(before.get() != nullptr) > 1, rooms);
    DirectionalRadianceGrid result;
    std::ranges::copy(kept != nullptr ? kept->textures : rooms(), result.faces.begin());
    injection.fill(frame, result, result.faces, bounces, before.get(), kept.get(),
                   {backWeight, opaqueAlong == OpaqueAlong::all});
    radiance = result;
  }
};

class OctreeInjectPass : public Pass {
  Injection injection{this};
  Bounces bounces{this, injection.light()};
  LightBefore<RadianceOctree> before{this};
  enum class Faces { one, six };
  In<VoxelOctree> tree{this, "tree", "the nodes that the fragments make"};
  Param<Faces> faces{
      this, "faces", Faces::one,
      "values of a voxel; one: the same to all sides; six: at all levels a value for each face, with its own light and opacity, as of inject_directional (Crassin et al. 2011, Sec. 8.1; thesis Sec. 3.1.3)"};
  Out<RadianceOctree> radiance{this, "radiance", "reflected radiance and opacity; the finest level only",
                               Levels::finest};

  Reads readsFrom() const override { return Injection::kReads; }
  int indirectBounces() const override { return bounces.count(); }
  std::string checkParameters() const override { return bounces.check(); }

  void run(PassContext& frame) override {
    RadianceOctree result;
    result.tree = *tree;
    result.faces = faces == Faces::six ? 6 : 1;
    injection.fill(frame, result, bounces, before.get());
    radiance = result;
  }
};

}  // namespace

void addInject(TechniqueRegistry& registry) {
  registry.add<InjectPass>("inject", "Direct light into the finest level (Crassin et al. 2011, Sec. 6)");
  registry.add<InjectDirectionalPass>(
      "inject_directional",
      "Direct light into the finest level of six directional grids (thesis Gomes 2015, Sec. 4.2.1, Table 1)");
  registry.add<OctreeInjectPass>(
      "octree_inject", "Direct light into the leaves of a sparse voxel octree (Crassin et al. 2011, Sec. 6)");
}

}  // namespace lumivox::voxel_cone_tracing
