#include "stress_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "command.h"
#include "common/command_line.h"
#include "lumivox/results/stress_cells.h"

namespace lumivox::command {
namespace {

/// A cell of the matrix: one word for each outcome.
const char* mark(StressOutcome outcome) {
  switch (outcome) {
    case StressOutcome::stable:
      return "ok";
    case StressOutcome::biased:
      return "bias";
    case StressOutcome::diverges:
      return "DIV";
    case StressOutcome::refused:
      return "refd";
    case StressOutcome::notApplicable:
      return "-";
    case StressOutcome::broken:
      return "BROKEN";
  }
  return "";
}

std::string matrix(const std::vector<StressCell>& cells) {
  std::vector<std::string> pipelines, cases;
  std::map<std::pair<std::string, std::string>, std::string> marks;
  for (const StressCell& cell : cells) {
    if (std::find(pipelines.begin(), pipelines.end(), cell.pipeline) == pipelines.end())
      pipelines.push_back(cell.pipeline);
    if (std::find(cases.begin(), cases.end(), cell.name) == cases.end()) cases.push_back(cell.name);
    marks[{cell.name, cell.pipeline}] = mark(cell.outcome);
  }
  std::vector<std::vector<std::string>> rows{{"Case"}};
  std::string names;
  for (std::size_t i = 0; i < pipelines.size(); ++i) {
    const std::string letter(1, static_cast<char>('A' + i % 26));
    rows[0].push_back(letter);
    names += fmt::format("{}: {}\n", letter, stem(pipelines[i]));
  }
  for (const std::string& one : cases) {
    rows.push_back({one});
    for (const std::string& pipeline : pipelines) rows.back().push_back(marks[{one, pipeline}]);
  }
  return textTable(rows) + names;
}

}  // namespace

std::string stressTable(const std::vector<StressCell>& cells) {
  std::string text = matrix(cells);
  std::map<StressOutcome, int> counts;
  for (const StressCell& cell : cells) {
    ++counts[cell.outcome];
    if (cell.outcome == StressOutcome::stable || cell.outcome == StressOutcome::notApplicable) continue;
    text += fmt::format("\n{}, {}: {}", stem(cell.pipeline), cell.name, stressValueText(cell));
    if (!cell.measure.empty()) text += fmt::format(" (limit {:.3g}): {}", cell.limit, cell.measure);
    if (!cell.detail.empty()) text += "\n  " + cell.detail;
    if (!cell.explanation.empty()) text += "\n  " + cell.explanation;
    text += "\n  " + cell.command + "\n";
  }
  std::string summary;
  for (const auto& [outcome, count] : counts)
    summary += fmt::format("{}{} {}", summary.empty() ? "" : ", ", count, name(outcome));
  return text + "\n" + summary + "\n";
}

}  // namespace lumivox::command
