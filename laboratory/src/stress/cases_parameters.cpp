// Parameters at the ends of their ranges. An extreme may be coarse. It is too bad where leaving the light out
// would be better, unless that also holds for the battery's values, or where a voxelizer misses more than
// half of the touched voxels.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stress/case_tools.h"
#include "stress/pass_parameters.h"

namespace lumivox::stress {
namespace {

constexpr double kMissed = 0.5;
/// As bad as leaving the light out, plus the noise of a reference of few samples.
constexpr double kNoise = 1.02;
/// The error of a bounded image never reaches a thousand times the light; that of light growing from step to
/// step does.
constexpr double kGrown = 1e3;

constexpr int kPixels = 48, kReferenceSamples = 64;

/// All other parameters have their cheap values, even in the full battery, since one upper end may take long.
Shot cheapShot(const Pipeline& pipeline) {
  Shot shot;
  shot.width = shot.height = kPixels;
  shot.parameters = batteryValues(pipeline, true);
  return shot;
}

/// Badness of a pipeline at these values: RMSE of each output over that of leaving it out, or the share of
/// touched voxels that are missed; by the output's name. Empty where neither applies.
std::map<std::string, Measured> badnessOf(Bench& bench, const Scene& scene, const Shot& shot) {
  if (makesImages(bench)) return ratiosToNothing(bench, scene, shot, kReferenceSamples);
  const auto error = bench.voxelError(scene, shot);
  if (!error) return {};
  return {{"voxels", {1.0 - error->recall(), 0.0}}};
}

/// Judges `shot` against bounds, or against the battery's values where these already exceed them.
std::optional<Finding> judgedBy(Bench& bench, const Shot& shot, bool isOrdinary) {
  const Scene scene = suitableScene(bench);
  const bool images = makesImages(bench);
  const double bound = images ? 1.0 : kMissed;
  const std::map<std::string, Measured> found = badnessOf(bench, scene, shot);
  if (found.empty()) return notApplicable("neither an output of it has a reference nor does it make voxels");
  std::map<std::string, Measured> ordinary;
  const auto isBad = [&](const auto& one) { return one.second.value > bound; };
  if (!isOrdinary && std::any_of(found.begin(), found.end(), isBad))
    ordinary = badnessOf(bench, scene, cheapShot(bench.pipeline()));
  Finding worst;
  double excess = -1.0;
  for (const auto& [name, badness] : found) {
    const double usual = ordinary.count(name) != 0 ? ordinary.at(name).value : 0.0;
    const double limit = kNoise * std::max(bound, usual);
    if (badness.value / limit <= excess) continue;
    excess = badness.value / limit;
    worst = judged(images ? "RMSE of the worst output over that of leaving it out"
                          : "share of the touched voxels that are missed",
                   badness, limit, images ? "output " + name : std::string());
    if (usual > bound)
      worst.detail += fmt::format("{}with the battery's own values already {:.3g}",
                                  worst.detail.empty() ? "" : ", ", usual);
  }
  if (images && worst.value.value > kGrown) worst.outcome = StressOutcome::diverges;
  return worst;
}

/// Collects the cases; a `Place` puts a value into a shot.
class ParameterCases {
 public:
  using Place = std::function<void(Shot&, const ParameterValue&)>;

  void ordinary() {
    cases_.push_back(
        {{"parameters", "battery_values",
          "all parameters at the values of the quick battery: what the ends are judged against", true},
         [](Bench& bench) { return judgedBy(bench, cheapShot(bench.pipeline()), true); }});
  }
  void range(const std::string& name, double low, double high, bool quick, const Place& place) {
    add(name + "_lowest", fmt::format("{} at the lower end of its range, {}", name, low), quick, place,
        {low, {}, {}});
    add(name + "_highest", fmt::format("{} at the upper end of its range, {}", name, high), false, place,
        {high, {}, {}});
  }
  void words(const std::string& name, const std::vector<std::string>& all, const std::string& standing,
             bool quick, const Place& place) {
    for (const std::string& word : all)
      if (word != standing)
        add(name + "_" + word, fmt::format("{} {}", name, word), quick, place, {0.0, word, {}});
  }
  std::vector<Case> take() { return std::move(cases_); }

 private:
  void add(const std::string& name, const std::string& meaning, bool quick, const Place& place,
           const ParameterValue& value) {
    cases_.push_back({{"parameters", name, meaning, quick}, [=](Bench& bench) {
                        Shot shot = cheapShot(bench.pipeline());
                        place(shot, value);
                        return judgedBy(bench, shot, false);
                      }});
  }
  std::vector<Case> cases_;
};

}  // namespace

std::vector<Case> parameterCases(const Pipeline& pipeline, TechniqueSource& techniques) {
  ParameterCases cases;
  cases.ordinary();
  for (const PipelineParameter& parameter : pipeline.parameters) {
    const std::string& name = parameter.name;
    const auto place = [name](Shot& shot, const ParameterValue& value) { shot.parameters[name] = value; };
    if (!parameter.choices.empty())
      cases.words(name, parameter.choices, parameter.value.text(), true, place);
    else if (parameter.low && parameter.high)
      cases.range(name, *parameter.low, *parameter.high, true, place);
  }
  for (const PassParameter& parameter : freePassParameters(pipeline, techniques)) {
    const std::string& name = parameter.name;
    const auto place = [name](Shot& shot, const ParameterValue& value) { shot.passParameters[name] = value; };
    if (!parameter.words.empty())
      cases.words(name, parameter.words, parameter.value, false, place);
    else
      cases.range(name, parameter.low, parameter.high, false, place);
  }
  return cases.take();
}

}  // namespace lumivox::stress
