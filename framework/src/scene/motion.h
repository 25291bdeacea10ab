// Evaluation of keys and rigid motion at a time.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <vector>

#include "lumivox/scene/scene.h"

namespace lumivox {

/// Below this length of a mean of two unit directions, the directions count as opposite: nothing tells which
/// way to turn.
inline constexpr double kShortestMean = 1e-3;

/// A value by keys in rising order of time. `valueOf` gives a key's value, or null where the key does not set
/// it: such keys are passed over. Linear: before the first key that sets it the value is the first key's.
/// Step: there it is `own`. Behind the last key it stays. `own` if no key sets it.
template <class Key, class Value, class ValueOf>
Value valueAt(const std::vector<Key>& keys, Interpolation interpolation, double time, const Value& own,
              const ValueOf& valueOf) {
  const Key *before = nullptr, *after = nullptr;
  for (const Key& key : keys) {
    if (valueOf(key) == nullptr) continue;
    if (key.time > time) {
      after = &key;
      break;
    }
    before = &key;
  }
  if (before == nullptr)
    return after == nullptr || interpolation == Interpolation::step ? own : *valueOf(*after);
  if (after == nullptr || interpolation == Interpolation::step) return *valueOf(*before);
  const double weight = std::clamp((time - before->time) / (after->time - before->time), 0.0, 1.0);
  if constexpr (std::is_same_v<Value, glm::vec3> || std::is_same_v<Value, float>) {
    return glm::mix(*valueOf(*before), *valueOf(*after), static_cast<float>(weight));
  } else {
    return glm::mix(*valueOf(*before), *valueOf(*after), weight);
  }
}

/// World space before motion to world space at a time, s.
glm::dmat4 rigidMotionAt(const RigidMotion& motion, double time);

/// The light as it is at a time, s, without motion. Error where two keys' directions are opposite.
Light lightAt(const Light& light, double time);

}  // namespace lumivox
