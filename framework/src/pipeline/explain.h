// The parts that a run leaves out, in words.
#pragma once

#include <map>
#include <string>

#include "lumivox/pipeline/pipeline.h"
#include "pipeline/context.h"
#include "pipeline/graph.h"
#include "pipeline/prune.h"

namespace lumivox {

/// What there is to be seen by a run.
struct Seen {
  const SceneTraits& traits;
  const Scene& scene;
  const Camera& camera;
};

struct ExplainedRun {
  const BoundGraph& graph;
  const PrunePlan& plan;
  const Pipeline& pipeline;
  const TechniqueSource& techniques;
  std::map<std::string, shader::ShaderLibrary::Usage> usage;
  const std::map<std::string, shader::ShaderPack>& packs;
  const std::set<FrameContext::Reused>& reusedParts;
  std::map<int, double> passMs;  ///< per pass that ran so far, its last device time
  const Seen seen;
  const PruneRequest& request;
  bool keepEverything = false;
  std::uint64_t poolBytes = 0, sharedBytes = 0;
};

Explanation explainRun(const ExplainedRun& run);

/// What the scene and the camera have that no pass which runs reads (Pass::readsFrom()), though an image is
/// made that it belongs to: "the lens of camera 'main', 0.05 m wide", "no pass sees through a lens: the image
/// is that of a pinhole". Nothing of a run without images.
std::vector<LeftOut> unreadTraits(const Seen& seen, const BoundGraph& graph, const PrunePlan& plan,
                                  const PruneRequest& request);

}  // namespace lumivox
