// Pictures of pipelines against the path-traced reference.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "lumivox/measure/metrics.h"
#include "lumivox/reference/path_tracer.h"
#include "support/scene_builder.h"
#include "support/techniques.h"

namespace lumivox::test {

/// RMSE divided by that of leaving the effect out, both without the reference's noise; and the mean divided
/// by the reference's.
struct Against {
  double rmse, ratio;
};
struct Picture {
  int width, height, referenceSamples = 64;
};

inline LayeredImage referenceOf(const Scene& scene, const Picture& picture) {
  ReferenceOptions options = quietly(picture.referenceSamples, 1);
  options.width = picture.width;
  options.height = picture.height;
  options.useCache = true;
  return cachedReference(scene, options);
}

/// `nothing`: the value of every pixel without the effect.
inline Against against(const LayeredImage& reference, const ImageBuffer& image, const std::string& layer,
                       float nothing) {
  const ImageBuffer &right = reference.layers.at(layer), &variance = reference.layers.at(layer + ".variance");
  ImageBuffer none(right.width(), right.height(), right.channels());
  for (float& value : none.values()) value = nothing;
  const auto squared = [](const ImageError& error) {
    return std::max(0.0, error.rmse.value * error.rmse.value - error.noiseFloor * error.noiseFloor);
  };
  const ImageError error = compare(image, right, variance), ofNone = compare(none, right, variance);
  return {std::sqrt(squared(error) / squared(ofNone)), error.meanRatio.value};
}
inline Against lightAgainst(const LayeredImage& reference, const ImageBuffer& image) {
  return against(reference, image, "one_bounce_diffuse", 0.0f);
}
inline Against occlusionAgainst(const LayeredImage& reference, const ImageBuffer& image) {
  return against(reference, image, "ambient_occlusion", 1.0f);
}

/// One frame of a pipeline at the picture's size.
inline FrameResult pictured(const Scene& scene, const Picture& picture, const Pipeline& text,
                            const std::vector<std::string>& settings) {
  RenderOptions options;
  options.width = picture.width;
  options.height = picture.height;
  options.parameters = text.settings(settings);
  return renderOnce(scene, text, options);
}

}  // namespace lumivox::test
