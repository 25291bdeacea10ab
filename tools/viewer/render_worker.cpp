#include "viewer/render_worker.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/scene/free_camera.h"

namespace lumivox::viewer {
namespace {

PassContract contractOf(const PassText& text, const Pass& pass, TechniqueSource& techniques) {
  PassContract contract{text.name, text.technique, text.pass, {}, {}, {}};
  if (const Technique* technique = techniques.technique(text.technique))
    if (const PassEntry* entry = technique->find(text.pass)) contract.meaning = entry->meaning;
  for (const ParamBase* parameter : pass.parameters()) {
    PassParameter one{parameter->name(),      parameter->meaning(),     parameter->unit(),
                      parameter->valueText(), parameter->defaultText(), parameter->choices()};
    one.integer = parameter->type() == ParamBase::Type::integer;
    one.number = one.integer || parameter->type() == ParamBase::Type::number;
    if (parameter->type() == ParamBase::Type::flag) one.choices = {"off", "on"};
    one.low = parameter->low();
    one.high = parameter->high();
    contract.parameters.push_back(std::move(one));
  }
  for (const OutBase* output : pass.outputs()) {
    PassContract::Port port{output->name(), output->kind().name, {}, drawnFields(output->kind())};
    for (const PortResource& resource : output->kind().resources)
      if (resource.shape != "buffer") port.textures.push_back(resource.name);
    contract.outputs.push_back(std::move(port));
  }
  return contract;
}

/// When each pass runs, from all that it and the passes before it read. The text's input statements connect
/// the passes.
std::map<std::string, RunsWhen> whenPassesRun(const Pipeline& pipeline, const PipelineExecutor& executor) {
  std::map<std::string, Reads> all;
  for (const PassText& text : pipeline.passes) all[text.name] = executor.pass(text.name).readsFrom();
  // Repeated once per pass, so that reads propagate along the longest chain whatever the order in the text.
  for (std::size_t i = 0; i < pipeline.passes.size(); ++i)
    for (const PassText& text : pipeline.passes)
      for (const dsl::Item& item : text.block->items) {
        if (!item.property || item.property->values.empty()) continue;
        const std::string& value = item.property->values.front().text;
        const auto source = all.find(value.substr(0, value.find('.')));
        const std::vector<InBase*>& inputs = executor.pass(text.name).inputs();
        const bool isInput = std::any_of(inputs.begin(), inputs.end(), [&](const InBase* input) {
          return input->name() == item.property->word;
        });
        if (isInput && source != all.end()) all[text.name] = all[text.name] | source->second;
      }
  std::map<std::string, RunsWhen> runs;
  for (const auto& [pass, read] : all) {
    const auto any = [read = read](Reads set) { return (read & set) != Reads::nothing; };
    runs[pass] = any(Reads::camera | Reads::partOfCamera | Reads::lens | Reads::history)
                     ? RunsWhen::everyFrame
                 : any(Reads::geometry | Reads::lights | Reads::media | Reads::capture | Reads::time)
                     ? RunsWhen::somethingMoves
                     : RunsWhen::once;
  }
  return runs;
}

RenderOptions optionsOf(const RenderWish& wish, const Side& side) {
  RenderOptions options;
  options.parameters = side.values;
  options.seed = wish.seed;
  options.keepEverything = wish.keepEverything;
  options.interactive = true;
  return options;
}

/// An executor with the wish that it was made for.
class Executor {
 public:
  Executor(gpu::Device& device, TechniqueSource& techniques, const RenderWish& wish, const Side& side)
      : scene_(wish.scene), pipeline_(side.pipeline), keepsEverything_(wish.keepEverything) {
    values_ = side.values;
    seed_ = wish.seed;
    executor_ =
        std::make_unique<PipelineExecutor>(device, techniques, *scene_, *pipeline_, optionsOf(wish, side));
    readContracts(techniques);
  }

  /// Whether change() suffices to render this wish.
  bool suits(const RenderWish& wish, const Side& side) const {
    return side.pipeline->hash == pipeline_->hash && wish.keepEverything == keepsEverything_;
  }
  void change(const RenderWish& wish, const Side& side, TechniqueSource& techniques) {
    if (wish.scene != scene_) {
      executor_->setScene(*wish.scene);
      scene_ = wish.scene;
    }
    if (side.values != values_) {
      executor_->setParameters(side.values);
      values_ = side.values;
      readContracts(techniques);
    }
    if (wish.seed != seed_) executor_->setSeed(seed_ = wish.seed);
  }

  RenderedSide render(const SceneSnapshot& snapshot) {
    RenderedSide side;
    side.frame = executor_->render(snapshot, 0, PipelineExecutor::Images::yes);
    side.times = times_;
    side.explanation = executor_->explain();
    side.bounces = executor_->indirectBounces();
    side.bytes = executor_->memory().bytes;
    side.contracts = contracts_;
    side.runs = runs_;
    return side;
  }

  /// Renders the frame again with every pass run and timed.
  void time(RenderedSide& side, const SceneSnapshot& snapshot) {
    executor_->invalidate();
    executor_->render(snapshot, 0, PipelineExecutor::Images::no, PipelineExecutor::Timing::passes);
    for (std::vector<PassRecord>& frame : executor_->timedPasses()) times_ = std::move(frame);
    side.times = times_;
    side.timed = true;
    side.explanation = executor_->explain();
  }

  PortPicture port(const PortChoice& choice, const SceneSnapshot& snapshot,
                   const std::function<VoxelView&()>& view) {
    const auto which = std::pair(choice.pass, choice.port);
    if (which != kept_) {
      executor_->keepOnly(choice.pass, choice.port);
      kept_ = which;
      executor_->render(snapshot, 0, PipelineExecutor::Images::no);
    }
    const OutBase* const output = executor_->output(choice.pass, choice.port);
    if (output == nullptr)
      throw Error(
          fmt::format("{}.{} was left out: nothing in the scene asks for it", choice.pass, choice.port));
    return pictureOfPort(output->contents(), choice, snapshot.camera, view);
  }

 private:
  void readContracts(TechniqueSource& techniques) {
    contracts_.clear();
    for (const PassText& text : pipeline_->passes)
      contracts_.push_back(contractOf(text, executor_->pass(text.name), techniques));
    runs_ = whenPassesRun(*pipeline_, *executor_);
  }

  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const Pipeline> pipeline_;
  bool keepsEverything_;
  ParameterValues values_;
  std::uint64_t seed_ = 1;
  std::pair<std::string, std::string> kept_;  ///< the port that is kept after a frame
  std::vector<PassRecord> times_;
  std::vector<PassContract> contracts_;
  std::map<std::string, RunsWhen> runs_;
  std::unique_ptr<PipelineExecutor> executor_;
};

/// Everything that lives on the thread.
class Renderer {
 public:
  explicit Renderer(const gpu::DeviceOptions& options) {
    try {
      device_ = std::make_unique<gpu::Device>(options);
    } catch (const std::exception& error) {
      deviceError_ = error.what();
    }
  }
  ~Renderer() {
    executors_.clear();  // before the libraries and the device
  }

  Rendered render(const RenderWish& wish) {
    Rendered rendered;
    rendered.wish = wish;
    if (device_ == nullptr) {
      for (std::size_t i = 0; i < wish.sides.size(); ++i) rendered.sides.emplace_back().error = deviceError_;
      return rendered;
    }
    rendered.device = device_->info().renderer + ", " + gpu::programRouteText(*device_);
    rendered.software = device_->info().software;
    if (techniques_ == nullptr || wish.techniques != directories_) {
      executors_.clear();
      // Libraries stay loaded, since code of removed passes may still run, for example in destructors.
      if (techniques_ != nullptr) earlier_.push_back(std::move(techniques_));
      techniques_ = std::make_unique<TechniqueSet>(wish.techniques);
      directories_ = wish.techniques;
    }
    rendered.techniques = techniques_->available();
    executors_.resize(wish.sides.size());
    for (std::size_t i = 0; i < wish.sides.size(); ++i) rendered.sides.push_back(renderSide(wish, i));
    for (const SkippedTechnique& one : techniques_->skipped())
      rendered.skipped += (rendered.skipped.empty() ? "" : "\n") + one.library.string() + ": " + one.reason;
    if (wish.port && !executors_.empty() && executors_.front() != nullptr) {
      try {
        rendered.port = executors_.front()->port(*wish.port, snapshotOf(wish), [this]() -> VoxelView& {
          if (voxels_ == nullptr) voxels_ = std::make_unique<VoxelView>(*device_);
          return *voxels_;
        });
      } catch (const std::exception& error) {
        rendered.portError = error.what();
      }
    }
    return rendered;
  }

  /// Whether to time or count this frame. While other wishes wait, this happens at most once per
  /// kLongestUntimed.
  bool wantsMore(const Rendered& rendered, bool othersWait) const {
    const RenderWish& wish = rendered.wish;
    return (wish.timesPasses || wish.countsWork) && device_ != nullptr &&
           (!othersWait || Clock::now() - measured_ > kLongestUntimed);
  }
  /// Times and counts the passes of the last frame.
  void measure(Rendered& rendered) {
    const RenderWish& wish = rendered.wish;
    for (std::size_t i = 0; i < rendered.sides.size(); ++i) {
      if (executors_[i] == nullptr) continue;
      try {
        const SceneSnapshot snapshot = snapshotOf(wish);
        if (wish.timesPasses) executors_[i]->time(rendered.sides[i], snapshot);
        if (wish.countsWork)
          rendered.sides[i].work = countFrame(*device_, *techniques_, *wish.scene, *wish.sides[i].pipeline,
                                              snapshot, optionsOf(wish, wish.sides[i]));
      } catch (const std::exception& error) {
        executors_[i].reset();
        rendered.sides[i].error = error.what();
      }
    }
    measured_ = Clock::now();
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kLongestUntimed{1};  // while wishes follow without a pause

  static SceneSnapshot snapshotOf(const RenderWish& wish) {
    return snapshotFrom(*wish.scene, wish.time, wish.camera, wish.width, wish.height);
  }

  RenderedSide renderSide(const RenderWish& wish, std::size_t index) {
    const Side& side = wish.sides[index];
    std::unique_ptr<Executor>& executor = executors_[index];
    try {
      if (executor != nullptr && executor->suits(wish, side)) {
        executor->change(wish, side, *techniques_);
      } else {
        executor.reset();  // frees its memory first
        executor = std::make_unique<Executor>(*device_, *techniques_, wish, side);
      }
      return executor->render(snapshotOf(wish));
    } catch (const std::exception& error) {
      executor.reset();  // its state is unknown: the next frame makes a new one
      RenderedSide failed;
      failed.error = error.what();
      return failed;
    }
  }

  std::unique_ptr<gpu::Device> device_;
  std::unique_ptr<VoxelView> voxels_;  ///< made when voxels are first shown
  std::string deviceError_;
  std::vector<std::unique_ptr<TechniqueSet>> earlier_;
  std::unique_ptr<TechniqueSet> techniques_;
  std::vector<std::filesystem::path> directories_;
  std::vector<std::unique_ptr<Executor>> executors_;
  Clock::time_point measured_;
};

}  // namespace

const char* wordOf(RunsWhen when) {
  switch (when) {
    case RunsWhen::once:
      return "once";
    case RunsWhen::somethingMoves:
      return "when something moves";
    case RunsWhen::everyFrame:
      break;
  }
  return "when the camera moves";
}

RenderWorker::Work makeRenderWork(const gpu::DeviceOptions& options) {
  return [renderer = std::make_shared<Renderer>(options)](const RenderWish& wish, RenderWorker::Turn& turn) {
    // The picture comes before the times, so that movement stays smooth.
    Rendered rendered = renderer->render(wish);
    if (renderer->wantsMore(rendered, turn.outdated())) {
      turn.give(rendered);
      renderer->measure(rendered);
    }
    turn.give(std::move(rendered));
  };
}

}  // namespace lumivox::viewer
