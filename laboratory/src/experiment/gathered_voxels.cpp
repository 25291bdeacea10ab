#include "experiment/gathered_voxels.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "lumivox/base/log.h"
#include "lumivox/experiment/voxelizers.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/ports/voxel_fragments.h"
#include "pipeline/graph.h"
#include "pipeline/prune.h"

namespace lumivox::experiment {
namespace {

bool isIndirect(Contributes component) {
  return component == Contributes::indirectDiffuse || component == Contributes::indirectGlossy ||
         component == Contributes::ambientOcclusion;
}

/// The pipeline's outputs of indirect light; without any, the whole image.
std::vector<OutputIndex> indirectOutputs(const BoundGraph& graph) {
  std::vector<OutputIndex> indirect, whole;
  for (const BoundOutput& output : graph.outputs) {
    const Contributes component = graph.output(output.source).contributes();
    if (isIndirect(component)) indirect.push_back(output.source);
    if (component == Contributes::final) whole.push_back(output.source);
  }
  return indirect.empty() ? whole : indirect;
}

/// Passes that are left out at this point.
std::set<std::string> leftOutPasses(const TimingContext& context, const Pipeline& pipeline,
                                    const RenderOptions& options) {
  const PipelineExecutor executor(context.device, context.techniques, context.scene, pipeline, options);
  std::set<std::string> passes;
  for (const LeftOut& one : executor.explain().leftOut)
    if (one.level == LeftOut::Level::pass) passes.insert(one.pass);
  return passes;
}

/// Judges the voxels that the frame made.
void judgeMade(const OutBase& made, VoxelReferences& references, GatheredVoxels& voxels) {
  const PortContents contents = made.contents();
  const PortContents::Occupancy* occupancy = contents.occupancy();
  if (occupancy == nullptr) {
    voxels.whyNot = "it does not say which voxels are occupied";
    return;
  }
  voxels.resolution = occupancy->grid.resolution;
  const int longest = std::max({voxels.resolution.x, voxels.resolution.y, voxels.resolution.z});
  if (longest > kLargestJudgedGrid) {
    voxels.whyNot = fmt::format("their grid has {} voxels along a side; up to {} are judged beside errors",
                                longest, kLargestJudgedGrid);
    return;
  }
  const OccupiedVoxels found = occupiedVoxels(made).value();
  const VoxelReferences::InGrid& reference = references.in(found.grid);
  voxels.occupied = found.voxels.count();
  voxels.reference = reference.voxels.certain.count();
  voxels.undecided = reference.voxels.possible.count() - voxels.reference;
  voxels.error = compareVoxels(found.voxels, reference.voxels);
  voxels.holes = reference.crossings.holes(found.voxels);
}

}  // namespace

VoxelReferences::VoxelReferences(const Scene& scene, double time, std::string camera, int width, int height)
    : scene_(&scene), time_(time), camera_(std::move(camera)), width_(width), height_(height) {}

const VoxelReferences::InGrid& VoxelReferences::in(const GridPlacement& grid) {
  for (const InGrid& one : made_)
    if (one.grid == grid) return one;
  const SceneSnapshot snapshot = snapshotOf(*scene_, time_, camera_, width_, height_);
  VoxelReference voxels = trueVoxels(*scene_, snapshot, grid);
  RayCrossings crossings(voxels);
  made_.push_back({grid, std::move(voxels), std::move(crossings)});
  return made_.back();
}

std::optional<PassOutput> gatheredVoxelsOf(const TimingContext& context, const Pipeline& pipeline,
                                           const ReportPoint& point) {
  const RenderOptions options = renderOptionsOf(context, point);
  const BoundGraph graph = bindPipeline(pipeline, context.techniques, options.parameters);
  PruneRequest request;
  request.traits = SceneTraits::of(context.scene);
  request.accumulate = options.accumulate;
  std::vector<OutputIndex> near = indirectOutputs(graph);
  const bool any = std::any_of(graph.passes.begin(), graph.passes.end(), [](const BoundPass& pass) {
    const auto& outputs = pass.object->outputs();
    return std::any_of(outputs.begin(), outputs.end(),
                       [](const OutBase* output) { return holdsVoxels(output->kind()); });
  });
  if (near.empty() || !any) return std::nullopt;
  const std::set<std::string> leftOut = leftOutPasses(context, pipeline, options);
  const PortKind& list = portKind<VoxelFragments>();
  std::set<int> visited;
  std::optional<OutputIndex> grid;
  const auto named = [&](OutputIndex index) {
    return PassOutput{graph.passes[static_cast<std::size_t>(index.pass)].name, graph.output(index).name()};
  };
  // Pass by pass away from the outputs.
  while (!near.empty()) {
    std::vector<OutputIndex> next;
    for (const OutputIndex index : near) {
      const BoundPass& pass = graph.passes[static_cast<std::size_t>(index.pass)];
      if (leftOut.count(pass.name) != 0) continue;
      const PortKind& kind = graph.output(index).kind();
      if (kind.isSameType(list)) return named(index);
      if (holdsVoxels(kind) && !grid) grid = index;
      if (!visited.insert(index.pass).second) continue;
      for (const OutputIndex source : sourcesRead(pass, request)) next.push_back(source);
    }
    near = std::move(next);
  }
  if (grid) return named(*grid);
  return std::nullopt;
}

void judgeVoxels(const TimingContext& context, const Pipeline& pipeline, VoxelReferences& references,
                 ReportPoint& point) {
  point.voxels.reset();
  const std::optional<PassOutput> output = gatheredVoxelsOf(context, pipeline, point);
  if (!output) return;
  GatheredVoxels voxels;
  voxels.output = output->pass + "." + output->port;
  const std::string why = whyFailed([&] {
    RenderOptions options = renderOptionsOf(context, point);
    options.wantsOutputs = false;
    PipelineExecutor executor(context.device, context.techniques, context.scene, pipeline, options);
    executor.keepOnly(output->pass, output->port);
    executor.render(context.options.time, 0, PipelineExecutor::Images::no);
    const OutBase* made = executor.output(output->pass, output->port);
    if (made == nullptr) {
      voxels.whyNot = "the scene does not have what it needs";
      return;
    }
    voxels.kind = made->kind().name;
    judgeMade(*made, references, voxels);
  });
  if (!why.empty()) {
    GatheredVoxels failed;
    failed.output = voxels.output;
    failed.kind = voxels.kind;
    failed.whyNot = why;
    voxels = std::move(failed);
  }
  if (!voxels.whyNot.empty())
    logDetails("{}, {}: the voxels of {} are not judged: {}", point.scene, point.pipeline, voxels.output,
               voxels.whyNot);
  point.voxels = std::move(voxels);
}

}  // namespace lumivox::experiment
