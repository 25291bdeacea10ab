// Explanations of cells in the techniques' paper cards.
#pragma once

#include <string>
#include <vector>

#include "lumivox/pipeline/pipeline.h"
#include "lumivox/report/store.h"

namespace lumivox::stress {

/// A row of the table below `## Where it breaks`.
struct CardRow {
  std::vector<std::string> cases;  ///< patterns: "case", "case_*", "pipeline_stem/case"
  std::string what, why;
};
std::vector<CardRow> whereItBreaks(const std::string& card);

/// The first row that names the pipeline and the case, else the first that names the case; null when none
/// does.
const CardRow* rowFor(const std::vector<CardRow>& rows, const std::string& pipelineStem,
                      const std::string& caseName);

/// From the cards of the technique that the pipeline stands for and then of the others that it names. Empty
/// for a cell that needs none (only those that are biased or diverge do) and for one that no card explains.
std::string explanationOf(const StressCell& cell, const Pipeline& pipeline, TechniqueSource& techniques);

}  // namespace lumivox::stress
