// Reading sweep blocks, in the text of a pipeline and in a text of their own.
#pragma once

#include <vector>

#include "lumivox/pipeline/sweep_text.h"

namespace lumivox {

/// Where a sweep block stands: only a text of its own names scenes and pipelines.
enum class SweepHome { pipeline, text };

/// Reads one block and appends every finding in it.
SweepBlock readSweepBlock(const dsl::Document& document, const dsl::Block& block, SweepHome home,
                          std::vector<Diagnostic>& findings);

/// The sweep as far as it concerns a pipeline. Appends a finding for each value that does not fit its
/// parameter. `lacking`: the axes whose parameters the pipeline does not have.
Sweep fittedSweep(const SweepBlock& block, const Pipeline& pipeline, const dsl::Document& document,
                  std::vector<Diagnostic>& findings, std::vector<const SweepAxis*>& lacking);

/// The table of sweep blocks.
dsl::BlockSpecification sweepSpecification(SweepHome home);

}  // namespace lumivox
