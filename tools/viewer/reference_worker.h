// The path-traced reference of the current view, which converges in rounds while the window shows it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lumivox/base/image.h"
#include "lumivox/reference/path_tracer.h"
#include "lumivox/scene/scene.h"
#include "viewer/latest_worker.h"

namespace lumivox::viewer {

struct ReferenceWish {
  std::shared_ptr<const Scene> scene;
  Camera camera;
  double time = 0.0;
  int width = 0, height = 0;
  std::vector<int> bounceLayers;
  int samples = 0;  ///< per pixel, after which it stops
  bool isSameView(const ReferenceWish& other) const;
};

/// The mean of all rounds so far, with the layers of renderReference() and their variances.
struct ConvergingReference {
  ReferenceWish wish;
  LayeredImage image;
  int samples = 0;
  double seconds = 0.0;
  std::string error;  ///< why there is no reference; empty: there is one
};
/// Shared: an image has dozens of layers.
using ReferenceResult = std::shared_ptr<const ConvergingReference>;
using ReferenceWorker = LatestWorker<ReferenceWish, ReferenceResult>;

/// Rounds of 2, 2, 4, 8, ... up to 64 samples per pixel on all cores but one, which is left to the window.
/// Round i has the seed i + 1, so that the same wish gives the same images.
ReferenceWorker::Work makeReferenceWork();

/// Adds a round to a mean of independent rounds: means are weighted by their samples, variances by the
/// squares of these weights. Both must have the same layers.
void addRound(LayeredImage& mean, int samples, const LayeredImage& round, int roundSamples);

}  // namespace lumivox::viewer
