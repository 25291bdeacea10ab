// Finds explanations of cells in the techniques' paper cards.
#pragma once

#include <string>
#include <vector>

#include "lumivox/pipeline/pipeline.h"
#include "lumivox/results/store.h"

namespace lumivox::stress {

/// A number in bold that a card gives for a cell: `**0.31**` (within 5 %, or one in the last written digit if
/// that is more), `**0.31 ± 0.04**`, `**0.31..0.41**`.
struct CardNumber {
  double low = 0.0, high = 0.0;
  std::string text;  ///< as written, without the stars
  /// Whether a measured number agrees within three of its standard uncertainties.
  bool admits(const Measured& measured) const;
};
/// All bold numbers of a text; other bold text is skipped.
std::vector<CardNumber> boldNumbers(const std::string& text);

/// An item of the list below `## Where it breaks`:
/// "- `case`, `pipeline_stem/case_*`: what happens, **0.31** of it. *Why:* the reason."
struct CardRow {
  std::vector<std::string> cases;  ///< patterns: "case", "case_*", "pipeline_stem/case"
  std::string what, why;
  std::vector<CardNumber> numbers = {};  ///< in `what`: each cell of the row measures one of them
};
std::vector<CardRow> whereItBreaks(const std::string& card);

/// The first row that names pipeline and case, else the first that names the case; null if none does.
const CardRow* rowFor(const std::vector<CardRow>& rows, const std::string& pipelineStem,
                      const std::string& caseName);

/// What the cards say about a cell.
struct CardAnswer {
  std::string explanation;
  std::string contradiction;  ///< set where a row names the cell with other numbers, which explains nothing
};
/// What a row says about a cell.
CardAnswer answerOf(const CardRow& row, const StressCell& cell);

/// Searches the card of the technique that the pipeline stands for, then those of the other techniques in it.
/// Empty for a cell that needs no explanation (only biased and diverging ones do) and for one without any.
CardAnswer explanationOf(const StressCell& cell, const Pipeline& pipeline, TechniqueSource& techniques);

}  // namespace lumivox::stress
