// The grammar of scene texts: the tables from which the checker, `lumivox describe` and the generated
// reference read.
#pragma once

#include <vector>

#include "lumivox/dsl/schema.h"

namespace lumivox {

/// One block, `scene NAME { ... }`, with everything that may stand inside.
const std::vector<dsl::BlockSpecification>& sceneSpecifications();

}  // namespace lumivox
