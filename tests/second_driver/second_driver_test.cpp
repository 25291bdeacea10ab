// A second OpenGL driver: Mesa's zink over lavapipe (Debian package mesa-vulkan-drivers), which needs no
// graphics processor and goes another way from SPIR-V to machine code than llvmpipe. Both are made in one
// process: EGL looks at the environment when a display is first used, and the surfaceless platform and the
// first software device are two displays.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/scene/scene.h"
#include "support/techniques.h"

using namespace lumivox;
namespace fs = std::filesystem;

namespace {

/// RMS of the difference that a pipeline may have between the drivers, as a share of the mean.
struct Agreement {
  double most;
  const char* why;
};
constexpr double kSame = 1e-5;
// Reasons are explained in docs/gpu.md, "A second driver".
const std::map<std::string, Agreement> kLessAlike = {
    {"voxel_cone_tracing_depth_of_field",
     {5e-5, "a cone ends at an opacity, and a lamp outshines what it ends at"}},
};

struct Drivers {
  std::unique_ptr<gpu::Device> first, second;
  std::string failures;  ///< why there is no second one
};

/// Where Mesa's packages put the description of lavapipe for the loader of Vulkan.
bool isInstalled() {
  std::error_code none;
  for (const auto& entry : fs::directory_iterator("/usr/share/vulkan/icd.d", none))
    if (entry.path().filename().string().starts_with("lvp_icd")) return true;
  return false;
}

/// The second one is null where it is not installed.
Drivers& drivers() {
  static Drivers both = [] {
    Drivers made;
    made.first = std::make_unique<gpu::Device>(gpu::DeviceOptions{"surfaceless"});
    setenv("MESA_LOADER_DRIVER_OVERRIDE", "zink", 1);
    setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
    // EGL counts hardware devices first; there are few.
    for (const char* index : {"0", "1", "2", "3"}) {
      try {
        auto device = std::make_unique<gpu::Device>(gpu::DeviceOptions{index});
        if (device->info().renderer.rfind("zink", 0) != 0 || !device->info().software) continue;
        made.second = std::move(device);
        break;
      } catch (const Error& error) {
        // No such device, or one that lacks something.
        made.failures += fmt::format("\n{}: {}", index, error.what());
      }
    }
    return made;
  }();
  return both;
}

ImageBuffer imageBy(gpu::Device& device, const Scene& scene, const Pipeline& pipeline, bool health) {
  constexpr int kPixels = 48;  // along a side: linking programs is what takes time
  RenderOptions options;
  options.width = options.height = kPixels;
  options.health = health;
  FrameResult frame = PipelineExecutor(device, test::techniques(), scene, pipeline, options).render(0.0);
  if (health) CHECK(frame.healthFindings == std::vector<std::string>{});
  const auto whole = frame.outputs.find("final");
  return whole != frame.outputs.end() ? whole->second : frame.outputs.begin()->second;
}

/// Root of the mean squared difference over the mean.
double differenceOf(const ImageBuffer& image, const ImageBuffer& reference) {
  REQUIRE(image.sameShape(reference));
  double squares = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < image.values().size(); ++i) {
    const double one = image.values()[i], other = reference.values()[i];
    REQUIRE(std::isfinite(one));
    squares += (one - other) * (one - other);
    sum += other;
  }
  const auto count = static_cast<double>(image.values().size());
  REQUIRE(sum > 0.0);
  return std::sqrt(squares / count) / (sum / count);
}

/// By how much the images of the two drivers differ, as differenceOf().
/// Zink of Mesa 22.3.6 makes another image of `smoke` by imperfect_volumes_propagation in about one process
/// of sixty on a busy machine (docs/gpu.md): a difference counts when the second driver makes it twice. The
/// first driver must make the same bits whenever it is asked.
double differenceBetween(Drivers& both, const Scene& scene, const Pipeline& pipeline, bool health,
                         double most) {
  const ImageBuffer first = imageBy(*both.first, scene, pipeline, false);
  const double difference = differenceOf(imageBy(*both.second, scene, pipeline, health), first);
  if (difference <= most) return difference;
  CHECK(imageBy(*both.first, scene, pipeline, false).values() == first.values());
  const double again = differenceOf(imageBy(*both.second, scene, pipeline, health), first);
  if (again <= most) WARN("the second driver made another image once, by " << difference << " of the mean");
  return again;
}

/// The images of these pipelines that the drivers make differently, with what they differ by.
std::vector<std::string> differing(const std::vector<std::string>& names) {
  std::vector<std::string> found;
  Drivers& both = drivers();
  if (both.second == nullptr && isInstalled())
    FAIL("the second driver is installed, and no device of it can be made:" << both.failures);
  if (both.second == nullptr) {
    test::skip(
        "the second driver, zink over lavapipe, is not installed (Debian package mesa-vulkan-drivers)");
    return found;
  }
  // Without captured pictures one of the techniques makes direct light alone.
  const bool captured = names == std::vector<std::string>{"captured_frames"};
  const std::vector<std::string> places = captured
                                              ? std::vector<std::string>{"mixed_reality"}
                                              : std::vector<std::string>{"cornell", "spinning_box", "smoke"};
  for (const std::string& place : places) {
    // Its memory is what MALLOC_PERTURB_ (tests/CMakeLists.txt) makes of it, so that texels that nobody wrote
    // are found when something reads them. Downloading what ports hold takes time: on one scene.
    const bool health = place == places.front();
    const Scene scene = loadScene(test::sourceDirectory() / "scenes" / fmt::format("{}.scene", place));
    for (const std::string& name : names) {
      const Pipeline pipeline = test::pipeline(name);
      const auto listed = kLessAlike.find(name);
      const double most = listed != kLessAlike.end() ? listed->second.most : kSame;
      const double difference = differenceBetween(both, scene, pipeline, health, most);
      if (std::getenv("LUMIVOX_PRINT_MEASURED") != nullptr)
        fmt::print("{} {} {:.2g}\n", name, place, difference);
      if (!(difference <= most))
        found.push_back(fmt::format("{} on {}: an RMS of {} of the mean", name, place, difference));
    }
  }
  return found;
}
const std::vector<std::string> kNone;

// Each pipeline stands in one case, so that none takes long. The last case finds those that stand in none.
const std::map<std::string, std::vector<std::string>> kCases = {
    {"direct light",
     {"direct_lighting", "screen_space", "reflective_shadow_maps", "virtual_area_lights",
      "virtual_area_lights_all_bounces"}},
    {"captured frames", {"captured_frames"}},
    {"imperfect volumes",
     {"imperfect_volumes", "imperfect_volumes_occlusion", "imperfect_volumes_visible",
      "imperfect_volumes_all_bounces"}},
    {"imperfect volumes by propagation", {"imperfect_volumes_propagation"}},
    {"implicit visibility",
     {"implicit_visibility", "implicit_visibility_lights", "implicit_visibility_all_bounces"}},
    {"light propagation volumes", {"light_propagation_volumes", "light_propagation_volumes_voxels"}},
    {"near field voxels",
     {"near_field_voxels", "near_field_voxels_filtered", "near_field_voxels_occlusion",
      "near_field_voxels_all_bounces", "voxel_path_tracing", "voxel_path_tracing_filtered"}},
    {"layers of maps", {"layered_reflective_shadow_maps"}},
    {"media", {"volumetric_smoke"}},
    {"dense grids", {"voxel_cone_tracing", "voxel_cone_tracing_lobes", "voxel_cone_tracing_soft_shadows"}},
    {"a lens", {"voxel_cone_tracing_depth_of_field"}},
    {"directional grids",
     {"voxel_cone_tracing_directional", "voxel_cone_tracing_directional_all_bounces",
      "voxel_cone_tracing_coarse_directional"}},
    {"a clipmap", {"voxel_cone_tracing_clipmap", "voxel_cone_tracing_clipmap_all_bounces"}},
    {"octrees", {"voxel_cone_tracing_octree", "voxel_cone_tracing_octree_photons"}},
    {"an octree of six faces",
     {"voxel_cone_tracing_octree_directional", "voxel_cone_tracing_octree_directional_all_bounces"}},
};

}  // namespace

TEST_CASE("a second driver makes the same images: direct light and screen space") {
  CHECK(differing(kCases.at("direct light")) == kNone);
}
TEST_CASE("a second driver makes the same images: captured frames") {
  CHECK(differing(kCases.at("captured frames")) == kNone);
}
TEST_CASE("a second driver makes the same images: imperfect volumes") {
  CHECK(differing(kCases.at("imperfect volumes")) == kNone);
}
TEST_CASE("a second driver makes the same images: imperfect volumes by propagation") {
  CHECK(differing(kCases.at("imperfect volumes by propagation")) == kNone);
}
TEST_CASE("a second driver makes the same images: implicit visibility") {
  CHECK(differing(kCases.at("implicit visibility")) == kNone);
}
TEST_CASE("a second driver makes the same images: light propagation volumes") {
  CHECK(differing(kCases.at("light propagation volumes")) == kNone);
}
TEST_CASE("a second driver makes the same images: near field voxels") {
  CHECK(differing(kCases.at("near field voxels")) == kNone);
}
TEST_CASE("a second driver makes the same images: layers of maps") {
  CHECK(differing(kCases.at("layers of maps")) == kNone);
}
TEST_CASE("a second driver makes the same images: media") {
  CHECK(differing(kCases.at("media")) == kNone);
}
TEST_CASE("a second driver makes the same images: cones in dense grids") {
  CHECK(differing(kCases.at("dense grids")) == kNone);
}
TEST_CASE("a second driver makes the same images: a lens") {
  CHECK(differing(kCases.at("a lens")) == kNone);
}
TEST_CASE("a second driver makes the same images: cones in directional grids") {
  CHECK(differing(kCases.at("directional grids")) == kNone);
}
TEST_CASE("a second driver makes the same images: cones in a clipmap") {
  CHECK(differing(kCases.at("a clipmap")) == kNone);
}
TEST_CASE("a second driver makes the same images: cones in octrees") {
  CHECK(differing(kCases.at("octrees")) == kNone);
}
TEST_CASE("a second driver makes the same images: cones in an octree of six faces") {
  CHECK(differing(kCases.at("an octree of six faces")) == kNone);
}

TEST_CASE("every committed pipeline is among those that the second driver renders") {
  std::set<std::string> listed, committed;
  for (const auto& [name, pipelines] : kCases) listed.insert(pipelines.begin(), pipelines.end());
  for (const auto& entry : fs::directory_iterator(test::sourceDirectory() / "scenes/pipelines"))
    if (entry.path().extension() == ".pipeline") committed.insert(entry.path().stem().string());
  CHECK(listed == committed);
  for (const auto& [name, agreement] : kLessAlike) CHECK(committed.contains(name));
}
