// The only door of the framework to OpenVDB: float grids become density volumes.
#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <cmath>
#include <istream>
#include <string>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/memory_stream.h"
#include "lumivox/scene/medium.h"
#include "scene/volume_file.h"

namespace lumivox {
namespace {

/// Refusals of one grid of one file.
struct Refusal {
  std::string file, grid;
  [[noreturn]] void operator()(const std::string& what, const std::string& expected) const {
    throw Error(grid.empty() ? fmt::format("{}: {}; expected {}", file, what, expected)
                             : fmt::format("{}: grid '{}' {}; expected {}", file, grid, what, expected));
  }
};

/// The grid with this name, or the only one.
openvdb::GridBase::Ptr readGrid(std::string_view bytes, const std::string& name, Refusal& refuse) {
  std::vector<std::string> names;
  openvdb::GridBase::Ptr grid;
  try {
    MemoryBuffer buffer(bytes);
    std::istream stream(&buffer);
    // OpenVDB does not check for the end of its stream and would use sizes that it never read.
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    const openvdb::GridPtrVecPtr grids = openvdb::io::Stream(stream, /*delayLoad=*/false).getGrids();
    for (const openvdb::GridBase::Ptr& one : *grids) {
      names.push_back(one->getName());
      if (name.empty() ? grids->size() == 1 : one->getName() == name) grid = one;
    }
    if (grid != nullptr) refuse.grid = grid->getName();
  } catch (const openvdb::Exception& error) {
    refuse(fmt::format("cannot be read as a volume file ({})", error.what()), "a whole .vdb file");
  } catch (const std::ios_base::failure&) {
    refuse("is damaged: it ends too early, or its parts contradict each other", "a whole .vdb file");
  } catch (const std::exception& error) {
    // A damaged file may ask for any amount of memory.
    refuse(fmt::format("is damaged ({})", error.what()), "a whole .vdb file");
  }
  if (grid == nullptr) {
    const std::string list = names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
    if (name.empty()) refuse("contains several grids and the text names none", "grid NAME, one of " + list);
    const std::string nearest = nearestWord(name, names);
    refuse(fmt::format("has no grid '{}'", name),
           "one of " + list + (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
  return grid;
}

/// A float grid that can be a density.
openvdb::FloatGrid::Ptr densityGrid(const openvdb::GridBase::Ptr& grid, const Refusal& refuse) {
  auto density = openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
  if (density == nullptr) refuse(fmt::format("contains values of type {}", grid->valueType()), "type float");
  if (!grid->transform().isLinear()) {
    refuse(fmt::format("has a transform that is not linear ({})", grid->transform().mapType()),
           "a linear one, without perspective");
  }
  if (grid->getGridClass() == openvdb::GRID_LEVEL_SET)
    refuse("is a level set, which contains distances", "a density (class fog volume)");
  if (density->background() != 0.0f)
    refuse(fmt::format("has the background {}, which has no end", density->background()), "0");
  if (density->activeVoxelCount() == 0) refuse("is empty", "at least one active voxel");
  for (auto value = density->cbeginValueOn(); value; ++value) {
    if (!std::isfinite(*value) || *value < 0.0f) {
      const openvdb::Coord at = value.getCoord();
      refuse(fmt::format("has the value {} at ({}, {}, {})", *value, at.x(), at.y(), at.z()),
             "finite densities that are not negative");
    }
  }
  return density;
}

void allocate(DensityVolume& volume, const glm::dvec3& size, const Refusal& refuse) {
  if (std::max({size.x, size.y, size.z}) > kLargestVolume) {
    refuse(fmt::format("covers {} x {} x {} voxels", size.x, size.y, size.z),
           fmt::format("at most {} along each side", kLargestVolume));
  }
  volume.resolution = glm::ivec3(size);
  const std::uint64_t count = static_cast<std::uint64_t>(size.x * size.y * size.z);
  requireMemory(count * sizeof(float), fmt::format("grid '{}' of {}", refuse.grid, refuse.file));
  volume.values.resize(count);
}

/// Calls fill(x, y, z) for all voxels in the order of the values.
template <class Fill>
void fillValues(DensityVolume& volume, Fill&& fill) {
  std::size_t i = 0;
  for (int z = 0; z < volume.resolution.z; ++z) {
    for (int y = 0; y < volume.resolution.y; ++y) {
      for (int x = 0; x < volume.resolution.x; ++x) volume.values[i++] = fill(x, y, z);
    }
  }
}

void toVolume(const openvdb::FloatGrid& grid, const Refusal& refuse, DensityVolume& volume) {
  const openvdb::math::Transform& transform = grid.transform();
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  const openvdb::Vec3d spacing = transform.voxelSize();
  const auto accessor = grid.getConstAccessor();
  // In OpenVDB whole index coordinates are the centres of voxels.
  const auto world = [&](const openvdb::Vec3d& index) {
    const openvdb::Vec3d p = transform.indexToWorld(index);
    return glm::dvec3(p.x(), p.y(), p.z());
  };
  const glm::dvec3 origin = world({0, 0, 0});
  const glm::dmat3 axes(world({1, 0, 0}) - origin, world({0, 1, 0}) - origin, world({0, 0, 1}) - origin);
  const double shortest = std::min({spacing.x(), spacing.y(), spacing.z()});
  if (!(shortest > 0.0) || !std::isfinite(glm::determinant(axes)) || glm::determinant(axes) == 0.0)
    refuse("has a transform without extent", "one that can be inverted");
  volume.voxelSize = shortest;

  double unevenness = 0.0;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row)
      unevenness = std::max(unevenness, std::abs(axes[column][row] - (row == column ? shortest : 0.0)));
  }
  constexpr double kRounding = 1e-9;  // relative: of a transform that was written as a decimal number
  if (unevenness <= kRounding * shortest) {
    const openvdb::Coord extent = box.extents(), first = box.min();
    allocate(volume, {extent.x(), extent.y(), extent.z()}, refuse);
    volume.low = world(first.asVec3d()) - 0.5 * shortest;
    fillValues(volume, [&](int x, int y, int z) { return accessor.getValue(first.offsetBy(x, y, z)); });
    return;
  }
  // Everything that trilinear interpolation can reach lies within one voxel of the active ones.
  glm::dvec3 low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p = world({corner & 1 ? box.max().x() + 1.0 : box.min().x() - 1.0,
                                corner & 2 ? box.max().y() + 1.0 : box.min().y() - 1.0,
                                corner & 4 ? box.max().z() + 1.0 : box.min().z() - 1.0});
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  allocate(volume, glm::max(glm::ceil((high - low) / shortest), 1.0), refuse);
  volume.low = low;
  fillValues(volume, [&](int x, int y, int z) {
    const glm::dvec3 centre = low + shortest * (glm::dvec3(x, y, z) + 0.5);
    float value = 0.0f;
    openvdb::tools::BoxSampler::sample(
        accessor, transform.worldToIndex(openvdb::Vec3d(centre.x, centre.y, centre.z)), value);
    return value;
  });
}

}  // namespace
}  // namespace lumivox

extern "C" void lumivoxReadVolume(std::string_view bytes, const char* file, const char* grid,
                                  lumivox::DensityVolume& volume);
void lumivoxReadVolume(std::string_view bytes, const char* file, const char* grid,
                       lumivox::DensityVolume& volume) {
  using namespace lumivox;
  openvdb::initialize();
  Refusal refuse{file, {}};
  const openvdb::GridBase::Ptr any = readGrid(bytes, grid, refuse);
  toVolume(*densityGrid(any, refuse), refuse, volume);
}
