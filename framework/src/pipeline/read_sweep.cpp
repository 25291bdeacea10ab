#include "pipeline/read_sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/text_values.h"

namespace lumivox {
namespace {

constexpr std::size_t kMostValues = 4096;            // of one axis that is written as steps
constexpr std::size_t kMostPoints = 1u << 17;        // of one sweep
constexpr double kLargestSeed = 9007199254740992.0;  // 2^53: numbers of a text are exact up to it

dsl::PropertySpecification listOf(const char* word, bool required, const char* meaning) {
  dsl::PropertySpecification specification;
  specification.word = word;
  specification.type = dsl::PropertyType::list;
  specification.required = required;
  specification.meaning = meaning;
  return specification;
}

/// The axis of accumulated frames, described like a parameter that every pipeline has.
PipelineParameter accumulatedFrames() {
  PipelineParameter frames;
  frames.name = kAccumulatedFrames;
  frames.value.number = 1.0;
  frames.low = 1.0;
  frames.high = kMostAccumulatedFrames;
  return frames;
}

/// Rounds away the last digits that binary fractions leave in sums and products: 0.3, not
/// 0.30000000000000004.
double rounded(double value) {
  return std::stod(fmt::format("{:.12g}", value));
}

class SweepReader : TextFindings {
 public:
  SweepReader(const dsl::Document& document, SweepHome home, std::vector<Diagnostic>& findings)
      : TextFindings(document, findings), home_(home) {}

  SweepBlock read(const dsl::Block& block) {
    const std::size_t before = findings_.size();
    readHeader(block);
    bool anything = false;
    for (const dsl::Item& item : block.items) {
      anything = true;
      if (item.block) {
        report(item.block->place, item.block->word, "a sweep cannot contain blocks", "parameter [values]");
      } else if (item.property->word == kSweptSeeds) {
        readSeeds(*item.property);
      } else if (item.property->word == kSweptScenes || item.property->word == kSweptPipelines) {
        readFiles(*item.property);
      } else {
        readAxis(*item.property);
      }
    }
    if (!anything && findings_.size() == before)
      report(block.place, block.word, "the sweep is empty", "parameter [values]");
    if (home_ == SweepHome::text && block.closed) requireFiles(block);
    if (sweep_.isList) evenOut();
    limitPoints();
    return std::move(sweep_);
  }

 private:
  void readHeader(const dsl::Block& block) {
    sweep_.place = block.place;
    const auto isName = [](const dsl::Value& value) {
      return value.isPlainWord() || (value.kind == dsl::ValueKind::text && !value.text.empty());
    };
    if (block.header.empty() || block.header.size() > 2 || !isName(block.header[0])) {
      report(block.place, block.word, "a sweep needs one name",
             "sweep NAME { parameter [values] }, or sweep NAME list { ... }");
      return;
    }
    sweep_.name = block.header[0].text;
    if (block.header.size() < 2) return;
    const dsl::Value& kind = block.header[1];
    sweep_.isList = kind.text == "list";
    if (!sweep_.isList && kind.text != "grid")
      report(kind.place, kind.length, fmt::format("unknown kind '{}' of a sweep", kind.text),
             "grid, which every sweep is without a kind, or list", nearestWord(kind.text, {"grid", "list"}));
  }

  bool givenTwice(const dsl::Property& property) {
    const bool known = std::find(words_.begin(), words_.end(), property.word) != words_.end();
    words_.push_back(property.word);
    if (known) report(property.place, property.word, fmt::format("'{}' is swept twice", property.word));
    return known;
  }

  /// The items of a list, or nothing and a finding.
  const std::vector<dsl::Value>* itemsOf(const dsl::Property& property, const std::string& expected) {
    if (property.values.size() == 1 && property.values[0].kind == dsl::ValueKind::list &&
        !property.values[0].items.empty())
      return &property.values[0].items;
    report(property.place, property.word, "a sweep needs a list of values", expected);
    return nullptr;
  }

  void readSeeds(const dsl::Property& property) {
    if (givenTwice(property)) return;
    const std::vector<dsl::Value>* items = itemsOf(property, "seeds [1 2 3]");
    if (items == nullptr) return;
    for (const dsl::Value& item : *items) {
      const bool whole = item.kind == dsl::ValueKind::number && item.integral && !item.unit &&
                         item.number >= 0.0 && item.number <= kLargestSeed;
      const auto seed = whole ? static_cast<std::uint64_t>(item.number) : 0;
      if (!whole) {
        report(item.place, item.length, "this is not a seed", "whole numbers from 0 to 2^53");
      } else if (std::find(sweep_.seeds.begin(), sweep_.seeds.end(), seed) != sweep_.seeds.end()) {
        report(item.place, item.length, fmt::format("the seed {} is given twice", seed));
      } else {
        sweep_.seeds.push_back(seed);
      }
    }
  }

  void readFiles(const dsl::Property& property) {
    const bool scenes = property.word == kSweptScenes;
    if (home_ == SweepHome::pipeline) {
      report(property.place, property.word, fmt::format("a pipeline names no {}", property.word),
             "a text of its own, FILE.sweep, for a sweep over them");
      return;
    }
    if (givenTwice(property)) return;
    const std::vector<dsl::Value>* items =
        itemsOf(property, scenes ? "scenes [\"a.scene\" \"b.scene\"]" : "pipelines [\"a.pipeline\"]");
    if (items == nullptr) return;
    std::vector<std::filesystem::path>& files = scenes ? sweep_.scenes : sweep_.pipelines;
    for (const dsl::Value& item : *items) {
      if (item.kind != dsl::ValueKind::text && item.kind != dsl::ValueKind::word) {
        report(item.place, item.length, "this is not the name of a file",
               "a path beside the text, in double quotes");
        continue;
      }
      const std::filesystem::path file = besideText(item);
      std::error_code failure;
      if (!std::filesystem::is_regular_file(file, failure)) {
        report(item.place, item.length, fmt::format("there is no file {}", file.string()),
               "a path beside the text");
      } else if (std::find(files.begin(), files.end(), file) != files.end()) {
        report(item.place, item.length, fmt::format("{} is given twice", file.string()));
      } else {
        files.push_back(file);
      }
    }
  }

  void requireFiles(const dsl::Block& block) {
    for (const char* word : {kSweptScenes, kSweptPipelines}) {
      if (std::find(words_.begin(), words_.end(), word) != words_.end()) continue;
      // A misspelt word was read as a parameter.
      const std::string nearest = nearestWord(word, words_);
      const auto axis = std::find_if(sweep_.axes.begin(), sweep_.axes.end(),
                                     [&](const SweepAxis& one) { return one.parameter == nearest; });
      report(axis == sweep_.axes.end() ? block.place : axis->place,
             axis == sweep_.axes.end() ? block.word : nearest, fmt::format("the sweep lacks its {}", word),
             fmt::format("{} [\"...\"], beside the parameters", word),
             axis == sweep_.axes.end() ? std::string() : word);
    }
  }

  void readAxis(const dsl::Property& property) {
    if (givenTwice(property)) return;
    SweepAxis axis{property.word, property.place, {}};
    const auto& values = property.values;
    if (!values.empty() && values[0].isPlainWord() &&
        (values[0].text == "times" || values[0].text == "plus")) {
      readSteps(property, axis);
    } else if (const auto* items = itemsOf(
                   property, fmt::format("{0} [a b c], or {0} times 2 in LOW..HIGH, or {0} plus STEP in "
                                         "LOW..HIGH",
                                         property.word))) {
      for (const dsl::Value& item : *items) {
        if (const auto value = parameterValue(item))
          axis.values.push_back({*value, item.place, item.length});
        else
          report(item.place, item.length,
                 fmt::format("this value does not fit the parameter '{}'", property.word),
                 "a number or a word");
      }
    }
    sweep_.axes.push_back(std::move(axis));
  }

  /// `times FACTOR in LOW..HIGH` and `plus STEP in LOW..HIGH`: from the lower end up to the upper one.
  void readSteps(const dsl::Property& property, SweepAxis& axis) {
    const auto& values = property.values;
    const bool multiplies = values[0].text == "times";
    const std::string form =
        fmt::format("{} {} in LOW..HIGH", property.word, multiplies ? "times 2" : "plus 8");
    const bool shaped = values.size() == 4 && values[1].kind == dsl::ValueKind::number &&
                        values[2].isPlainWord() && values[2].text == "in" && isNumberRange(values[3]);
    if (!shaped) return report(property.place, property.word, "malformed steps", form);
    const dsl::Value& low = values[3].items[0];
    const dsl::Value& high = values[3].items[1];
    const dsl::Dimension dimension = low.unit ? low.unit->dimension : dsl::kNoDimension;
    const dsl::Dimension highDimension = high.unit ? high.unit->dimension : dsl::kNoDimension;
    const dsl::Dimension stepDimension = values[1].unit ? values[1].unit->dimension : dsl::kNoDimension;
    const double from = low.inBaseUnits(), to = high.inBaseUnits(), step = values[1].inBaseUnits();
    if (highDimension != dimension || stepDimension != (multiplies ? dsl::kNoDimension : dimension))
      return report(property.place, property.word, "the steps and their ends have different units",
                    multiplies ? "a factor without a unit" : "one unit for all");
    if (!(from <= to))
      return report(values[3].place, values[3].length, "the range runs backwards", "the lower end first");
    if (multiplies ? !(step > 1.0 && from > 0.0) : !(step > 0.0))
      return report(values[1].place, values[1].length, "these steps never reach the upper end",
                    multiplies ? "a factor above 1, and a lower end above 0" : "a step above 0");
    const double steps = multiplies ? std::log(to / from) / std::log(step) : (to - from) / step;
    constexpr double kLastDigits = 1e-9;  // an end within this share of a step belongs to the range
    if (!(steps < kMostValues))
      return report(property.place, property.word, "there are too many steps",
                    fmt::format("at most {}", kMostValues));
    for (int i = 0; i <= static_cast<int>(steps + kLastDigits); ++i) {
      ParameterValue value;
      value.number = rounded(multiplies ? from * std::pow(step, i) : from + step * i);
      value.dimension = dimension;
      axis.values.push_back({value, values[3].place, values[3].length});
    }
  }

  /// In a `list` sweep a single value holds for all points; all other axes have equally many values.
  void evenOut() {
    std::size_t points = 1;
    const SweepAxis* longest = nullptr;
    for (const SweepAxis& axis : sweep_.axes) {
      if (axis.values.size() <= points) continue;
      points = axis.values.size();
      longest = &axis;
    }
    for (SweepAxis& axis : sweep_.axes) {
      if (axis.values.size() == 1) axis.values.resize(points, axis.values.front());
      if (axis.values.size() != points && !axis.values.empty())
        report(axis.place, axis.parameter,
               fmt::format("'{}' has {} values, but '{}' has {}", axis.parameter, axis.values.size(),
                           longest->parameter, points),
               "as many in every axis of a list, or one value for all");
    }
  }

  void limitPoints() {
    double points = 1.0;
    if (!sweep_.isList)
      for (const SweepAxis& axis : sweep_.axes) points *= static_cast<double>(axis.values.size());
    if (points > static_cast<double>(kMostPoints)) {
      report(sweep_.place, "sweep", fmt::format("the sweep has {:.6g} points", points),
             fmt::format("at most {}", kMostPoints));
      sweep_.axes.clear();
    }
  }

  SweepHome home_;
  std::vector<std::string> words_;
  SweepBlock sweep_;
};

}  // namespace

SweepBlock readSweepBlock(const dsl::Document& document, const dsl::Block& block, SweepHome home,
                          std::vector<Diagnostic>& findings) {
  return SweepReader(document, home, findings).read(block);
}

Sweep fittedSweep(const SweepBlock& block, const Pipeline& pipeline, const dsl::Document& document,
                  std::vector<Diagnostic>& findings, std::vector<const SweepAxis*>& lacking) {
  Sweep sweep;
  sweep.name = block.name;
  sweep.isList = block.isList;
  sweep.seeds = block.seeds;
  for (const SweepAxis& axis : block.axes) {
    static const PipelineParameter kFrames = accumulatedFrames();
    const PipelineParameter* parameter =
        axis.parameter == kFrames.name ? &kFrames : findParameter(pipeline, axis.parameter);
    if (parameter == nullptr) {
      lacking.push_back(&axis);
      continue;
    }
    std::vector<ParameterValue> values;
    for (const SweepValue& one : axis.values) {
      std::string misfit = parameter->misfit(one.value);
      if (misfit.empty() && parameter == &kFrames && one.value.number != std::floor(one.value.number))
        misfit = "must be a whole number";
      if (misfit.empty()) {
        values.push_back(one.value);
        values.back().dimension = parameter->value.dimension;
        continue;
      }
      Diagnostic finding = document.finding(
          one.place, one.length, fmt::format("this value does not fit the parameter '{}'", parameter->name),
          misfitExpectation(misfit));
      // The values of steps share one place.
      const bool known = std::any_of(findings.begin(), findings.end(),
                                     [&](const Diagnostic& other) { return other.text() == finding.text(); });
      if (!known) findings.push_back(std::move(finding));
    }
    sweep.axes.emplace_back(parameter->name, std::move(values));
  }
  return sweep;
}

std::vector<ParameterValues> Sweep::points() const {
  std::vector<ParameterValues> points{{}};
  if (isList) points.resize(axes.empty() ? 1 : axes.front().second.size());
  for (const auto& [parameter, values] : axes) {
    if (isList) {
      for (std::size_t i = 0; i < std::min(points.size(), values.size()); ++i)
        points[i][parameter] = values[i];
      continue;
    }
    std::vector<ParameterValues> longer;
    for (const ParameterValues& point : points) {
      for (const ParameterValue& value : values) {
        longer.push_back(point);
        longer.back()[parameter] = value;
      }
    }
    points = std::move(longer);
  }
  return points;
}

dsl::BlockSpecification sweepSpecification(SweepHome home) {
  static const char* const kAxes =
      "Each parameter has a list, `resolution [16 32 64]`, or steps, `resolution times 2 in 16..64` and `cones "
      "plus 2 in 4..12`. The points are the grid over all axes, or with `sweep NAME list { ... }` those along "
      "them: the first values together, then the second ones; an axis of one value applies to all. The axis `frames` "
      "is not a parameter: a pipeline that accumulates is measured after that many frames of the still scene.";
  dsl::BlockSpecification sweep;
  sweep.word = "sweep";
  sweep.name = dsl::HeaderUse::required;
  sweep.open = true;
  if (home == SweepHome::pipeline) {
    sweep.meaning = fmt::format(
        "`sweep NAME {{ parameter [values] }}`: the points at which the pipeline is measured. {}", kAxes);
  } else {
    sweep.meaning = fmt::format(
        "`sweep NAME {{ scenes [...] pipelines [...] parameter [values] }}`: what `lumivox sweep` measures, every "
        "pipeline at every point on every scene. {} A pipeline without one of the parameters is measured "
        "without that axis, with a note.",
        kAxes);
    sweep.required = true;
    sweep.properties = {listOf(kSweptScenes, true, "files of scenes, beside the text"),
                        listOf(kSweptPipelines, true, "files of pipelines, beside the text")};
  }
  sweep.properties.push_back(
      listOf(kSweptSeeds, false,
             "seeds of the techniques' random numbers; each is a run of its own, which "
             "has that seed alone"));
  return sweep;
}

}  // namespace lumivox
