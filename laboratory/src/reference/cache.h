// Keys and provenance of references.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "lumivox/base/hash.h"
#include "reference/render.h"

namespace lumivox::reference {

/// The version of the path tracer; raise it with every change that changes images, so that older cached
/// references are not taken.
inline constexpr int kTracerVersion = 4;
/// The same for what changes images of scenes with media alone.
inline constexpr int kMediaVersion = 2;

/// Scene::hash, or for a scene made by code the hash of all that the path tracer reads.
ContentHash contentOf(const Scene& scene);

/// Everything that the image depends on.
ContentHash cacheKey(const Scene& scene, const ResolvedOptions& resolved);

/// Name of the entry's file.
std::string entryName(const ContentHash& key);
/// Notes that an entry was taken, so that it is not among the first to give way.
void markAsUsed(const std::filesystem::path& file);

std::map<std::string, std::string> provenance(const Scene& scene, const ResolvedOptions& resolved);

}  // namespace lumivox::reference
