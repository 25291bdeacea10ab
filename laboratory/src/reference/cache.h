// Keys and provenance of references.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "lumivox/base/hash.h"
#include "reference/render.h"

namespace lumivox::reference {

/// The version of the path tracer. Raise it with every change of images, so that older cached references are
/// not used.
inline constexpr int kTracerVersion = 4;
/// The same for changes that affect only images of scenes with media.
inline constexpr int kMediaVersion = 2;
/// The same for scenes with an environment.
inline constexpr int kEnvironmentVersion = 1;

/// Scene::hash, or for a scene made by code the hash of everything that the path tracer reads.
ContentHash contentOf(const Scene& scene);

/// The hash of everything that the image depends on.
ContentHash cacheKey(const Scene& scene, const ResolvedOptions& resolved);

/// Name of the entry's file.
std::string entryName(const ContentHash& key);
/// Marks an entry as used, so that it is not among the first to be removed.
void markAsUsed(const std::filesystem::path& file);

/// Keeps a reference in the cache; a failure is a warning.
void keepInCache(const Scene& scene, const ResolvedOptions& resolved, LayeredImage& image);

std::map<std::string, std::string> provenance(const Scene& scene, const ResolvedOptions& resolved);

}  // namespace lumivox::reference
