#include "scene/volume_file.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/installation.h"

namespace lumivox {
namespace {

constexpr const char* kLibrary = "liblumivox_volume.so";

/// The reader, from the folder of this library. It stays open: closing it would unload OpenVDB's types.
VolumeReader* openReader() {
  void* handle = dlopen((libraryFolder() / kLibrary).c_str(), RTLD_NOW | RTLD_LOCAL);
  void* symbol = handle == nullptr ? nullptr : dlsym(handle, kVolumeReaderSymbol);
  if (symbol == nullptr) {
    throw Error(
        fmt::format("the reader of volume files cannot be opened: {}; expected {} beside liblumivox, "
                    "where `ninja lumivox_volume` builds it",
                    dlerror(), kLibrary));
  }
  return reinterpret_cast<VolumeReader*>(symbol);
}

}  // namespace

DensityVolume readVolumeFile(const std::filesystem::path& file, const std::string& grid, Hasher& hasher) {
  const std::string bytes = readFile(file, kLargestVolumeFile);
  hasher.add(bytes);
  static VolumeReader* const reader = openReader();
  DensityVolume volume;
  reader(bytes, file.c_str(), grid.c_str(), volume);
  return volume;
}

}  // namespace lumivox
