// The state of a forest's nodes at a time.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <span>

#include "forest.h"

namespace lumivox::implicit_visibility {
namespace {

/// An object's vertices in the world at a time.
class PlacedObject {
 public:
  PlacedObject(const Scene& scene, const SceneSnapshot& snapshot, std::uint32_t object)
      : scene_(&scene), state_(&snapshot.objects[object]), first_(scene.objects[object].firstVertex) {}

  glm::vec3 position(std::uint32_t vertex) const {
    const glm::vec3& local =
        state_->positions.empty() ? scene_->positions[vertex] : state_->positions[vertex - first_];
    return glm::vec3(state_->toWorld * glm::vec4(local, 1.0f));
  }
  glm::vec3 normal(std::uint32_t vertex) const {
    const glm::vec3& local =
        state_->normals.empty() ? scene_->normals[vertex] : state_->normals[vertex - first_];
    return unit(state_->normalToWorld * local);
  }
  std::array<glm::vec3, 3> corners(std::uint32_t triangle) const {
    const std::uint32_t* at = &scene_->indices[3 * triangle];
    return {position(at[0]), position(at[1]), position(at[2])};
  }
  /// Vector along the front side's normal with twice the triangle's area as its length.
  glm::vec3 doubleArea(std::uint32_t triangle) const {
    const auto [a, b, c] = corners(triangle);
    return glm::cross(b - a, c - a);
  }
  static glm::vec3 unit(const glm::vec3& vector) {
    const float length = glm::length(vector);
    return length > 0.0f ? vector / length : glm::vec3(0.0f);
  }

 private:
  const Scene* scene_;
  const ObjectState* state_;
  std::uint32_t first_;
};

class StateMaker {
 public:
  StateMaker(const Forest& forest, const Scene& scene, const SceneSnapshot& snapshot, Areas areas)
      : forest_(forest), scene_(scene), tree_(*forest.tree), areas_(areas) {
    for (std::uint32_t o = 0; o < scene.objects.size(); ++o) objects_.emplace_back(scene, snapshot, o);
    state_.position.resize(tree_.nodeCount);
    state_.area.resize(tree_.nodeCount);
    state_.normal.resize(tree_.nodeCount);
    state_.radius.resize(tree_.nodeCount);
    state_.reach.resize(tree_.nodeCount);
    state_.still.resize(tree_.nodeCount);
    if (!tree_.firstCorner.empty()) state_.corners.resize(tree_.firstCorner.back());
  }

  ElementState make() {
    for (const ElementTree::Run& run : tree_.levels)
      tbb::parallel_for(tbb::blocked_range<std::uint32_t>(run.first, run.first + run.count),
                        [&](const auto& range) {
                          for (std::uint32_t node = range.begin(); node < range.end(); ++node)
                            if (tree_.isLeaf(node))
                              placeLeaf(node);
                            else
                              average(node);
                        });
    for (std::uint32_t node = 0; node < tree_.nodeCount; ++node) state_.still[node] = isStill(node);
    return std::move(state_);
  }

 private:
  /// Whether triangles may stretch: they deform, or their node may be scaled.
  bool changesShape(const Leaf& leaf) const {
    const Object& object = scene_.objects[leaf.object];
    return object.sequence.has_value() || object.animation != nullptr;
  }

  /// The area at rest times the stretching; 0 for a triangle that has become a point or a line.
  float areaOf(const Leaf& leaf, std::uint32_t node, const PlacedObject& object,
               const glm::vec3& normal) const {
    if (normal == glm::vec3(0.0f)) return 0.0f;
    if (!changesShape(leaf)) return leaf.area;
    float area = 0.0f;
    if (leaf.vertex == kNoElement)
      area = 0.5f * glm::length(object.doubleArea(leaf.triangle));
    else
      for (std::uint32_t i = forest_.origins.firstTriangle[node]; i < forest_.origins.firstTriangle[node + 1];
           ++i)
        area += 0.5f * glm::length(object.doubleArea(forest_.origins.triangles[i]));
    if (!(area > 0.0f)) return 0.0f;
    const float rest = forest_.restTriangleArea[node];
    return areas_ == Areas::now && rest > 0.0f ? leaf.area * (area / rest) : leaf.area;
  }

  void placeLeaf(std::uint32_t node) {
    const Leaf& leaf = forest_.origins.leaves[node];
    const PlacedObject& object = objects_[leaf.object];
    if (leaf.vertex == kNoElement) {
      const auto [a, b, c] = object.corners(leaf.triangle);
      state_.position[node] = a + leaf.second * (b - a) + leaf.third * (c - a);
      state_.normal[node] = PlacedObject::unit(object.doubleArea(leaf.triangle));
    } else {
      state_.position[node] = object.position(leaf.vertex);
      state_.normal[node] = object.normal(leaf.vertex);
    }
    state_.area[node] = areaOf(leaf, node, object, state_.normal[node]);
    state_.radius[node] = state_.reach[node] = std::sqrt(0.5f * state_.area[node]);
    if (leaf.outline.count > 0) placeOutline(node, leaf, object);
  }

  /// Corners follow the triangle. With areas at rest the outline is scaled to keep its area.
  void placeOutline(std::uint32_t node, const Leaf& leaf, const PlacedObject& object) {
    const auto [a, b, c] = object.corners(leaf.triangle);
    float scale = state_.area[node] > 0.0f ? 1.0f : 0.0f;
    if (changesShape(leaf) && areas_ == Areas::rest && scale > 0.0f) {
      const float now = 0.5f * glm::length(object.doubleArea(leaf.triangle));
      scale = std::sqrt(forest_.restTriangleArea[node] / now);
    }
    float squared = 0.0f;
    for (std::uint32_t i = 0; i < leaf.outline.count; ++i) {
      const glm::vec2& at = leaf.outline.corners[i];
      const glm::vec3 corner = scale * (at.x * (b - a) + at.y * (c - a));
      state_.corners[tree_.firstCorner[node] + i] = corner;
      squared = std::max(squared, glm::dot(corner, corner));
    }
    state_.reach[node] = std::sqrt(squared);
  }

  void average(std::uint32_t node) {
    glm::vec3 position(0.0f), plain(0.0f), normal(0.0f), shown(0.0f);
    float area = 0.0f, count = 0.0f;
    for (const std::uint32_t child : tree_.childrenOf(node)) {
      if (child == kNoElement) continue;
      const float childArea = state_.area[child];
      position += childArea * state_.position[child];
      plain += state_.position[child];
      normal += childArea * state_.normal[child];
      shown += tree_.isGroup(child) ? state_.normal[child] : childArea * glm::abs(state_.normal[child]);
      area += childArea;
      count += 1.0f;
    }
    state_.position[node] = area > 0.0f ? position / area : plain / count;
    state_.area[node] = area;
    state_.normal[node] = tree_.isGroup(node) ? shown : area > 0.0f ? normal / area : glm::vec3(0.0f);
    state_.radius[node] = std::sqrt(0.5f * area);
    float reach = 0.0f;
    for (const std::uint32_t child : tree_.childrenOf(node))
      if (child != kNoElement && state_.area[child] > 0.0f)
        reach = std::max(reach,
                         glm::distance(state_.position[child], state_.position[node]) + state_.reach[child]);
    state_.reach[node] = reach;
  }

  bool isStill(std::uint32_t node) const {
    const std::uint32_t object = tree_.objectOfNode[node];
    if (object != kNoElement) return !scene_.objects[object].animated();
    for (const std::uint32_t child : tree_.childrenOf(node))
      if (child != kNoElement && !state_.still[child]) return false;
    return true;
  }

  const Forest& forest_;
  const Scene& scene_;
  const ElementTree& tree_;
  Areas areas_;
  std::vector<PlacedObject> objects_;
  ElementState state_;
};

}  // namespace

ElementState stateOf(const Forest& forest, const Scene& scene, const SceneSnapshot& snapshot, Areas areas) {
  return StateMaker(forest, scene, snapshot, areas).make();
}

}  // namespace lumivox::implicit_visibility
