// Measures the set-ups of a published table or figure and renders the panels of a figure.
#include "lumivox/experiment/reproduce.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <tuple>

#include "base/process.h"
#include "experiment/choice.h"
#include "experiment/claimed_values.h"
#include "experiment/gathered_voxels.h"
#include "experiment/measure.h"
#include "experiment/plan.h"
#include "experiment/reproduction_steps.h"
#include "experiment/turns.h"
#include "lumivox/analysis/judge.h"
#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/experiment/voxelizers.h"
#include "lumivox/measure/exposure.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/ports.h"
#include "lumivox/results/text.h"

namespace lumivox {
namespace {

using namespace experiment;
namespace fs = std::filesystem;

/// A set-up with the rows and points that it gives values for.
struct TimedSetUp {
  const Scene* scene = nullptr;
  std::string sceneShown;
  LoadedPipeline loaded;
  PlannedPoint planned;
  ReportOptions options;
  int width = 0, height = 0;
  int subdivisions = 0;
  std::vector<std::pair<const PublishedSetUp*, MeasuredSetUp*>> answers;
  KeptOutputs kept;
  StoredRun run;
  std::string failure;
};

class Reproduction {
 public:
  Reproduction(gpu::Device& device, TechniqueSet& techniques, const PublishedResult& published,
               const ReproduceOptions& options, const std::function<Scene(const fs::path&)>& loadScene,
               ResultsStore* store)
      : device_(device),
        techniques_(techniques),
        options_(options),
        loadScene_(loadScene),
        store_(store),
        steps_(options, store != nullptr) {
    result_.published = published;
    result_.device = device.info();
    result_.host = hostText();
    result_.date = dateText();
    result_.repeats = options.repeats;
    result_.scale = options.scale > 0.0      ? options.scale
                    : device.info().software ? published.softwareScale
                                             : 1.0;
    result_.command =
        fmt::format("lumivox reproduce {} --scale {} --repeats {} --seed {}",
                    shellQuoted(shownPath(published.file)), result_.scale, options.repeats, options.seed);
    if (options.referenceSamples > 0) result_.command += fmt::format(" --spp {}", options.referenceSamples);
    for (const std::string& argument : options.repeatArguments)
      result_.command += " " + shellQuoted(argument);
  }

  ReproducedResult run() {
    for (const PublishedRow& row : result_.published.rows) {
      MeasuredRow measured;
      measured.name = row.name;
      measured.quantity = row.quantity;
      measured.published = row.published;
      measured.over = row.over;
      result_.rows.push_back(std::move(measured));
    }
    for (const PublishedCurve& curve : result_.published.curves)
      result_.curves.push_back({curve.name, curve.over, curve.points.front().quantity, curve.growth,
                                std::vector<MeasuredPoint>(curve.points.size())});
    // From here on measured rows keep their addresses.
    for (std::size_t i = 0; i < result_.rows.size(); ++i) place(result_.published.rows[i], result_.rows[i]);
    for (std::size_t i = 0; i < result_.curves.size(); ++i) placeCurve(i);
    std::vector<std::string> names;
    for (const TimedSetUp& setUp : setUps_) names.push_back(nameOf(setUp));
    std::vector<bool> traced;
    for (const PublishedPanel& panel : result_.published.panels) traced.push_back(!panel.reference.empty());
    steps_.expect(names, traced);
    time();
    for (const MeasuredCurve& curve : result_.curves) result_.judgedCurves.push_back(judgeGrowth(curve));
    result_.judged = judge(result_.rows);
    if (store_ != nullptr) store();
    setUps_.clear();  // frees their memory, which images may need
    for (const PublishedPanel& panel : result_.published.panels) {
      const Clock::time_point start = Clock::now();
      result_.panels.push_back(show(panel));
      steps_.shownPanel(start);
    }
    for (const PublishedClaim& claim : result_.published.claims) {
      result_.claims.push_back(compared(claim));
      result_.judgedClaims.push_back(judgeClaim(result_.claims.back()));
    }
    result_.exposure = meter_.exposure();
    return std::move(result_);
  }

 private:
  using Clock = ReproductionSteps::Clock;

  static std::string nameOf(const TimedSetUp& setUp) {
    return fmt::format("{}, camera {} at {} s", shownSetUp(setUp), setUp.options.camera, setUp.options.time);
  }

  void time() {
    std::vector<Turn> turns;
    for (TimedSetUp& setUp : setUps_)
      turns.push_back({setUp.loaded.shown,
                       [&](const std::shared_ptr<TransientMemory>& memory) {
                         TimingContext context = timingOf(setUp);
                         context.transientMemory = memory;
                         const Clock::time_point start = Clock::now();
                         TimedPoint timed(context, setUp.loaded.pipeline, setUp.run.point, setUp.kept);
                         steps_.opened(nameOf(setUp), start);
                         return timed;
                       },
                       [&](TimedPoint& timed) {
                         for (const auto& [published, measured] : setUp.answers)
                           readOff(setUp, timed.executor(), *published, *measured);
                         steps_.timed(nameOf(setUp));
                       }});
    // A store holds the times of following frames, too.
    timeInTurns(device_, turns, options_.repeats, store_ == nullptr ? 0 : options_.repeats);
    for (std::size_t i = 0; i < turns.size(); ++i) {
      TimedSetUp& setUp = setUps_[i];
      setUp.failure = turns[i].failure;
      if (!setUp.failure.empty()) steps_.timed(nameOf(setUp));
      if (!setUp.failure.empty())
        logWarning("{}: {}: {}", result_.published.id, setUp.loaded.shown, setUp.failure);
      for (const auto& [published, measured] : setUp.answers) {
        if (setUp.failure.empty()) continue;
        measured->whyNot = setUp.failure;
        measured->failed = true;
      }
      result_.setUps.push_back(shownSetUp(setUp));
    }
  }

  static std::string shownSetUp(const TimedSetUp& setUp) {
    return fmt::format("{}{}, {}: {}, {} x {} pixels", setUp.sceneShown,
                       setUp.subdivisions == 0 ? std::string()
                                               : fmt::format(" with every triangle split into four, {} times",
                                                             setUp.subdivisions),
                       setUp.loaded.shown, pointText(setUp.planned.parameters), setUp.width, setUp.height);
  }

  TimingContext timingOf(const TimedSetUp& setUp) {
    return {device_, techniques_, *setUp.scene, setUp.options, setUp.width, setUp.height};
  }

  /// Stores the points as a sweep would: times, and errors and work measured apart from them. The verdict
  /// does not depend on its success.
  void store() {
    // No sweep could name a scene that was subdivided here.
    for (TimedSetUp& setUp : setUps_) {
      const Clock::time_point start = Clock::now();
      const bool isNew = setUp.subdivisions == 0 && store(setUp);
      steps_.stored(nameOf(setUp), start, isNew);
    }
  }

  /// False where the store has it already.
  bool store(TimedSetUp& setUp) {
    StoredRun& run = setUp.run;
    for (const auto& [pass, port] : setUp.kept) run.identity.kept.push_back(pass + "." + port);
    std::sort(run.identity.kept.begin(), run.identity.kept.end());
    if (const auto held = store_->find(run.identity.key()); held && held->point.failure.empty()) {
      logInformation("{}: the store already has this set-up, which is kept", setUp.loaded.shown);
      return false;
    }
    guarded(setUp, [&] {
      PointRecord record;
      record.point = run.point;
      // A pipeline that is only timed may make no image.
      if (!setUp.loaded.pipeline.outputs.empty()) {
        const MeasureContext context{timingOf(setUp), referenceOf(setUp)};
        measureErrors(context, setUp.loaded.pipeline, record);
        measureFlicker(context, setUp.loaded.pipeline, record);
        VoxelReferences references(*setUp.scene, setUp.options.time, setUp.options.camera, setUp.width,
                                   setUp.height);
        judgeVoxels(context, setUp.loaded.pipeline, references, record.point);
      }
      countWork(timingOf(setUp), setUp.loaded.pipeline, record.point, setUp.kept);
      run.point = std::move(record.point);
    });
    run.point.failure = setUp.failure;
    run.created = dateText();
    store_->add(run);
    return true;
  }

  SceneReference& referenceOf(const TimedSetUp& setUp) {
    std::unique_ptr<SceneReference>& reference =
        references_[{setUp.scene, setUp.options.camera, setUp.options.time, setUp.width, setUp.height}];
    if (!reference)
      reference = std::make_unique<SceneReference>(
          *setUp.scene, referenceOptionsOf(setUp.options, setUp.width, setUp.height));
    return *reference;
  }

  /// A set-up that cannot be measured must not cost the others.
  template <class Work>
  void guarded(TimedSetUp& setUp, const Work& work) {
    if (!setUp.failure.empty()) return;
    try {
      work();
    } catch (const DiagnosticsError&) {
      throw;  // a wrong text
    } catch (const Error& error) {
      setUp.failure = error.what();
      logWarning("{}: {}: {}", result_.published.id, setUp.loaded.shown, error.what());
    }
  }

  /// The scene, read once; null with the reason where its model is absent.
  const Scene* sceneOf(const PublishedSetUp& published, std::string& whyNot) {
    const auto [known, isNew] = scenes_.emplace(std::pair(published.scene, published.subdivisions), nullptr);
    if (isNew) {
      try {
        Scene scene = loadScene_(published.scene);
        for (int times = 0; times < published.subdivisions; ++times) scene = subdivided(scene);
        known->second = std::make_unique<Scene>(std::move(scene));
      } catch (const AbsentError& error) {
        whyAbsent_[published.scene] = error.what();
      }
    }
    if (!known->second) whyNot = whyAbsent_[published.scene];
    return known->second.get();
  }

  /// The scene of a set-up with all its parts present, else null with the reason.
  const Scene* sceneWithAll(const PublishedSetUp& published, std::string& whyNot) {
    if (published.pipeline)
      for (const std::string& technique : published.pipeline->techniques())
        if (techniques_.technique(technique) == nullptr) {
          whyNot = fmt::format("the technique '{}' is not available", technique);
          return nullptr;
        }
    return sceneOf(published, whyNot);
  }

  void place(const PublishedSetUp& published, MeasuredSetUp& measured) {
    measured.whyNot = published.absent.empty() ? published.substitute : published.absent;
    if (!published.absent.empty()) return;
    const Scene* scene = sceneWithAll(published, measured.whyNot);
    if (scene == nullptr) return;
    TimedSetUp& setUp = setUpOf(published, *scene);
    setUp.answers.emplace_back(&published, &measured);
    const std::pair<std::string, std::string> output(published.pass, published.port);
    if (!published.pass.empty() &&
        std::find(setUp.kept.begin(), setUp.kept.end(), output) == setUp.kept.end())
      setUp.kept.push_back(output);
  }

  void placeCurve(std::size_t index) {
    const PublishedCurve& curve = result_.published.curves[index];
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
      const PublishedSetUp& published = curve.points[i];
      MeasuredPoint& point = result_.curves[index].points[i];
      place(published, point);
      std::string whyNot;
      if (curve.over != "triangles") {
        point.x = published.pipeline ? parametersOf(published).at(curve.over).number
                                     : std::numeric_limits<double>::quiet_NaN();
      } else if (const Scene* scene = published.absent.empty() ? sceneOf(published, whyNot) : nullptr) {
        point.x = static_cast<double>(scene->triangleCount());
      } else {
        point.x = std::numeric_limits<double>::quiet_NaN();
      }
    }
  }

  /// All parameters of the pipeline, reduced as the set-up says.
  ParameterValues parametersOf(const PublishedSetUp& published) const {
    ParameterValues parameters;
    for (const PipelineParameter& parameter : published.pipeline->parameters)
      parameters[parameter.name] = parameter.value;
    for (const auto& [name, value] : published.settings) parameters[name] = value;
    for (const PipelineParameter& parameter : published.pipeline->parameters)
      reduce(parameter, parameters[parameter.name]);
    return parameters;
  }

  TimedSetUp& setUpOf(const PublishedSetUp& published, const Scene& scene) {
    const ParameterValues parameters = parametersOf(published);
    for (TimedSetUp& known : setUps_)
      if (known.scene == &scene && known.loaded.pipeline.file == published.pipeline->file &&
          pointText(known.planned.parameters) == pointText(parameters) &&
          known.options.camera == published.camera && known.options.time == published.time)
        return known;
    setUps_.push_back(newSetUp(published, scene, parameters));
    return setUps_.back();
  }

  TimedSetUp newSetUp(const PublishedSetUp& published, const Scene& scene,
                      const ParameterValues& parameters) {
    TimedSetUp setUp;
    setUp.scene = &scene;
    setUp.subdivisions = published.subdivisions;
    setUp.sceneShown = shownPath(scene.file);
    setUp.loaded = {*published.pipeline, shownPath(published.pipeline->file), {}};
    setUp.planned.parameters = parameters;
    setUp.options.repeats = options_.repeats;
    std::tie(setUp.width, setUp.height) = sizeOf(published, scene);
    setUp.options.camera = published.camera;
    setUp.options.time = published.time;
    setUp.options.seed = options_.seed;
    setUp.options.referenceSamples = options_.referenceSamples;
    setUp.run = storedRunOf(
        device_, techniques_, scene, setUp.loaded, setUp.planned, setUp.options, setUp.width, setUp.height,
        referenceOptionsOf(setUp.options, setUp.width, setUp.height).samplesPerPixel, setUp.sceneShown);
    setUp.run.point.command = result_.command;
    return setUp;
  }

  std::pair<int, int> sizeOf(const PublishedSetUp& published, const Scene& scene) const {
    const Camera& camera = scene.camera(published.camera);
    const PublishedResult& whole = result_.published;
    return {reduced(whole.width > 0 ? whole.width : camera.width),
            reduced(whole.width > 0 ? whole.height : camera.height)};
  }

  int reduced(int size) const { return std::max(1, static_cast<int>(std::lround(size * result_.scale))); }

  void reduce(const PipelineParameter& parameter, ParameterValue& value) const {
    const std::vector<std::string>& scaled = result_.published.scaled;
    if (result_.scale == 1.0 || !value.word.empty() ||
        std::find(scaled.begin(), scaled.end(), parameter.name) == scaled.end())
      return;
    value.number = std::round(value.number * result_.scale);
    if (parameter.low) value.number = std::clamp(value.number, *parameter.low, *parameter.high);
  }

  void readOff(const TimedSetUp& setUp, const PipelineExecutor& executor, const PublishedSetUp& row,
               MeasuredSetUp& measured) {
    const ReportPoint& point = setUp.run.point;
    for (const std::string& pass : row.passes) {
      if (std::find(point.passOrder.begin(), point.passOrder.end(), pass) != point.passOrder.end()) continue;
      measured.whyNot = fmt::format("pass '{}' was left out", pass);
      for (const LeftOut& leftOut : executor.explain().leftOut)
        if (leftOut.level == LeftOut::Level::pass && leftOut.pass == pass)
          measured.whyNot += ": " + leftOut.why;
      return;
    }
    switch (row.quantity) {
      case PublishedQuantity::time:
      case PublishedQuantity::frameRate:
        measured.measured = row.passes.empty() ? point.frameMs : sumOf(point.passDeviceMs, row.passes);
        return;
      case PublishedQuantity::fragments:
        measured.measured = exactly(fragmentsOf(executor, row));
        return;
      case PublishedQuantity::memory: {
        constexpr double kMegabyte = 1e6;
        double bytes = 0.0;
        if (row.passes.empty())
          bytes =
              static_cast<double>(row.pass.empty() ? point.peakBytes : heldBytes(outputOf(executor, row)));
        for (const std::string& pass : row.passes) bytes += static_cast<double>(point.passBytes.at(pass));
        measured.measured = exactly(bytes / kMegabyte);
        return;
      }
      case PublishedQuantity::voxelBytes: {
        const OutBase& output = outputOf(executor, row);
        const std::optional<std::uint64_t> voxels = opaqueVoxels(output);
        if (!voxels || *voxels == 0)
          throw Error(fmt::format("{}: output {}.{} has no voxels with an opacity", row.place.text(),
                                  row.pass, row.port));
        measured.measured = exactly(static_cast<double>(heldBytes(output)) / static_cast<double>(*voxels));
        return;
      }
    }
  }

  static TimingStatistics exactly(double value) { return {value, value, value, value, value, 1}; }

  static TimingStatistics sumOf(const std::map<std::string, TimingStatistics>& times,
                                const std::vector<std::string>& passes) {
    TimingStatistics sum;
    for (const std::string& pass : passes) {
      const TimingStatistics& one = times.at(pass);
      sum.median += one.median;
      sum.lowerQuartile += one.lowerQuartile;
      sum.upperQuartile += one.upperQuartile;
      sum.smallest += one.smallest;
      sum.largest += one.largest;
      sum.repeats = one.repeats;
    }
    return sum;
  }

  static const OutBase& outputOf(const PipelineExecutor& executor, const PublishedSetUp& row) {
    const OutBase* output = row.pass.empty() ? nullptr : executor.output(row.pass, row.port);
    if (output == nullptr)
      throw Error(fmt::format("{}: no output whose bytes could be counted; expected 'output PASS.PORT'",
                              row.place.text()));
    return *output;
  }

  static double fragmentsOf(const PipelineExecutor& executor, const PublishedSetUp& row) {
    const OutBase* output = executor.output(row.pass, row.port);
    const std::optional<OccupiedVoxels> voxels = output == nullptr ? std::nullopt : occupiedVoxels(*output);
    if (!voxels || voxels->fragments == 0)
      throw Error(
          fmt::format("{}: output {}.{} has no voxel fragments", row.place.text(), row.pass, row.port));
    return static_cast<double>(voxels->fragments);
  }

  // ---- images

  ShownPanel show(const PublishedPanel& panel) {
    ShownPanel shown;
    shown.name = panel.name;
    shown.whyNot = panel.absent.empty() ? panel.substitute : panel.absent;
    shown.meanLuminance = std::numeric_limits<double>::quiet_NaN();
    const Scene* scene = panel.absent.empty() ? sceneWithAll(panel, shown.whyNot) : nullptr;
    if (scene == nullptr) return shown;
    try {
      shown.image = panel.reference.empty() ? rendered(panel, *scene, shown) : traced(panel, *scene, shown);
    } catch (const DiagnosticsError&) {
      throw;  // a wrong text
    } catch (const Error& error) {
      shown.whyNot = error.what();
      shown.failed = true;
      logWarning("{}: {}: {}", result_.published.id, panel.name, error.what());
    }
    if (!shown.image.empty()) {
      // A pass may make images that are not the camera's, of another size.
      const auto [width, height] = sizeOf(panel, *scene);
      meterImage(meter_, *scene, snapshotOf(*scene, panel.time, panel.camera, width, height), shown.image);
      const ImageBuffer bright = luminance(shown.image);
      const Health health = scanHealth(bright.values().data(), bright.values().size(), 1);
      shown.radiance = shown.image.isRadiance();
      shown.meanLuminance =
          health.sum / static_cast<double>(bright.pixelCount() - health.nan - health.infinite);
    }
    return shown;
  }

  const ShownPanel& panelNamed(const std::string& name) const {
    return *std::find_if(result_.panels.begin(), result_.panels.end(),
                         [&](const ShownPanel& panel) { return panel.name == name; });
  }

  /// Both panels of a claim, by the same pixels.
  MeasuredClaim compared(const PublishedClaim& claim) const {
    MeasuredClaim measured;
    static_cast<PublishedClaim&>(measured) = claim;
    measured.lessValue = measured.thanValue = std::numeric_limits<double>::quiet_NaN();
    const ShownPanel &less = panelNamed(claim.less), &than = panelNamed(claim.than),
                     &dark = panelNamed(claim.darkIn.empty() ? claim.less : claim.darkIn);
    for (const ShownPanel* panel : {&less, &than, &dark}) {
      if (measured.whyNot.empty() && !panel->whyNot.empty())
        measured.whyNot = fmt::format("panel '{}': {}", panel->name, panel->whyNot);
      if (panel->image.empty()) return measured;
      if (panel->image.width() != less.image.width() || panel->image.height() != less.image.height()) {
        measured.whyNot = fmt::format("panels '{}' and '{}' have different sizes", less.name, panel->name);
        return measured;
      }
    }
    const std::vector<std::size_t> pixels = comparedPixels(dark.image, !claim.darkIn.empty());
    measured.lessValue = claimedValue(less.image, pixels, claim.quantity);
    measured.thanValue = claimedValue(than.image, pixels, claim.quantity);
    return measured;
  }

  ImageBuffer rendered(const PublishedPanel& panel, const Scene& scene, ShownPanel& shown) {
    const TimedSetUp setUp = newSetUp(panel, scene, parametersOf(panel));
    RenderOptions options;
    options.parameters = setUp.planned.parameters;
    options.camera = panel.camera;
    options.width = setUp.width;
    options.height = setUp.height;
    options.seed = options_.seed;
    options.wantsOutputs = panel.pass.empty();
    PipelineExecutor executor(device_, techniques_, scene, setUp.loaded.pipeline, options);
    if (!panel.pass.empty()) executor.keepOutput(panel.pass, panel.port);
    const std::string set = shownSetUp(setUp);
    if (std::find(result_.setUps.begin(), result_.setUps.end(), set) == result_.setUps.end())
      result_.setUps.push_back(set);
    if (panel.pass.empty()) {
      ImageBuffer whole = compositeImage(executor.render(panel.time));
      if (whole.empty())
        throw Error(
            fmt::format("{}: pipeline \"{}\" makes no image; expected an output PASS.PORT of the panel",
                        panel.place.text(), setUp.loaded.pipeline.name));
      return whole;
    }
    executor.render(panel.time, 0, PipelineExecutor::Images::no);
    const OutBase* output = executor.output(panel.pass, panel.port);
    if (output == nullptr || !output->hasValue()) {
      shown.whyNot = fmt::format("{}.{} was left out", panel.pass, panel.port);
      for (const LeftOut& leftOut : executor.explain().leftOut)
        if (leftOut.pass == panel.pass) shown.whyNot += ": " + leftOut.why;
      return {};
    }
    const auto* image = dynamic_cast<const Out<Image>*>(output);
    if (image == nullptr)
      throw Error(fmt::format("{}: {}.{} is not an image", panel.place.text(), panel.pass, panel.port));
    return imageOf(*image);
  }

  ImageBuffer traced(const PublishedPanel& panel, const Scene& scene, ShownPanel& shown) {
    TimedSetUp setUp;
    setUp.scene = &scene;
    std::tie(setUp.width, setUp.height) = sizeOf(panel, scene);
    setUp.options.camera = panel.camera;
    setUp.options.time = panel.time;
    setUp.options.seed = options_.seed;
    setUp.options.referenceSamples = options_.referenceSamples;
    result_.setUps.push_back(fmt::format(
        "{}, path-traced reference ({}): {} samples a pixel, {} x {} pixels", shownPath(scene.file),
        panel.reference, referenceOptionsOf(setUp.options, setUp.width, setUp.height).samplesPerPixel,
        setUp.width, setUp.height));
    const ReferenceLayer* layer = referenceOf(setUp).layer(panel.reference);
    if (layer == nullptr) {
      shown.whyNot = fmt::format("the reference of this scene has no layer {}", panel.reference);
      return {};
    }
    return layer->mean;
  }

  gpu::Device& device_;
  TechniqueSet& techniques_;
  const ReproduceOptions& options_;
  const std::function<Scene(const fs::path&)>& loadScene_;
  ReproducedResult result_;
  ExposureMeter meter_;
  std::map<std::pair<fs::path, int>, std::unique_ptr<Scene>> scenes_;  // by file and subdivisions
  std::map<fs::path, std::string> whyAbsent_;
  ResultsStore* store_;
  ReproductionSteps steps_;
  /// By scene, camera, time and size.
  std::map<std::tuple<const Scene*, std::string, double, int, int>, std::unique_ptr<SceneReference>>
      references_;
  std::deque<TimedSetUp> setUps_;  // points keep references to their records
};

}  // namespace

bool ReproducedResult::failed() const {
  const auto bad = [](const auto& one) { return one.failed; };
  return std::any_of(rows.begin(), rows.end(), bad) || std::any_of(panels.begin(), panels.end(), bad) ||
         std::any_of(curves.begin(), curves.end(), [&](const MeasuredCurve& curve) {
           return std::any_of(curve.points.begin(), curve.points.end(), bad);
         });
}

ReproducedResult reproduce(gpu::Device& device, TechniqueSet& techniques, const PublishedResult& published,
                           const ReproduceOptions& options,
                           const std::function<Scene(const fs::path&)>& loadScene, ResultsStore* store) {
  // Texts whose techniques are all here are checked whole; the others as far as they go.
  const std::vector<const PublishedSetUp*> setUps = published.setUps();
  const bool complete = std::all_of(setUps.begin(), setUps.end(), [&](const PublishedSetUp* one) {
    if (!one->pipeline) return true;
    const std::vector<std::string> needed = one->pipeline->techniques();
    return std::all_of(needed.begin(), needed.end(),
                       [&](const std::string& name) { return techniques.technique(name) != nullptr; });
  });
  if (complete) checkReproduction(published, techniques);
  return Reproduction(device, techniques, published, options, loadScene, store).run();
}

std::vector<fs::path> committedReproductions() {
  std::vector<fs::path> files;
  const auto scenes = committedScenes();
  if (!scenes) return files;
  std::error_code failure;
  for (const fs::directory_entry& entry : fs::directory_iterator(*scenes / "reproductions", failure))
    if (entry.path().extension() == ".reproduction" && entry.is_regular_file(failure))
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace lumivox
