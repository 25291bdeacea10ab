// Whether a reference has to be made.
#pragma once

#include "lumivox/reference/path_tracer.h"

namespace lumivox::reference {

/// Whether cachedReference() finds it among those that are kept, so that it costs no more than reading it.
bool isKept(const Scene& scene, const ReferenceOptions& options);

}  // namespace lumivox::reference
