// Traces paths through voxels: Thiedemann, Henrich, Grosch & Mueller 2011, "Voxel-based global illumination"
// (slides); thesis Gomes 2015, Sec. 3.2.4.
#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/environment.h"
#include "lumivox/toolkit/grid_placement.h"
#include "lumivox/toolkit/loop_limit.h"
#include "lumivox/toolkit/ray_stop.h"
#include "lumivox/toolkit/room.h"
#include "lumivox/toolkit/voxel_rays.h"
#include "voxel_path_tracing_shaders.h"

namespace lumivox::voxel_path_tracing {
namespace {

using namespace shaders::voxel_path_tracing;

constexpr int kMostBounces = 1024;

/// Loop turns per light sample.
constexpr int kTurnsOfLight = 1;

/// Turns of the loop by which a ray is moved out of a set voxel: `startOf` in path.glsl.
constexpr int kTurnsOfPush = 8;

class TracePass : public Pass {
  enum class Order { forward, backward };
  enum class Stuck { push, hit };
  enum class Normals { map, voxels };
  enum class Frames { sum, apart };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces, where paths begin"};
  In<BinaryGrid> bits{this, "bits", "where rays end: one bit a voxel"};
  In<ReflectiveShadowMap> map{
      this, "map", Presence::optional,
      "what the lights see, with what reflects it: the light where rays end; without it only the environment "
      "shines",
      Needs::anyLight};
  In<AttributeGrid> attributes{
      this, "attributes", Presence::optional,
      "with two bounces and more: normals and albedos where rays end in shadow, in the grid of 'bits'"};
  Param<int> samples{this, "samples", 16, within(1, 1 << 20), "paths per pixel and frame"};
  Param<int> bounces{this, "bounces", 2, within(1, kMostBounces),
                     "rays of a path: the indirect bounces that the light makes at most"};
  Param<Frames> framesOf{
      this, "frames", Frames::sum,
      "paths of several frames; sum: added while nothing changes, in runs that accumulate; apart: each frame has paths of its own and their light alone, for a filter over frames"};
  RayMethod method{this};
  Param<Order> order{
      this, "order", Order::forward,
      "light is added as a path meets it; or all surfaces of the path stay in textures, and light is carried back over them",
      published(Order::backward)};
  Param<float> offset{
      this, "offset", 1.0f, within(0.0f, 100.0f),
      "start of a ray along the normal, in the distance beyond which no voxel lies that the surface's plane touches"};
  Param<Stuck> stuck{
      this, "stuck", Stuck::push,
      "rays from a voxel that begin in a set one, at whose box they would end: begin in the next empty voxel along the normal, within two; or end at once",
      published(Stuck::hit)};
  Param<Normals> normals{
      this, "normals", Normals::map,
      "about which normal paths go on from lit surfaces: that of the map, or the mean of the voxel",
      published(Normals::voxels)};
  Param<bool> roulette{
      this, "roulette", false,
      "paths end by chance, the more often the less light they carry; the others count more"};
  Param<float> radius{
      this, "radius", 0.0f, within(0.0f, 1e9f), "m", "length of a ray; 0: through all of the grid"};
  RayStop stop{this};
  lumivox::BackProjection projection{this};
  PublishedForm asPublished{this,
                            "the tests of Listing 4.49 whether a texel of the map shows the end of a ray"};
  Out<Image> arriving{this, "arriving", Contributes::nothing, Needs::nothing,
                      "E / pi at the pixels: mean radiance that arrives, W/(sr m^2)"};
  Out<Image> glossy{this, "glossy", Contributes::indirectGlossy, Needs::glossyMaterial,
                    "indirect light reflected by the Phong lobe"};

  Reads readsFrom() const override {
    return Reads::camera | Reads::environment | Reads::history |
           (framesOf == Frames::apart ? Reads::time : Reads::nothing);
  }
  bool uses(const InBase& input) const override {
    if (stop.isInput(input)) return stop.atPlanes();
    return &input != &attributes || bounces > 1;
  }
  int indirectBounces() const override { return bounces; }
  std::string checkParameters() const override {
    if (roulette && order == Order::backward)
      return "'roulette' is on and 'order' backward; expected one of both: stored paths do not end";
    // With planes there is one walk and one order: others would only add variants of the programs.
    std::string ofStop = stop.check(order == Order::backward, "order", "backward");
    if (ofStop.empty())
      ofStop = stop.check(method.axis() != trace::Variant::bitRuleHierarchy, "method", method.name());
    if (!ofStop.empty()) return ofStop;
    return projection.taps() == 1 ? std::string()
                                  : "'taps' is 4; expected 1: a path goes on from one texel's surface";
  }

  bool readsMap() const { return map.present() && map->lightCount > 0; }
  bool readsAttributes() const { return bounces > 1 && attributes.present(); }

  /// Bounds the turns of all loops of one ray of a path.
  std::int64_t turnsOfRay() const {
    const std::int64_t lights = readsMap() ? std::int64_t{kTurnsOfLight} * map->lightCount : 0;
    return method.turns(*bits) + stop.turns(*bits) + lights + kTurnsOfPush;
  }

  /// Error where the connected inputs do not belong together.
  void checkInputs() const {
    if (bounces > 1) {
      if (!attributes.present())
        throw Error(fmt::format(
            "voxel_path_tracing.trace: 'bounces' is {}, and paths do not know what reflects them in shadow; expected 'attributes' to be connected, or 'bounces 1'",
            static_cast<int>(bounces)));
      if (!(attributes->grid == bits->grid))
        throw Error(fmt::format(
            "voxel_path_tracing.trace: 'bits' have {}, and 'attributes' {}; expected one grid for both",
            inWords(bits->grid), inWords(attributes->grid)));
    }
    if (!readsMap()) return;
    requireWhole(*map, "voxel_path_tracing.trace");
    if (map->albedo == nullptr || (gbuffer->specular != nullptr && map->specular == nullptr))
      throw Error(
          "voxel_path_tracing.trace: 'map' does not tell what its surfaces reflect; expected the output that does, 'surfaces' of reflective_shadow_maps.render");
    if (const std::int64_t turns = turnsOfRay(); turns > kLoopLimit)
      throw Error(fmt::format(
          "voxel_path_tracing.trace: a ray through {} asks {} light samples of 'map', in loops of {} turns; expected at most {}: fewer light samples or voxels",
          inWords(bits->grid), map->lightCount, turns, kLoopLimit));
  }

  void run(PassContext& frame) override {
    checkInputs();
    const glm::ivec3 size = pixels(frame);
    const Outputs outputs{arriving.wanted(), glossy.wanted() && gbuffer->specular != nullptr};
    const int layers = outputs.reflected ? 4 : 2;
    const bool apart = framesOf == Frames::apart;
    const char* const label = "light of all paths";
    const History<gpu::TextureRef> sums =
        apart ? History<gpu::TextureRef>{nullptr, frame.texture(layersOf(size, layers), label)}
              : frame.history(layersOf(size, layers), label);
    const int before = sums.previous ? frame.accumulated() : 0;
    if (before > 0)
      frame.dispatch(frame.program(go_on::kProgram),
                     {go_on::sums(sums.current), go_on::earlierSums(sums.previous, gpu::Sampling::nearest)},
                     {size.x, size.y, layers});
    else
      sums.current->clear(glm::vec4(0.0f));
    const auto paths = static_cast<std::uint32_t>(static_cast<int>(samples));
    if (outputs.any()) {
      const VoxelPlanes planes = stop.planes(frame, *bits, "voxel_path_tracing.trace");
      const shader::BindingSet scene{sceneOf(frame), planes};
      Path path = pathOf(frame);
      path.number =
          static_cast<std::uint32_t>(apart ? frame.frameIndex() + frame.accumulated() : before) * paths;
      if (order == Order::forward)
        followForward(frame, scene, sums.current, path, outputs);
      else
        followBackward(frame, scene, sums.current, path, outputs);
    }
    finish(frame, sums.current, outputs, static_cast<float>(before + 1) * static_cast<float>(paths));
  }

  struct Outputs {
    bool arriving, reflected;  ///< which light is summed
    bool any() const { return arriving || reflected; }
  };

  static gpu::TextureDescription layersOf(const glm::ivec3& size, int layers) {
    return {gpu::TextureKind::d2Array, gpu::Format::rgba32f, size.x, size.y, layers, 1};
  }

  Path pathOf(PassContext& frame) const {
    return {.environment = frame.sceneDescription().environment,
            .offset = offset,
            .eye = frame.snapshot().camera.eye,
            .reach = radius > 0.0f ? radius / bits->grid.voxelSize : std::numeric_limits<float>::infinity(),
            .seed = seedWords(frame),
            .number = 0,
            .bounce = 1,
            .bounces = bounces,
            .raysAtOnce = 1};
  }

  /// The bindings that both orders read.
  shader::BindingSet sceneOf(PassContext& frame) const {
    shader::BindingSet result{GBufferBinding(*gbuffer), EnvironmentBinding(frame),
                              method.binding(frame, *bits)};
    if (readsMap()) {
      result.add(ReflectiveShadowMapBinding(*map));
      result.add(
          projection.binding(stop.voxelsOfMap() * bits->grid.voxelSize, asPublished, 0, map->lightCount));
      result.add(shader::SampledSlot{"rsmAlbedo"}(map->albedo, gpu::Sampling::nearest));
      if (map->specular)
        result.add(shader::SampledSlot{"rsmSpecular"}(map->specular, gpu::Sampling::nearest));
    }
    if (readsAttributes()) {
      result.add(shader::SampledSlot{"voxelAlbedo"}(attributes->albedo, gpu::Sampling::nearest));
      result.add(shader::SampledSlot{"voxelNormal"}(attributes->normal, gpu::Sampling::nearest));
    }
    return result;
  }

  template <class Variant>
  Variant variantOf(Variant variant) const {
    variant.map = readsMap();
    variant.glossy = gbuffer->specular != nullptr;
    variant.attributes = readsAttributes();
    variant.bitRule = method.axis();
    return variant;
  }
  template <class Constants>
  Constants constantsOf(const PassContext& frame) const {
    return {.frontTest = projection.front(),
            .normalOfVoxels = normals == Normals::voxels,
            .pushes = stuck == Stuck::push,
            .roulette = roulette,
            .printedTests = asPublished,
            .environmentMap = environmentMapOf(frame)};
  }

  /// Light is added as a path meets it: three textures hold all paths, whatever the number of bounces. A
  /// dispatch follows as many rays of a path as the limit of loops allows.
  void followForward(PassContext& frame, const shader::BindingSet& scene, const gpu::TextureRef& sums,
                     Path path, Outputs outputs) const {
    const shader::BoundProgram& program = frame.program(
        variantOf(trace::Variant{
            .arriving = outputs.arriving, .reflected = outputs.reflected, .planes = stop.atPlanes()}),
        constantsOf<trace::Constants>(frame));
    const gpu::TextureRef starts = frame.image("starts of rays"),
                          directions = frame.image("directions of rays"),
                          throughputs = frame.image("throughputs of paths");
    const shader::BindingSet states{scene, trace::sums(sums), trace::pathStart(starts),
                                    trace::pathDirection(directions), trace::pathThroughput(throughputs)};
    for (int i = 0; i < samples; ++i, ++path.number)
      forEachPortion(bounces, turnsOfRay(), [&](int first, int count) {
        path.bounce = first + 1;
        path.raysAtOnce = count;
        frame.dispatch(program, {states, trace::path(path)}, pixels(frame));
      });
  }

  /// Textures keep every surface of a path, one layer per bounce, and light is carried back over them.
  void followBackward(PassContext& frame, const shader::BindingSet& scene, const gpu::TextureRef& sums,
                      Path path, Outputs outputs) const {
    const glm::ivec3 size = pixels(frame);
    const record::Variant variant = variantOf(record::Variant{});
    const int textures = variant.glossy ? 6 : 4;
    const auto layersBytes = [&](int layers) {
      return 16u * static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y) *
             static_cast<std::uint64_t>(layers);
    };
    requireRoom(
        frame, bounces,
        [&](int layers) {
          return std::vector<std::uint64_t>(static_cast<std::size_t>(textures), layersBytes(layers));
        },
        "bounces of 'order backward'");
    const auto vertices = [&](const char* label) { return frame.texture(layersOf(size, bounces), label); };
    const gpu::TextureRef place = vertices("surfaces of paths"), normal = vertices("their normals"),
                          light = vertices("their light"), reflection = vertices("their reflection"),
                          specular = variant.glossy ? vertices("their Phong lobes") : nullptr,
                          toViewer = variant.glossy ? vertices("directions back along paths") : nullptr,
                          weights = frame.image("first weights of paths"),
                          back = frame.image("carried light");
    const shader::BindingSet stored{record::vertexPlace(place), record::vertexLight(light),
                                    record::vertexReflection(reflection), record::firstWeights(weights)},
        recorded{scene, stored, record::vertexNormal(normal), record::vertexSpecular(specular),
                 record::vertexToViewer(toViewer)};
    const shader::BoundProgram& forwards = frame.program(variant, constantsOf<record::Constants>(frame));
    const shader::BoundProgram& backwards =
        frame.program(bring_back::Variant{.arriving = outputs.arriving, .reflected = outputs.reflected});
    for (int i = 0; i < samples; ++i, ++path.number) {
      for (path.bounce = 1; path.bounce <= bounces; ++path.bounce)
        frame.dispatch(forwards, {recorded, record::path(path)}, size);
      for (int layer = bounces - 1; layer >= 0; --layer)
        frame.dispatch(backwards,
                       {stored, bring_back::sums(sums), bring_back::carried(back),
                        bring_back::carriedLayer({.layer = layer, .isLast = layer == bounces - 1})},
                       size);
    }
  }

  /// Divides sums into means over all paths.
  void finish(PassContext& frame, const gpu::TextureRef& sums, Outputs outputs, float paths) {
    if (arriving.wanted()) arriving = Image{frame.image("arriving radiance")};
    if (glossy.wanted()) glossy = Image{frame.image("indirect glossy radiance")};
    if (glossy.wanted() && !outputs.reflected) glossy->texture->clear(glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));
    if (!outputs.any()) return;
    frame.dispatch(
        frame.program(finish::Variant{.arriving = outputs.arriving, .reflected = outputs.reflected}),
        {GBufferBinding(*gbuffer), finish::sums(sums), finish::finish({.paths = paths}),
         finish::arrivingImage(textureOf(arriving)), finish::glossyImage(textureOf(glossy))},
        pixels(frame));
  }
};

}  // namespace
}  // namespace lumivox::voxel_path_tracing

LUMIVOX_TECHNIQUE(registry) {
  using namespace lumivox::voxel_path_tracing;
  registry.describe(
      "Voxel path tracing: paths through one bit a voxel, lit and reflected as reflective shadow maps know",
      "Thiedemann et al. 2011; thesis Gomes 2015, Sec. 3.2.4");
  registry.add<TracePass>("trace", "Several bounces by paths through bits (thesis Gomes 2015, Sec. 3.2.4)");
}
