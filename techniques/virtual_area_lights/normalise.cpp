// Scales averaged lights so that each gives what all lights give (Lensing and Broll 2013, Sec. 3.2 step 2).
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "lumivox/toolkit/bindings.h"
#include "passes.h"
#include "sparse_texture.h"
#include "virtual_area_lights_shaders.h"

namespace lumivox::virtual_area_lights {
namespace {

using namespace shaders::virtual_area_lights;

class NormalisePass : public Pass {
  In<SurfacePoints> points{this, "points", "where light was gathered"};
  In<SparseLight> gathered{this, "light", "averaged light, from gather"};
  Param<float> amplification{this, "amplification", 10.0f, within(1.0f, 1e6f),
                             "largest factor that the division by the averaged light's cosine may give"};
  PublishedForm asPublished{
      this,
      "without this limit and that of the brightest light, Eq. 11 with its squared distance to the "
      "averaged place"};
  Out<SparseLight> light{
      this, "light", Contributes::nothing, Needs::anyLight,
      "averaged light that the local model reflects as the sum of the lights at the point"};

  bool looksBack_ = true;  ///< whether anything reflects towards the eye

  Reads readsFrom() const override { return Reads::partOfCamera; }
  std::vector<float> readsOfCamera(const SceneSnapshot& snapshot) const override {
    return looksBack_ ? eyeOf(snapshot) : std::vector<float>{};
  }

  struct Normalised {
    gpu::TextureRef light;
    gpu::BufferRef kept;
  };

  void run(PassContext& frame) override {
    const Normalised& diffuse = frame.kept("normalised diffuse light", gathered->diffuse, [&] {
      return normalise(frame, normalise::Variant::lobeDiffuse, gathered->diffuse, gathered->diffusePosition);
    });
    SparseLight result = *gathered;
    result.diffuse = diffuse.light;
    tellShare(frame, diffuse, "diffuse");
    looksBack_ = gathered->glossy != nullptr;
    if (looksBack_) {
      const Normalised glossy =
          normalise(frame, normalise::Variant::lobeGlossy, gathered->glossy, gathered->glossyPosition);
      result.glossy = glossy.light;
      tellShare(frame, glossy, "glossy");
    }
    light = result;
  }

  Normalised normalise(PassContext& frame, int lobe, const gpu::TextureRef& lights,
                       const gpu::TextureRef& places) const {
    const Normalised result{
        sparseTexture(frame, *points, "normalised light"),
        frame.emptyElements(normalise::kept, static_cast<std::uint64_t>(points->count), "shares of light")};
    using gpu::Sampling;
    forEachPoint(
        frame, frame.program(normalise::Variant{.lobe = lobe, .published = asPublished}),
        {normalise::parameters({frame.snapshot().camera.eye, amplification}), SurfacePointsBinding(*points),
         normalise::lights(lights, Sampling::nearest), normalise::places(places, Sampling::nearest),
         normalise::brightest(gathered->diffuse, Sampling::nearest), normalise::kept(result.kept),
         normalise::normalisedImage(result.light)},
        *points);
    return result;
  }

  void tellShare(PassContext& frame, const Normalised& of, const char* lobe) const {
    if (!frame.inspects() || asPublished || points->count == 0) return;
    auto shares = of.kept->downloadValues<float>();
    shares.resize(static_cast<std::size_t>(points->count));  // a pooled buffer may be longer
    double lost = 0.0;
    std::size_t clamped = 0;
    for (const float share : shares) {
      lost += 1.0 - share;
      if (share < 1.0f) ++clamped;
    }
    const auto all = static_cast<double>(shares.size());
    frame.note(fmt::format("{:.1f} % of the points have their {} light clamped, {:.1f} % of it in the mean",
                           100.0 * static_cast<double>(clamped) / all, lobe, 100.0 * lost / all));
  }
};

}  // namespace

void addNormalise(TechniqueRegistry& registry) {
  registry.add<NormalisePass>(
      "normalise",
      "Averaged lights scaled to the sum of the lights that they replace (Lensing & Broll 2013, Eq. 11)");
}

}  // namespace lumivox::virtual_area_lights
