#include "changed_cells.h"

#include <algorithm>
#include <utility>

#include "lumivox/toolkit/bindings.h"

namespace lumivox::voxel_cone_tracing {

using namespace shaders::voxel_cone_tracing;

namespace {

/// Cells are bricks of 4 x 4 x 4 voxels, and larger ones where there would be more of them along an axis:
/// each is looked for behind all that moves.
constexpr int kLeastShift = 2, kMostCellDepth = 5;

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

std::vector<Bounds> Changes::atEither(const std::vector<Bounds>& now, const std::vector<Bounds>& then) {
  const auto faces = [](const Bounds& box) {
    const glm::vec3 size = box.high - box.low;
    return size.x * size.y + size.y * size.z + size.z * size.x;
  };
  std::vector<Bounds> result = now;
  for (std::size_t i = 0; i < then.size(); ++i) {
    if (i < now.size()) {
      Bounds both = now[i];
      both.grow(then[i].low);
      both.grow(then[i].high);
      if (faces(both) <= faces(now[i]) + faces(then[i])) {
        result[i] = both;
        continue;
      }
    }
    result.push_back(then[i]);
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
  result.cellDepth = std::clamp(result.voxelDepth - kLeastShift, 0, kMostCellDepth);
  return result;
}
std::uint64_t countOf(const ChangedCells& cells) {
  return std::uint64_t{1} << (3 * cells.cellDepth);
}

/// Marks the cells in which light that passes through these bounds arrives.
void markLit(PassContext& frame, const VoxelFragments& list, const CellFragments& still,
             const In<ShadowMap>& shadow, const std::vector<Bounds>& moving, const ChangedCells& result) {
  const BoxesInViews boxes(frame, shadow, moving);
  const int voxels = 1 << (result.voxelDepth - result.cellDepth);
  frame.dispatchList(frame.program(changed_cells::kProgram),
                     {changed_cells::cells({.gridLow = list.grid.low,
                                            .cellSize = static_cast<float>(voxels) * list.grid.voxelSize,
                                            .boxCount = boxes.count,
                                            .lightCount = boxes.lightCount,
                                            .texel = boxes.texel}),
                      changed_cells::cellEnds(still.ends), boxes.bindings(), bindingOf(result)},
                     countOf(result));
}

}  // namespace

BoxesInViews::BoxesInViews(PassContext& frame, const In<ShadowMap>& shadow, const std::vector<Bounds>& boxes)
    : count(static_cast<int>(boxes.size())), lights_(shadow) {
  std::vector<glm::vec4> corners;
  for (const Bounds& one : boxes)
    for (const glm::vec3& corner : {one.low, one.high}) corners.emplace_back(corner, 0.0f);
  bounds = frame.uploaded(corners, "bounds of what moves");
  const int views = shadow.present() ? shadow->layerCount : 0, all = count * views;
  casts = frame.elements(changed_views::casts, static_cast<std::uint64_t>(all), "what moves in shadow views");
  if (all == 0) return;
  lightCount = lights_.count;
  texel = 2.0f / static_cast<float>(shadow->depth->description().width);
  frame.dispatch(frame.program(changed_views::kProgram),
                 {changed_views::boxes({count, views}), changed_views::moving(bounds),
                  changed_views::casts(casts), lights_},
                 {all, 1, 1});
}

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

namespace {

/// What is listed of changed cells.
shader::BindingSet listing(const ChangedCells& cells) {
  return {bindingOf(cells), changed_mark::changedCount(cells.count),
          changed_mark::changedFragments(cells.fragments)};
}

}  // namespace

ChangedCells Changes::movingCells(PassContext& frame, const VoxelFragments& list) {
  ChangedCells result = cellsOver(list.grid);
  result.bits =
      frame.emptyElements(changed_mark::changedCells, firstTagWord(result.cellDepth + 1), "changed cells");
  result.fragments = frame.elements(changed_mark::changedFragments, list.capacity, "changed fragments");
  result.count = frame.buffer(4 * sizeof(std::uint32_t), "changed fragment count");
  result.count->clear();
  forEachFragment(frame, frame.program(changed_mark::Variant{.moving = 1}),
                  {listing(result), behindStill(list)}, movingOf(list));
  return result;
}

ChangedCells Changes::cells(PassContext& frame, const VoxelFragments& list, const CellFragments& still,
                            const In<ShadowMap>& shadow, const std::vector<Bounds>& moving,
                            gpu::BufferRef* before) {
  ChangedCells result = movingCells(frame, list);
  if (before != nullptr) {
    std::swap(result.bits, *before);
    frame.dispatchList(frame.program(changed_join::kProgram),
                       {bindingOf(result), changed_join::otherCells(*before)},
                       firstTagWord(result.cellDepth + 1));
  }
  if (shadow.present() && !moving.empty() && shadow->layerCount > 0)
    markLit(frame, list, still, shadow, moving, result);
  frame.dispatchList(
      frame.program(changed_list::kProgram),
      {listing(result), changed_list::cellEnds(still.ends), changed_list::cellFragments(still.fragments)},
      countOf(result));
  frame.dispatch(frame.program(changed_arguments::kProgram), listing(result), {1, 1, 1});
  return result;
}

}  // namespace lumivox::voxel_cone_tracing
