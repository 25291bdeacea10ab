#include "changed_cells.h"

#include <algorithm>

#include "lumivox/toolkit/bindings.h"

namespace lumivox::voxel_cone_tracing {

using namespace shaders::voxel_cone_tracing;

namespace {

constexpr int kCellShift = 3;  // 8 voxels along a cell

/// Light is looked for behind about so many boxes around what moves, and one for each draw at least.
constexpr std::uint32_t kBoxes = 64;

Bounds placed(const Bounds& bounds, const glm::mat4& toWorld) {
  Bounds result;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 local = glm::mix(bounds.low, bounds.high, glm::bvec3(corner & 1, corner & 2, corner & 4));
    result.grow(glm::vec3(toWorld * glm::vec4(local, 1.0f)));
  }
  return result;
}

}  // namespace

shader::BindingSet bindingOf(const ChangedCells& cells, int stillShift) {
  return {
      shader::UniformSlot<changed_mark::Changes>{"Changes"}({cells.cellDepth, cells.voxelDepth, stillShift}),
      shader::StorageSlot{"ChangedCells"}(cells.bits)};
}

int voxelDepthOver(const GridPlacement& grid) {
  int depth = 1;
  while ((1 << depth) < grid.longest()) ++depth;
  return depth;
}

std::uint64_t firstTagWord(int depth) {
  return depth < 2 ? static_cast<std::uint64_t>(depth) : 2 + ((std::uint64_t{1} << (3 * depth - 5)) - 2) / 7;
}

VoxelFragments stillOf(const VoxelFragments& list) {
  VoxelFragments result = list;
  result.count = list.still;
  result.still = result.moving = nullptr;
  return result;
}

VoxelFragments movingOf(const VoxelFragments& list) {
  VoxelFragments result = list;
  result.count = list.moving;
  return result;
}

shader::BindingSet behindStill(const VoxelFragments& list) {
  return {shader::StorageSlot{"StillFragments"}(list.still)};
}

std::optional<std::vector<Bounds>> Changes::moving(PassContext& frame) {
  const Scene& scene = frame.sceneDescription();
  const std::vector<SceneDraw>& draws = frame.scene().draws();
  std::uint32_t indices = 0;
  for (const SceneDraw& draw : draws) {
    if (!draw.moving) continue;
    if (scene.materials[static_cast<std::size_t>(draw.material)].emissive()) return std::nullopt;
    indices += draw.indexCount;
  }
  // Triangles that follow each other mostly lie beside each other.
  const std::uint32_t each = 3 * ((indices / 3 + kBoxes - 1) / kBoxes);
  atRest_.resize(draws.size());
  std::vector<Bounds> result;
  for (std::size_t i = 0; i < draws.size(); ++i) {
    const SceneDraw& draw = draws[i];
    if (!draw.moving) continue;
    const ObjectState& state = frame.snapshot().objects[static_cast<std::size_t>(draw.object)];
    const bool deforms = !state.positions.empty();
    std::vector<Bounds>& boxes = atRest_[i];
    if (deforms) boxes.clear();
    if (boxes.empty()) {
      const std::uint32_t firstVertex = scene.objects[static_cast<std::size_t>(draw.object)].firstVertex;
      for (std::uint32_t k = 0; k < draw.indexCount; ++k) {
        if (k % each == 0) boxes.emplace_back();
        const std::uint32_t vertex = scene.indices[draw.firstIndex + k];
        boxes.back().grow(deforms ? state.positions[vertex - firstVertex] : scene.positions[vertex]);
      }
    }
    for (const Bounds& box : boxes) result.push_back(placed(box, state.toWorld));
  }
  return result;
}

LightPlacement Changes::placementOf(const PassContext& frame, const In<ShadowMap>& shadow, float brightest) {
  const SceneSnapshot& snapshot = frame.snapshot();
  LightPlacement result{.lights = snapshot.lights,
                        .low = snapshot.bounds.low,
                        .high = snapshot.bounds.high,
                        .brightest = brightest};
  if (!shadow.present()) return result;
  result.lightCount = shadow->lightCount;
  result.layerCount = shadow->layerCount;
  result.side = shadow->depth->description().width;
  return result;
}

namespace {

/// Cells of a grid; nothing in them.
ChangedCells cellsOver(const GridPlacement& grid) {
  ChangedCells result;
  result.voxelDepth = voxelDepthOver(grid);
  result.cellDepth = std::max(result.voxelDepth - kCellShift, 0);
  return result;
}
std::uint64_t countOf(const ChangedCells& cells) {
  return std::uint64_t{1} << (3 * cells.cellDepth);
}

/// Marks the cells in which light that passes through these bounds arrives.
void markLit(PassContext& frame, const VoxelFragments& list, const CellFragments& still,
             const In<ShadowMap>& shadow, const std::vector<Bounds>& moving, const ChangedCells& result) {
  std::vector<glm::vec4> boxes;
  for (const Bounds& one : moving)
    for (const glm::vec3& corner : {one.low, one.high}) boxes.emplace_back(corner, 0.0f);
  const LightBinding lights(shadow);
  const int boxCount = static_cast<int>(moving.size()), casts = boxCount * shadow->layerCount;
  const gpu::BufferRef cast = frame.elements(changed_views::casts, static_cast<std::uint64_t>(casts),
                                             "what moves in shadow views"),
                       bounds = frame.uploaded(boxes, "bounds of what moves");
  frame.dispatch(frame.program(changed_views::kProgram),
                 {changed_views::boxes({boxCount, shadow->layerCount}), changed_views::moving(bounds),
                  changed_views::casts(cast), lights},
                 {casts, 1, 1});
  const int voxels = 1 << (result.voxelDepth - result.cellDepth);
  frame.dispatchList(
      frame.program(changed_cells::kProgram),
      {changed_cells::cells({.gridLow = list.grid.low,
                             .cellSize = static_cast<float>(voxels) * list.grid.voxelSize,
                             .boxCount = boxCount,
                             .lightCount = lights.count,
                             .texel = 2.0f / static_cast<float>(shadow->depth->description().width)}),
       changed_cells::casts(cast), changed_cells::cellEnds(still.ends), lights, bindingOf(result)},
      countOf(result));
}

}  // namespace

CellFragments sortedByCells(PassContext& frame, const VoxelFragments& still) {
  ChangedCells cells = cellsOver(still.grid);
  const CellFragments result{
      frame.emptyElements(changed_sort::cellEnds, countOf(cells), "fragments of cells"),
      frame.elements(changed_sort::cellFragments, still.capacity, "static fragments by cells")};
  cells.bits = result.ends;  // no cell has changed, and no shader here asks
  const shader::BindingSet bindings{bindingOf(cells), changed_sort::cellEnds(result.ends),
                                    changed_sort::cellFragments(result.fragments)};
  forEachFragment(frame, frame.program(changed_sort::Variant{}), bindings, still);
  frame.dispatch(frame.program(changed_scan::kProgram), bindings, {1, 1, 1});
  forEachFragment(frame, frame.program(changed_sort::Variant{.stage = changed_sort::Variant::stageFill}),
                  bindings, still);
  return result;
}

void forEachChanged(PassContext& frame, const shader::BoundProgram& program,
                    const shader::BindingSet& bindings, const VoxelFragments& list,
                    const ChangedCells& changed) {
  frame.dispatchIndirect(program,
                         {bindings, FragmentBinding(list), shader::StorageSlot{"ChangedCount"}(changed.count),
                          shader::StorageSlot{"ChangedFragments"}(changed.fragments)},
                         *changed.count, sizeof(std::uint32_t));
}

ChangedCells Changes::cells(PassContext& frame, const VoxelFragments& list, const CellFragments& still,
                            const In<ShadowMap>& shadow, const std::vector<Bounds>& moving) {
  ChangedCells result = cellsOver(list.grid);
  result.bits =
      frame.emptyElements(changed_mark::changedCells, firstTagWord(result.cellDepth + 1), "changed cells");
  result.fragments = frame.elements(changed_mark::changedFragments, list.capacity, "changed fragments");
  result.count = frame.buffer(4 * sizeof(std::uint32_t), "changed fragment count");
  result.count->clear();
  const shader::BindingSet bindings{bindingOf(result), changed_mark::changedCount(result.count),
                                    changed_mark::changedFragments(result.fragments)};
  forEachFragment(frame, frame.program(changed_mark::Variant{.moving = 1}), {bindings, behindStill(list)},
                  movingOf(list));
  if (shadow.present() && !moving.empty() && shadow->layerCount > 0)
    markLit(frame, list, still, shadow, moving, result);
  frame.dispatchList(
      frame.program(changed_list::kProgram),
      {bindings, changed_list::cellEnds(still.ends), changed_list::cellFragments(still.fragments)},
      countOf(result));
  frame.dispatch(frame.program(changed_arguments::kProgram), bindings, {1, 1, 1});
  return result;
}

}  // namespace lumivox::voxel_cone_tracing
