// Motion that a model file brings along: nodes that move, morph targets and skins (glTF 2.0, Sec. 3.7.2.2,
// 3.7.3 and 3.11). A function of the time alone.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/base/hash.h"
#include "lumivox/scene/scene.h"

namespace lumivox {

/// Values at rising times, s. A cubic track has three values a key: in-tangent, value, out-tangent.
struct AnimationTrack {
  enum class Joining { linear, step, cubic };
  Joining joining = Joining::linear;
  bool isRotation = false;  ///< quaternions (x y z w), joined on the sphere
  std::size_t components = 3;
  std::vector<float> times;
  std::vector<float> values;

  /// The components at a time; the first and the last key hold outside.
  std::vector<double> at(double time) const;
};

/// A node of the hierarchy.
struct AnimatedNode {
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t parent = kNone;
  std::optional<glm::dmat4> matrix;  ///< in place of the three below
  glm::dvec3 translation{0}, scale{1};
  glm::dquat rotation{1, 0, 0, 0};
  std::size_t translationTrack = kNone, rotationTrack = kNone, scaleTrack = kNone, weightsTrack = kNone;
};

struct AnimatedSkin {
  std::vector<std::size_t> joints;  ///< nodes
  std::vector<glm::dmat4> inverseBind;
};

/// The nodes of a model file with the animation that plays.
struct AnimatedModel {
  std::vector<AnimatedNode> nodes;
  std::vector<AnimationTrack> tracks;
  std::vector<AnimatedSkin> skins;
  double duration = 0.0;  ///< s
  bool loop = true;       ///< else the last state stays

  /// The time within the animation at a time of the scene.
  double timeOf(double time) const;
  /// Node to the space of the file, at a time within the animation.
  glm::dmat4 globalOf(std::size_t node, double time) const;
  /// Whether a track moves the node or one above it.
  bool moves(std::size_t node) const;
  /// Times of all keys and of points between them, rising, from 0 up to the duration; at most `most`.
  std::vector<double> sampleTimes(std::size_t most) const;
};

/// How the vertices of one object deform.
struct VertexDeformation {
  struct Influence {
    std::array<std::uint32_t, 4> joints{};
    std::array<float, 4> weights{};
  };
  std::vector<glm::vec3> positions, normals;                         ///< before morphing
  std::vector<std::vector<glm::vec3>> positionDeltas, normalDeltas;  ///< [target][vertex]
  std::vector<float> weights;                                        ///< of the targets without a track
  std::size_t skin = AnimatedNode::kNone;
  std::vector<Influence> influences;  ///< four a vertex, `sets` after one another
  std::size_t sets = 0;
};

/// The motion of one object.
class ModelAnimation {
 public:
  ModelAnimation(std::shared_ptr<const AnimatedModel> model, std::size_t node,
                 std::shared_ptr<const VertexDeformation> deformation = nullptr);
  /// The same of an object that a mesh block places.
  std::shared_ptr<const ModelAnimation> placedBy(const glm::dmat4& placement) const;

  bool deforms() const { return deformation_ != nullptr; }
  /// Object space to the world before the object's rigid motion, at a time of the scene, s. A skin places its
  /// vertices itself.
  glm::dmat4 placementAt(double time) const;
  /// Vertices and unit normals in object space. Only of an object that deforms.
  void deform(double time, std::vector<glm::vec3>& positions, std::vector<glm::vec3>& normals) const;
  /// Times of the scene at which everything that the animation covers is seen.
  std::vector<double> sampleTimes() const;
  void addTo(Hasher& hasher) const;

 private:
  std::vector<double> weightsAt(double time) const;
  std::shared_ptr<const AnimatedModel> model_;
  std::size_t node_;
  std::shared_ptr<const VertexDeformation> deformation_;
  glm::dmat4 placement_{1.0};
};

/// Whether the vertices of an object move in its own space.
bool deforms(const Object& object);

}  // namespace lumivox
