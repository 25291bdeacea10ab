// Explanations of cells in the techniques' paper cards.
#pragma once

#include <string>
#include <vector>

#include "lumivox/pipeline/pipeline.h"
#include "lumivox/results/store.h"

namespace lumivox::stress {

/// A number that a card says a cell measures, in bold: `**0.31**` (within 5 %, or one more or less in the
/// last digit that is written, whichever is more), `**0.31 ± 0.04**`, `**0.31..0.41**`.
struct CardNumber {
  double low = 0.0, high = 0.0;
  std::string text;  ///< as written, without the stars
  /// Whether a measured number agrees, within three standard uncertainties of its own.
  bool admits(const Measured& measured) const;
};
/// All of a text. What is in bold and no number is passed over.
std::vector<CardNumber> boldNumbers(const std::string& text);

/// An item of the list below `## Where it breaks`:
/// "- `case`, `pipeline_stem/case_*`: what happens, **0.31** of it. *Why:* the reason."
struct CardRow {
  std::vector<std::string> cases;  ///< patterns: "case", "case_*", "pipeline_stem/case"
  std::string what, why;
  std::vector<CardNumber> numbers = {};  ///< in `what`: each cell that the row speaks of measures one of them
};
std::vector<CardRow> whereItBreaks(const std::string& card);

/// The first row that names the pipeline and the case, else the first that names the case; null when none
/// does.
const CardRow* rowFor(const std::vector<CardRow>& rows, const std::string& pipelineStem,
                      const std::string& caseName);

/// The answer of the cards for a cell.
struct CardAnswer {
  std::string explanation;
  std::string contradiction;  ///< a row speaks of the cell, but of other numbers: it explains nothing
};
/// Of the row that speaks of a cell with such a number.
CardAnswer answerOf(const CardRow& row, const StressCell& cell);

/// From the cards of the technique that the pipeline stands for and then of the others that it names. Empty
/// for a cell that needs none (only those that are biased or diverge do) and for one that no card explains.
CardAnswer explanationOf(const StressCell& cell, const Pipeline& pipeline, TechniqueSource& techniques);

}  // namespace lumivox::stress
