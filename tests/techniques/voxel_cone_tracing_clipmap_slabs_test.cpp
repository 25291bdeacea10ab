// Levels that follow a camera: what is carried from frame to frame is what a frame alone would make, to the
// bit; and what it costs, and how it flickers.
#include <chrono>
#include <cmath>

#include "lumivox/measure/metrics.h"
#include "lumivox/reference/path_tracer.h"
#include "support/clipmap.h"
#include "support/kept_table.h"
#include "support/moving_room.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::clipmap;

namespace {

Scene cornell() {
  return loadScene(sourceDirectory() / "scenes/cornell.scene");
}

/// The pipeline of the clipmap with parameters of the pass that its text leaves alone.
Pipeline withParameters(const std::string& parameters) {
  const Pipeline committed = pipeline("voxel_cone_tracing_clipmap");
  std::string source = committed.document->source;
  const std::string before = "levels $levels\n";
  source.insert(source.find(before), parameters + "\n    ");
  return Pipeline::parse(source, committed.file);
}

struct Settings {
  std::string resolution = "16", levels = "3", parameters = "";
};

/// Renders frames of cameras that a test moves.
class Walk {
 public:
  Walk(const Scene& scene, const Settings& settings)
      : scene_(scene), pipeline_(withParameters(settings.parameters)) {
    options_.width = options_.height = 8;
    options_.interactive = true;  // cameras move that the scene says nothing of
    options_.parameters =
        pipeline_.settings({"resolution=" + settings.resolution, "levels=" + settings.levels});
    executor_ = std::make_unique<PipelineExecutor>(device(), techniques(), scene_, pipeline_, options_);
    executor_->keepOutput("grid", "mips");
  }
  FrameResult render(const glm::dvec3& eye, double time = 0.0) {
    SceneSnapshot snapshot = snapshotOf(scene_, time, {}, options_.width, options_.height);
    snapshot.camera.eye = glm::vec3(eye - snapshot.origin);
    return executor_->render(snapshot, frame_++);
  }
  const RadianceClipmap& clipmap() const {
    return static_cast<const Out<RadianceClipmap>*>(executor_->output("grid", "mips"))->value();
  }
  std::vector<std::byte> bits() const {
    std::vector<std::byte> result = clipmap().occupied->download();
    for (const gpu::TextureRef& face : clipmap().faces) {
      const std::vector<std::byte> texels = face->download();
      result.insert(result.end(), texels.begin(), texels.end());
    }
    return result;
  }
  PipelineExecutor& executor() { return *executor_; }

 private:
  const Scene& scene_;
  Pipeline pipeline_;
  RenderOptions options_;
  std::unique_ptr<PipelineExecutor> executor_;
  int frame_ = 0;
};

/// Whether a frame of a sequence is the frame alone, of its voxels and its image.
void checkSequence(const Scene& scene, const Settings& settings,
                   const std::vector<std::pair<glm::dvec3, double>>& frames) {
  Walk sequence(scene, settings), alone(scene, settings);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto& [eye, time] = frames[i];
    const ImageBuffer image = sequence.render(eye, time).outputs.at("final");
    alone.executor().invalidate();
    const ImageBuffer expected = alone.render(eye, time).outputs.at("final");
    CAPTURE(settings.resolution, settings.levels, settings.parameters, i, eye.x, eye.y, eye.z, time);
    CHECK(std::ranges::equal(image.values(), expected.values()));
    CHECK((sequence.bits() == alone.bits()));
  }
}

}  // namespace

TEST_CASE(
    "after steps along each axis, diagonals and jumps the voxels are those of a full update, to the bit") {
  const Scene scene = cornell();
  const double voxel = 0.57 / 16 / 4;  // about a finest one
  std::vector<std::pair<glm::dvec3, double>> frames;
  glm::dvec3 eye(0.25, 0.25, 0.25);
  frames.emplace_back(eye, 0.0);
  for (int axis = 0; axis < 3; ++axis)
    for (const double step : {1.0, 1.0, -3.0, 2.5}) {
      eye[axis] += step * voxel;
      frames.emplace_back(eye, 0.0);
    }
  for (const glm::dvec3 step : {glm::dvec3(1, 1, 1), {-2, 1, -1}, {5, -7, 3}, {0.1, 0.1, 0.1}}) {
    eye += voxel * step;
    frames.emplace_back(eye, 0.0);
  }
  for (const glm::dvec3 jump : {glm::dvec3(0.05, 0.5, 0.5), {3, 3, 3}, {-1e7, 0, 0}, {0.3, 0.2, 0.3}})
    frames.emplace_back(jump, 0.0);
  checkSequence(scene, {}, frames);
  checkSequence(scene, {"15", "2", "precision half"}, frames);
  checkSequence(scene, {"16", "3", "coverage samples"}, frames);
  // Levels that all follow the camera, and the coarsest does not hold the scene.
  checkSequence(scene, {"16", "3", "extent 0.1 m"}, frames);
  checkSequence(scene, {"13", "2", "extent 0.2 m"}, frames);
}

TEST_CASE("things that move change the levels as a frame alone has them") {
  // Its light changes with it, and elsewhere its shadow.
  const Scene scene = loadScene(sourceDirectory() / "scenes/spinning_box.scene");
  const glm::dvec3 eye = scene.cameras.front().eye;
  std::vector<std::pair<glm::dvec3, double>> frames;
  for (int i = 0; i < 4; ++i) frames.emplace_back(eye + 0.1 * i * glm::dvec3(1, 0, 0), 0.2 * i);
  frames.emplace_back(eye, 0.6);
  frames.emplace_back(eye, 0.0);
  checkSequence(scene, {"16", "2", ""}, frames);
}

TEST_CASE("things that move in unchanged light change only their voxels and their shadows, to the bit") {
  for (const RoomLight& one : kRoomLights) {
    const Scene scene = movingRoom(one.light);
    const glm::dvec3 eye(0, 0, 0.9);
    // Slowly, back, far away and back, at rest, and while the levels move.
    std::vector<std::pair<glm::dvec3, double>> frames;
    for (const double time : {0.0, 0.05, 0.3, 0.1, 6.0, 0.2, 0.2}) frames.emplace_back(eye, time);
    for (int i = 1; i < 4; ++i) frames.emplace_back(eye - 0.1 * i * glm::dvec3(1, 0.5, 1), 0.2 + 0.1 * i);
    // Of a finest voxel, where coarser levels stay.
    for (int i = 0; i < 4; ++i) frames.emplace_back(eye + 0.04 * i * glm::dvec3(-1, 0, 0), 0.5 + 0.02 * i);
    CAPTURE(one.name);
    checkSequence(scene, {"16", "3", ""}, frames);
    checkSequence(scene, {"26", "1", "precision half"}, frames);
    checkSequence(scene, {"13", "2", "coverage samples"}, frames);
    checkSequence(scene, {"16", "2", "extent 0.5 m"}, frames);
  }
}

TEST_CASE("leaving out and keeping everything give the same bits") {
  const Scene scene = cornell();
  const Pipeline levels = pipeline("voxel_cone_tracing_clipmap");
  RenderOptions options;
  options.width = options.height = 32;
  options.parameters = levels.settings({"resolution=32"});
  const FrameResult pruned = renderOnce(scene, levels, options);
  options.keepEverything = true;
  const FrameResult kept = renderOnce(scene, levels, options);
  for (const auto& [name, image] : pruned.outputs)
    CHECK(std::ranges::equal(image.values(), kept.outputs.at(name).values()));
}

TEST_CASE("a camera that turns, or moves within a voxel, fills no voxel anew, and a step fills some") {
  const Scene scene = cornell();
  Walk camera(scene, {"16", "3", ""});
  const auto ran = [](const FrameResult& frame) {
    for (const PassRecord& pass : frame.passes)
      if (pass.name == "light") return pass.ran;
    FAIL("no pass 'light'");
    return false;
  };
  const glm::dvec3 eye(0.28, 0.27, 0.28);
  CHECK(ran(camera.render(eye)));
  CHECK_FALSE(ran(camera.render(eye + 1e-5)));
  // A step empties slabs, a full update all volumes.
  const std::uint64_t before = device().transfers().cleared;
  CHECK(ran(camera.render(eye + glm::dvec3(0.02, 0, 0))));
  const std::uint64_t byStep = device().transfers().cleared - before;
  camera.executor().invalidate();
  camera.render(eye);
  CHECK(byStep < (device().transfers().cleared - before - byStep) / 2);
}

TEST_CASE(
    "a camera that crosses levels sees no more flicker than one level of as many voxels has, and 10 %") {
  // Against the path tracer, frame by frame: the camera goes over several voxels of all levels.
  Scene scene = cornell();
  constexpr int kFrames = 8, kSide = 24;
  std::vector<ImageBuffer> references, variances, withLevels, without;
  const Pipeline levels = pipeline("voxel_cone_tracing_clipmap");
  RenderOptions options;
  options.width = options.height = kSide;
  options.parameters = levels.settings({"levels=3"});
  PipelineExecutor three(device(), techniques(), scene, levels, options);
  options.parameters = levels.settings({"levels=1"});
  PipelineExecutor one(device(), techniques(), scene, levels, options);
  for (int i = 0; i < kFrames; ++i) {
    scene.cameras.front().eye =
        glm::dvec3(0.2, 0.25, 0.05) + static_cast<double>(i) * glm::dvec3(0.017, 0.004, 0.006);
    scene.cameras.front().target = scene.cameras.front().eye + glm::dvec3(0.3, -0.1, 1.0);
    ReferenceOptions samples = quietly(4096, 2);
    samples.width = samples.height = kSide;
    const LayeredImage truth = renderReference(scene, samples);
    references.push_back(truth.layers.at("one_bounce_diffuse"));
    variances.push_back(truth.layers.at("one_bounce_diffuse.variance"));
    const SceneSnapshot snapshot = snapshotOf(scene, 0.0, {}, kSide, kSide);
    withLevels.push_back(three.render(snapshot, i).outputs.at("indirect_diffuse"));
    without.push_back(one.render(snapshot, i).outputs.at("indirect_diffuse"));
  }
  const double a = flicker(withLevels, references, variances).value,
               b = flicker(without, references, variances).value;
  CAPTURE(a, b);
  CHECK(b > 0.0);
  CHECK(a < 1.1 * b);
}

TEST_CASE("a step of one voxel costs at most 0.15 of a full update", "[.]") {
  // In turns, the least of several times of the two passes of the clipmap:
  // voxel_cone_tracing_tests "a step of one voxel costs at most 0.15 of a full update"
  KeptTable table("voxel_cone_tracing.clipmap_steps", {{"along x", 2, 0.03, 0.3, true},
                                                       {"along y", 2, 0.03, 0.3, true},
                                                       {"along z", 2, 0.03, 0.3, true},
                                                       {"along all", 2, 0.03, 0.3, true}});
  for (const char* name : {"cornell", "arcade"}) {
    const Scene scene = loadScene(sourceDirectory() / "scenes" / (std::string(name) + ".scene"));
    Walk camera(scene, {"64", "4", ""});
    const SceneSnapshot start = snapshotOf(scene, 0.0, {}, 8, 8);
    const glm::dvec3 middle = start.origin + 0.5 * glm::dvec3(start.bounds.low + start.bounds.high);
    camera.render(middle);
    const double voxel = camera.clipmap().voxelSize;
    const auto milliseconds = [&](const glm::dvec3& eye) {
      SceneSnapshot snapshot = start;
      snapshot.camera.eye = glm::vec3(eye - start.origin);
      camera.executor().render(snapshot, 0, PipelineExecutor::Images::no, PipelineExecutor::Timing::passes);
      double sum = 0.0;
      for (const auto& passes : camera.executor().timedPasses())
        for (const PassRecord& pass : passes)
          if (pass.ran && (pass.name == "light" || pass.name == "grid")) sum += pass.deviceMs;
      return sum;
    };
    double full = 1e9;
    std::array<double, 4> least{1e9, 1e9, 1e9, 1e9};  // x, y, z, diagonal
    for (int turn = 0; turn < 4; ++turn) {
      camera.executor().invalidate();
      full = std::min(full, milliseconds(middle));
      for (int way = 0; way < 4; ++way) {
        glm::dvec3 step(0.0);
        for (int axis = 0; axis < 3; ++axis)
          if (way == 3 || way == axis) step[axis] = 1.0 * voxel;
        // Of several steps in a row: a coarser level moves with every second one.
        constexpr int kSteps = 8;
        double sum = 0.0;
        for (int i = 1; i <= kSteps; ++i) sum += milliseconds(middle + static_cast<double>(i) * step);
        least[static_cast<std::size_t>(way)] = std::min(least[static_cast<std::size_t>(way)], sum / kSteps);
        milliseconds(middle);
      }
    }
    table.row(name, {least[0] / full, least[1] / full, least[2] / full, least[3] / full});
    for (const double step : least) CHECK(step < 0.15 * full);
  }
}
