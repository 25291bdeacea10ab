// A reference in parts: the sums of some samples of some pixels, which merge to the bits of one run.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "lumivox/reference/path_tracer.h"

namespace lumivox {

/// Renders part `index` of `count` (from 1 on) of a reference, so many of the tiles and of the blocks of 4096
/// samples, and writes its sums into a file. Parts are of the size of their pixels and blocks, about 400
/// bytes each. Error as renderReference().
void renderReferencePart(const Scene& scene, const ReferenceOptions& options, std::size_t index,
                         std::size_t count, const std::filesystem::path& file);

/// The reference that renderReference() would give, from all of its parts in any order; a part may be there
/// twice. It is kept in the cache where the options use it. Error that names the file for one that is damaged
/// or of another reference, and for samples that no part has.
LayeredImage mergedReference(const Scene& scene, const ReferenceOptions& options,
                             const std::vector<std::filesystem::path>& files);

}  // namespace lumivox
