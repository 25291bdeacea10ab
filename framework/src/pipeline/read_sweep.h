// Reading sweep blocks, in the text of a pipeline and in a text of their own.
#pragma once

#include <vector>

#include "lumivox/pipeline/sweep_text.h"

namespace lumivox {

/// Where a sweep block stands. Only a sweep text of its own names scenes and pipelines.
enum class SweepHome { pipeline, text };

/// Reads one block and appends every finding in it.
SweepBlock readSweepBlock(const dsl::Document& document, const dsl::Block& block, SweepHome home,
                          std::vector<Diagnostic>& findings);

/// The axes of a sweep that the pipeline has. Appends a finding for each value that does not fit its
/// parameter. `lacking` receives the other axes.
Sweep fittedSweep(const SweepBlock& block, const Pipeline& pipeline, const dsl::Document& document,
                  std::vector<Diagnostic>& findings, std::vector<const SweepAxis*>& lacking);

/// The table of sweep blocks.
dsl::BlockSpecification sweepSpecification(SweepHome home);

}  // namespace lumivox
