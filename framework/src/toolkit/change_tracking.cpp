#include "lumivox/toolkit/change_tracking.h"

#include <algorithm>
#include <utility>

#include "lumivox/toolkit/bit_tree.h"
#include "lumivox/toolkit/counts.h"
#include "toolkit_shaders.h"

namespace lumivox {

namespace {

namespace code = shaders::toolkit;

/// Cells are bricks of 4 x 4 x 4 voxels, or larger ones where an axis would have more than 2^kMostCellDepth:
/// each cell is tested against all moving boxes.
constexpr int kLeastShift = 2, kMostCellDepth = 5;

/// The number of boxes around moving triangles behind which light may change; at least one for each draw.
constexpr std::uint32_t kBoxes = 64;

Bounds placed(const Bounds& bounds, const glm::mat4& toWorld) {
  Bounds result;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 local = glm::mix(bounds.low, bounds.high, glm::bvec3(corner & 1, corner & 2, corner & 4));
    result.grow(glm::vec3(toWorld * glm::vec4(local, 1.0f)));
  }
  return result;
}

/// The empty cells of a grid.
ChangedCells cellsOver(const GridPlacement& grid) {
  ChangedCells result;
  result.voxelDepth = voxelDepthOver(grid);
  result.cellDepth = std::clamp(result.voxelDepth - kLeastShift, 0, kMostCellDepth);
  return result;
}
std::uint64_t countOf(const ChangedCells& cells) {
  return std::uint64_t{1} << (3 * cells.cellDepth);
}

CellFragments sortedByCells(PassContext& frame, const VoxelFragments& still) {
  ChangedCells cells = cellsOver(still.grid);
  const CellFragments result{
      frame.emptyElements(code::changed_sort::cellEnds, countOf(cells), "fragments of cells"),
      frame.elements(code::changed_sort::cellFragments, still.capacity, "static fragments by cells")};
  cells.bits = result.ends;  // no cell has changed, and no shader here reads it
  const shader::BindingSet bindings{cells.bindings(), code::changed_sort::cellEnds(result.ends),
                                    code::changed_sort::cellFragments(result.fragments)};
  using Variant = code::changed_sort::Variant;
  forEachFragment(frame, frame.program(Variant{}), bindings, still);
  scan(frame, result.ends, countOf(cells));
  forEachFragment(frame, frame.program(Variant{.stage = Variant::stageFill}), bindings, still);
  return result;
}

/// Bindings of the list of changed cells.
shader::BindingSet listing(const ChangedCells& cells) {
  return {cells.bindings(), code::changed_mark::changedCount(cells.count),
          code::changed_mark::changedFragments(cells.fragments)};
}

/// The cells that hold moving fragments, with their list.
ChangedCells cellsOfMoving(PassContext& frame, const VoxelFragments& list) {
  ChangedCells result = cellsOver(list.grid);
  result.bits = frame.emptyElements(code::changed_mark::changedCells, wordsBeforeDepth(result.cellDepth + 1),
                                    "changed cells");
  result.fragments = frame.elements(code::changed_mark::changedFragments, list.capacity, "changed fragments");
  result.count = countBuffer(frame, "changed fragment count");
  forEachFragment(frame, frame.program(code::changed_mark::Variant{.moving = 1}),
                  {listing(result), bindStaticCount(list)}, movingOf(list));
  return result;
}

/// Marks the cells that light arrives in after it has passed through these bounds.
void markLit(PassContext& frame, const VoxelFragments& list, const CellFragments& still,
             const In<ShadowMap>& shadow, const std::vector<Bounds>& moving, const ChangedCells& result) {
  const BoxesInViews boxes(frame, shadow, moving);
  const int voxels = 1 << (result.voxelDepth - result.cellDepth);
  frame.dispatchList(frame.program(code::changed_lit::kProgram),
                     {code::changed_lit::cells({.gridLow = list.grid.low,
                                                .cellSize = static_cast<float>(voxels) * list.grid.voxelSize,
                                                .boxCount = boxes.count,
                                                .lightCount = boxes.lightCount,
                                                .texel = boxes.texel}),
                      code::changed_lit::cellEnds(still.ends), boxes.bindings(), result.bindings()},
                     countOf(result));
}

}  // namespace

VoxelFragments staticOf(const VoxelFragments& list) {
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

shader::BindingSet bindStaticCount(const VoxelFragments& list) {
  return {shader::StorageSlot{"StillFragments"}(list.still)};
}

shader::BindingSet ChangedCells::bindings() const {
  return {shader::UniformSlot<code::changed_mark::Changes>{"Changes"}({cellDepth, voxelDepth}),
          shader::StorageSlot{"ChangedCells"}(bits)};
}

void forEachChanged(PassContext& frame, const shader::BoundProgram& program,
                    const shader::BindingSet& bindings, const VoxelFragments& list,
                    const ChangedCells& changed) {
  frame.dispatchIndirect(program,
                         {bindings, FragmentBinding(list), shader::StorageSlot{"ChangedCount"}(changed.count),
                          shader::StorageSlot{"ChangedFragments"}(changed.fragments)},
                         *changed.count, kGroupsOffset);
}

LightPlacement lightPlacement(const PassContext& frame, const In<ShadowMap>& shadow, float brightest) {
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

BoxesInViews::BoxesInViews(PassContext& frame, const In<ShadowMap>& shadow, const std::vector<Bounds>& boxes)
    : count(static_cast<int>(boxes.size())), lights_(shadow) {
  std::vector<glm::vec4> corners;
  for (const Bounds& one : boxes)
    for (const glm::vec3& corner : {one.low, one.high}) corners.emplace_back(corner, 0.0f);
  bounds = frame.uploaded(corners, "bounds of what moves");
  const int views = shadow.present() ? shadow->layerCount : 0, all = count * views;
  casts = frame.elements(code::changed_views::casts, static_cast<std::uint64_t>(all),
                         "what moves in shadow views");
  if (all == 0) return;
  lightCount = lights_.count;
  texel = 2.0f / static_cast<float>(shadow->depth->description().width);
  frame.dispatch(frame.program(code::changed_views::kProgram),
                 {code::changed_views::boxes({count, views}), code::changed_views::moving(bounds),
                  code::changed_views::casts(casts), lights_},
                 {all, 1, 1});
}

std::vector<Bounds> boundsAtEither(const std::vector<Bounds>& now, const std::vector<Bounds>& then) {
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

std::optional<std::vector<Bounds>> ChangeTracking::moving(PassContext& frame) {
  const Scene& scene = frame.sceneDescription();
  const std::vector<SceneDraw>& draws = frame.scene().draws();
  std::uint32_t indices = 0;
  for (const SceneDraw& draw : draws) {
    if (!draw.moving) continue;
    if (scene.materials[static_cast<std::size_t>(draw.material)].emissive()) return std::nullopt;
    indices += draw.indexCount;
  }
  // Consecutive triangles mostly lie beside each other, so runs of them have small boxes.
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

std::optional<StaticLight> ChangeTracking::staticLight(PassContext& frame, const VoxelFragments& list,
                                                       const In<ShadowMap>& shadow, float brightest) {
  if (list.still == nullptr || list.reflected != nullptr || !moving(frame)) return std::nullopt;
  return StaticLight{list.still, lightPlacement(frame, shadow, brightest)};
}

LitMoment ChangeTracking::momentOfAll(PassContext& frame, const VoxelFragments& list) {
  return {*moving(frame), cellsOfMoving(frame, list).bits, {}};
}

LitMoment ChangeTracking::momentOfStatic(PassContext& frame, const VoxelFragments& list) {
  return {*moving(frame), nullptr, sortedByCells(frame, staticOf(list))};
}

ChangedCells ChangeTracking::since(PassContext& frame, const VoxelFragments& list,
                                   const In<ShadowMap>& shadow, LitMoment& moment) {
  if (moment.still.ends == nullptr) moment.still = sortedByCells(frame, staticOf(list));
  std::vector<Bounds> now = *moving(frame);
  const std::vector<Bounds> atEither = boundsAtEither(now, moment.moving);
  ChangedCells result = cellsOfMoving(frame, list);
  if (moment.movingCells != nullptr) {
    std::swap(result.bits, moment.movingCells);
    moment.moving = std::move(now);
    frame.dispatchList(frame.program(code::changed_join::kProgram),
                       {result.bindings(), code::changed_join::otherCells(moment.movingCells)},
                       wordsBeforeDepth(result.cellDepth + 1));
  }
  if (shadow.present() && !atEither.empty() && shadow->layerCount > 0)
    markLit(frame, list, moment.still, shadow, atEither, result);
  frame.dispatchList(frame.program(code::changed_list::kProgram),
                     {listing(result), code::changed_list::cellEnds(moment.still.ends),
                      code::changed_list::cellFragments(moment.still.fragments)},
                     countOf(result));
  finishCount(frame, result.count, list.capacity);
  return result;
}

}  // namespace lumivox
