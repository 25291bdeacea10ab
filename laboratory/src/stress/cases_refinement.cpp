// Refinement: doubles every number that a pipeline declares several times. Errors must fall, or the case
// names what limits them.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "lumivox/base/error.h"
#include "stress/case_tools.h"
#include "stress/measures.h"

namespace lumivox::stress {
namespace {

constexpr double kLongestLevel =
    25.0;  // s; after a slower point no finer one is tried, which may take 8 times as long
constexpr double kTolerance = 0.05;  // relative growth of an error that counts as none

struct Level {
  double value = 0.0;
  Measured error;     ///< of the reference's mean; uncertainty: of the reference's noise
  ImageBuffer image;  ///< that of the judged component; empty where only an error is known
  FrameResult frame;
};

/// Least squares of log y over log x; 0 where fewer than two points are positive.
double slopeOf(const std::vector<double>& x, const std::vector<double>& y) {
  double n = 0.0, sumX = 0.0, sumY = 0.0, sumXx = 0.0, sumXy = 0.0;
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
    if (x[i] <= 0.0 || y[i] <= 0.0) continue;
    const double u = std::log(x[i]), v = std::log(y[i]);
    n += 1.0;
    sumX += u;
    sumY += v;
    sumXx += u * u;
    sumXy += u * v;
  }
  const double spread = n * sumXx - sumX * sumX;
  return n < 2.0 || spread <= 0.0 ? 0.0 : (n * sumXy - sumX * sumY) / spread;
}

/// Doublings from a quarter of the declared value on.
std::vector<double> valuesOf(const PipelineParameter& parameter, bool quick) {
  const double first = parameter.value.number / 4.0;
  std::vector<double> values;
  for (int i = 0; i < (quick ? 3 : 5); ++i) {
    const double value = std::ldexp(first, i);
    // Numbers written as integers are counts.
    const double rounded = parameter.value.number == std::round(parameter.value.number)
                               ? std::max(1.0, std::round(value))
                               : value;
    if ((parameter.low && rounded < *parameter.low) || (parameter.high && rounded > *parameter.high))
      continue;
    if (values.empty() || rounded > values.back()) values.push_back(rounded);
  }
  return values;
}

/// Names the term that limits the error.
std::string limitingTerm(const std::vector<Level>& levels, const std::vector<double>& values,
                         const std::vector<double>& errors, const std::vector<double>& changes) {
  const Measured& last = levels.back().error;
  const double before = errors[errors.size() - 2];
  if (last.value < (1.0 - 2.0 * kTolerance) * before)
    return fmt::format("none yet, the error falls as the power {:.2g} of it", slopeOf(values, errors));
  if (last.uncertainty > 0.5 * last.value) return "the reference's own noise";
  if (changes.empty()) return "the method itself";
  if (changes.back() < 0.02) return "the method's own model: this parameter hardly changes the image";
  if (changes.back() < 0.5 * last.value)
    return fmt::format("the method's own model: its images come together {:.2g} away from the reference",
                       last.value);
  return "its images do not come together yet";
}

Finding judge(const std::string& name, const std::string& subject, const std::vector<Level>& levels,
              const std::string& remark) {
  std::vector<double> values, errors, changes, coarser;
  std::string detail = fmt::format("{} and error of {}:", name, subject);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    values.push_back(levels[i].value);
    errors.push_back(levels[i].error.value);
    detail += fmt::format("{} {:g} {:.3g}", i == 0 ? "" : ",", levels[i].value, levels[i].error.value);
    if (i == 0 || levels[i].image.empty()) continue;
    coarser.push_back(levels[i - 1].value);
    changes.push_back(relativeDifference(levels[i].image, levels[i - 1].image));
  }
  if (!changes.empty()) {
    detail += "; changes of the image from one to the next:";
    for (const double change : changes) detail += fmt::format(" {:.3g}", change);
    if (changes.size() > 1) detail += fmt::format(", as the power {:.2g} of it", slopeOf(coarser, changes));
  }
  const Measured &first = levels.front().error, &last = levels.back().error;
  detail += fmt::format("; the reference's noise is {:.2g}; limiting term: {}", last.uncertainty,
                        limitingTerm(levels, values, errors, changes));
  if (!remark.empty()) detail += "; " + remark;
  const double smallest = std::max(first.value, std::max(first.uncertainty, 1e-6));
  // Growth within the reference's noise does not count.
  const double noise = 2.0 * last.uncertainty / smallest;
  Finding finding =
      judged(fmt::format("error at the largest {} over the error at the smallest", name),
             {last.value / smallest, last.uncertainty / smallest}, 1.0 + std::max(kTolerance, noise), detail);
  if (finding.outcome == StressOutcome::biased && changes.size() > 1 &&
      changes.back() > 2.0 * changes.front() && changes.back() > changes[changes.size() - 2])
    finding.outcome = StressOutcome::diverges;
  return finding;
}

/// The Cornell box seen from below its light, which would outshine all other light. Full: with a light of
/// each kind of shadow; quick: with the cheap one.
Scene roomOf(const Bench& bench) {
  return bench.sceneFromText(
      fmt::format(R"(scene "Cornell box without its light in sight" {{
  camera main {{ eye 0.278 0.4 -0.5  target 0.278 0.15 0.3  fov 45 deg  resolution 48 48 }}
  mesh room {{ file "../models/cornell.obj" }}
  light beam spot {{ position 0.3 0.5 0.2  direction -0.1 -1 0.3  intensity 1  inner 15 deg  outer 40 deg }}
  {}
}}
)",
                  bench.quick() ? "" : "light lamp area { mesh room/ceiling_lamp  radiance 8 6 4 }"));
}

/// The effect of a parameter on the images or voxels of a pipeline.
class Refinement {
 public:
  Refinement(Bench& bench, std::string name) : bench_(bench), name_(std::move(name)), scene_(roomOf(bench)) {
    if (!makesImages(bench)) return;
    Shot small;
    small.width = small.height = 8;
    if (hasComponent(bench.render(scene_, small).result, Contributes::scattered))
      scene_ = bench.committedScene("smoke");
  }

  /// Renders one value of the parameter; nullopt where there is nothing to compare.
  std::optional<Level> at(double value) {
    Shot shot = shotOf(value);
    if (makesImages(bench_)) {
      Level level{value, {}, {}, {}};
      const Frame frame = bench_.render(scene_, shot);
      level.frame = frame.result;
      bench_.show(frame.whole);
      return level;
    }
    const auto error = bench_.voxelError(scene_, shot);
    if (!error) return std::nullopt;
    const double wrong = static_cast<double>(error->falsePositive + error->falseNegative);
    const double all = static_cast<double>(error->truePositive + error->falseNegative);
    return Level{value, {wrong / std::max(all, 1.0), 0.0}, {}, {}};
  }

  /// Fills in the errors of the output that the parameter changes most, against the reference of its
  /// component. Returns its name; empty where no output has a reference.
  std::string judgeImages(std::vector<Level>& levels) {
    const FrameResult &coarse = levels.front().frame, &fine = levels.back().frame;
    std::string chosen;
    double most = -1.0;
    for (const auto& [output, component] : fine.components) {
      if (component == Contributes::final || ownLayer(fine, output).empty()) continue;
      if (!(meanOf(fine.outputs.at(output)) > 0.0)) continue;
      const double change = relativeDifference(coarse.outputs.at(output), fine.outputs.at(output));
      if (change <= most) continue;
      most = change;
      chosen = output;
    }
    if (chosen.empty()) return chosen;
    const LayeredImage reference =
        bench_.reference(scene_, shotOf(levels.front().value), bench_.quick() ? 1024 : 2048);
    const auto layer = referenceLayer(reference, ownLayer(fine, chosen));
    if (!layer) return {};
    for (Level& level : levels) {
      level.image = level.frame.outputs.at(chosen);
      level.error = differenceFromReference(level.image, *layer);
    }
    return chosen;
  }

 private:
  Shot shotOf(double value) const {
    Shot shot;
    shot.parameters[name_].number = value;
    shot.subpixels = 4;
    return shot;
  }

  Bench& bench_;
  std::string name_;
  Scene scene_;
};

std::optional<Finding> refined(Bench& bench, const PipelineParameter& parameter) {
  Refinement refinement(bench, parameter.name);
  std::vector<Level> levels;
  std::string remark;
  for (const double value : valuesOf(parameter, bench.quick())) {
    const auto start = std::chrono::steady_clock::now();
    try {
      const std::optional<Level> level = refinement.at(value);
      if (!level) return notApplicable("it makes neither an image nor voxels");
      levels.push_back(*level);
    } catch (const Error& refusal) {
      // A value that exceeds the device ends the refinement; the first two must be possible.
      if (levels.size() < 2) throw;
      remark = fmt::format("{} {:g} was refused: {}", parameter.name, value, refusal.what());
      break;
    }
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    if (taken.count() > kLongestLevel && levels.size() > 1) {
      remark = fmt::format("no larger value was tried: the last one took {:.0f} s", taken.count());
      break;
    }
  }
  if (levels.size() < 2) return notApplicable(parameter.name + " cannot be doubled within its range");
  std::string subject = "voxels";
  if (makesImages(bench)) {
    subject = refinement.judgeImages(levels);
    if (subject.empty()) return notApplicable("no output that has a reference shines here");
  }
  return judge(parameter.name, subject, levels, remark);
}

bool isNumber(const PipelineParameter& parameter) {
  return parameter.value.word.empty() && parameter.choices.empty();
}

}  // namespace

std::vector<Case> refinementCases(const Pipeline& pipeline) {
  std::vector<Case> cases;
  for (const PipelineParameter& parameter : pipeline.parameters) {
    if (!isNumber(parameter)) continue;
    cases.push_back(
        {{"refinement", "refine_" + parameter.name,
          fmt::format("{} is doubled again and again: the error against the reference falls, or what "
                      "limits it is named",
                      parameter.name),
          cases.empty()},
         [parameter](Bench& bench) { return refined(bench, *bench.parameter(parameter.name)); }});
  }
  return cases;
}

}  // namespace lumivox::stress
