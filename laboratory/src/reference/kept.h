// Whether a reference is in the cache.
#pragma once

#include "lumivox/reference/path_tracer.h"

namespace lumivox::reference {

/// Whether cachedReference() finds the reference in the cache, so that it only has to be read.
bool isKept(const Scene& scene, const ReferenceOptions& options);

}  // namespace lumivox::reference
