// Light accumulated over frames, reprojected by the motion of camera and objects, with its variance: Schied
// et al. 2017, Spatiotemporal Variance-Guided Filtering, Sec. 4.1 and 4.2.
#include <fmt/format.h>

#include <vector>

#include "image_filters_shaders.h"
#include "lumivox/base/error.h"
#include "lumivox/scene/models.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/visible_surface.h"
#include "passes.h"

namespace lumivox::image_filters {
namespace {

namespace reproject = shaders::image_filters::reproject;
namespace accumulate = shaders::image_filters::accumulate;
namespace seen = shaders::image_filters::seen;

class AccumulatePass : public Pass {
  enum class Weight { mean, exponential };
  enum class VarianceOf { result, frame };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<Image> arriving{this, "diffuse", "mean arriving radiance, E / pi, at every pixel, new in every frame"};
  In<Image> feedback{this, "feedback", Presence::history,
                     "light that takes the place of the last frame's accumulated light, such as "
                     "image_filters.atrous.first (Sec. 4.3)"};
  Param<Weight> weight{
      this, "weight", Weight::mean,
      "weight of a frame; mean: 1/n, n at most 'frames'; exponential: 'alpha', or 1/n while that is larger",
      published(Weight::exponential)};
  Param<float> alpha{this, "alpha", 0.2f, within(1e-3f, 1.0f),
                     "with 'weight exponential': weight of a frame (Schied et al. 2017: 0.2)"};
  Param<int> frames{this, "frames", 64, within(1, 4096), "with 'weight mean': most frames in the mean"};
  Param<float> change{
      this,
      "change",
      4.0f,
      within(0.0f, 100.0f),
      "standard errors of 7 x 7 pixels by which the history's mean there may differ from the frame's before it is shortened; 0: it never is",
      published(0.0f)};
  Param<VarianceOf> varianceOf{
      this, "variance_of", VarianceOf::result,
      "what 'variance' is of; result: the accumulated light; frame: the light of one frame",
      published(VarianceOf::frame)};
  Param<float> tolerance{
      this, "tolerance", 2.0f, within(1e-3f, 1e3f),
      "distance from its plane beyond which a pixel of the last frame saw another surface, in widths of a pixel"};
  Param<float> cosine{this, "cosine", 0.9f, within(-1.0f, 1.0f),
                      "least cosine between the normals of one surface in both frames"};
  Out<Image> diffuse{this, "diffuse", Contributes::nothing, Needs::nothing,
                     "accumulated arriving radiance, E / pi, W/(sr m^2)"};
  Out<Image> variance{this, "variance", Contributes::nothing, Needs::nothing,
                      "variance of its luminance, W^2/(sr^2 m^4)"};
  Out<Image> motion{
      this, "motion", Contributes::nothing, Needs::nothing,
      "x, y: pixels from here to where the surface was in the last frame, right and down; z: frames of its history, 0 where it is new"};

  Reads readsFrom() const override { return Reads::camera | Reads::geometry | Reads::history; }

  /// World to clip space, then the matrix of each model to the world and its inverse: reproject.comp.
  static std::vector<glm::mat4> placesOf(const PassContext& frame) {
    const std::vector<std::uint32_t> models = modelsOf(frame.sceneDescription());
    std::vector<glm::mat4> places{worldToClip(frame.snapshot()), glm::mat4(1.0f), glm::mat4(1.0f)};
    for (std::size_t i = 0; i < models.size(); ++i) {
      if (models[i] == 0) continue;
      const std::size_t at = 1 + 2 * std::size_t(models[i]);
      if (places.size() < at + 2) places.resize(at + 2, glm::mat4(1.0f));
      places[at] = frame.snapshot().objects[i].toWorld;
      places[at + 1] = glm::inverse(places[at]);
    }
    return places;
  }

  void run(PassContext& frame) override {
    const glm::ivec3 size = pixels(frame);
    const gpu::TextureDescription& samples = arriving->texture->description();
    if (samples.width != size.x || samples.height != size.y)
      throw Error(fmt::format(
          "image_filters.accumulate: 'diffuse' has {} x {} samples for {} x {} pixels; expected one for each pixel",
          samples.width, samples.height, size.x, size.y));
    const gpu::TextureDescription all{.format = gpu::Format::rgba32f, .width = size.x, .height = size.y};
    const History<gpu::TextureRef> light = frame.history(all, "accumulated light"),
                                   moments = frame.history(all, "accumulated moments"),
                                   position = frame.history(all, "positions"),
                                   normal = frame.history(all, "normals");
    const std::vector<glm::mat4> now = placesOf(frame);
    const History<gpu::BufferRef> places = frame.history(now.size() * sizeof(glm::mat4), "places of models");
    places.current->uploadValues(std::span<const glm::mat4>(now));
    const CameraView& camera = frame.snapshot().camera;
    const bool hasPast =
        light.previous && moments.previous && position.previous && normal.previous && places.previous;
    const gpu::TextureRef pastLight = frame.image("reprojected light"),
                          pastMoments = frame.image("reprojected moments");
    motion = Image{frame.image("motion"), false};
    using gpu::Sampling;
    frame.dispatch(
        frame.program(seen::kProgram),
        {GBufferBinding(*gbuffer), seen::seenPosition(position.current), seen::seenNormal(normal.current)},
        size);
    if (hasPast)
      frame.dispatch(
          frame.program(reproject::kProgram),
          {reproject::reprojection({.eye = camera.eye,
                                    .pixelAngle = pixelAngleOf(camera),
                                    .tolerance = tolerance,
                                    .leastCosine = cosine}),
           GBufferBinding(*gbuffer), reproject::placesNow(places.current),
           reproject::placesThen(places.previous),
           reproject::positionThen(position.previous, Sampling::nearest),
           reproject::normalThen(normal.previous, Sampling::nearest),
           reproject::lightThen(light.previous, Sampling::nearest),
           reproject::feedbackThen(feedback.present() ? feedback->texture : light.previous,
                                   Sampling::nearest),
           reproject::momentsThen(moments.previous, Sampling::nearest), reproject::pastLight(pastLight),
           reproject::pastMoments(pastMoments), reproject::motionImage(motion->texture)},
          size);
    else
      motion->texture->clear(glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));
    diffuse = Image{frame.image("accumulated light of this frame")};
    variance = Image{frame.image("variance of the light"), false};
    frame.dispatch(
        frame.program(accumulate::kProgram, {},
                      accumulate::Constants{.exponential = weight == Weight::exponential,
                                            .varianceOfSample = varianceOf == VarianceOf::frame}
                          .values()),
        {accumulate::accumulation({.eye = camera.eye,
                                   .pixelAngle = pixelAngleOf(camera),
                                   .alpha = alpha,
                                   .frames = static_cast<float>(int(frames)),
                                   .change = change,
                                   .hasPast = hasPast}),
         GBufferBinding(*gbuffer), accumulate::lightNow(arriving->texture, Sampling::nearest),
         accumulate::pastLight(hasPast ? pastLight : gbuffer->position, Sampling::nearest),
         accumulate::pastMoments(hasPast ? pastMoments : gbuffer->position, Sampling::nearest),
         accumulate::lightHistory(light.current), accumulate::momentsHistory(moments.current),
         accumulate::accumulatedImage(diffuse->texture), accumulate::varianceImage(variance->texture)},
        size);
  }
};

}  // namespace

void addAccumulate(TechniqueRegistry& registry) {
  registry.add<AccumulatePass>(
      "accumulate",
      "Light accumulated over frames along the motion of camera and objects, and its variance (Schied et al. 2017)");
}

}  // namespace lumivox::image_filters
