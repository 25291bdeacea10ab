// Measures the passes of pipelines in turns, and prints the figures.
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/measure/power_law.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "spread.h"

namespace lumivox {

using Times = std::map<std::string, double>;  ///< ms by pass

inline std::string inWords(const std::vector<double>& ratios) {
  const Spread spread = spreadOf(ratios);
  return fmt::format("{:.3g} [{:.3g}, {:.3g}]", spread.median, spread.lower, spread.upper);
}

inline void row(const std::string& what, const std::string& figure) {
  fmt::print("  {:<76}{}\n", what, figure);
  std::fflush(stdout);
}

struct Machine {
  gpu::Device device;
  TechniqueSet techniques{TechniqueSet::defaultDirectories({})};
  int repeats = 5;
};

/// A pipeline on a scene.
class Bench {
 public:
  Bench(Machine& machine, const Scene& scene, const Pipeline& pipeline,
        const std::vector<std::string>& settings, int size = 64)
      : repeats_(machine.repeats) {
    RenderOptions options;
    options.width = options.height = size;
    options.parameters = pipeline.settings(settings);
    executor_ =
        std::make_unique<PipelineExecutor>(machine.device, machine.techniques, scene, pipeline, options);
  }
  PipelineExecutor& executor() { return *executor_; }
  void keep(const std::string& pass, const std::string& port) { executor_->keepOutput(pass, port); }

  /// The times of the passes in a frame at this time; 0 for one that did not run.
  Times at(double time) {
    executor_->render(time, 0, PipelineExecutor::Images::no, PipelineExecutor::Timing::passes);
    Times times;
    const std::vector<std::vector<PassRecord>> frames = executor_->timedPasses();
    for (const PassRecord& pass : frames.back()) times[pass.name] = pass.ran ? pass.deviceMs : 0.0;
    return times;
  }
  FrameResult pictured(double time = 0.0) { return executor_->render(time); }
  Times afresh(double time = 0.0) {
    executor_->invalidate();
    return at(time);
  }
  /// The times of Machine::repeats frames after one of warm-up, in which all passes run.
  std::vector<Times> severalAfresh() {
    afresh();
    std::vector<Times> result;
    for (int i = 0; i < repeats_; ++i) result.push_back(afresh());
    return result;
  }
  template <class Port>
  const Port& made(const std::string& pass, const std::string& port) {
    return static_cast<const Out<Port>*>(executor_->output(pass, port))->value();
  }

 private:
  int repeats_;
  std::unique_ptr<PipelineExecutor> executor_;
};

inline double sumOf(const Times& times, const std::vector<std::string>& passes) {
  double sum = 0.0;
  for (const std::string& pass : passes) sum += times.at(pass);
  return sum;
}

inline double total(const Times& times) {
  double sum = 0.0;
  for (const auto& [pass, ms] : times) sum += ms;
  return sum;
}

inline std::vector<double> ratios(const std::vector<Times>& frames, const std::vector<std::string>& passes,
                                  const std::vector<std::string>& over) {
  std::vector<double> result;
  for (const Times& frame : frames) result.push_back(sumOf(frame, passes) / sumOf(frame, over));
  return result;
}

/// Figures measured at several numbers of elements; print() fits the exponents of their power laws.
class Growth {
 public:
  void add(const std::string& what, double elements, double value) {
    points_[what].push_back({elements, {value, 0.0}});
  }
  void print() const {
    for (const auto& [what, points] : points_) {
      const PowerLaw law = fitPowerLaw(points);
      std::string values;
      for (const PowerLawPoint& point : points) values += fmt::format(" {:.4g}", point.y.value);
      row("exponent of " + what,
          fmt::format("{:.2f} +- {:.2f}  of{}", law.slope.value, law.slope.uncertainty, values));
    }
  }

 private:
  std::map<std::string, std::vector<PowerLawPoint>> points_;
};

/// The number of repeats on a program's command line.
inline int repeatsOf(const char* text, std::string_view program) {
  const std::string_view word = text;
  int number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size() || number < 1)
    throw Error(fmt::format("'{}': REPEATS is a whole number from 1 on; usage: {} [--quick | REPEATS]", word,
                            program));
  return number;
}

}  // namespace lumivox
