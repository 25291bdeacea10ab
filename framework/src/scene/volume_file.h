// Density volumes from files (.vdb). OpenVDB takes longer to load than the rest of the program together, so
// its reader is a library of its own (framework/src/volume) that is opened when a scene names a volume file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "lumivox/base/hash.h"
#include "lumivox/scene/scene.h"

namespace lumivox {

/// One float grid of a volume file; an empty `grid` takes the only one. The grid's own linear transform gives
/// its place in metres; where that is not a uniform scale along the axes, the densities are resampled to
/// cubic voxels of the grid's shortest spacing. The file's bytes go into the hash. Throws Error naming file
/// and grid for a file that is no volume file or is damaged, an absent grid, one that holds no numbers or no
/// density (not float, a level set, negative or not finite values, a background other than 0, nothing at
/// all), a perspective transform, or one that does not fit.
DensityVolume readVolumeFile(const std::filesystem::path& file, const std::string& grid, Hasher& hasher);

/// Name and type of the library's function. It takes the bytes of the file, and the file's name for messages.
inline constexpr const char* kVolumeReaderSymbol = "lumivoxReadVolume";
using VolumeReader = void(std::string_view bytes, const char* file, const char* grid, DensityVolume& volume);

}  // namespace lumivox
