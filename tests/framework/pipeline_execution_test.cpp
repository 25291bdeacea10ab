// Running pipelines: what is left out and why, what runs again, what memory is shared, what passes tell.
#include <algorithm>
#include <cmath>

#include "gpu/state.h"
#include "lumivox/base/log.h"
#include "pipeline_toys.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;
using Ran = std::vector<std::string>;

namespace {

/// Static grid, a view that follows the camera, and their sum.
const char* const kGather =
    "pass voxels toy.voxels { }\n"
    "pass view toy.paint_camera { value 2 }\n"
    "pass gather toy.gather { grid voxels  view view }\n"
    "output diffuse gather.diffuse\noutput glossy gather.glossy";

const LeftOut* find(const Explanation& explanation, LeftOut::Level level, const std::string& what) {
  for (const LeftOut& one : explanation.leftOut) {
    if (one.level == level && one.what.rfind(what, 0) == 0) return &one;
  }
  return nullptr;
}

/// A grid that follows the camera in steps of a metre, but not upwards.
class SteppedGrid : public VoxelsToy {
 public:
  using VoxelsToy::VoxelsToy;
  Reads readsFrom() const override { return Reads::partOfCamera; }
  std::vector<float> readsOfCamera(const SceneSnapshot& snapshot) const override {
    return {std::floor(snapshot.camera.eye.x), std::floor(snapshot.camera.eye.z)};
  }
};

class Warner : public Toy {
 public:
  using Toy::Toy;
  Out<Image> image{this, "image"};
  Reads readsFrom() const override { return Reads::time; }
  void run(PassContext& frame) override {
    frame.warn("too dark");
    frame.note(frame.inspects() ? "inspected" : "not inspected");
    image = paint(frame, 1.0f);
  }
};

}  // namespace

TEST_CASE("a pipeline renders its outputs as images with their components") {
  Fixture f;
  if (!f) return;
  PipelineExecutor executor = f.executor(kGather);
  const FrameResult frame = executor.render(0.0);
  // 0.25 from the grid and 2 from the view.
  CHECK(first(frame, "diffuse") == 2.25f);
  CHECK(frame.outputs.at("diffuse").width() == 4);
  CHECK(frame.outputs.at("diffuse").channels() == 3);
  CHECK(frame.components.at("diffuse") == Contributes::indirectDiffuse);
  CHECK(frame.passes.size() == 3);
  CHECK(f.techniques.takeRan() == Ran{"voxels", "paint_camera", "gather"});
}

TEST_CASE("passes run after their sources whatever their order in the text") {
  Fixture f;
  if (!f) return;
  PipelineExecutor executor = f.executor(
      "pass gather toy.gather { grid voxels }\npass voxels toy.voxels { }\noutput o gather.diffuse");
  executor.render(0.0);
  CHECK(f.techniques.takeRan() == Ran{"voxels", "gather"});
}

TEST_CASE("a pass that nothing wanted depends on is left out, and so are its sources") {
  Fixture f;
  if (!f) return;
  PipelineExecutor executor = f.executor(
      "pass a toy.paint { }\npass unread toy.paint { }\npass reader toy.add { first unread }\noutput o "
      "a.radiance");
  executor.render(0.0);
  CHECK(f.techniques.takeRan() == Ran{"paint"});
  const Explanation explanation = executor.explain();
  CHECK(explanation.passesKept == 1);
  CHECK(explanation.passesTotal == 3);
  const LeftOut* unread = find(explanation, LeftOut::Level::pass, "unread (toy.paint)");
  REQUIRE(unread != nullptr);
  CHECK(unread->why == "nothing that is wanted depends on it");
  CHECK(unread->pass == "unread");
  CHECK(find(explanation, LeftOut::Level::pass, "reader") != nullptr);
}

TEST_CASE("an output that was not asked for is not computed") {
  Fixture f;
  if (!f) return;
  RenderOptions options;
  options.wanted = {"one"};
  PipelineExecutor executor = f.executor(
      "pass a toy.paint { }\npass b toy.paint { }\noutput one a.radiance\noutput two b.radiance", options);
  const FrameResult frame = executor.render(0.0);
  CHECK(frame.outputs.size() == 1);
  CHECK(f.techniques.takeRan().size() == 1);
  CHECK(executor.outputNames() == std::vector<std::string>{"one", "two"});
}

TEST_CASE("a pass whose needs the scene does not meet is left out, and its output is black") {
  Fixture f;
  if (!f) return;
  PipelineExecutor executor = f.executor("pass fog toy.fog { }\noutput o fog.scattered");
  const FrameResult frame = executor.render(0.0);
  CHECK(f.techniques.takeRan().empty());
  CHECK(first(frame, "o") == 0.0f);
  CHECK(frame.outputs.at("o").width() == 4);
  CHECK(frame.components.at("o") == Contributes::scattered);
  const Explanation explanation = executor.explain();
  const LeftOut* fog = find(explanation, LeftOut::Level::pass, "fog");
  REQUIRE(fog != nullptr);
  CHECK(fog->why == "needs a medium, which the scene does not have");
}

TEST_CASE("an output whose needs the scene does not meet is not computed though its pass is kept") {
  Fixture f;
  if (!f) return;
  PipelineExecutor executor = f.executor(kGather);
  const FrameResult frame = executor.render(0.0);
  CHECK(first(frame, "glossy") == 0.0f);
  const Explanation explanation = executor.explain();
  const LeftOut* glossy = find(explanation, LeftOut::Level::resource, "gather.glossy");
  REQUIRE(glossy != nullptr);
  CHECK(glossy->why == "needs a glossy material, which the scene does not have");
  f.scene.materials[0].specular = glm::vec3(0.5f);
  PipelineExecutor shiny = f.executor(kGather);
  CHECK(first(shiny.render(0.0), "glossy") == 2.0f);
  CHECK(find(shiny.explain(), LeftOut::Level::resource, "gather.glossy") == nullptr);
}

TEST_CASE("a pruned source is absent for an optional input") {
  Fixture f;
  if (!f) return;
  PipelineExecutor executor = f.executor(
      "pass a toy.paint { }\npass fog toy.fog { }\npass s toy.add { first a  second fog }\noutput o s.sum");
  CHECK(first(executor.render(0.0), "o") == 1.0f);
  CHECK(f.techniques.takeRan() == Ran{"paint", "add"});
}

TEST_CASE("a pass whose required input was pruned is left out too, and so on down the chain") {
  Fixture f;
  if (!f) return;
  PipelineExecutor executor = f.executor(
      "pass fog toy.fog { }\npass one toy.add { first fog }\npass two toy.add { first one }\noutput o "
      "two.sum");
  CHECK(first(executor.render(0.0), "o") == 0.0f);
  CHECK(f.techniques.takeRan().empty());
  const Explanation explanation = executor.explain();
  CHECK(find(explanation, LeftOut::Level::pass, "one")->why ==
        "its input 'first' comes from 'fog.scattered', which was left out");
  CHECK(find(explanation, LeftOut::Level::pass, "two")->why ==
        "its input 'first' comes from 'one.sum', which was left out");
}

TEST_CASE("techniques that the pipeline does not name are listed as left out") {
  Fixture f;
  if (!f) return;
  f.techniques.add<Fog>("other", "fog");
  const Explanation explanation = f.executor(kGather).explain();
  REQUIRE(find(explanation, LeftOut::Level::plugin, "other") != nullptr);
  CHECK(find(explanation, LeftOut::Level::plugin, "toy") == nullptr);
}

TEST_CASE("keeping everything runs every pass in every frame and gives the same images") {
  Fixture f;
  if (!f) return;
  const std::string body = std::string(kGather) +
                           "\npass fog toy.fog { }\npass unread toy.paint { }\n"
                           "pass sum toy.add { first gather.diffuse  second fog }\noutput final sum.sum";
  PipelineExecutor pruned = f.executor(body);
  const FrameResult without = pruned.render(0.0);
  f.techniques.takeRan();
  RenderOptions options;
  options.keepEverything = true;
  PipelineExecutor everything = f.executor(body, options);
  for (int repeat = 0; repeat < 2; ++repeat) {
    const FrameResult with = everything.render(0.0);
    CHECK(f.techniques.takeRan().size() == 6);
    REQUIRE(with.outputs.size() == without.outputs.size());
    for (const auto& [name, image] : with.outputs) CHECK(image.values() == without.outputs.at(name).values());
  }
  const Explanation explanation = everything.explain();
  CHECK(explanation.passesKept == explanation.passesTotal);
  CHECK(explanation.sharedBytes == 0);
  // What no pass of the pipeline reads is told, but nothing is left out of the run.
  CHECK(std::all_of(explanation.leftOut.begin(), explanation.leftOut.end(),
                    [](const LeftOut& one) { return one.level == LeftOut::Level::scene; }));
}

TEST_CASE("nothing runs again while nothing changes, and the image stays") {
  Fixture f;
  if (!f) return;
  PipelineExecutor executor = f.executor(kGather);
  executor.render(0.0, 0, PipelineExecutor::Images::yes, PipelineExecutor::Timing::passes);
  f.techniques.takeRan();
  const FrameResult second = executor.render(1.0, 1);
  CHECK(f.techniques.takeRan().empty());
  CHECK(first(second, "diffuse") == 2.25f);
  CHECK(std::none_of(second.passes.begin(), second.passes.end(),
                     [](const PassRecord& pass) { return pass.ran; }));
  CHECK(second.passes[0].bytes == 8 * 8 * 8 * 16);
  const Explanation explanation = executor.explain();
  const LeftOut* voxels = find(explanation, LeftOut::Level::time, "voxels");
  REQUIRE(voxels != nullptr);
  CHECK(voxels->savedMs > 0.0);
  CHECK_THAT(voxels->why, Contains("geometry"));
}

TEST_CASE("after invalidate every kept pass runs again") {
  Fixture f;
  if (!f) return;
  PipelineExecutor executor = f.executor(kGather);
  executor.render(0.0);
  executor.invalidate();
  f.techniques.takeRan();
  executor.render(0.0);
  CHECK(f.techniques.takeRan() == Ran{"voxels", "paint_camera", "gather"});
}

TEST_CASE("a moving camera runs what reads the camera again, and nothing else") {
  Fixture f;
  if (!f) return;
  f.scene.cameras[0].keys = {{0.0, {0, 0, 1}, {0, 0, 0}}, {1.0, {0, 0, 2}, {0, 0, 0}}};
  PipelineExecutor executor = f.executor(kGather);
  executor.render(0.0);
  f.techniques.takeRan();
  CHECK(first(executor.render(1.0, 1), "diffuse") == 2.25f);
  CHECK(f.techniques.takeRan() == Ran{"paint_camera", "gather"});
  const Explanation explanation = executor.explain();
  CHECK(find(explanation, LeftOut::Level::time, "voxels") != nullptr);
  CHECK(find(explanation, LeftOut::Level::time, "gather") == nullptr);
}

TEST_CASE("a pass that reads a part of the camera runs again when that part changed, and only then") {
  Fixture f;
  if (!f) return;
  f.techniques.add<SteppedGrid>("toy", "stepped_grid");
  RenderOptions options;
  options.interactive = true;
  PipelineExecutor executor = f.executor(
      "pass grid toy.stepped_grid { }\npass gather toy.gather { grid grid }\noutput o gather.diffuse",
      options);
  SceneSnapshot snapshot = snapshotOf(f.scene, 0.0);
  snapshot.camera.eye = glm::vec3(0.2f);
  executor.render(snapshot);
  CHECK(f.techniques.takeRan() == Ran{"stepped_grid", "gather"});
  snapshot.camera.eye = {0.6f, 7.0f, 0.2f};  // the same cell
  CHECK(first(executor.render(snapshot, 1), "o") == 0.25f);
  CHECK(f.techniques.takeRan() == Ran{"gather"});
  snapshot.camera.eye = {1.2f, 7.0f, 0.2f};  // another one
  executor.render(snapshot, 2);
  CHECK(f.techniques.takeRan() == Ran{"stepped_grid", "gather"});
  snapshot.camera.eye = {0.3f, 7.0f, 0.2f};  // back: not what was computed last
  executor.render(snapshot, 3);
  CHECK(f.techniques.takeRan() == Ran{"stepped_grid", "gather"});
  executor.invalidate();
  executor.render(snapshot, 4);
  CHECK(f.techniques.takeRan() == Ran{"stepped_grid", "gather"});
}

TEST_CASE("moving geometry runs what reads the geometry and what depends on that again") {
  Fixture f;
  if (!f) return;
  f.scene.objects[0].motion = RigidMotion{{0, 1, 0}, 1.0, {}, {}};
  PipelineExecutor executor = f.executor(kGather);
  executor.render(0.0);
  f.techniques.takeRan();
  executor.render(0.5, 1);
  // The view did not change, and its image was kept because its reader runs again.
  CHECK(f.techniques.takeRan() == Ran{"voxels", "gather"});
}

TEST_CASE(
    "a camera that moves without the scene's word runs again what it must, with a value that was given "
    "back") {
  Fixture f;
  if (!f) return;
  // The scene is static, so the grid's memory is given back after the gather; the viewer then moves the
  // camera.
  PipelineExecutor executor = f.executor(kGather);
  SceneSnapshot snapshot = snapshotOf(f.scene, 0.0);
  executor.render(snapshot);
  f.techniques.takeRan();
  snapshot.camera.eye.z += 1.0f;
  CHECK(first(executor.render(snapshot, 1), "diffuse") == 2.25f);
  CHECK(f.techniques.takeRan() == Ran{"voxels", "paint_camera", "gather"});

  RenderOptions options;
  options.interactive = true;
  PipelineExecutor viewer = f.executor(kGather, options);
  viewer.render(snapshot);
  f.techniques.takeRan();
  snapshot.camera.eye.z += 1.0f;
  CHECK(first(viewer.render(snapshot, 1), "diffuse") == 2.25f);
  CHECK(f.techniques.takeRan() == Ran{"paint_camera", "gather"});
}

TEST_CASE("sharing memory between short-lived resources needs less of it") {
  Fixture f;
  if (!f) return;
  // A chain of four sums: two images are alive at any time, and the last one stays.
  const std::string body =
      "pass a toy.paint { }\npass b toy.add { first a }\npass c toy.add { first b }\npass d toy.add { first "
      "c }\noutput o d.sum";
  constexpr std::uint64_t kImage = 4 * 4 * 16;
  PipelineExecutor shared = f.executor(body);
  const FrameResult sharedFrame = shared.render(0.0);
  CHECK(shared.explain().poolBytes == 2 * kImage);
  CHECK(shared.explain().sharedBytes == 2 * kImage);
  CHECK(find(shared.explain(), LeftOut::Level::resource, "memory of its own")->savedBytes == 2 * kImage);
  RenderOptions options;
  options.keepEverything = true;
  PipelineExecutor separate = f.executor(body, options);
  const FrameResult separateFrame = separate.render(0.0);
  CHECK(separate.explain().poolBytes == 4 * kImage);
  CHECK(first(sharedFrame, "o") == first(separateFrame, "o"));
  for (const PassRecord& pass : sharedFrame.passes) CHECK(pass.bytes == kImage);
}

TEST_CASE("frames of an animation do not need more and more memory") {
  Fixture f;
  if (!f) return;
  f.scene.objects[0].motion = RigidMotion{{0, 1, 0}, 1.0, {}, {}};
  PipelineExecutor executor = f.executor(kGather);
  executor.render(0.0);
  executor.render(0.1, 1);
  const std::uint64_t bytes = executor.explain().poolBytes;
  for (int frame = 2; frame < 6; ++frame) executor.render(0.1 * frame, frame);
  CHECK(executor.explain().poolBytes == bytes);
}

TEST_CASE("an output that is asked to be kept stays alive, with the pass that makes it") {
  Fixture f;
  if (!f) return;
  PipelineExecutor executor = f.executor(std::string(kGather) + "\npass unread toy.paint { value 5 }");
  executor.render(0.0);
  CHECK(executor.output("voxels", "grid") == nullptr);
  executor.keepOutput("voxels", "grid");
  executor.keepOutput("unread", "radiance");
  executor.render(0.0);
  REQUIRE(executor.output("voxels", "grid") != nullptr);
  CHECK(executor.output("voxels", "grid")->textures().front()->downloadFloats().front() == 0.25f);
  REQUIRE(executor.output("unread", "radiance") != nullptr);
  CHECK_THAT(messageOf<Error>([&] { executor.keepOutput("voxles", "grid"); }), Contains("no pass 'voxles'"));
  CHECK_THAT(messageOf<Error>([&] { executor.output("voxels", "grit"); }),
             Contains("no output 'grit'; expected grid"));
}

TEST_CASE("the times of the passes and the time between them make up the frame") {
  Fixture f;
  if (!f) return;
  PipelineExecutor executor = f.executor(kGather);
  const FrameResult frame = executor.render(0.0);
  double host = 0.0;
  for (const PassRecord& pass : frame.passes) {
    CHECK(pass.ran);
    CHECK(pass.hostMs >= 0.0);
    CHECK(pass.deviceMs == 0.0);
    host += pass.hostMs;
  }
  CHECK(frame.betweenPassesMs >= 0.0);
  CHECK(host + frame.betweenPassesMs <= frame.frameMs);
  CHECK(frame.peakBytes >= 8 * 8 * 8 * 16);
}

TEST_CASE("the passes of a frame are timed only where that is asked for, and each frame's are its own") {
  // By the clock that this device deserves, and by time stamps, whether they deserve belief or not: that
  // decides about the numbers, not about which frame and pass they belong to.
  for (const bool stamps : {false, true}) {
    CAPTURE(stamps);
    Fixture f;
    if (!f) return;
    f.device->info();  // checks the time stamps, once
    if (stamps) f.device->state()->info.timerQueriesTrusted = true;
    PipelineExecutor executor = f.executor(kGather);
    using Timing = PipelineExecutor::Timing;
    executor.render(0.0);
    CHECK(executor.timedPasses().empty());
    // More frames than are under way at a time; the second one runs nothing.
    for (int frame = 0; frame < 7; ++frame) {
      if (frame != 1) executor.invalidate();
      const FrameResult result = executor.render(0.0, 0, PipelineExecutor::Images::no, Timing::passes);
      CHECK(std::isnan(result.frameMs));
      if (frame == 3) executor.render(0.0);  // a frame that is not timed comes between
    }
    const auto frames = executor.timedPasses();
    REQUIRE(frames.size() == 7);
    for (std::size_t frame = 0; frame < 7; ++frame) {
      REQUIRE(frames[frame].size() == 3);
      for (const PassRecord& pass : frames[frame]) {
        CHECK(pass.ran == (frame != 1));
        if (!pass.ran) CHECK(pass.deviceMs == 0.0);
        CHECK(pass.deviceMs >= 0.0);
      }
      // The sum of a frame's passes is something where they ran.
      if (frame != 1)
        CHECK(frames[frame][0].deviceMs + frames[frame][1].deviceMs + frames[frame][2].deviceMs > 0.0);
    }
    CHECK(frames[0][0].name == "voxels");
    CHECK(executor.timedPasses().empty());
  }
}

namespace {

/// Fails in the middle of its first drawing.
class Interrupted : public Toy {
 public:
  using Toy::Toy;
  Out<Image> image{this, "image"};
  Reads readsFrom() const override { return Reads::time; }
  void run(PassContext& frame) override {
    const Image painted = paint(frame, 1.0f);
    const gpu::Drawing drawing = frame.device().drawTo({{{painted.texture.get()}}}, {});
    if (!std::exchange(failed_, true)) throw Error("the texture does not fit");
    image = painted;
  }

 private:
  bool failed_ = false;
};

}  // namespace

TEST_CASE("a pass that fails while it draws fails alone: the next frame draws again") {
  using Timing = PipelineExecutor::Timing;
  for (const bool stamps : {false, true}) {
    CAPTURE(stamps);
    Fixture f;
    if (!f) return;
    f.device->info();
    if (stamps) f.device->state()->info.timerQueriesTrusted = true;
    f.techniques.add<Interrupted>("toy", "interrupted");
    PipelineExecutor executor = f.executor("pass one toy.interrupted { }\noutput image one.image");
    CHECK_THAT(
        messageOf<Error>([&] { executor.render(0.0, 0, PipelineExecutor::Images::no, Timing::passes); }),
        Contains("pass one: the texture does not fit"));
    CHECK(executor.timedPasses().empty());
    CHECK(executor.render(0.0, 0, PipelineExecutor::Images::no, Timing::passes).passes.size() == 1);
    CHECK(executor.timedPasses().size() == 1);
    CHECK(first(executor.render(0.0), "image") == 0.0f);  // the drawing cleared it
  }
}

TEST_CASE("a warning of a pass is told once per run") {
  Fixture f;
  if (!f) return;
  f.techniques.add<Warner>("toy", "warner");
  PipelineExecutor executor = f.executor("pass dim toy.warner { }\noutput o dim.image");
  const LogCapture log;
  executor.render(0.0);
  executor.render(1.0, 1);
  CHECK_THAT(log.text(), Contains("pass dim: too dark"));
  CHECK(log.text().find("too dark") == log.text().rfind("too dark"));
}

TEST_CASE("what a pass tells about itself is kept only when the run is inspected, frame by frame") {
  Fixture f;
  if (!f) return;
  f.techniques.add<Warner>("toy", "warner");
  const char* text = "pass dim toy.warner { }\noutput o dim.image";
  PipelineExecutor plain = f.executor(text);
  CHECK(plain.render(0.0, 0).notes.empty());
  RenderOptions options;
  options.health = true;
  PipelineExecutor inspected = f.executor(text, options);
  for (int frame = 0; frame < 2; ++frame)
    CHECK(inspected.render(0.0, frame).notes == std::vector<std::string>{"pass dim: inspected"});
}

TEST_CASE("an unknown camera is refused when the pipeline is bound") {
  Fixture f;
  if (!f) return;
  RenderOptions options;
  options.camera = "mian";
  CHECK_THAT(messageOf<Error>([&] { f.executor(kGather, options); }), Contains("main"));
}

TEST_CASE("the size of the image can be chosen") {
  Fixture f;
  if (!f) return;
  RenderOptions options;
  options.width = 6;
  options.height = 2;
  PipelineExecutor executor = f.executor(kGather, options);
  const FrameResult frame = executor.render(0.0);
  CHECK(frame.outputs.at("diffuse").width() == 6);
  CHECK(frame.outputs.at("glossy").height() == 2);
}

TEST_CASE("the harness runs one pass on inputs made by a test") {
  Fixture f;
  if (!f) return;
  const SceneSnapshot snapshot = snapshotOf(f.scene, 0.0);
  PassHarness harness(*f.device, f.techniques, "toy", "add", f.scene, snapshot);
  const auto constant = [&](float value) {
    Image image{harness.context().image("constant")};
    image.texture->clear(glm::vec4(value));
    return image;
  };
  CHECK_THAT(messageOf<Error>([&] { harness.run(); }), Contains("required input 'first' was not set"));
  harness.setInput<Image>("first", constant(1.5f));
  harness.run();
  CHECK(imageOf(*harness.output<Image>("sum").texture).at(0, 0, 0) == 1.5f);
  harness.setInput<Image>("second", constant(2.0f));
  harness.run();
  CHECK(imageOf(*harness.output<Image>("sum").texture).at(3, 3, 2) == 3.5f);
  CHECK_THROWS_AS(harness.setInput<RadianceGrid>("first", RadianceGrid{}), Error);
  CHECK_THROWS_AS(harness.setInput<Image>("third", constant(0.0f)), Error);
  CHECK_THROWS_AS(harness.output<Image>("difference"), Error);

  PassHarness voxels(*f.device, f.techniques, "toy", "voxels", f.scene, snapshot);
  voxels.setParameter("resolution", 4.0);
  CHECK_THROWS_AS(voxels.setParameter("resolution", 400.0), Error);
  CHECK_THROWS_AS(voxels.setParameter("layout", "sparce"), Error);
  voxels.run();
  CHECK(voxels.output<RadianceGrid>("grid").radiance->description().width == 4);
  CHECK_THROWS_AS(PassHarness(*f.device, f.techniques, "toy", "nothing", f.scene, snapshot), Error);
}
