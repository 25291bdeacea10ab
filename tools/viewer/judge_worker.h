// Errors of the shown frame against the reference as far as it has converged.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/measure/metrics.h"
#include "viewer/latest_worker.h"
#include "viewer/reference_worker.h"
#include "viewer/render_worker.h"

namespace lumivox::viewer {

/// The name of the sum of all radiance in the list of outputs.
inline constexpr const char* kWholeImage = "whole image";

using RenderedResult = std::shared_ptr<const Rendered>;

/// The error of one output of one side.
struct JudgedOutput {
  std::string output, layer;  ///< layer: that of the reference
  ImageError error;
  double ofNothing = 0.0;  ///< FLIP without this output: black, or 1 for ambient occlusion
};
struct JudgeWish {
  RenderedResult rendered;
  ReferenceResult reference;
  std::optional<double> exposure;
};
struct Judged {
  JudgeWish wish;
  std::vector<std::vector<JudgedOutput>> sides;
  std::string error;  ///< why an output could not be judged; empty: all were
};
using JudgeWorker = LatestWorker<JudgeWish, std::shared_ptr<const Judged>>;

JudgeWorker::Work makeJudgeWork();

/// The image of an output, or of kWholeImage; empty if there is none.
ImageBuffer outputOf(const FrameResult& frame, const std::string& output);
/// The reference layer for an output, with as many bounces as the technique models; empty: none.
std::string layerOf(const RenderedSide& side, const std::string& output);
/// The outputs that can be shown: kWholeImage first if there is one, then all others.
std::vector<std::string> shownOutputs(const FrameResult& frame);
/// The numbers of bounces for which a reference of these sides needs layers, sorted.
std::vector<int> bounceLayersOf(const Rendered& rendered);

}  // namespace lumivox::viewer
