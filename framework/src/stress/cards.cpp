#include "stress/cards.h"

#include <fnmatch.h>

#include <algorithm>
#include <sstream>

#include "lumivox/base/file.h"

namespace lumivox::stress {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t`"), last = text.find_last_not_of(" \t`");
  return first == std::string::npos ? std::string() : text.substr(first, last - first + 1);
}

/// "| a | b | c |" as its cells.
std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line.substr(1));
  for (std::string cell; std::getline(stream, cell, '|');) cells.push_back(trimmed(cell));
  return cells;
}

}  // namespace

std::vector<CardRow> whereItBreaks(const std::string& card) {
  std::vector<CardRow> rows;
  std::istringstream lines(card);
  bool inside = false, head = true;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("## ", 0) == 0) {
      inside = trimmed(line.substr(3)) == "Where it breaks";
      head = true;
    } else if (inside && line.rfind("|", 0) == 0) {
      const std::vector<std::string> cells = cellsOf(line);
      if (cells.size() < 3 || head || cells[0].find_first_not_of("-: ") == std::string::npos) {
        head = false;
        continue;
      }
      CardRow row{{}, cells[1], cells[2]};
      std::istringstream names(cells[0]);
      for (std::string name; std::getline(names, name, ',');) row.cases.push_back(trimmed(name));
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

const CardRow* rowFor(const std::vector<CardRow>& rows, const std::string& pipelineStem,
                      const std::string& caseName) {
  for (const bool namesPipeline : {true, false}) {
    const std::string subject = namesPipeline ? pipelineStem + "/" + caseName : caseName;
    for (const CardRow& row : rows)
      for (const std::string& pattern : row.cases)
        if ((pattern.find('/') != std::string::npos) == namesPipeline &&
            fnmatch(pattern.c_str(), subject.c_str(), 0) == 0)
          return &row;
  }
  return nullptr;
}

std::string explanationOf(const StressCell& cell, const Pipeline& pipeline, TechniqueSource& techniques) {
  if (cell.outcome != StressOutcome::biased && cell.outcome != StressOutcome::diverges) return {};
  std::vector<std::string> names = pipeline.techniques();
  std::stable_partition(names.begin(), names.end(),
                        [&](const std::string& name) { return name == cell.technique; });
  std::vector<CardRow> rows;
  for (const std::string& name : names) {
    const Technique* technique = techniques.technique(name);
    if (technique == nullptr) continue;
    const std::filesystem::path file = technique->library.parent_path() / (name + ".md");
    std::error_code failure;
    if (!std::filesystem::exists(file, failure)) continue;
    for (CardRow& row : whereItBreaks(readFile(file))) rows.push_back(std::move(row));
  }
  const CardRow* row = rowFor(rows, pipeline.file.stem().string(), cell.name);
  return row == nullptr ? std::string() : row->what + ": " + row->why;
}

}  // namespace lumivox::stress
