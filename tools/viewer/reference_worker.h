// The path-traced reference of the current view, which converges in rounds while somebody looks.
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
  int samples = 0;  ///< per pixel, at which it is good enough
  bool isSameView(const ReferenceWish& other) const;
};

/// The mean of all rounds so far, with the layers of renderReference() and their variances.
struct ConvergingReference {
  ReferenceWish wish;
  LayeredImage image;
  int samples = 0;
  double seconds = 0.0;
  std::string error;  ///< why there is none; empty: there is
};
/// Shared: an image has dozens of layers.
using ReferenceResult = std::shared_ptr<const ConvergingReference>;
using ReferenceWorker = LatestWorker<ReferenceWish, ReferenceResult>;

/// Rounds of 2, 2, 4, 8, ... up to 64 samples on all cores but one, so that the window keeps its own. Round i
/// has the seed i + 1, so that the same wish converges in the same way.
ReferenceWorker::Work makeReferenceWork();

/// Adds independent means to a mean: of every layer the mean weighted by samples, of every variance the
/// square of the weights. Both must have the same layers.
void addRound(LayeredImage& mean, int samples, const LayeredImage& round, int roundSamples);

}  // namespace lumivox::viewer
