// Comparisons of pipelines as tables.
#pragma once

#include <string>

#include "lumivox/analysis/comparison.h"

namespace lumivox::command {

enum class ComparisonTable { front, equalTime, equalError };

/// The chosen table, with a line that explains its numbers.
std::string comparisonText(const PipelineComparison& comparison, ComparisonTable table);

}  // namespace lumivox::command
