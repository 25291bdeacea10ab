#include "experiment/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <optional>
#include <span>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/base/low_discrepancy.h"
#include "pipeline/changes.h"

namespace lumivox::experiment {
namespace {

/// The images of one seed: every output that has a reference, and the whole image.
struct Judged {
  std::string output;
  Contributes component;
  std::vector<ImageBuffer> seeds;
  bool deterministic = false;  ///< every seed gives the same image
};

void collect(std::vector<Judged>& judged, const std::string& output, Contributes component,
             ImageBuffer image) {
  if (image.empty() || referenceLayers(component).first.empty()) return;
  const auto found =
      std::find_if(judged.begin(), judged.end(), [&](const Judged& one) { return one.output == output; });
  if (found == judged.end())
    judged.push_back({output, component, {std::move(image)}});
  else
    found->seeds.push_back(std::move(image));
}

void collectOutputs(std::vector<Judged>& judged, const PipelineExecutor& executor, FrameResult frame) {
  ImageBuffer whole = compositeImage(frame);
  for (const std::string& output : executor.outputNames()) {
    const auto image = frame.outputs.find(output);
    const auto component = frame.components.find(output);
    // An output that already is the whole image is judged once, as that.
    if (image != frame.outputs.end() && component != frame.components.end() &&
        component->second != Contributes::final)
      collect(judged, output, component->second, std::move(image->second));
  }
  collect(judged, kWholeImage, Contributes::final, std::move(whole));
}

bool sameValues(const ImageBuffer& a, const ImageBuffer& b) {
  return a.sameShape(b) &&
         std::equal(a.values().begin(), a.values().end(), b.values().begin(),
                    [](float x, float y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

bool sameInEverySeed(const Judged& judged) {
  return std::all_of(judged.seeds.begin() + 1, judged.seeds.end(),
                     [&](const ImageBuffer& seed) { return sameValues(judged.seeds.front(), seed); });
}

/// `flipMap` becomes that of the first seed.
ComponentError errorAgainst(const Judged& judged, SceneReference& references, const std::string& layer,
                            bool bias, ImageBuffer& flipMap) {
  const ReferenceLayer& reference = *references.layer(layer);
  ComponentError record;
  record.output = judged.output;
  record.component = name(judged.component);
  record.reference = layer;
  record.bias = bias;
  record.seeds = static_cast<int>(judged.seeds.size());
  record.deterministic = judged.deterministic;
  // Seeds with the same bits are one image.
  SeedsError error =
      compareSeeds(std::span(judged.seeds).first(record.deterministic ? 1 : judged.seeds.size()),
                   reference.mean, reference.variance, references.display(layer).exposure);
  record.error = error.mean;
  flipMap = std::move(error.flipMap);
  record.parts = errorParts(judged.seeds, reference.mean, reference.variance, record.deterministic);
  record.noiseRmse = judged.seeds.size() > 1 ? record.parts.noise.value : 0.0;
  record.errorOfNothing = references.errorOfNothing(layer);
  return record;
}

SceneSnapshot snapshotAt(const MeasureContext& context, const RenderOptions& options, double time) {
  return snapshotOf(context.scene, time, options.camera, options.width, options.height);
}

}  // namespace

RenderOptions renderOptionsOf(const TimingContext& context, const ReportPoint& point) {
  RenderOptions options;
  options.parameters = point.parameters;
  options.parameters.erase(kAccumulatedFrames);
  options.accumulate = framesOf(point.parameters) > 1;
  options.seed = context.options.seed;
  options.camera = context.options.camera;
  options.width = context.width;
  options.height = context.height;
  options.transientMemory = context.transientMemory;
  return options;
}

void fail(ReportPoint& point, const std::string& why) {
  ReportPoint empty;
  empty.scene = point.scene;
  empty.pipeline = point.pipeline;
  empty.sweep = point.sweep;
  empty.parameters = point.parameters;
  empty.command = point.command;
  empty.failure = why;
  point = std::move(empty);
}

std::string whyFailed(const std::function<void()>& work) {
  try {
    work();
  } catch (const DiagnosticsError&) {
    throw;
  } catch (const Error& error) {
    return error.what();
  } catch (const std::bad_alloc&) {
    return "out of memory; what was too large is not known";
  } catch (const std::exception& error) {
    return fmt::format("an unexpected error: {}", error.what());
  }
  return {};
}

FrameResult renderFiltered(PipelineExecutor& executor, const SceneSnapshot& centre, int positions,
                           int frameIndex, int frames, FrameResult* apart) {
  // The reference is filtered over the pixel. With one sample at the pixel's centre the silhouettes of bright
  // area lights would outweigh every other error. The image plane is shifted by a fraction of a pixel;
  // turning the camera instead would shift pixels far from the image's centre further.
  const int count = std::max(1, positions);
  // Unlike a regular grid, the lattice has as many different rows and columns as positions, which matters
  // where edges run along the rows.
  const std::vector<std::array<double, 2>> positionsInPixel = latticePoints(count);
  FrameResult sum;
  for (int position = 0; position < count; ++position) {
    SceneSnapshot shifted = centre;
    const auto [u, v] = positionsInPixel[static_cast<std::size_t>(position)];
    shifted.camera.shift = glm::vec2(u - 0.5, v - 0.5);
    if (frames > 1) {
      executor.invalidate();
      executor.emptyHistories();
      for (int before = 0; before + 1 < frames; ++before)
        executor.render(shifted, frameIndex + before, PipelineExecutor::Images::no);
    }
    FrameResult frame = executor.render(shifted, frameIndex + frames - 1);
    if (position == 0) {
      sum = std::move(frame);
      if (apart != nullptr) *apart = sum;
      continue;
    }
    // The outer positions and the inner ones: each half lies around the centre.
    const bool outer = 4 * position < count || 4 * position >= 3 * count;
    if (sum.healthFindings.empty()) sum.healthFindings = std::move(frame.healthFindings);
    for (auto& [name, image] : sum.outputs) {
      const std::vector<float>& added = frame.outputs.at(name).values();
      for (std::size_t i = 0; i < added.size(); ++i) image.values()[i] += added[i];
      if (apart == nullptr) continue;
      std::vector<float>& difference = apart->outputs.at(name).values();
      for (std::size_t i = 0; i < added.size(); ++i) difference[i] += outer ? added[i] : -added[i];
    }
  }
  for (FrameResult* result : {&sum, apart}) {
    if (result == nullptr) continue;
    for (auto& [name, image] : result->outputs)
      for (float& value : image.values()) value /= static_cast<float>(count);
  }
  return sum;
}

bool flickers(const Scene& scene, const ReportOptions& options) {
  if (options.flickerPairs < 1) return false;
  const auto at = [&](double time) { return snapshotOf(scene, time, options.camera, 1, 1); };
  const Reads changed =
      whatChanged(scene, at(options.time), at(options.time + options.flickerPairs * kFlickerStep));
  return reads(changed, Reads::geometry) || reads(changed, Reads::lights) || reads(changed, Reads::camera) ||
         SceneTraits::of(scene).particles;
}

std::map<std::string, int> bouncesOf(const PipelineExecutor& executor) {
  std::map<std::string, int> bounces = executor.indirectBounces();
  int most = 1;
  for (const auto& [output, count] : bounces) most = std::max(most, count);
  bounces[kWholeImage] = most;
  return bounces;
}

bool isProgressive(const Pipeline& pipeline, TechniqueSource& techniques) {
  return std::any_of(pipeline.passes.begin(), pipeline.passes.end(), [&](const PassText& text) {
    const Technique* technique = techniques.technique(text.technique);
    const PassEntry* entry = technique == nullptr ? nullptr : technique->find(text.pass);
    if (entry == nullptr) return false;
    const std::unique_ptr<Pass> pass = entry->make();
    const auto isBound = [&](const std::string& name) {
      return std::any_of(text.block->items.begin(), text.block->items.end(),
                         [&](const dsl::Item& item) { return item.property && item.property->word == name; });
    };
    return reads(pass->readsFrom(), Reads::history) ||
           std::any_of(pass->inputs().begin(), pass->inputs().end(), [&](const InBase* input) {
             return input->presence() == Presence::history && isBound(input->name());
           });
  });
}

namespace {

double rootMeanSquare(const std::vector<float>& values, const std::vector<float>* subtracted = nullptr) {
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i] - (subtracted != nullptr ? (*subtracted)[i] : 0.0f);
    sum += value * value;
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

/// Whether the whole image is the sum of the other outputs that are parts of it.
bool addsUp(const FrameResult& frame) {
  FrameResult parts = frame;
  for (const auto& [name, component] : frame.components)
    if (component == Contributes::final || name == "final") parts.outputs.erase(name);
  const ImageBuffer whole = compositeImage(frame), sum = compositeImage(parts);
  if (whole.empty() || !whole.sameShape(sum)) return false;
  constexpr double kRounding = 1e-5;
  return rootMeanSquare(sum.values(), &whole.values()) <= kRounding * rootMeanSquare(whole.values());
}

/// Makes the images of one seed whose errors are taken: means over positions in the pixel. A few positions
/// suffice for most outputs, but not where silhouettes are most of the error, as in direct light. Only those
/// outputs are rendered at all positions, and the sums that they are a part of are added up anew.
class JudgedImages {
 public:
  JudgedImages(const MeasureContext& context, const Pipeline& pipeline, const RenderOptions& options,
               ReportPoint& point)
      : context_(context),
        pipeline_(pipeline),
        options_(options),
        point_(point),
        all_(context.device, context.techniques, context.scene, pipeline, options) {
    const int asked = std::max(1, context.options.subpixels);
    point.subpixels = asked > 2 * kLook ? kLook : asked;
    for (const auto& [output, bounces] : bouncesOf(all_)) context.reference.require(bounces);
  }

  const PipelineExecutor& executor() const { return all_; }
  /// By what share more positions would change an error of an output; `rmse` is that error as an RMSE. The
  /// remaining error of edges is independent of it, so that squares add up.
  double leftShare(const std::string& output, double rmse) const {
    const auto left = left_.find(output);
    return left == left_.end() || !(rmse > 0.0) ? 0.0 : 0.5 * left->second * left->second / (rmse * rmse);
  }

  /// Whether two seeds give images that differ in any value, at one position in the pixel.
  bool differ(std::uint64_t one, std::uint64_t other) {
    const SceneSnapshot centre = snapshotAt(context_, options_, context_.options.time);
    std::vector<Judged> images;
    for (const std::uint64_t seed : {one, other}) {
      all_.setSeed(seed);
      all_.setHealth(false);
      const Measuring measuring(point_, "images");
      collectOutputs(images, all_, renderFiltered(all_, centre, 1, 0, framesOf(point_.parameters)));
    }
    return !std::all_of(images.begin(), images.end(), sameInEverySeed);
  }

  FrameResult render(std::uint64_t seed, bool health) {
    all_.setSeed(seed);
    all_.setHealth(health);
    FrameResult apart, frame = rendered(all_, point_.subpixels, &apart);
    if (!std::exchange(looked_, true) && choose(frame, apart))
      frame = rendered(all_, point_.subpixels, nullptr);
    if (!some_) return frame;
    some_->setSeed(seed);
    FrameResult finer = rendered(*some_, context_.options.subpixels, nullptr);
    for (auto& [name, image] : finer.outputs) frame.outputs[name] = std::move(image);
    for (const auto& [name, component] : frame.components)
      if (component == Contributes::final || name == "final") frame.outputs.erase(name);
    return frame;
  }

 private:
  static constexpr int kLook = 4;

  FrameResult rendered(PipelineExecutor& executor, int positions, FrameResult* apart) {
    const Measuring images(point_, "images");
    return renderFiltered(executor, snapshotAt(context_, options_, context_.options.time), positions, 0,
                          framesOf(point_.parameters), apart);
  }

  /// Decides from the first few positions how the images of all seeds are made. True: at all positions, this
  /// seed included.
  bool choose(const FrameResult& mean, const FrameResult& apart) {
    if (point_.subpixels == std::max(1, context_.options.subpixels)) return false;
    const std::vector<std::string> open = unsettled(mean, apart);
    if (open.empty()) return false;
    std::vector<std::string> parts;
    for (const std::string& name : open)
      if (name != kWholeImage) parts.push_back(name);
    if (parts.empty() || !addsUp(mean)) {
      point_.subpixels = context_.options.subpixels;
      left_.clear();
      return true;
    }
    RenderOptions options = options_;
    options.wanted = parts;
    FrameResult rest = apart;
    for (const std::string& name : parts) {
      std::fill(rest.outputs.at(name).values().begin(), rest.outputs.at(name).values().end(), 0.0f);
      left_.erase(name);
    }
    for (const auto& [name, component] : apart.components)
      if (component == Contributes::final || name == "final") rest.outputs.erase(name);
    left_[kWholeImage] = rootMeanSquare(compositeImage(rest).values());
    some_.emplace(context_.device, context_.techniques, context_.scene, pipeline_, options);
    return false;
  }

  /// Outputs that more positions would move by more than kSettled of their error. Half the difference between
  /// the means of the outer and the inner positions bounds the error of edges that is left in the mean of
  /// all.
  std::vector<std::string> unsettled(const FrameResult& mean, const FrameResult& apart) {
    constexpr double kSettled = 0.3;  // an RMSE is sqrt(1 + 0.3^2), 5 % too large at most
    std::vector<Judged> images, differences;
    collectOutputs(images, all_, mean);
    collectOutputs(differences, all_, apart);
    const std::map<std::string, int> bounces = bouncesOf(all_);
    std::vector<std::string> open;
    for (std::size_t i = 0; i < images.size(); ++i) {
      const std::string layer = referenceLayers(images[i].component, bounces.at(images[i].output)).first;
      const ReferenceLayer* reference = context_.reference.layer(layer);
      const ImageBuffer& image = images[i].seeds.front();
      if (reference == nullptr || !reference->mean.sameShape(image)) continue;  // told where errors are taken
      const double moves = rootMeanSquare(differences[i].seeds.front().values());
      left_[images[i].output] = moves;
      // Not finite counts as not settled.
      if (!(moves <= kSettled * rootMeanSquare(image.values(), &reference->mean.values())))
        open.push_back(images[i].output);
    }
    return open;
  }

  const MeasureContext& context_;
  const Pipeline& pipeline_;
  RenderOptions options_;
  ReportPoint& point_;
  PipelineExecutor all_;
  std::optional<PipelineExecutor> some_;  ///< of the outputs that need all positions
  std::map<std::string, double> left_;    ///< by output, RMS that more positions would move its image by
  bool looked_ = false;
};

/// Adds the uncertainty of an error that may be off by this share.
void widen(ImageError& error, double share) {
  const auto add = [share](double& uncertainty, double value) {
    uncertainty = std::hypot(uncertainty, share * value);
  };
  add(error.rmse.uncertainty, error.rmse.value);
  add(error.relativeMse.uncertainty, 2.0 * error.relativeMse.value);
  add(error.percentile95Uncertainty, error.percentile95);
  add(error.ssimUncertainty, 1.0 - error.ssim);
  add(error.flipUncertainty, error.flip);
  add(error.flipLdrUncertainty, error.flipLdr);
}

}  // namespace

void measureErrors(const MeasureContext& context, const Pipeline& pipeline, PointRecord& record) {
  RenderOptions options = renderOptionsOf(context, record.point);
  options.interactive = true;
  JudgedImages source(context, pipeline, options, record.point);
  const PipelineExecutor& executor = source.executor();
  std::vector<Judged> judged;
  const std::uint64_t first = context.options.seed;
  bool deterministic = false;
  for (int seed = 0; seed < std::max(1, context.options.seeds); ++seed) {
    // Where no pass reads the seed, or a second seed gives the same bits, more seeds would only cost time.
    if (seed == 1) deterministic = !executor.readsSeed() || !source.differ(first, first + 1);
    if (seed > 0 && deterministic) break;
    FrameResult frame = source.render(first + static_cast<std::uint64_t>(seed), seed == 0);
    if (seed == 0) {
      record.point.healthFindings = frame.healthFindings;
      record.point.notes = frame.notes;
    }
    collectOutputs(judged, executor, std::move(frame));
  }
  const Measuring errors(record.point, "errors");
  const std::map<std::string, int> bounces = bouncesOf(executor);
  for (Judged& one : judged)
    one.deterministic =
        deterministic || !executor.readsSeed() || (one.seeds.size() > 1 && sameInEverySeed(one));

  for (const Judged& one : judged) {
    const auto [biasLayer, missLayer] = referenceLayers(one.component, bounces.at(one.output));
    OutputImages images;
    images.output = one.output;
    images.component = name(one.component);
    images.image = encodePng(one.seeds.front(), context.reference.display(missLayer, context.options.tone));
    for (const bool bias : {true, false}) {
      const std::string& layer = bias ? biasLayer : missLayer;
      const ReferenceLayer* reference = context.reference.layer(layer);
      if (reference == nullptr || (!bias && missLayer == biasLayer)) continue;
      if (!reference->mean.sameShape(one.seeds.front()))
        throw Error(fmt::format(
            "output '{}' has {} x {} pixels of {} channels, but its reference '{}' has {} x {} of {}",
            one.output, one.seeds.front().width(), one.seeds.front().height(), one.seeds.front().channels(),
            layer, reference->mean.width(), reference->mean.height(), reference->mean.channels()));
      ImageBuffer flipMap;
      ComponentError error = errorAgainst(one, context.reference, layer, bias, flipMap);
      widen(error.error, source.leftShare(one.output, error.error.rmse.value));
      images.against.push_back({layer, encodePng(falseColour(flipMap)), error.error.flip});
      record.point.errors.push_back(std::move(error));
    }
    record.images.push_back(std::move(images));
  }
}

namespace {

/// The frames of an animation with one seed, in place of seeds.
std::vector<Judged> sequenceOf(const MeasureContext& context, const Pipeline& pipeline,
                               const ReportPoint& point, int seed) {
  RenderOptions options = renderOptionsOf(context, point);
  options.seed += static_cast<std::uint64_t>(seed);
  options.interactive = true;
  PipelineExecutor executor(context.device, context.techniques, context.scene, pipeline, options);
  std::vector<Judged> judged;
  for (int frame = 0; frame <= context.options.flickerPairs; ++frame)
    collectOutputs(
        judged, executor,
        renderFiltered(executor, snapshotAt(context, options, context.options.time + frame * kFlickerStep),
                       point.subpixels > 0 ? point.subpixels : context.options.subpixels, frame));
  return judged;
}

Measured flickerAgainst(const MeasureContext& context, const std::vector<ImageBuffer>& frames,
                        const std::string& reference) {
  std::vector<ImageBuffer> means, variances;
  for (int frame = 0; frame <= context.options.flickerPairs; ++frame) {
    const ReferenceLayer& layer = *context.reference.later(frame).layer(reference);
    means.push_back(layer.mean);
    variances.push_back(layer.variance);
  }
  return flicker(frames, means, variances);
}

}  // namespace

void measureFlicker(const MeasureContext& context, const Pipeline& pipeline, PointRecord& record) {
  if (record.point.errors.empty() || !flickers(context.scene, context.options)) return;
  const Measuring measuring(record.point, "flicker");
  int seeds = 0;  // as many as differ
  for (const ComponentError& error : record.point.errors)
    seeds = std::max(seeds, error.deterministic ? 1 : error.seeds);
  std::vector<std::vector<Measured>> flickers(record.point.errors.size());  // of each error, by seed
  for (int seed = 0; seed < seeds; ++seed) {
    const std::vector<Judged> judged = sequenceOf(context, pipeline, record.point, seed);
    for (std::size_t i = 0; i < flickers.size(); ++i) {
      const ComponentError& error = record.point.errors[i];
      for (const Judged& one : judged)
        if (one.output == error.output && (seed == 0 || !error.deterministic))
          flickers[i].push_back(flickerAgainst(context, one.seeds, error.reference));
    }
  }
  for (std::size_t i = 0; i < flickers.size(); ++i) {
    if (flickers[i].empty()) continue;
    std::vector<double> values;
    for (const Measured& one : flickers[i]) values.push_back(one.value);
    const Measured over = meanOverSeeds(values);
    record.point.errors[i].flicker = {over.value,
                                      std::hypot(flickers[i].front().uncertainty, over.uncertainty)};
  }
}

void countWork(const TimingContext& context, const Pipeline& pipeline, ReportPoint& point,
               const KeptOutputs& kept) {
  const Measuring measuring(point, "work");
  RenderOptions options = renderOptionsOf(context, point);
  options.countWork = true;
  try {
    PipelineExecutor executor(context.device, context.techniques, context.scene, pipeline, options);
    for (const auto& [pass, port] : kept) executor.keepOutput(pass, port);
    FrameResult frame = executor.render(context.options.time, 0, PipelineExecutor::Images::no);
    for (PassRecord& pass : frame.passes) point.passWork[pass.name] = std::move(pass.work);
  } catch (const AbsentError& error) {
    point.whyNotCounted = error.what();
  }
}

}  // namespace lumivox::experiment
