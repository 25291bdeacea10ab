// The parts that a run leaves out, in words.
#pragma once

#include <map>
#include <string>

#include "lumivox/pipeline/pipeline.h"
#include "pipeline/context.h"
#include "pipeline/graph.h"
#include "pipeline/prune.h"

namespace lumivox {

struct ExplainedRun {
  const BoundGraph& graph;
  const PrunePlan& plan;
  const Pipeline& pipeline;
  const TechniqueSource& techniques;
  std::map<std::string, shader::ShaderLibrary::Usage> usage;
  const std::map<std::string, shader::ShaderPack>& packs;
  const std::set<FrameContext::Reused>& reusedParts;
  std::map<int, double> passMs;  ///< per pass that ran so far, its last device time
  const Camera& camera;
  bool keepEverything = false;
  std::uint64_t poolBytes = 0, sharedBytes = 0;
};

Explanation explainRun(const ExplainedRun& run);

/// Whether a pass that runs sees through the camera's lens (Reads::lens).
bool seesThroughLens(const BoundGraph& graph, const PrunePlan& plan);
/// "the lens of camera 'main', 0.05 m wide"
std::string lensText(const Camera& camera);

}  // namespace lumivox
