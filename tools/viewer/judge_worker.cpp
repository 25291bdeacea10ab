#include "viewer/judge_worker.h"

#include <algorithm>
#include <set>

#include "lumivox/experiment/report.h"

namespace lumivox::viewer {

ImageBuffer outputOf(const FrameResult& frame, const std::string& output) {
  if (output == kWholeImage) return compositeImage(frame);
  const auto found = frame.outputs.find(output);
  return found == frame.outputs.end() ? ImageBuffer{} : found->second;
}

std::string layerOf(const RenderedSide& side, const std::string& output) {
  // As in reports: the whole image against all light, an output against the light that its technique models.
  if (output == kWholeImage) return "full";
  const auto component = side.frame.components.find(output);
  if (component == side.frame.components.end()) return {};
  const auto bounces = side.bounces.find(output);
  return referenceLayers(component->second, bounces == side.bounces.end() ? 1 : bounces->second).first;
}

std::vector<std::string> shownOutputs(const FrameResult& frame) {
  std::vector<std::string> names;
  if (!compositeImage(frame).empty()) names.emplace_back(kWholeImage);
  for (const auto& [name, image] : frame.outputs)
    if (!image.empty()) names.push_back(name);
  return names;
}

std::vector<int> bounceLayersOf(const Rendered& rendered) {
  std::set<int> layers;
  for (const RenderedSide& side : rendered.sides)
    for (const auto& [output, bounces] : side.bounces)
      if (bounces > 1) layers.insert(std::min(bounces, ReferenceOptions().bounces));
  return {layers.begin(), layers.end()};
}

namespace {

/// The errors of one side; nothing if another wish waits.
std::optional<std::vector<JudgedOutput>> judged(const RenderedSide& side, const JudgeWish& wish,
                                                const JudgeWorker::Turn& turn) {
  std::vector<JudgedOutput> outputs;
  if (!side.error.empty()) return outputs;
  for (const std::string& name : shownOutputs(side.frame)) {
    if (turn.outdated()) return std::nullopt;
    const std::string layer = layerOf(side, name);
    const std::optional<ReferenceLayer> reference =
        layer.empty() ? std::nullopt : referenceLayer(wish.reference->image, layer);
    const ImageBuffer image = outputOf(side.frame, name);
    if (!reference || !reference->mean.sameShape(image)) continue;
    JudgedOutput one{name, layer, compare(image, reference->mean, reference->variance, wish.exposure), 0.0};
    const auto component = side.frame.components.find(name);
    const ImageBuffer nothing =
        neutralImage(image.width(), image.height(),
                     component == side.frame.components.end() ? Contributes::final : component->second);
    one.ofNothing = compare(nothing, reference->mean, reference->variance, wish.exposure).flip;
    outputs.push_back(std::move(one));
  }
  return outputs;
}

}  // namespace

JudgeWorker::Work makeJudgeWork() {
  return [](const JudgeWish& wish, JudgeWorker::Turn& turn) {
    auto result = std::make_shared<Judged>();
    result->wish = wish;
    result->sides.resize(wish.rendered->sides.size());
    try {
      for (std::size_t i = 0; i < result->sides.size(); ++i) {
        auto outputs = judged(wish.rendered->sides[i], wish, turn);
        if (!outputs) return;
        result->sides[i] = std::move(*outputs);
      }
    } catch (const std::exception& error) {
      result->error = error.what();  // such as radiance whose square overflows
    }
    turn.give(std::move(result));
  };
}

}  // namespace lumivox::viewer
