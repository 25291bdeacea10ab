// What moves changes only a part of a grid or of an octree: the rest is kept, and nothing tells a frame from
// the first one of a fresh run; and what that costs, in every store.
#include <algorithm>
#include <array>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include "support/kept_table.h"
#include "support/moving_room.h"
#include "support/octree.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr std::array kGrids{"voxel_cone_tracing", "voxel_cone_tracing_directional",
                            "voxel_cone_tracing_coarse_directional"};
constexpr std::array kOctrees{"voxel_cone_tracing_octree", "voxel_cone_tracing_octree_directional"};
std::vector<std::string> gridsAndOctrees() {
  std::vector<std::string> all(kGrids.begin(), kGrids.end());
  all.insert(all.end(), kOctrees.begin(), kOctrees.end());
  return all;
}

/// All that a grid or an octree holds.
struct Voxels {
  std::vector<std::vector<float>> levels;  ///< of each texture, or of each face of the bricks
  std::set<std::uint32_t> bricks;
  float unit = 1.0f;
  bool operator==(const Voxels& other) const {
    const auto sameBits = [](const std::vector<float>& a, const std::vector<float>& b) {
      return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
    };
    return unit == other.unit && bricks == other.bricks && std::ranges::equal(levels, other.levels, sameBits);
  }
};

/// A grid of one of the pipelines that stays readable. `settings` are parameters of the pass that injects.
class Run {
 public:
  Run(const std::string& name, const Scene& scene, int resolution = 32, const std::string& settings = "",
      const std::string& ambient = "0")
      : isOctree_(name.rfind(kOctrees[0], 0) == 0),
        isDirectional_(name != kGrids[0]),
        pipeline_(withSettings(name, settings)),
        executor_(device(), techniques(), scene, pipeline_, optionsFor(resolution, ambient)) {
    executor_.keepOutput(filled(), "mips");
  }
  /// The pass that fills all levels.
  const char* filled() const { return isOctree_ ? "bricks" : "grid"; }
  Voxels at(double time, int frame = 0) {
    executor_.render(time, frame);
    Voxels result;
    if (isOctree_) {
      add(result,
          static_cast<const Out<octree::RadianceOctree>*>(executor_.output("bricks", "mips"))->value());
      return result;
    }
    OccupiedBricks occupied;
    if (isDirectional_) {
      const auto& grid =
          static_cast<const Out<DirectionalRadianceGrid>*>(executor_.output("grid", "mips"))->value();
      add(result, grid.finest);
      for (const gpu::TextureRef& face : grid.faces) add(result, face);
      occupied = grid.occupied;
      result.unit = grid.unit;
    } else {
      const auto& grid = static_cast<const Out<RadianceGrid>*>(executor_.output("grid", "mips"))->value();
      add(result, grid.radiance);
      occupied = grid.occupied;
      result.unit = grid.unit;
    }
    const auto words = occupied.bricks->downloadValues<std::uint32_t>();
    const std::uint32_t count = occupied.count->downloadValues<std::uint32_t>().at(0);
    result.bricks = {words.begin(), words.begin() + count};
    CHECK(result.bricks.size() == count);
    return result;
  }
  PipelineExecutor& executor() { return executor_; }
  ParameterValues parameters(const std::vector<std::string>& assignments) const {
    return pipeline_.settings(assignments);
  }

 private:
  Pipeline withSettings(const std::string& name, const std::string& settings) const {
    const Pipeline committed = pipeline(name);
    if (isOctree_) return committed;
    std::string source = committed.document->source;
    const std::string parameter = "  param cones", place = "    fragments voxels.fragments\n";
    source.insert(source.find(place), "    ambient $ambient\n    " + settings + "\n");
    source.insert(source.find(parameter), "  param ambient 0 in 0..10\n");
    return Pipeline::parse(source, committed.file);
  }
  RenderOptions optionsFor(int resolution, const std::string& ambient) const {
    RenderOptions result;
    result.width = result.height = 8;
    std::vector<std::string> assignments{"resolution=" + std::to_string(resolution)};
    if (!isOctree_) assignments.push_back("ambient=" + ambient);
    result.parameters = parameters(assignments);
    return result;
  }
  static void add(Voxels& voxels, const gpu::TextureRef& texture) {
    if (texture == nullptr) return;
    for (int level = 0; level < texture->description().levels; ++level)
      voxels.levels.push_back(texture->downloadFloats(level));
  }

  static void add(Voxels& voxels, const octree::RadianceOctree& octree) {
    voxels.unit = octree.unit;
    for (int level = 0; level <= octree.tree.depth; ++level)
      for (int face = 0; face < octree.faces; ++face) {
        std::vector<float> values;
        for (const auto& [place, brick] : octree::bricksOf(octree, level, face)) {
          for (const int i : place) values.push_back(static_cast<float>(i));
          for (const glm::vec4& texel : brick)
            values.insert(values.end(), {texel.x, texel.y, texel.z, texel.w});
        }
        CHECK_FALSE(values.empty());
        voxels.levels.push_back(std::move(values));
      }
  }

  bool isOctree_, isDirectional_;
  Pipeline pipeline_;
  PipelineExecutor executor_;
};

/// A tenth of the triangles of `arcade` turn and travel: pots, plants and a cloth.
Scene movingArcade() {
  Scene scene = loadScene(sourceDirectory() / "scenes/arcade.scene");
  std::size_t moving = 0;
  for (Object& object : scene.objects) {
    const bool isCloth = object.name == "house/cloth_red";
    if (!isCloth && object.name != "house/pots" && object.name != "house/plants") continue;
    glm::dvec3 low(1e9), high(-1e9);
    for (std::uint32_t i = object.firstVertex; i < object.firstVertex + object.vertexCount; ++i) {
      low = glm::min(low, glm::dvec3(scene.positions[i]));
      high = glm::max(high, glm::dvec3(scene.positions[i]));
    }
    // Within the walls: bounds that change move the sun's shadow map, and all light with it.
    object.motion =
        RigidMotion{{0, 1, 0}, isCloth ? 0.2 : 0.02, 0.5 * (low + high), {isCloth ? 0.0 : 0.2, 0, 0.1}};
    object.placedBounds.reset();
    object.sweptBounds.reset();
    for (const Part& part : object.parts) moving += part.indexCount / 3;
  }
  const double share = static_cast<double>(moving) / static_cast<double>(scene.triangleCount());
  REQUIRE(share > 0.095);
  REQUIRE(share < 0.105);
  return scene;
}

}  // namespace

TEST_CASE("after any sequence of times grids and octrees are those of a fresh run at that time, to the bit") {
  for (const std::string& name : gridsAndOctrees())
    for (const RoomLight& one : kRoomLights) {
      if (name == kOctrees[1] && one.light != lamp) continue;
      const Scene scene = movingRoom(one.light);
      Run run(name, scene);
      int frame = 0;
      // Forwards, backwards, the same time again, and far away and back.
      for (const double time : {0.0, 0.1, 0.2, 0.5, 0.3, 0.3, 6.0, 0.4}) {
        CAPTURE(name, one.name, time);
        const bool same = run.at(time, frame++) == Run(name, scene).at(time);
        CHECK(same);
      }
      CHECK(reusesStill(run.executor(), "light"));
      CHECK(reusesStill(run.executor(), run.filled()));
    }
}

TEST_CASE("grids of any size and precision are those of a fresh run while things move") {
  const Scene scene = movingRoom(lamp);
  for (const char* name : kGrids)
    for (const int resolution : {1, 5, 17, 50}) {
      const std::string settings = resolution == 17 ? "precision half" : "light_samples 3";
      Run run(name, scene, resolution, settings);
      int frame = 0;
      for (const double time : {0.0, 0.6, 5.0, 0.1}) {
        CAPTURE(name, resolution, time);
        const bool same = run.at(time, frame++) == Run(name, scene, resolution, settings).at(time);
        CHECK(same);
      }
    }
}

TEST_CASE("a parameter, a light or a scene that changes while things move makes grids anew") {
  const Scene scene = movingRoom(lamp);
  Scene brighter = movingRoom(lamp), other = movingRoom(spot);
  brighter.lights.front().power *= 2.0f;
  for (const char* name : kGrids) {
    CAPTURE(name);
    Run run(name, scene);
    int frame = 0;
    const auto sameAs = [&](Run&& fresh, double time) { return run.at(time, frame++) == fresh.at(time); };
    CHECK(sameAs(Run(name, scene), 0.0));
    CHECK(sameAs(Run(name, scene), 0.1));
    run.executor().setParameters(run.parameters({"resolution=32", "ambient=1"}));
    CHECK(sameAs(Run(name, scene, 32, "", "1"), 0.2));
    CHECK(sameAs(Run(name, scene, 32, "", "1"), 0.3));
    for (const Scene* next : std::array<const Scene*, 3>{&brighter, &other, &scene}) {
      run.executor().setScene(*next);
      for (const double time : {0.4, 0.5, 0.2}) CHECK(sameAs(Run(name, *next, 32, "", "1"), time));
    }
  }
}

TEST_CASE("what stands still is kept in grids and octrees, and not where all of it is lit anew") {
  for (const std::string& name : gridsAndOctrees())
    for (const bool lightMoves : {false, true}) {
      Scene scene = movingRoom(lamp);
      if (lightMoves)
        for (Object& object : scene.objects)
          if (object.animated())
            scene.materials[static_cast<std::size_t>(object.parts[0].material)].emission = glm::vec3(1.0f);
      Run run(name, scene);
      CAPTURE(name, lightMoves);
      for (int frame = 0; frame < 3; ++frame) {
        const bool same = run.at(0.1 * frame, frame) == Run(name, scene).at(0.1 * frame);
        CHECK(same);
      }
      CHECK(reusesStill(run.executor(), "light") == !lightMoves);
      CHECK(reusesStill(run.executor(), run.filled()) == !lightMoves);
      if (run.filled() == std::string("grid")) continue;
      CHECK(reusesStill(run.executor(), "voxels"));
      CHECK(reusesStill(run.executor(), "tree"));
    }
}

TEST_CASE(
    "moving a tenth of the triangles costs a third of a full rebuild at most, or half where bricks are copied",
    "[.]") {
  // Voxels, light and levels; the least of several times, in turns: voxel_cone_tracing_tests "moving a
  // tenth*". Of six faces in an octree the bricks of what stands still are copied; at 64 voxels the
  // dispatches that find what changed are a third of so little work.
  const Scene scene = movingArcade();
  KeptTable table("voxel_cone_tracing.moving", {{"slowly", 2, 0.1, 0.3, true}, {"far", 2, 0.1, 0.3, true}});
  for (const char* name :
       {"voxel_cone_tracing", "voxel_cone_tracing_directional", "voxel_cone_tracing_coarse_directional",
        "voxel_cone_tracing_octree", "voxel_cone_tracing_octree_directional", "voxel_cone_tracing_clipmap"})
    for (const char* resolution : {"64", "128", "256"}) {
      // Its light would take 264 MiB of one buffer, twice what OpenGL promises.
      if (name == std::string("voxel_cone_tracing_clipmap") && resolution == std::string("256")) continue;
      RenderOptions options;
      options.width = options.height = 8;
      options.parameters = pipeline(name).settings({std::string("resolution=") + resolution});
      PipelineExecutor executor(device(), techniques(), scene, pipeline(name), options);
      const bool isOctree = std::string(name).find("octree") != std::string::npos;
      executor.keepOutput(isOctree ? "bricks" : "grid", "mips");
      int frame = 0;
      std::string parts;
      const auto milliseconds = [&](double time) {
        executor.render(time, frame++, PipelineExecutor::Images::no, PipelineExecutor::Timing::passes);
        double sum = 0.0;
        parts.clear();
        for (const auto& passes : executor.timedPasses())
          for (const PassRecord& pass : passes)
            if (pass.ran && (pass.name == "voxels" || pass.name == "tree" || pass.name == "light" ||
                             pass.name == "grid" || pass.name == "bricks")) {
              sum += pass.deviceMs;
              parts += " " + pass.name + " " + std::to_string(pass.deviceMs);
            }
        return sum;
      };
      double full = 1e9, slow = 1e9, fast = 1e9;
      std::array<std::string, 3> of;
      const auto least = [&](double& value, std::size_t place, double time) {
        const double now = milliseconds(time);
        if (now < value) of[place] = parts;
        value = std::min(value, now);
      };
      for (int turn = 0; turn < 3; ++turn) {
        executor.invalidate();
        least(full, 0, 0.0);
        milliseconds(0.01);
        milliseconds(0.02);
        for (int i = 3; i < 6; ++i) least(slow, 1, 0.01 * i);
        for (int i = 0; i < 4; ++i) least(fast, 2, i % 2 == 0 ? 3.0 : 0.0);
      }
      table.row(std::string(name) + ", " + resolution, {slow / full, fast / full});
      WARN(name << " " << resolution << ": full " << full << " ms; slowly " << slow / full << ", far "
                << fast / full << "\n  full:" << of[0] << "\n  slowly:" << of[1] << "\n  far:" << of[2]);
      const bool copies = name == std::string("voxel_cone_tracing_octree_directional"),
                 little = resolution == std::string("64");
      CHECK(slow < (copies || little ? 0.5 : 1.0 / 3.0) * full);
      // Where things have moved far, cells change at both places.
      CHECK(fast < 0.7 * full);
    }
}
