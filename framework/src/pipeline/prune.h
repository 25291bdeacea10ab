// Decides which passes and outputs a scene needs, and why the others are left out.
#pragma once

#include <string>
#include <vector>

#include "lumivox/pipeline/pass.h"
#include "pipeline/graph.h"

namespace lumivox {

/// Needs of one run.
struct PruneRequest {
  SceneTraits traits;
  bool keepEverything = false;
  bool interactive = false;
  bool accumulate = false;          ///< histories are carried on; otherwise no pass ever sees one
  std::vector<bool> wanted;         ///< per output of the pipeline
  std::vector<OutputIndex> forced;  ///< outputs that stay alive after the frame
};

struct OutputPlan {
  bool wanted = false;      ///< computed and stored
  bool keep = false;        ///< must outlive the frame: a later frame may read it without running its pass
  bool impossible = false;  ///< the scene lacks what it or a pass before it needs
  bool lacksNeed = false;   ///< the scene lacks what the output itself needs
  int lastReader = -1;      ///< position in PrunePlan::order after which it is no longer read
  std::string why;          ///< the reason if not wanted
};

struct PassPlan {
  bool kept = false;
  std::string why;  ///< the reason if not kept
  std::vector<OutputPlan> outputs;
  Reads dependsOn = Reads::nothing;  ///< reads of the pass and of all its kept sources, histories included
};

struct PrunePlan {
  std::vector<PassPlan> passes;      ///< parallel to BoundGraph::passes
  std::vector<int> order;            ///< kept passes, sources first
  Reads mayChange = Reads::nothing;  ///< between the frames of this scene

  const OutputPlan& output(OutputIndex index) const {
    return passes[static_cast<std::size_t>(index.pass)].outputs[static_cast<std::size_t>(index.port)];
  }
  OutputPlan& output(OutputIndex index) {
    return passes[static_cast<std::size_t>(index.pass)].outputs[static_cast<std::size_t>(index.port)];
  }
};

PrunePlan prune(const BoundGraph& graph, const PruneRequest& request);

/// What a pass reads besides its inputs: its declared reads, and Reads::history if a history input is
/// connected.
Reads readsOf(const BoundPass& pass);
/// Outputs of this frame that a pass reads: its connected inputs but for those that the scene or the
/// parameters make useless.
std::vector<OutputIndex> sourcesRead(const BoundPass& pass, const PruneRequest& request);
/// Outputs of the previous frame that a pass reads by history inputs. Empty without accumulation.
std::vector<OutputIndex> historiesRead(const BoundPass& pass, const PruneRequest& request);

/// "geometry, camera"
std::string readsText(Reads set);

}  // namespace lumivox
