// Which objects move together.
#pragma once

#include <cstdint>
#include <vector>

#include "lumivox/scene/scene.h"

namespace lumivox {

/// The model of each of Scene::objects: 0 for all that stand still, then numbers from 1 on in the order of
/// the objects. Rigid objects of one motion are one model; what deforms is a model of its own.
std::vector<std::uint32_t> modelsOf(const Scene& scene);

}  // namespace lumivox
