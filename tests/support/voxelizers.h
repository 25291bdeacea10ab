// Every voxelizer of triangles, alone and in a pipeline.
#pragma once

#include <string>
#include <vector>

#include "support/passes.h"
#include "support/voxel_fragments.h"

namespace lumivox::test {

struct Voxelizer {
  std::string pass;
  Settings settings = {};
  bool columns = true;     ///< samples triangles at the centres of voxel columns; else at arbitrary points
  bool attributes = true;  ///< else all fragments are black
  bool sums = false;       ///< the coverages of a voxel's fragments add up; else each counts alone
  std::string words() const {
    std::string result;
    for (const Setting& one : settings) result += one.text() + ' ';
    return result;
  }
  std::string name() const { return pass + ' ' + words(); }
};
inline const std::vector<Voxelizer> kVoxelizers{
    {"conservative", {{"method", "raster"}}},
    {"conservative", {{"method", "compute"}}},
    {"slicing", {{"axes", 3}}},
    {"depth_peeling"},
    {.pass = "msaa_opacity", .sums = true},
    {.pass = "points", .settings = {{"adaptive", "on"}, {"density", 8}}, .columns = false},
    {.pass = "atlas_attributes", .columns = false},
    {.pass = "atlas_binary", .columns = false, .attributes = false}};

inline Voxels voxelized(const Scene& scene, const Voxelizer& by, const Settings& settings,
                        std::uint64_t seed = 1) {
  LonePass pass("voxelization." + by.pass, scene, by.settings);
  return voxelsOf(pass.with(settings).run(seed).out<VoxelFragments>("fragments"));
}
inline Voxels voxelized(const Scene& scene, const Voxelizer& by, int resolution) {
  return voxelized(scene, by, {{"resolution", resolution}});
}

/// Checks that each level of the stacks is the union of the finer one, at full depth.
inline void checkLevelsAreUnions(const BinaryGrid& grid) {
  const gpu::TextureDescription& description = grid.stacks->description();
  CHECK(description.levels == gpu::fullLevelCount(grid.grid.resolution.x, grid.grid.resolution.y));
  std::set<Cell> finer = cellsOf(grid);
  CHECK(!finer.empty());
  for (int level = 1; level < description.levels; ++level) {
    std::set<Cell> expected;
    for (const Cell& cell : finer)
      expected.insert({std::min(cell[0] / 2, std::max(description.width >> level, 1) - 1),
                       std::min(cell[1] / 2, std::max(description.height >> level, 1) - 1), cell[2]});
    CHECK(cellsOf(grid, level) == expected);
    finer = expected;
  }
}

/// Frames of a pipeline with one voxelizer, whose fragments are kept for reading.
class VoxelizedFrames {
 public:
  VoxelizedFrames(const Scene& scene, const Voxelizer& by, const std::string& words,
                  const RenderOptions& options = {})
      : executor(device(), techniques(), scene,
                 Pipeline::parse("pipeline \"voxels\" {\n  pass voxels voxelization." + by.pass + " { " +
                                     by.words() + words + " }\n}\n",
                                 "made_by_a_test.pipeline"),
                 options) {
    executor.keepOutput("voxels", "fragments");
  }
  const VoxelFragments& list() const { return kept<VoxelFragments>(executor, "voxels", "fragments"); }
  Voxels at(double time, int frame = 0) {
    executor.render(time, frame, PipelineExecutor::Images::no);
    return voxelsOf(list());
  }
  bool reusesStill() const { return reused(executor, "static geometry"); }

  PipelineExecutor executor;
};

}  // namespace lumivox::test
