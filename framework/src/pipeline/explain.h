// Explains in words what a run leaves out.
#pragma once

#include <map>
#include <string>

#include "lumivox/pipeline/pipeline.h"
#include "pipeline/context.h"
#include "pipeline/graph.h"
#include "pipeline/prune.h"

namespace lumivox {

/// The scene, camera and traits of a run.
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
  std::map<int, double> passMs;  ///< the last device time of each pass that ran
  const Seen seen;
  const PruneRequest& request;
  bool keepEverything = false;
  std::uint64_t poolBytes = 0, sharedBytes = 0;
};

Explanation explainRun(const ExplainedRun& run);

/// Traits of scene and camera that belong to the image but that no running pass reads (Pass::readsFrom()),
/// such as "the lens of camera 'main', 0.05 m wide" with "no pass sees through a lens: the image is that of a
/// pinhole". Empty for a run without images.
std::vector<LeftOut> unreadTraits(const Seen& seen, const BoundGraph& graph, const PrunePlan& plan,
                                  const PruneRequest& request);

}  // namespace lumivox
