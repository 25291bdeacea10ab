// Sends rays from the middle of every voxel through the volume. They gather light from all sides (Mavridis &
// Papaioannou 2011, Sec. 3.3) over several bounces, or openness (Sec. 3.5).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/toolkit/bit_grid.h"
#include "lumivox/toolkit/counts.h"
#include "lumivox/toolkit/environment.h"
#include "lumivox/toolkit/loop_limit.h"
#include "lumivox/toolkit/ray_stop.h"
#include "lumivox/toolkit/volume_room.h"
#include "volume.h"

namespace lumivox::imperfect_volumes {

using namespace shaders::imperfect_volumes;

namespace {

constexpr int kTogether = 8;  // invocations that share the rays of a voxel, as in march.comp
// A little more than sqrt(3) / 2, the distance of a voxel's corners, so that rounding leads no ray back into
// its voxel.
constexpr float kPublishedGuard = 0.8660255f;

/// Common parts of `march` and `occlude`.
class Marching : public Pass {
 protected:
  enum class Reading { nearest, linear };
  enum class Walk { steps, exact };
  enum class Exit { early, branchless };
  enum class Directions { voxel, shared };
  enum class Cover { read, all };

  In<OccupancyGrid> opacity{this, "opacity", "coverage of each voxel: which are occupied"};
  In<BinaryGrid> bits{this, "bits", Presence::optional,
                      "with 'walk exact': which voxels are occupied, one bit each"};
  In<GBuffer> gbuffer{
      this, "gbuffer", Presence::optional,
      "visible surfaces: rays begin only in the voxels that they read; without them in all voxels"};
  Param<int> rays{this, "rays", 100, within(2, 1 << 20),
                  "rays from each voxel over the sphere, in opposite pairs: an odd number is rounded up"};
  Param<float> step{this, "step", 1.0f, within(0.01f, 64.0f), "step of the ray march, in voxels"};
  Param<float> guard{
      this, "guard", kPublishedGuard, within(0.0f, 2048.0f),
      "length at the start of a ray that hits nothing, in voxels; as published: from a voxel's centre to its corner"};
  Param<Reading> reading{
      this, "reading", Reading::nearest,
      "look-up at a step; nearest: the voxel there; linear: trilinear between the eight voxels around, occupied from one half on"};
  Param<Walk> walk{this, "walk", Walk::steps,
                   "steps: one look-up at each step; exact: every voxel along the ray, by 'bits'"};
  Param<Exit> exit{
      this, "exit", Exit::early,
      "where a ray stops; early: at its first hit; branchless: at the end of the volume, and what lies behind the hit is discarded (Sec. 4.1). Both give the same bits",
      published(Exit::branchless)};
  Param<Directions> directions{
      this, "directions", Directions::voxel,
      "directions of the rays; voxel: other ones for each voxel, which gives noise; shared: the same for all, which gives bands"};
  Param<float> occupied{
      this, "occupied", 0.0f, within(0.0f, 1.0f),
      "coverage above which a voxel is occupied; must be 0 with 'walk exact', since bits hold no coverage"};
  Param<Cover> cover{
      this, "cover", Cover::read,
      "voxels in which rays begin; read: with 'gbuffer', those that 'gather' reads; all: every voxel, for readers of the volume itself"};
  Neighbours neighbours{this};

  bool uses(const InBase& input) const override {
    return (&input != &bits || walk == Walk::exact) && (&input != &gbuffer || cover == Cover::read) &&
           (&input != &opacity || readsOpacity());
  }
  virtual bool readsOpacity() const { return walk == Walk::steps; }
  const GridPlacement& grid() const { return walk == Walk::exact ? bits->grid : opacity->grid; }

  void checkGrids() const {
    if (walk == Walk::exact && !bits.present())
      throw Error("'walk exact' goes through 'bits'; expected it to be connected");
    if (walk == Walk::exact && occupied > 0.0f)
      throw Error(fmt::format(
          "'walk exact' meets every voxel that has a bit, and 'occupied' is {:g}; expected 0, or 'walk steps'",
          float(occupied)));
    if (walk == Walk::exact && opacity.present())
      requireSameGrid("bits", bits->grid, "opacity", opacity->grid);
    const glm::vec3 size(grid().resolution);
    if (guard >= glm::length(size))
      throw Error(fmt::format(
          "'guard' is {:g} voxels, and no ray through {} x {} x {} voxels is longer than "
          "{:g}; expected less",
          float(guard), grid().resolution.x, grid().resolution.y, grid().resolution.z, glm::length(size)));
    if (grid().voxelCount() > std::uint64_t{1} << 29)
      throw Error(fmt::format(
          "rays from {} x {} x {} voxels take {} of coefficients for each colour; expected at most 2^29 voxels",
          grid().resolution.x, grid().resolution.y, grid().resolution.z,
          formatBytes(16 * grid().voxelCount())));
  }

  /// Voxels in which rays begin; null members: all.
  struct Begins {
    gpu::BufferRef count, voxels;
    std::string readFor;  ///< ShGrid::readFor
  };
  bool beginsWhereRead() const { return cover == Cover::read && gbuffer.present(); }
  virtual void markMore(PassContext&, const shader::BindingSet& /*marks*/) {}
  gpu::TextureRef emptyMarks(PassContext& frame) const {
    return frame.emptyVolume(grid().resolution, gpu::Format::r32ui, "voxels that are read");
  }
  shader::BindingSet marking(const gpu::TextureRef& marks) const {
    return {volumeBinding(grid(), occupied), neighbours.binding(), mark_surfaces::marks(marks)};
  }
  /// Marks what pixels read, over other marks.
  void markSeen(PassContext& frame, const shader::BindingSet& marks) {
    frame.dispatch(frame.program(mark_surfaces::Variant{}, neighbours.in(mark_surfaces::Constants{})),
                   {marks, GBufferBinding(*gbuffer)}, pixels(frame));
  }
  /// Lists voxels by a program over all of them, which counts in `listCount` and writes `list`.
  Begins listed(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bound) {
    Begins result{countBuffer(frame, "count of voxels that are read"),
                  frame.elements(list_marked::list, grid().voxelCount(), "list of voxels that are read"),
                  neighbours.inWords()};
    frame.dispatch(program,
                   {bound, volumeBinding(grid(), occupied), list_marked::listCount(result.count),
                    list_marked::list(result.voxels)},
                   grid().resolution);
    finishCount(frame, result.count, grid().voxelCount(), kCountedGroupSize / kTogether);
    return result;
  }
  Begins begins(PassContext& frame) {
    if (!beginsWhereRead() || frame.keepsEverything()) return {};
    const gpu::TextureRef marks = emptyMarks(frame);
    markSeen(frame, marking(marks));
    markMore(frame, marking(marks));
    return listed(frame, frame.program(list_marked::kProgram), {list_marked::marks(marks)});
  }

  march::Constants constants() const {
    return {.branchless = exit == Exit::branchless,
            .linear = reading == Reading::linear,
            .harmonics = 0,
            .sharedSet = directions == Directions::shared};
  }
  march::Variant variant(const Begins& from, int of) const {
    return {.of = of,
            .walk = walk == Walk::exact ? march::Variant::walkExact : march::Variant::walkSteps,
            .listed = from.voxels != nullptr,
            .planes = false,
            .bitRule = march::Variant::bitRuleHierarchy};
  }

  /// Sends all rays of all voxels, in enough dispatches to keep loops within what drivers run. `moreTurns`:
  /// bound for what a ray's loops turn beyond those of 'walk'.
  void sendRays(PassContext& frame, const shader::BoundProgram& program, const shader::BindingSet& bound,
                march::Rays parameters, const Begins& from, std::int64_t moreTurns = 0) const {
    const int pairs = (rays + 1) / 2, rounds = (pairs + kTogether - 1) / kTogether;
    // Light travels from one end of the volume to the other; openness has a reach.
    const float way = std::min(parameters.reach, glm::length(glm::vec3(grid().resolution)));
    parameters.seed = seedWords(frame);
    parameters.guard = guard;
    parameters.step = step;
    parameters.pairs = pairs;
    parameters.mostSteps = static_cast<int>(std::max(std::ceil((way - guard) / step), 0.0f)) + 2;
    const std::int64_t ofRay = walk == Walk::exact
                                   ? hierarchyTurns(*bits)
                                   : parameters.mostSteps * (reading == Reading::linear ? 9 : 1);
    shader::BindingSet all{bound, volumeBinding(grid(), occupied)};
    if (walk == Walk::exact) all.add(shader::SampledSlot{"bitStacks"}(bits->stacks, gpu::Sampling::nearest));
    if (opacity.present()) all.add(march::opacity(opacity->opacity, gpu::Sampling::nearest));
    if (from.voxels) all.add(shader::BindingSet{march::listCount(from.count), march::list(from.voxels)});
    forEachPortion(rounds, 2 * (ofRay + moreTurns + 1), [&](int first, int count) {
      parameters.firstPair = first * kTogether;
      parameters.pairsAtOnce = count * kTogether;
      const shader::BindingSet dispatched{all, march::rays(parameters)};
      if (from.voxels)
        frame.dispatchIndirect(program, dispatched, *from.count, kGroupsOffset);
      else
        frame.dispatchList(program, dispatched, grid().voxelCount() * kTogether);
    });
  }

  /// Light comes from all of the volume, so the reach has no end.
  static constexpr float kNoEnd = std::numeric_limits<float>::infinity();
};

class MarchPass : public Marching {
  enum class Source { surface, harmonics };
  enum class Feed { front, own, printed };

  In<ShGrid> reflected{this, "reflected", "radiance that the voxels send, of 'inject'"};
  In<AttributeGrid> attributes{
      this, "attributes", Presence::optional,
      "mean normals and albedos of the voxels; needed unless 'source harmonics' and one bounce"};
  In<ShGrid> before{
      this, "before", Presence::history,
      "light of the frame before, 'carried' of this pass: surfaces reflect what arrived then beside direct light, so that frames in a row come to all bounces; 'bounces' counts those of the first frame"};
  Param<Source> source{
      this, "source", Source::surface,
      "radiance of a hit; surface: of the side that the ray sees, exact for a Lambert wall; harmonics: of two bands, 1/2 + 3/4 cos in place of 1",
      published(Source::harmonics)};
  Param<int> bounces{this, "bounces", 1, within(1, 1024), "number of reflections of the light"};
  Param<int> turns{
      this, "turns", 0, within(0, 64),
      "with 'before' and 'gbuffer': frames in which a voxel that surfaces read, and no pixel, sends rays once, and keeps its light in the others; it sends them at once where it held nothing, and in each of the first frames, as many. Surfaces then reflect the light of the free voxel in front of each side. 0: rays begin in every frame, and surfaces read light as pixels do, with 'cover all' also where it was left out before"};
  Param<Feed> feed{
      this, "feed", Feed::front,
      "light that a voxel reflects at the next bounce; front: light that arrives in front of both its sides, as at a surface through its centre; own: light of its own coefficients; printed: two buffers alternate (Sec. 3.3): a voxel sends what arrives in it, by 'source harmonics' and whatever its albedo, and only the last buffer is read",
      published(Feed::printed)};
  Out<ShGrid> incoming{this, "incoming", Contributes::nothing, Needs::anyLight,
                       "radiance that arrives in each voxel from all sides, of all bounces"};
  Out<ShGrid> carried{this, "carried", Contributes::nothing, Needs::anyLight,
                      "the same, in the voxels that surfaces read too: 'before' of the next frame"};

  Reads readsFrom() const override {
    return turns > 0 ? Reads::environment | Reads::history : Reads::environment;
  }
  int indirectBounces() const override { return bounces; }
  bool uses(const InBase& input) const override {
    return Marching::uses(input) && (&input != &attributes || readsAttributes()) &&
           (&input != &before || feed != Feed::printed);
  }
  bool sendsBands() const { return source == Source::harmonics || feed == Feed::printed; }
  /// Whether surfaces read the light that arrives, for bounces of this frame or of the next one.
  bool surfacesRead() const { return bounces > 1 || carried.wanted(); }
  bool readsAttributes() const { return !sendsBands() || surfacesRead(); }
  bool readsOpacity() const override { return Marching::readsOpacity() || surfacesRead(); }

  void markMore(PassContext& frame, const shader::BindingSet& marks) override {
    if (!surfacesRead()) return;
    frame.dispatch(frame.program(mark_voxels::Variant{},
                                 neighbours.in(mark_voxels::Constants{.feedsOwn = feed != Feed::front})),
                   {marks, mark_voxels::opacity(opacity->opacity, gpu::Sampling::nearest),
                    mark_voxels::meanNormals(attributes->normal, gpu::Sampling::nearest)},
                   grid().resolution);
  }

  void run(PassContext& frame) override {
    checkGrids();
    const auto [sent, sentUnit] = volumeOf(reflected);  // rays may meet any voxel
    requireSameGrid("reflected", sent.grid, walk == Walk::exact ? "bits" : "opacity", grid());
    if (readsAttributes() && !attributes.present())
      throw Error("'source surface' and further bounces read 'attributes'; expected it to be connected");
    if (readsAttributes()) requireSameGrid("attributes", attributes->grid, "reflected", sent.grid);
    const bool inTurns = takesTurns();
    const Turns turn = inTurns ? takeTurns(frame) : Turns{begins(frame), emptyVolumes(frame, kArriving)};
    const Begins& from = turn.from;
    ShGrid result;
    result.quantity = ShGrid::Quantity::radiance;
    result.readFor = from.readFor;
    const ShGrid::Level* const earlier = lightBefore(from.readFor);
    if (earlier != nullptr && (!inTurns || turn.before)) {
      // Rays in steps read no voxels but those that reflectFronts() fills.
      const char* const label = "direct light and light of the frame before, reflected";
      const auto both = inTurns && walk == Walk::steps ? coefficientVolumes(frame, grid().resolution, label)
                                                       : emptyVolumes(frame, label);
      if (inTurns)
        reflectFronts(frame, *earlier, turn.before, turn.surfaces, both, &sent, sentUnit);
      else
        reflectAgain(frame, *earlier, both, &sent, sentUnit);
      gather(frame, {grid(), both}, 1.0f, from, 0, turn.light);
      result.levels.push_back({grid(), turn.light});
      deliver(result);
      return;
    }
    gather(frame, sent, sentUnit, from, 0, turn.light);
    result.levels.push_back({grid(), turn.light});
    const auto& sum = result.levels.front().coefficients;
    if (feed == Feed::printed) {
      for (int bounce = 1; bounce < bounces; ++bounce)
        result.levels.front().coefficients = arriving(frame, result.levels.front(), 1.0f, from, bounce);
      deliver(result);
      return;
    }
    ShGrid::Level latest = result.levels.front();
    std::array<gpu::TextureRef, 3> passedOn;
    for (int bounce = 1; bounce < bounces; ++bounce) {
      if (!passedOn[0]) passedOn = emptyVolumes(frame, "radiance that is reflected again");
      if (inTurns)
        reflectFronts(frame, latest, turn.now, turn.surfaces, passedOn);
      else
        reflectAgain(frame, latest, passedOn);
      latest.coefficients = arriving(frame, {grid(), passedOn}, 1.0f, from, bounce);
      for (std::size_t i = 0; i < 3; ++i)
        frame.dispatch(frame.program(add::kProgram),
                       {add::bounceImage(latest.coefficients[i]), add::sumImage(sum[i])}, grid().resolution);
    }
    deliver(result);
  }

  void deliver(const ShGrid& result) {
    incoming = result;
    ShGrid further = result;
    if (!result.readFor.empty()) further.readFor = readForSurfaces(result.readFor);
    carried = further;
  }

  /// Rays begin in the voxels of visible surfaces, and with 'carried' in those of all surfaces.
  std::string readForSurfaces(const std::string& readFor) const {
    return readFor + (takesTurns() ? " and in front of all surfaces" : " on all surfaces");
  }

  /// After a frame with n reflections one gathering gives n + 1: what arrived then is reflected with the
  /// direct light, and no bounce counts twice. Null where there is no such light in this grid.
  const ShGrid::Level* lightBefore(const std::string& readFor) const {
    if (!before.present() || feed == Feed::printed) return nullptr;
    const auto [level, unit] = volumeOf(before, readFor.empty() ? std::string() : readForSurfaces(readFor));
    return level.grid == grid() ? &before->levels.front() : nullptr;
  }

  bool takesTurns() const {
    return turns > 0 && beginsWhereRead() && surfacesRead() && feed != Feed::printed;
  }
  /// Occupied voxels, of front.glsl.
  struct Surfaces {
    gpu::BufferRef count, list;
  };
  Surfaces markFronts(PassContext& frame, const shader::BindingSet& marks) const {
    const Surfaces result{
        countBuffer(frame, "count of surfaces"),
        frame.elements(mark_front::surfaces, grid().voxelCount(), "surfaces and their fronts")};
    frame.dispatch(
        frame.program(mark_front::Variant{}, mark_front::Constants{.feedsOwn = feed != Feed::front}),
        {marks, mark_front::opacity(opacity->opacity, gpu::Sampling::nearest),
         mark_front::meanNormals(attributes->normal, gpu::Sampling::nearest),
         mark_front::surfaceCount(result.count), mark_front::surfaces(result.list)},
        grid().resolution);
    finishCount(frame, result.count, grid().voxelCount());
    return result;
  }

  struct Turns {
    Begins from;
    std::array<gpu::TextureRef, 3> light;  ///< kept where no rays begin, else 0
    // With 'turns':
    Surfaces surfaces{};
    gpu::TextureRef before{};  ///< turns of the frame before; null: there is no light of it
    gpu::TextureRef now{};
  };
  Turns takeTurns(PassContext& frame) {
    const glm::ivec3& size = grid().resolution;
    const History<gpu::TextureRef> turn = frame.history(
        {gpu::TextureKind::d3, gpu::Format::r32ui, size.x, size.y, size.z}, "turns of the voxels");
    turn.current->clear(glm::vec4(0.0f));
    const gpu::TextureRef marks = emptyMarks(frame);
    Turns result{
        {}, emptyVolumes(frame, kArriving), markFronts(frame, marking(marks)), nullptr, turn.current};
    markSeen(frame, marking(marks));
    shader::BindingSet bound{take_turns::turns({static_cast<std::uint32_t>(int(turns))}),
                             take_turns::marks(marks), take_turns::turnImage(turn.current),
                             images(result.light)};
    if (const ShGrid::Level* const earlier = lightBefore(neighbours.inWords());
        earlier != nullptr && turn.previous) {
      result.before = turn.previous;
      bound.add(shader::BindingSet{take_turns::turnBefore(turn.previous, gpu::Sampling::nearest),
                                   ShLevelBinding(*earlier, gpu::Sampling::nearest)});
    }
    result.from = listed(frame,
                         frame.program(take_turns::Variant{.before = result.before != nullptr},
                                       take_turns::Constants{.everywhere = frame.keepsEverything()}),
                         bound);
    return result;
  }

  std::array<gpu::TextureRef, 3> emptyVolumes(PassContext& frame, const char* label) const {
    auto volumes = coefficientVolumes(frame, grid().resolution, label);
    for (const gpu::TextureRef& volume : volumes) volume->clear(glm::vec4(0.0f));
    return volumes;
  }

  static constexpr const char* kArriving = "radiance that arrives";

  std::array<gpu::TextureRef, 3> arriving(PassContext& frame, const ShGrid::Level& sent, float unit,
                                          const Begins& from, int bounce) const {
    auto volumes = emptyVolumes(frame, kArriving);
    gather(frame, sent, unit, from, bounce, volumes);
    return volumes;
  }
  /// One bounce: the light that arrives at voxels from what they send.
  void gather(PassContext& frame, const ShGrid::Level& sent, float unit, const Begins& from, int bounce,
              const std::array<gpu::TextureRef, 3>& volumes) const {
    march::Constants choices = constants();
    choices.harmonics = sendsBands();
    choices.environmentMap = environmentMapOf(frame);
    const shader::BoundProgram& program = frame.program(variant(from, march::Variant::ofLight), choices);
    // A texture must be bound even where no normals are read.
    const gpu::TextureRef& normals = readsAttributes() ? attributes->normal : sent.coefficients[0];
    // The first bounce has seen the sky. A buffer that replaces another one sees it again.
    const glm::vec3 sky =
        bounce == 0 || feed == Feed::printed ? frame.sceneDescription().environment : glm::vec3(0.0f);
    sendRays(frame, program,
             {images(volumes), EnvironmentBinding(frame), march::meanNormals(normals, gpu::Sampling::nearest),
              ShLevelBinding(sent, gpu::Sampling::nearest)},
             {.environment = sky, .reach = kNoEnd, .reflectedUnit = unit, .bounce = bounce}, from);
  }

  /// Direct light that voxels reflect, for the shaders that reflect again.
  static shader::BindingSet besides(const ShGrid::Level* direct, float unit) {
    if (direct == nullptr) return {};
    return {feed::beside({unit}), feed::directRed(direct->coefficients[0], gpu::Sampling::nearest),
            feed::directGreen(direct->coefficients[1], gpu::Sampling::nearest),
            feed::directBlue(direct->coefficients[2], gpu::Sampling::nearest)};
  }
  /// What surfaces reflect of the light that arrives at them, and of `direct` light, if any.
  void reflectAgain(PassContext& frame, const ShGrid::Level& light,
                    const std::array<gpu::TextureRef, 3>& passedOn, const ShGrid::Level* direct = nullptr,
                    float directUnit = 1.0f) const {
    frame.dispatch(frame.program(feed::Variant{.direct = direct != nullptr},
                                 neighbours.in(feed::Constants{.feedsOwn = feed == Feed::own})),
                   {besides(direct, directUnit), volumeBinding(grid(), occupied), neighbours.binding(),
                    ShLevelBinding(light, gpu::Sampling::linear),
                    feed::opacityAround(opacity->opacity, gpu::Sampling::nearest),
                    feed::normalsAround(attributes->normal, gpu::Sampling::nearest),
                    feed::opacity(opacity->opacity, gpu::Sampling::nearest),
                    feed::meanNormals(attributes->normal, gpu::Sampling::nearest),
                    feed::albedo(attributes->albedo, gpu::Sampling::nearest), images(passedOn)},
                   grid().resolution);
  }
  /// The same with light in turns.
  void reflectFronts(PassContext& frame, const ShGrid::Level& light, const gpu::TextureRef& turnsOfLight,
                     const Surfaces& surfaces, const std::array<gpu::TextureRef, 3>& passedOn,
                     const ShGrid::Level* direct = nullptr, float directUnit = 1.0f) const {
    frame.dispatchIndirect(
        frame.program(reflect_front::Variant{.direct = direct != nullptr},
                      reflect_front::Constants{.feedsOwn = feed != Feed::front}),
        {besides(direct, directUnit), volumeBinding(grid(), occupied),
         reflect_front::surfaceCount(surfaces.count), reflect_front::surfaces(surfaces.list),
         ShLevelBinding(light, gpu::Sampling::nearest),
         reflect_front::turnsOfLight(turnsOfLight, gpu::Sampling::nearest),
         reflect_front::opacity(opacity->opacity, gpu::Sampling::nearest),
         reflect_front::meanNormals(attributes->normal, gpu::Sampling::nearest),
         reflect_front::albedo(attributes->albedo, gpu::Sampling::nearest), images(passedOn)},
        *surfaces.count, kGroupsOffset);
  }
};

class OccludePass : public Marching {
  Param<float> distance{
      this,
      "distance",
      0.0f,
      within(0.0f, 1e9f),
      "m",
      "distance within which voxels occlude; 0: a tenth of the diagonal of the scene's bounds, as in the reference"};
  RayStop stop{this};
  Out<ShGrid> visibility{
      this, "visibility", Contributes::nothing, Needs::triangles,
      "visibility over the directions from each voxel: 0 where a ray hits within 'distance', else 1"};

  Reads readsFrom() const override { return Reads::geometry; }
  bool uses(const InBase& input) const override {
    return stop.isInput(input) ? stop.atPlanes() : Marching::uses(input);
  }
  std::string checkParameters() const override { return stop.check(walk == Walk::steps, "walk", "steps"); }

  void run(PassContext& frame) override {
    checkGrids();
    const VoxelPlanes planes =
        stop.atPlanes() ? stop.planes(frame, *bits, "imperfect_volumes.occlude") : VoxelPlanes();
    const Begins from = begins(frame);
    ShGrid result;
    result.quantity = ShGrid::Quantity::radiance;
    result.readFor = from.readFor;
    const gpu::TextureRef open =
        roomFor(frame, grid().resolution, 1, gpu::Format::rgba32f, "openness", false, "a volume").front();
    open->clear(glm::vec4(0.0f));
    result.levels.push_back({grid(), {open, nullptr, nullptr}});
    const float reach = distance > 0.0f
                            ? float(distance)
                            : static_cast<float>(ambientOcclusionDistance(frame.snapshot().bounds));
    march::Variant chosen = variant(from, march::Variant::ofOpenness);
    chosen.planes = stop.atPlanes();
    sendRays(frame, frame.program(chosen, constants()), {march::openImage(open), planes},
             {.reach = reach / grid().voxelSize}, from, stop.atPlanes() ? stop.turns(*bits) : 0);
    visibility = result;
  }
};

}  // namespace

void addMarch(TechniqueRegistry& registry) {
  registry.add<MarchPass>(
      "march", "Light that arrives in each voxel, by rays (Mavridis & Papaioannou 2011, Sec. 3.3)");
  registry.add<OccludePass>(
      "occlude", "Visibility of each voxel within a distance (Mavridis & Papaioannou 2011, Sec. 3.5)");
}

}  // namespace lumivox::imperfect_volumes
