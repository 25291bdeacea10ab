// The committed pipeline on sequences of the TUM RGB-D benchmark, where the asset path has some.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>

#include "lumivox/base/file.h"
#include "lumivox/scene/text.h"
#include "support/passes.h"

using namespace lumivox;
using namespace lumivox::test;
namespace fs = std::filesystem;

namespace {

constexpr const char* kSequences = "rgbd_dataset_freiburg";

/// Folders tum/rgbd_dataset_freiburg* in $LUMIVOX_ASSETS and in ../shared/models beside the project.
std::vector<fs::path> sequences() {
  std::vector<fs::path> assets{sourceDirectory() / "../shared/models"};
  if (const char* variable = std::getenv("LUMIVOX_ASSETS")) {
    std::istringstream stream(variable);
    for (std::string folder; std::getline(stream, folder, ':');) assets.emplace_back(folder);
  }
  std::vector<fs::path> found;
  std::error_code error;
  for (const fs::path& folder : assets)
    for (const auto& entry : fs::directory_iterator(folder / "tum", error))
      if (entry.is_directory() && entry.path().filename().string().starts_with(kSequences))
        found.push_back(fs::canonical(entry.path()));
  std::sort(found.begin(), found.end());
  return found;
}

/// Published with the benchmark for each of its three cameras.
std::string cameraOf(const fs::path& sequence) {
  switch (sequence.filename().string().at(std::string(kSequences).size())) {
    case '1':
      return "focal 517.3 516.5  centre 318.6 255.3  distortion 0.2624 -0.9531 -0.0054 0.0026 1.1633";
    case '2':
      return "focal 520.9 521.0  centre 325.1 249.7  distortion 0.2312 -0.7849 -0.0033 -0.0001 0.9172";
    default:
      return "focal 535.4 539.2  centre 320.1 247.6";
  }
}

/// Lines of the list of frames, without comments.
int listedFrames(const fs::path& sequence) {
  const fs::path pairs = sequence / "associations.txt";
  std::istringstream lines(readFile(fs::exists(pairs) ? pairs : sequence / "depth.txt"));
  int count = 0;
  for (std::string line; std::getline(lines, line);) count += !line.empty() && line.front() != '#';
  return count;
}

}  // namespace

TEST_CASE(
    "sequences of the TUM benchmark have poses for nine of ten frames, and light a sphere with finite light") {
  const std::vector<fs::path> all = sequences();
  if (all.empty()) return skip("no folder tum/rgbd_dataset_freiburg* is on the asset path");
  for (const fs::path& sequence : all) {
    CAPTURE(sequence);
    // At most a hundred frames from the middle of the sequence.
    constexpr int kMost = 100;
    const int listed = listedFrames(sequence), first = std::max(0, (listed - kMost) / 2),
              wanted = std::min(kMost, listed);
    const std::string capture =
        fmt::format("camera ar {{ capture room }} capture room {{ folder \"{}\" {} range {}..{} }}",
                    sequence.string(), cameraOf(sequence), first, first + wanted - 1);
    const Scene room =
        loadSceneText("scene \"room\" { " + capture + " }", sourceDirectory() / "scenes/room.scene");
    const std::vector<CaptureFrame>& frames = room.captures.at(0)->frames;
    CHECK(10 * static_cast<int>(frames.size()) >= 9 * wanted);

    // A ball of 10 cm, 70 cm before the first eye.
    const glm::dvec3 place = frames.front().eye + frames.front().rotation * glm::dvec3(0, 0, 0.7);
    Scene scene = loadSceneText(
        fmt::format(
            "scene \"ball\" {{ camera m {{ eye 0 0 1 target 0 0 0 }} material clay {{ diffuse 0.6 specular "
            "0.2 exponent 20 }} mesh ball {{ file \"models/sphere.obj\" material clay scale 5 cm translate {} "
            "{} {} }} }}",
            place.x, place.y, place.z),
        sourceDirectory() / "scenes/ball.scene");
    scene.cameras = room.cameras;
    scene.captures = room.captures;
    const Pipeline text = pipeline("captured_frames");
    RenderOptions options = sized(160, 120);
    options.parameters = text.settings({"pictures=2"});
    options.health = true;
    PipelineExecutor executor(device(), techniques(), scene, text, options);
    for (const std::size_t frame : std::set{std::size_t{0}, frames.size() / 2, frames.size() - 1}) {
      CAPTURE(frame);
      const FrameResult result = executor.render(frames[frame].time);
      CAPTURE(result.healthFindings);
      CHECK(result.healthFindings.empty());
      for (const auto& [name, image] : result.outputs) {
        CAPTURE(name);
        CHECK(std::all_of(image.values().begin(), image.values().end(),
                          [](float value) { return std::isfinite(value) && value >= 0.0f; }));
      }
      CHECK(meanOf(result.outputs.at("final")) > 0.0);
      if (frame > 0) continue;
      for (const char* pass : {"gbuffer", "read", "captured", "choose", "discs", "points", "gather",
                               "normalise", "occlude", "apply", "compose", "composite"}) {
        CAPTURE(pass);
        CHECK(ran(result, pass));
      }
    }
  }
}

TEST_CASE("the scene of the guide reads a sequence in the layout of the benchmark") {
  const std::string guide = readFile(sourceDirectory() / "docs/captured_frames.md"),
                    begin = "```text\nscene ";
  const std::size_t from = guide.find(begin);
  REQUIRE(from != std::string::npos);
  std::string text = guide.substr(from + 8, guide.find("\n```", from) - from - 8);
  // In place of the sequence, which is not here, pictures of the same layout.
  for (const auto& [theirs, ours] : {std::pair("tum/rgbd_dataset_freiburg1_desk", "captures/cornell_past"),
                                     {"range 0..89", "range 0..3"}}) {
    const std::size_t at = text.find(theirs);
    REQUIRE(at != std::string::npos);
    text.replace(at, std::string(theirs).size(), ours);
  }
  const Scene scene = loadSceneText(text, sourceDirectory() / "scenes/desk.scene");
  REQUIRE(scene.captures.size() == 1);
  const Capture& capture = *scene.captures.front();
  CHECK(capture.frames.size() == 4);
  CHECK(capture.camera.distortion[0] == Approx(0.2624));
  // As the guide says: tx ty tz of the file, here 0.278 0.42 -0.8, becomes tx tz -ty.
  CHECK(glm::length(capture.frames[0].eye - glm::dvec3(0.278, -0.8, -0.42)) < 1e-3);
}
