// Voxelizes the inside of closed meshes (solid voxelization by parity along columns).
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "../aside.h"
#include "bit_voxelizer.h"
#include "lumivox/scene/topology.h"

namespace lumivox::voxelization {

using namespace shaders::voxelization;

namespace {

/// The closed surfaces of an object.
struct ClosedSurface {
  std::string name;                                    ///< of the object
  std::uint32_t firstTriangle = 0, triangleCount = 0;  ///< in the triangle list of all objects
  Bounds bounds;                                       ///< object space, at rest
  bool room = false;                                   ///< whether its front sides face inwards
};

/// Columns that an object may occupy.
struct Columns {
  glm::ivec2 low{0}, size{0};
};

Columns columnsOf(const Bounds& bounds, const glm::mat4& toWorld, const GridPlacement& grid) {
  const Bounds inGrid = boundsInGrid(bounds, toWorld, grid);
  const glm::vec2 most(grid.resolution);
  const glm::ivec2 low(glm::clamp(glm::floor(glm::vec2(inGrid.low)), glm::vec2(0.0f), most));
  const glm::ivec2 high(glm::clamp(glm::ceil(glm::vec2(inGrid.high)), glm::vec2(0.0f), most));
  return {low, high - low};
}

class SolidPass : public BitVoxelizer {
  enum class Inwards { leave, fill };

  In<VoxelFragments> base{this, "fragments", Presence::optional,
                          "surface samples to which the inside is added; their grid is used"};
  Param<Inwards> inwards{
      this, "inwards", Inwards::leave,
      "closed surfaces whose front sides face inwards; leave: they are rooms, which hold air; fill: they are solid like the others"};

  static constexpr std::size_t kMostNames = 8;  // of objects in one message

  const VoxelFragments* surface() const override { return base.present() ? &*base : nullptr; }

  void mark(PassContext& frame, const GridPlacement& grid, const gpu::Texture& words,
            const Draws& draws) override {
    if (triangles_ == nullptr) findClosedSurfaces(frame);
    std::set<int> objects;
    std::vector<std::string> rooms;
    for (const SceneDraw* draw : draws) {
      const ClosedSurface& closed = surfaces_[static_cast<std::size_t>(draw->object)];
      if (closed.triangleCount == 0 || objects.count(draw->object) == 1) continue;
      if (!closed.room || inwards == Inwards::fill)
        objects.insert(draw->object);
      else if (const std::string name = "'" + closed.name + "'"; rooms.empty() || rooms.back() != name)
        rooms.push_back(name);
    }
    if (!rooms.empty())
      frame.warn(
          fmt::format("closed but facing inwards, so treated as rooms full of air: {}", listed(rooms)));
    if (objects.empty()) return;
    const gpu::TextureRef parity = bitWords(frame, grid, "parity");
    const Aside aside(frame, mostTriangles_);
    // Within an object a second surface inside the first is a cavity; overlapping objects are both solid.
    for (const int object : objects) fillObject(frame, grid, words, *parity, aside, object);
  }

  void fillObject(PassContext& frame, const GridPlacement& grid, const gpu::Texture& words,
                  const gpu::Texture& parity, const Aside& aside, int object) const {
    const ClosedSurface& closed = surfaces_[static_cast<std::size_t>(object)];
    const ObjectState& state = frame.snapshot().objects[static_cast<std::size_t>(object)];
    const Columns columns = state.positions.empty() ? columnsOf(closed.bounds, state.toWorld, grid)
                                                    : Columns{{0, 0}, {grid.resolution.x, grid.resolution.y}};
    if (columns.size.x <= 0 || columns.size.y <= 0) return;
    aside.dispatch(frame, solid_flip::Variant{}, solid_flip::Constants{},
                   {SceneBinding(frame, SceneDraw{object}), gridBinding(grid),
                    solid_flip::surface(
                        {static_cast<int>(closed.firstTriangle), static_cast<int>(closed.triangleCount)}),
                    solid_flip::triangles(triangles_), solid_flip::parity(parity)},
                   closed.triangleCount);
    frame.dispatch(frame.program(solid_fill::kProgram),
                   {solid_fill::parameters({columns.low, columns.size, grid.resolution.z}),
                    solid_fill::parity(parity), solid_fill::words(words)},
                   {columns.size, 1});
  }

  /// Once per scene: the connectivity of surfaces does not change while they move.
  void findClosedSurfaces(PassContext& frame) {
    const Scene& scene = frame.sceneDescription();
    std::vector<std::uint32_t> triangles;
    std::vector<std::string> open;
    for (const Object& object : scene.objects) {
      const WeldedObject welded = weld(scene, object);
      const std::vector<SurfaceComponent> components = surfaceComponents(welded);
      std::size_t openEdges = 0;
      double volume = 0.0;
      for (const SurfaceComponent& component : components) {
        openEdges += component.openEdges;
        if (component.closed()) volume += component.volume;
      }
      if (openEdges > 0) open.push_back(fmt::format("'{}' ({} open edges)", object.name, openEdges));
      ClosedSurface& closed = surfaces_.emplace_back();
      closed.name = object.name;
      closed.room = volume < 0.0;
      closed.firstTriangle = static_cast<std::uint32_t>(triangles.size());
      for (const SurfaceComponent& component : components) {
        if (!component.closed()) continue;
        for (const std::uint32_t t : component.triangles) {
          triangles.push_back(welded.firstIndices[t] / 3);
          for (std::size_t k = 0; k < 3; ++k)
            closed.bounds.grow(welded.places[welded.corners[3 * std::size_t{t} + k]]);
        }
      }
      closed.triangleCount = static_cast<std::uint32_t>(triangles.size()) - closed.firstTriangle;
      mostTriangles_ = std::max(mostTriangles_, closed.triangleCount);
    }
    if (!open.empty()) frame.warn(fmt::format("not closed, so without an inside: {}", listed(open)));
    triangles_ = frame.uploaded(triangles, "triangles of closed surfaces");
  }

  static std::string listed(const std::vector<std::string>& names) {
    const auto shown = static_cast<std::ptrdiff_t>(std::min(names.size(), kMostNames));
    std::string text = fmt::format("{}", fmt::join(names.begin(), names.begin() + shown, ", "));
    if (names.size() > kMostNames) text += fmt::format(" and {} more", names.size() - kMostNames);
    return text;
  }

  std::vector<ClosedSurface> surfaces_;  ///< per object
  std::uint32_t mostTriangles_ = 0;      ///< of one object
  gpu::BufferRef triangles_;
};

}  // namespace

void addSolid(TechniqueRegistry& registry) {
  registry.add<SolidPass>("solid", "The inside of closed meshes, by parity along columns");
}

}  // namespace lumivox::voxelization
