// Errors of what is shown against the reference so far.
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

/// Name of the sum of all radiance among the outputs.
inline constexpr const char* kWholeImage = "whole image";

using RenderedResult = std::shared_ptr<const Rendered>;

/// The error of one output of one side.
struct JudgedOutput {
  std::string output, layer;  ///< layer: of the reference that it is judged by
  ImageError error;
  double ofNothing = 0.0;  ///< the FLIP of leaving it out: black, or 1 for ambient occlusion
};
struct JudgeWish {
  RenderedResult rendered;
  ReferenceResult reference;
  std::optional<double> exposure;
};
struct Judged {
  JudgeWish wish;
  std::vector<std::vector<JudgedOutput>> sides;
  std::string error;  ///< why something could not be judged; empty: all of it was
};
using JudgeWorker = LatestWorker<JudgeWish, std::shared_ptr<const Judged>>;

JudgeWorker::Work makeJudgeWork();

/// The image of an output, or of kWholeImage; empty when there is none.
ImageBuffer outputOf(const FrameResult& frame, const std::string& output);
/// The layer that it is judged by, that of as many bounces as the technique models; empty: none.
std::string layerOf(const RenderedSide& side, const std::string& output);
/// Outputs that are shown: kWholeImage first where there is one, then all.
std::vector<std::string> shownOutputs(const FrameResult& frame);
/// The bounces that a reference of these sides needs layers for, sorted.
std::vector<int> bounceLayersOf(const Rendered& rendered);

}  // namespace lumivox::viewer
