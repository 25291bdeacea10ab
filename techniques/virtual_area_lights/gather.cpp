// Gathers all virtual area lights at every sparse point and averages them to one light per lobe (Lensing and
// Broll 2013, Sec. 3.1, 3.2 step 1 and 4.2).
#include <array>
#include <vector>

#include "directions/point_sight.h"
#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/environment.h"
#include "lumivox/toolkit/loop_limit.h"
#include "passes.h"
#include "sparse_texture.h"
#include "virtual_area_lights_shaders.h"

namespace lumivox::virtual_area_lights {
namespace {

using namespace shaders::virtual_area_lights;

constexpr int kChunk = 128;  // kChunk in gather.comp
/// beta of resolvedExponent(): the spacing of points is 1.4 times the width sqrt(1/k) of a lobe of exponent
/// k. Among 1/4 to 4 this value has the least error over exponents 10 to 10^5 (see the card).
constexpr float kResolvedBySpacing = 2.0f;
constexpr float kSmallWeights = 1e-6f;  ///< epsilon of Eq. 7 for all lights together; the print has no value

class GatherPass : public Pass {
  enum class Method { cached, shared };
  enum class ExponentLimit { spacing, none };

  In<SurfacePoints> points{this, "points", "where light is gathered"};
  In<SurfaceLights> lights{this, "lights", Presence::optional, "virtual area lights", Needs::anyLight};
  In<SurfaceLights> moreLights{this, "more_lights", Presence::optional,
                               "more virtual area lights, from another pass"};
  In<SurfaceLights> reflected{
      this, "reflected", Presence::optional,
      "points that reflect the light of the frame before ('bounce'): they lie where other lights do, too"};
  In<PointSight> sight{this, "sight", Presence::optional,
                       "with 'visibility directions': what the points see, from 'look'"};
  Param<Visibility> visibility{this, "visibility", Visibility::sphere, kVisibilityMeaning,
                               published(Visibility::sphere)};
  Param<Method> method{
      this, "method", Method::shared,
      "how the sum over lights is computed; cached: 128 lights in a dispatch, added to the targets; shared: through shared memory of a work group",
      published(Method::cached)};
  Param<ExponentLimit> exponentLimit{
      this, "exponent_limit", ExponentLimit::spacing,
      "limit of the glossy exponent; spacing: no lobe narrower than the spacing of points resolves; none: no limit",
      published(ExponentLimit::none)};
  PublishedForm asPublished{
      this,
      "Eq. 4 with the flux, Eq. 5 at the centre of the disc and without the receiver's cosine, and the sphere of Sec. 3.3 without the lights' own extent"};
  Param<float> factor{this, "factor", 1.0f, within(0.0f, 1e6f),
                      "with 'as_published': c of Eq. 5, which the paper leaves to the user"};
  Out<SparseLight> light{this, "light", Contributes::nothing, Needs::anyLight,
                         "at each point and for each lobe one averaged light"};

  bool looksBack_ = true;  ///< whether anything reflects towards the eye

  bool uses(const InBase& input) const override { return &input != &sight || byDirection(); }
  Reads readsFrom() const override {
    return byDirection() ? Reads::partOfCamera | Reads::environment : Reads::partOfCamera;
  }
  std::vector<float> readsOfCamera(const SceneSnapshot& snapshot) const override {
    return looksBack_ ? eyeOf(snapshot) : std::vector<float>{};
  }

  struct Averaged {
    gpu::TextureRef light, place;
  };
  struct DiffuseKey {
    gpu::TextureRef points;
    gpu::BufferRef lights, more, reflected, sight;
    glm::vec3 environment;
    bool operator==(const DiffuseKey&) const = default;
  };

  bool byDirection() const { return visibility == Visibility::directions; }
  /// Whether directions are asked: not where nothing occludes.
  bool asks() const { return byDirection() && sight->nearest; }

  /// Not in a first frame.
  bool reflects() const { return reflected && reflected->count > 0; }

  void run(PassContext& frame) override {
    if (byDirection() && !sight.present())
      throw Error(
          "virtual_area_lights.gather: 'visibility directions' reads 'sight'; expected it to be connected to a "
          "pass virtual_area_lights.look");
    const DiffuseKey key{points->position,
                         lights ? lights->lights : nullptr,
                         moreLights ? moreLights->lights : nullptr,
                         reflects() ? reflected->lights : nullptr,
                         asks() ? sight->nearest : nullptr,
                         asks() ? frame.sceneDescription().environment : glm::vec3(0.0f)};
    const Averaged& diffuse = frame.kept("diffuse light of points", key,
                                         [&] { return gather(frame, gather::Variant::lobeDiffuse); });
    SparseLight result{diffuse.light, diffuse.place, nullptr, nullptr};
    looksBack_ = frame.traits().glossy;
    if (looksBack_) {
      const Averaged glossy = gather(frame, gather::Variant::lobeGlossy);
      result.glossy = glossy.light;
      result.glossyPosition = glossy.place;
    }
    light = result;
  }

  Averaged gather(PassContext& frame, int lobe) const {
    const Averaged result{sparseTexture(frame, *points, "averaged light"),
                          sparseTexture(frame, *points, "place of averaged light")};
    const std::array<const In<SurfaceLights>*, 3> all{&lights, &moreLights, &reflected};
    int total = 0, added = 0, upon = 0;  // upon each other, of all lists together
    for (const In<SurfaceLights>* some : all)
      if (*some) total += (*some)->count, upon += (*some)->overlapping;
    const bool sky = asks() && frame.traits().environment;
    if (total == 0 && !sky) return result;
    const Method how = method;
    const int most = how == Method::cached ? kChunk : kLoopLimit / kChunk * kChunk / 2;
    const std::array<gpu::TextureRef, 3> sums{sparseTexture(frame, *points, "sums of light"),
                                              sparseTexture(frame, *points, "sums of offsets"),
                                              sparseTexture(frame, *points, "sums of squares")};
    const shader::BoundProgram& program =
        frame.program(gather::Variant{.lobe = lobe,
                                      .method = how == Method::cached ? gather::Variant::methodCached
                                                                      : gather::Variant::methodShared,
                                      .published = asPublished,
                                      .lobed = frame.traits().glossy && !asPublished,
                                      .sight = asks()},
                      gather::Constants{.environmentMap = asks() ? environmentMapOf(frame) : 0});
    const auto add = [&](const gpu::BufferRef& some, const gather::Parameters& parameters) {
      shader::BindingSet bound{gather::parameters(parameters),   SurfacePointsBinding(*points),
                               gather::surfaceLights(some),      gather::sumImage(sums[0]),
                               gather::offsetImage(sums[1]),     gather::squareImage(sums[2]),
                               gather::lightImage(result.light), gather::placeImage(result.place)};
      if (asks()) {
        const GridPlacement& grid = points->grid;
        bound.add(gather::sight(sight->nearest));
        bound.add(gather::sky({frame.sceneDescription().environment,
                               grid.voxelSize * glm::length(glm::vec3(grid.resolution))}));
        bound.add(EnvironmentBinding(frame));
      }
      forEachPoint(frame, program, bound, *points);
    };
    const float resolved = exponentLimit == ExponentLimit::spacing ? kResolvedBySpacing : 0.0f;
    if (total == 0)
      add(frame.emptyElements(gather::surfaceLights, 1, "no lights"),
          {.eyeWorld = frame.snapshot().camera.eye,
           .smallWeight = kSmallWeights,
           .begins = 1,
           .ends = 1,
           .resolved = resolved,
           .factor = factor,
           .overlapping = 1.0f});
    for (const In<SurfaceLights>* some : all) {
      if (!*some) continue;
      const auto overlapping = static_cast<float>(reflects() ? upon : (*some)->overlapping);
      for (int first = 0; first < (*some)->count; first += most) {
        const int count = std::min(most, (*some)->count - first);
        const int before = added;
        added += count;
        const gather::Parameters parameters{.eyeWorld = frame.snapshot().camera.eye,
                                            .firstLight = first,
                                            .lights = count,
                                            .smallWeight = kSmallWeights / static_cast<float>(total),
                                            .begins = before == 0,
                                            .ends = added == total,
                                            .resolved = resolved,
                                            .factor = factor,
                                            .overlapping = overlapping};
        add((*some)->lights, parameters);
      }
    }
    return result;
  }
};

}  // namespace

void addGather(TechniqueRegistry& registry) {
  registry.add<GatherPass>(
      "gather",
      "All virtual area lights averaged to one light at each sparse point (Lensing & Broll 2013, Sec. 3.2)");
}

}  // namespace lumivox::virtual_area_lights
