// Pipelines set against each other, as tables.
#pragma once

#include <string>

#include "lumivox/analysis/comparison.h"

namespace lumivox::command {

enum class ComparisonTable { front, equalTime, equalError };

/// The table that was asked for, with a line on what its numbers are.
std::string comparisonText(const PipelineComparison& comparison, ComparisonTable table);

}  // namespace lumivox::command
