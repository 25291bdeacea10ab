// Measuring the set-ups of a published table.
#include "lumivox/report/reproduce.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <set>
#include <tuple>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/report/voxelisers.h"
#include "report/choice.h"
#include "report/measure.h"
#include "report/plan.h"

namespace lumivox {
namespace {

using namespace report;
namespace fs = std::filesystem;

/// One set-up with the rows that it answers.
struct SetUp {
  const Scene* scene = nullptr;
  std::string sceneShown;
  LoadedPipeline loaded;
  PlannedPoint planned;
  ReportOptions options;
  int width = 0, height = 0;
  std::vector<std::size_t> rows;
  KeptOutputs kept;
  StoredRun run;
  std::unique_ptr<TimedPoint> timed;
  std::string failure;
};

class Reproduction {
 public:
  Reproduction(gpu::Device& device, TechniqueSet& techniques, const PublishedTable& table,
               const ReproduceOptions& options, const std::function<Scene(const fs::path&)>& loadScene,
               ResultsStore* store)
      : device_(device), techniques_(techniques), options_(options), loadScene_(loadScene), store_(store) {
    result_.table = table;
    result_.device = device.info();
    result_.host = hostText();
    result_.date = dateText();
    result_.scale = options.scale > 0.0 ? options.scale : device.info().software ? table.softwareScale : 1.0;
    result_.command =
        fmt::format("lumivox reproduce {} --scale {} --repeats {} --seed {}",
                    shellQuoted(shownPath(table.file)), result_.scale, options.repeats, options.seed);
    if (options.truthSamples > 0) result_.command += fmt::format(" --spp {}", options.truthSamples);
    for (const std::string& argument : options.repeatArguments)
      result_.command += " " + shellQuoted(argument);
  }

  ReproducedTable run() {
    for (const PublishedRow& row : result_.table.rows) {
      MeasuredRow measured;
      measured.name = row.name;
      measured.quantity = row.quantity;
      measured.published = row.published;
      measured.whyNot = row.absent.empty() ? row.substitute : row.absent;
      result_.rows.push_back(std::move(measured));
    }
    for (std::size_t i = 0; i < result_.rows.size(); ++i)
      if (result_.table.rows[i].absent.empty()) place(i);
    for (SetUp& setUp : setUps_)
      guarded(setUp, [&] {
        setUp.timed =
            std::make_unique<TimedPoint>(timingOf(setUp), setUp.loaded.pipeline, setUp.run.point, setUp.kept);
      });
    for (int repeat = 0; repeat < options_.repeats; ++repeat)
      for (SetUp& setUp : setUps_) guarded(setUp, [&] { setUp.timed->timeFrame(); });
    for (SetUp& setUp : setUps_) {
      guarded(setUp, [&] {
        setUp.timed->finish();
        for (const std::size_t row : setUp.rows) readOff(setUp, row);
      });
      for (const std::size_t row : setUp.rows) {
        if (setUp.failure.empty()) continue;
        result_.rows[row].whyNot = setUp.failure;
        result_.rows[row].failed = true;
      }
      result_.setUps.push_back(fmt::format("{}, {}: {}, {} x {} pixels", setUp.sceneShown, setUp.loaded.shown,
                                           pointText(setUp.planned.parameters), setUp.width, setUp.height));
    }
    result_.judged = judge(result_.rows);
    if (store_ != nullptr) store();
    return std::move(result_);
  }

 private:
  TimingContext timingOf(const SetUp& setUp) {
    return {device_, techniques_, *setUp.scene, setUp.options, setUp.width, setUp.height};
  }

  /// What a sweep would store: the times, of later frames too, and errors and work, which are measured apart
  /// from them. The verdict stands whether this succeeds or not.
  void store() {
    for (int repeat = 0; repeat < options_.repeats; ++repeat)
      for (SetUp& setUp : setUps_) guarded(setUp, [&] { setUp.timed->timeNextFrame(); });
    for (SetUp& setUp : setUps_) {
      guarded(setUp, [&] { setUp.timed->finish(); });
      setUp.timed.reset();  // its memory, which errors may need
    }
    for (SetUp& setUp : setUps_) store(setUp);
  }

  void store(SetUp& setUp) {
    StoredRun& run = setUp.run;
    for (const auto& [pass, port] : setUp.kept) run.identity.kept.push_back(pass + "." + port);
    std::sort(run.identity.kept.begin(), run.identity.kept.end());
    if (const auto held = store_->find(run.identity.key()); held && held->point.failure.empty()) {
      logInformation("{}: the store has this set-up already, which stays", setUp.loaded.shown);
      return;
    }
    guarded(setUp, [&] {
      PointRecord record;
      record.point = run.point;
      // A pipeline that only times something makes no picture.
      if (!setUp.loaded.pipeline.outputs.empty()) {
        const MeasureContext context{timingOf(setUp), truthOf(setUp)};
        measureErrors(context, setUp.loaded.pipeline, record);
        measureFlicker(context, setUp.loaded.pipeline, record);
      }
      countWork(timingOf(setUp), setUp.loaded.pipeline, {}, record.point, setUp.kept);
      run.point = std::move(record.point);
    });
    run.point.failure = setUp.failure;
    run.created = dateText();
    store_->add(run);
  }

  Truth& truthOf(const SetUp& setUp) {
    std::unique_ptr<Truth>& truth =
        truths_[{setUp.scene, setUp.options.camera, setUp.options.time, setUp.width, setUp.height}];
    if (!truth)
      truth = std::make_unique<Truth>(*setUp.scene, truthOptionsOf(setUp.options, setUp.width, setUp.height));
    return *truth;
  }

  /// One set-up that cannot be measured must not cost the others.
  template <class Work>
  void guarded(SetUp& setUp, const Work& work) {
    if (!setUp.failure.empty()) return;
    try {
      work();
    } catch (const DiagnosticsError&) {
      throw;  // a wrong text
    } catch (const Error& error) {
      setUp.failure = error.what();
      logWarning("{}: {}: {}", result_.table.id, setUp.loaded.shown, error.what());
    }
  }

  /// The scene, read once; null, and why, when its model is not on this machine.
  const Scene* sceneOf(const fs::path& file, std::string& whyNot) {
    const auto [known, isNew] = scenes_.emplace(file, nullptr);
    if (isNew) {
      try {
        known->second = std::make_unique<Scene>(loadScene_(file));
      } catch (const AbsentError& error) {
        whyAbsent_[file] = error.what();
      }
    }
    if (!known->second) whyNot = whyAbsent_[file];
    return known->second.get();
  }

  /// Finds the set-up of a row, or makes it.
  void place(std::size_t index) {
    const PublishedRow& row = result_.table.rows[index];
    MeasuredRow& measured = result_.rows[index];
    std::string obstacle;
    for (const std::string& technique : row.pipeline->techniques())
      if (techniques_.technique(technique) == nullptr)
        obstacle = fmt::format("the technique '{}' is not here", technique);
    const Scene* scene = obstacle.empty() ? sceneOf(row.scene, obstacle) : nullptr;
    if (scene == nullptr) {
      measured.whyNot = obstacle;
      return;
    }
    SetUp& setUp = setUpOf(row, *scene);
    setUp.rows.push_back(index);
    const std::pair<std::string, std::string> output(row.pass, row.port);
    if (!row.pass.empty() && std::find(setUp.kept.begin(), setUp.kept.end(), output) == setUp.kept.end())
      setUp.kept.push_back(output);
  }

  SetUp& setUpOf(const PublishedRow& row, const Scene& scene) {
    ParameterValues parameters;
    for (const PipelineParameter& parameter : row.pipeline->parameters)
      parameters[parameter.name] = parameter.value;
    for (const auto& [name, value] : row.settings) parameters[name] = value;
    for (const PipelineParameter& parameter : row.pipeline->parameters)
      reduce(parameter, parameters[parameter.name]);
    for (SetUp& known : setUps_)
      if (known.scene == &scene && known.loaded.pipeline.file == row.pipeline->file &&
          pointText(known.planned.parameters) == pointText(parameters) &&
          known.options.camera == row.camera && known.options.time == row.time)
        return known;
    SetUp setUp;
    setUp.scene = &scene;
    setUp.sceneShown = shownPath(scene.file);
    setUp.loaded = {*row.pipeline, shownPath(row.pipeline->file), {}};
    setUp.planned.parameters = parameters;
    setUp.options.camera = row.camera;
    setUp.options.time = row.time;
    setUp.options.seed = options_.seed;
    setUp.options.repeats = options_.repeats;
    setUp.options.truthSamples = options_.truthSamples;
    const Camera& camera = scene.camera(row.camera);
    const PublishedTable& table = result_.table;
    setUp.width = reduced(table.width > 0 ? table.width : camera.width);
    setUp.height = reduced(table.width > 0 ? table.height : camera.height);
    setUp.run = storedRunOf(
        device_, techniques_, scene, setUp.loaded, setUp.planned, setUp.options, setUp.width, setUp.height,
        truthOptionsOf(setUp.options, setUp.width, setUp.height).samplesPerPixel, setUp.sceneShown);
    setUp.run.point.command = result_.command;
    setUps_.push_back(std::move(setUp));
    return setUps_.back();
  }

  int reduced(int size) const { return std::max(1, static_cast<int>(std::lround(size * result_.scale))); }

  void reduce(const PipelineParameter& parameter, ParameterValue& value) const {
    const std::vector<std::string>& scaled = result_.table.scaled;
    if (result_.scale == 1.0 || !value.word.empty() ||
        std::find(scaled.begin(), scaled.end(), parameter.name) == scaled.end())
      return;
    value.number = std::round(value.number * result_.scale);
    if (parameter.low) value.number = std::clamp(value.number, *parameter.low, *parameter.high);
  }

  void readOff(SetUp& setUp, std::size_t index) {
    const PublishedRow& row = result_.table.rows[index];
    MeasuredRow& measured = result_.rows[index];
    const ReportPoint& point = setUp.run.point;
    for (const std::string& pass : row.passes) {
      if (std::find(point.passOrder.begin(), point.passOrder.end(), pass) != point.passOrder.end()) continue;
      measured.whyNot = fmt::format("pass '{}' was left out", pass);
      for (const LeftOut& leftOut : setUp.timed->executor().explain().leftOut)
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
        measured.measured = exactly(fragmentsOf(setUp, row));
        return;
      case PublishedQuantity::memory: {
        constexpr double kMegabyte = 1e6;
        double bytes = row.passes.empty() ? static_cast<double>(point.peakBytes) : 0.0;
        for (const std::string& pass : row.passes) bytes += static_cast<double>(point.passBytes.at(pass));
        measured.measured = exactly(bytes / kMegabyte);
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

  double fragmentsOf(const SetUp& setUp, const PublishedRow& row) const {
    const OutBase* output = setUp.timed->executor().output(row.pass, row.port);
    const std::optional<OccupiedVoxels> voxels = output == nullptr ? std::nullopt : occupiedVoxels(*output);
    if (!voxels || voxels->fragments == 0)
      throw Error(
          fmt::format("{}: output {}.{} holds no voxel fragments", row.place.text(), row.pass, row.port));
    return static_cast<double>(voxels->fragments);
  }

  gpu::Device& device_;
  TechniqueSet& techniques_;
  const ReproduceOptions& options_;
  const std::function<Scene(const fs::path&)>& loadScene_;
  ReproducedTable result_;
  std::map<fs::path, std::unique_ptr<Scene>> scenes_;
  std::map<fs::path, std::string> whyAbsent_;
  ResultsStore* store_;
  /// By scene, camera, time and size.
  std::map<std::tuple<const Scene*, std::string, double, int, int>, std::unique_ptr<Truth>> truths_;
  std::deque<SetUp> setUps_;  // points keep references to their records
};

}  // namespace

ReproducedTable reproduce(gpu::Device& device, TechniqueSet& techniques, const PublishedTable& table,
                          const ReproduceOptions& options,
                          const std::function<Scene(const fs::path&)>& loadScene, ResultsStore* store) {
  // Tables whose techniques are all here are checked whole; the others as far as they go.
  const bool complete = std::all_of(table.rows.begin(), table.rows.end(), [&](const PublishedRow& row) {
    if (!row.pipeline) return true;
    const std::vector<std::string> needed = row.pipeline->techniques();
    return std::all_of(needed.begin(), needed.end(),
                       [&](const std::string& name) { return techniques.technique(name) != nullptr; });
  });
  if (complete) checkReproduction(table, techniques);
  return Reproduction(device, techniques, table, options, loadScene, store).run();
}

}  // namespace lumivox
