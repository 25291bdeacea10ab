// Tolerances of values that a sampler has filtered.
#pragma once

#include <algorithm>

#include "support/techniques.h"

namespace lumivox::test {

/// The relative tolerance of a value that a sampler filtered, which is `exact` where weights are floats:
/// graphics cards weigh texels by steps of 1/256.
inline float filtered(float exact) {
  return device().info().software ? exact : std::max(exact, 0.02f);
}

}  // namespace lumivox::test
