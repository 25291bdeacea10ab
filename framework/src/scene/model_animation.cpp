#include "lumivox/scene/model_animation.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace lumivox {
namespace {

std::vector<double> normalised(std::vector<double> quaternion) {
  double length = 0.0;
  for (const double value : quaternion) length += value * value;
  length = std::sqrt(length);
  for (double& value : quaternion) value = length > 0.0 ? value / length : 0.0;
  if (!(length > 0.0)) quaternion[3] = 1.0;
  return quaternion;
}

std::vector<double> slerp(const std::vector<double>& a, const std::vector<double>& b, double weight) {
  const glm::dquat q =
      glm::slerp(glm::dquat(a[3], a[0], a[1], a[2]), glm::dquat(b[3], b[0], b[1], b[2]), weight);
  return {q.x, q.y, q.z, q.w};
}

/// The cofactor matrix with the sign of the determinant: it turns normals as the inverse transpose does, up
/// to a positive factor.
glm::mat3 cofactors(const glm::mat3& m) {
  const glm::mat3 result(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::dot(m[0], result[0]) < 0.0f ? -result : result;
}

}  // namespace

std::vector<double> AnimationTrack::at(double time) const {
  const bool isCubic = joining == Joining::cubic;
  /// Of a cubic key: 0 the in-tangent, 1 the value, 2 the out-tangent.
  const auto key = [&](std::size_t number, std::size_t which) {
    const std::size_t first = (isCubic ? 3 * number + which : number) * components;
    return std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(first),
                               values.begin() + static_cast<std::ptrdiff_t>(first + components));
  };
  const auto upper = std::upper_bound(times.begin(), times.end(), time, [](double wanted, float one) {
    return wanted < static_cast<double>(one);
  });
  const auto next = static_cast<std::size_t>(upper - times.begin());
  std::vector<double> result;
  if (next == 0 || next == times.size() || joining == Joining::step) {
    result = key(next == 0 ? 0 : next - 1, 1);
  } else {
    const double span = static_cast<double>(times[next]) - static_cast<double>(times[next - 1]);
    const double t = (time - static_cast<double>(times[next - 1])) / span;
    const std::vector<double> a = key(next - 1, 1), b = key(next, 1);
    if (!isCubic && isRotation) return slerp(normalised(a), normalised(b), t);
    result.resize(components);
    if (!isCubic) {
      for (std::size_t c = 0; c < components; ++c) result[c] = (1.0 - t) * a[c] + t * b[c];
    } else {
      // glTF 2.0, Appendix C.4: a Hermite spline whose tangents are scaled by the span.
      const std::vector<double> out = key(next - 1, 2), in = key(next, 0);
      const double t2 = t * t, t3 = t2 * t;
      for (std::size_t c = 0; c < components; ++c)
        result[c] = (2 * t3 - 3 * t2 + 1) * a[c] + span * (t3 - 2 * t2 + t) * out[c] +
                    (3 * t2 - 2 * t3) * b[c] + span * (t3 - t2) * in[c];
    }
  }
  return isRotation ? normalised(std::move(result)) : result;
}

double AnimatedModel::timeOf(double time) const {
  if (duration <= 0.0) return 0.0;
  if (!loop) return std::clamp(time, 0.0, duration);
  const double rest = std::fmod(time, duration);
  return rest < 0.0 ? rest + duration : rest;
}

glm::dmat4 AnimatedModel::globalOf(std::size_t node, double time) const {
  glm::dmat4 result(1.0);
  for (; node != AnimatedNode::kNone; node = nodes[node].parent) {
    const AnimatedNode& one = nodes[node];
    if (one.matrix) {
      result = *one.matrix * result;
      continue;
    }
    glm::dvec3 translation = one.translation, scale = one.scale;
    glm::dquat rotation = one.rotation;
    const auto vectorAt = [&](std::size_t track) {
      const std::vector<double> value = tracks[track].at(time);
      return glm::dvec3(value[0], value[1], value[2]);
    };
    if (one.translationTrack != AnimatedNode::kNone) translation = vectorAt(one.translationTrack);
    if (one.scaleTrack != AnimatedNode::kNone) scale = vectorAt(one.scaleTrack);
    if (one.rotationTrack != AnimatedNode::kNone) {
      const std::vector<double> value = tracks[one.rotationTrack].at(time);
      rotation = glm::dquat(value[3], value[0], value[1], value[2]);
    }
    result = glm::translate(glm::dmat4(1.0), translation) * glm::mat4_cast(rotation) *
             glm::scale(glm::dmat4(1.0), scale) * result;
  }
  return result;
}

bool AnimatedModel::moves(std::size_t node) const {
  for (; node != AnimatedNode::kNone; node = nodes[node].parent) {
    const AnimatedNode& one = nodes[node];
    if (one.translationTrack != AnimatedNode::kNone || one.rotationTrack != AnimatedNode::kNone ||
        one.scaleTrack != AnimatedNode::kNone)
      return true;
  }
  return false;
}

std::vector<double> AnimatedModel::sampleTimes(std::size_t most) const {
  std::vector<double> keys{0.0, duration};
  for (const AnimationTrack& track : tracks) {
    for (const float time : track.times)
      if (time > 0.0f && static_cast<double>(time) < duration) keys.push_back(time);
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  constexpr std::size_t kBetween = 8;  // arcs of a turn of 180 degrees miss 2 % of its radius
  std::vector<double> result;
  // Every key as long as there is room for it: what moves turns round there.
  const std::size_t between = std::min(kBetween, most / keys.size());
  if (between == 0) {
    for (std::size_t i = 0; i + 1 < most; ++i)
      result.push_back(duration * static_cast<double>(i) / static_cast<double>(most - 1));
  } else {
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
      for (std::size_t k = 0; k < between; ++k)
        result.push_back(keys[i] +
                         (keys[i + 1] - keys[i]) * static_cast<double>(k) / static_cast<double>(between));
    }
  }
  // The end itself is the start where the animation loops.
  result.push_back(std::nextafter(duration, 0.0));
  return result;
}

ModelAnimation::ModelAnimation(std::shared_ptr<const AnimatedModel> model, std::size_t node,
                               std::shared_ptr<const VertexDeformation> deformation)
    : model_(std::move(model)), node_(node), deformation_(std::move(deformation)) {}

std::shared_ptr<const ModelAnimation> ModelAnimation::placedBy(const glm::dmat4& placement) const {
  auto result = std::make_shared<ModelAnimation>(*this);
  result->placement_ = placement * placement_;
  return result;
}

glm::dmat4 ModelAnimation::placementAt(double time) const {
  if (deformation_ && deformation_->skin != AnimatedNode::kNone) return placement_;
  return placement_ * model_->globalOf(node_, model_->timeOf(time));
}

std::vector<double> ModelAnimation::weightsAt(double time) const {
  const std::size_t track = model_->nodes[node_].weightsTrack;
  if (track != AnimatedNode::kNone) return model_->tracks[track].at(time);
  return {deformation_->weights.begin(), deformation_->weights.end()};
}

void ModelAnimation::deform(double time, std::vector<glm::vec3>& positions,
                            std::vector<glm::vec3>& normals) const {
  const VertexDeformation& deformation = *deformation_;
  const double local = model_->timeOf(time);
  positions = deformation.positions;
  normals = deformation.normals;
  const std::vector<double> weights = weightsAt(local);
  for (std::size_t target = 0; target < deformation.positionDeltas.size(); ++target) {
    const auto weight = static_cast<float>(weights[target]);
    if (weight == 0.0f) continue;
    for (std::size_t v = 0; v < positions.size(); ++v) {
      positions[v] += weight * deformation.positionDeltas[target][v];
      normals[v] += weight * deformation.normalDeltas[target][v];
    }
  }
  if (deformation.skin != AnimatedNode::kNone) {
    const AnimatedSkin& skin = model_->skins[deformation.skin];
    std::vector<glm::mat4> joints;
    for (std::size_t j = 0; j < skin.joints.size(); ++j)
      joints.emplace_back(model_->globalOf(skin.joints[j], local) * skin.inverseBind[j]);
    for (std::size_t v = 0; v < positions.size(); ++v) {
      glm::mat4 blended(0.0f);
      for (std::size_t set = 0; set < deformation.sets; ++set) {
        const VertexDeformation::Influence& influence = deformation.influences[set * positions.size() + v];
        for (std::size_t k = 0; k < 4; ++k)
          if (influence.weights[k] != 0.0f) blended += influence.weights[k] * joints[influence.joints[k]];
      }
      positions[v] = glm::vec3(blended * glm::vec4(positions[v], 1.0f));
      normals[v] = cofactors(glm::mat3(blended)) * normals[v];
    }
  }
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const double length = glm::length(glm::dvec3(normals[v]));
    normals[v] = length > 1e-20 ? glm::vec3(glm::dvec3(normals[v]) / length) : deformation.normals[v];
  }
}

std::vector<double> ModelAnimation::sampleTimes() const {
  constexpr std::size_t kMost = 4096, kMostOfVertices = 256;  // deforming places every vertex each time
  return model_->sampleTimes(deforms() ? kMostOfVertices : kMost);
}

void ModelAnimation::addTo(Hasher& hasher) const {
  hasher.bytes(&placement_, sizeof placement_)
      .add(std::uint64_t{node_})
      .add(model_->duration)
      .add(model_->loop);
  for (const AnimatedNode& node : model_->nodes) {
    hasher.add(std::uint64_t{node.parent}).add(node.matrix.has_value());
    const glm::dmat4 matrix = node.matrix.value_or(glm::dmat4(1.0));
    hasher.bytes(&matrix, sizeof matrix).bytes(&node.translation, sizeof node.translation);
    hasher.bytes(&node.scale, sizeof node.scale).bytes(&node.rotation, sizeof node.rotation);
    for (const std::size_t track :
         {node.translationTrack, node.rotationTrack, node.scaleTrack, node.weightsTrack})
      hasher.add(std::uint64_t{track});
  }
  for (const AnimationTrack& track : model_->tracks)
    hasher.add(track.joining).add(track.isRotation).add(track.times).add(track.values);
  for (const AnimatedSkin& skin : model_->skins) hasher.add(skin.joints).add(skin.inverseBind);
  if (!deformation_) return;
  const VertexDeformation& deformation = *deformation_;
  hasher.add(deformation.positions).add(deformation.normals).add(deformation.weights);
  for (const auto& target : deformation.positionDeltas) hasher.add(target);
  for (const auto& target : deformation.normalDeltas) hasher.add(target);
  hasher.add(std::uint64_t{deformation.skin}).add(deformation.influences);
}

bool deforms(const Object& object) {
  return object.sequence.has_value() || (object.animation != nullptr && object.animation->deforms());
}

}  // namespace lumivox
