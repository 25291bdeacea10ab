#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/global_control.h>

#include "competitors.h"

namespace lumivox::bench {

struct NarrowBand::State {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
};

NarrowBand::NarrowBand(const Mesh& mesh) : state_(std::make_unique<State>()) {
  openvdb::initialize();
  for (const glm::vec3& position : mesh.positions)
    state_->points.emplace_back(position.x, position.y, position.z);
  for (const Mesh::Triangle& triangle : mesh.triangles)
    state_->triangles.emplace_back(triangle.corner[0], triangle.corner[1], triangle.corner[2]);
}
NarrowBand::~NarrowBand() = default;

std::uint64_t NarrowBand::convert(int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  constexpr float kBand = 3.0f;  // voxels to each side, OpenVDB's default
  // The mesh is in voxel units already.
  const auto grid = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(
      *openvdb::math::Transform::createLinearTransform(1.0), state_->points, state_->triangles, kBand);
  return grid->activeVoxelCount();
}

}  // namespace lumivox::bench
