// Running pipelines: what is left out and why, what runs again, what memory is shared, what passes tell.
#include <algorithm>
#include <cmath>

#include "gpu/state.h"
#include "lumivox/base/log.h"
#include "pipeline_toys.h"
#include "support/facts.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Static grid, a view that follows the camera, and their sum.
const char* const kGather =
    "pass voxels toy.voxels { }\n"
    "pass view toy.paint_camera { value 2 }\n"
    "pass gather toy.gather { grid voxels  view view }\n"
    "output diffuse gather.diffuse\noutput glossy gather.glossy";

/// A grid that follows the camera in steps of a metre, but not upwards.
struct SteppedGrid : VoxelsToy {
  using VoxelsToy::VoxelsToy;
  Reads readsFrom() const override { return Reads::partOfCamera; }
  std::vector<float> readsOfCamera(const SceneSnapshot& snapshot) const override {
    return {std::floor(snapshot.camera.eye.x), std::floor(snapshot.camera.eye.z)};
  }
};

/// Passes are timed by time stamps, whether they deserve belief or not, or by the clock that this device
/// deserves: that decides about the numbers, not about which frame and pass they belong to.
void timedByStamps(Fixture& f, bool stamps) {
  f.device->info();  // checks the time stamps, once
  if (stamps) f.device->state()->info.timerQueriesTrusted = true;
}

struct Warner : Toy {
  using Toy::Toy;
  Out<Image> image{this, "image"};
  Reads readsFrom() const override { return Reads::time; }
  void run(PassContext& frame) override {
    frame.warn("too dark");
    frame.note(frame.inspects() ? "inspected" : "not inspected");
    image = paint(frame, 1.0f);
  }
};

/// Fails in the middle of its first drawing.
struct Interrupted : Toy {
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

TEST_CASE("a pipeline renders its outputs as images with their components, of the size that is asked for") {
  Fixture f;
  const FrameResult frame = f.executor(kGather).render(0.0);
  // 0.25 from the grid and 2 from the view.
  CHECK(first(frame, "diffuse") == 2.25f);
  CHECK(frame.outputs.at("diffuse").width() == 4);
  CHECK(frame.outputs.at("diffuse").channels() == 3);
  CHECK(frame.components.at("diffuse") == Contributes::indirectDiffuse);
  CHECK(frame.passes.size() == 3);
  RenderOptions options;
  options.width = 6;
  options.height = 2;
  const FrameResult wide = f.executor(kGather, options).render(0.0);
  CHECK(wide.outputs.at("diffuse").width() == 6);
  CHECK(wide.outputs.at("glossy").height() == 2);
}

TEST_CASE("passes run after their sources, those that wanted outputs of this scene depend on and no others") {
  const auto [body, ran, value] = GENERATE(table<std::string, Ran, float>({
      {"pass gather toy.gather { grid voxels }\npass voxels toy.voxels { }\noutput o gather.diffuse",
       {"voxels", "gather"},
       0.25f},
      {"pass a toy.paint { }\npass unread toy.paint { }\npass r toy.add { first unread }\noutput o a.radiance",
       {"paint"},
       1.0f},
      {"pass fog toy.fog { }\noutput o fog.scattered", {}, 0.0f},
      {"pass a toy.paint { }\npass fog toy.fog { }\npass s toy.add { first a  second fog }\noutput o s.sum",
       {"paint", "add"},
       1.0f},
      {"pass fog toy.fog { }\npass one toy.add { first fog }\npass two toy.add { first one }\noutput o two.sum",
       {},
       0.0f},
  }));
  CAPTURE(body);
  Fixture f;
  PipelineExecutor executor = f.executor(body);
  const FrameResult frame = executor.render(0.0);
  CHECK(f.techniques.takeRan() == ran);
  CHECK(frame.outputs.at("o").values() == std::vector<float>(4 * 4 * 3, value));
  CHECK(executor.explain().passesKept == ran.size());
  executor.invalidate();
  executor.render(0.0);
  CHECK(f.techniques.takeRan() == ran);
}

TEST_CASE("outputs that nobody wants, or whose needs the scene lacks, are not computed") {
  Fixture f;
  RenderOptions options;
  options.wanted = {"one"};
  PipelineExecutor executor = f.executor(
      "pass a toy.paint { }\npass b toy.paint { }\noutput one a.radiance\noutput two b.radiance", options);
  CHECK(executor.render(0.0).outputs.size() == 1);
  CHECK(f.techniques.takeRan().size() == 1);
  CHECK(executor.outputNames() == std::vector<std::string>{"one", "two"});
  CHECK(executor.explain().passesTotal == 2);
  CHECK(first(f.executor(kGather).render(0.0), "glossy") == 0.0f);
  f.scene.materials[0].specular = glm::vec3(0.5f);
  PipelineExecutor shiny = f.executor(kGather);
  CHECK(first(shiny.render(0.0), "glossy") == 2.0f);
  CHECK(whyLeftOut(shiny, LeftOut::Level::resource, "gather.glossy").empty());
}

TEST_CASE("what is left out is explained with the reason") {
  using Level = LeftOut::Level;
  const auto [body, level, what, told] = GENERATE(table<std::string, Level, const char*, Tells>({
      {"pass a toy.paint { }\npass unread toy.paint { }\noutput o a.radiance", Level::pass,
       "unread (toy.paint)", Tells("nothing", "wanted")},
      {"pass fog toy.fog { }\noutput o fog.scattered", Level::pass, "fog", Tells("medium", "scene")},
      {kGather, Level::resource, "gather.glossy", Tells("glossy material", "scene")},
      {"pass fog toy.fog { }\npass one toy.add { first fog }\noutput o one.sum", Level::pass, "one",
       Tells("first", "fog.scattered", "left out")},
      {"pass fog toy.fog { }\npass one toy.add { first fog }\npass two toy.add { first one }\noutput o two.sum",
       Level::pass, "two", Tells("first", "one.sum", "left out")},
  }));
  Fixture f;
  const PipelineExecutor executor = f.executor(body);
  CHECK_THAT(whyLeftOut(executor, level, what), told);
  if (level == Level::pass)
    CHECK(find(executor.explain(), level, what)->pass ==
          std::string(what).substr(0, std::string(what).find(' ')));
}

TEST_CASE("techniques that the pipeline does not name are listed as left out") {
  Fixture f;
  f.techniques.add<Fog>("other", "fog");
  const Explanation explanation = f.executor(kGather).explain();
  REQUIRE(find(explanation, LeftOut::Level::plugin, "other") != nullptr);
  CHECK(find(explanation, LeftOut::Level::plugin, "toy") == nullptr);
}

TEST_CASE("keeping everything runs every pass in every frame and gives the same images") {
  Fixture f;
  const std::string body = std::string(kGather) +
                           "\npass fog toy.fog { }\npass unread toy.paint { }\n"
                           "pass sum toy.add { first gather.diffuse  second fog }\noutput final sum.sum";
  const FrameResult without = f.executor(body).render(0.0);
  f.techniques.takeRan();
  PipelineExecutor everything = f.executor(body, with(&RenderOptions::keepEverything));
  for (int repeat = 0; repeat < 2; ++repeat) {
    const FrameResult whole = everything.render(0.0);
    CHECK(f.techniques.takeRan().size() == 6);
    REQUIRE(whole.outputs.size() == without.outputs.size());
    for (const auto& [name, image] : whole.outputs)
      CHECK(image.values() == without.outputs.at(name).values());
  }
  const Explanation explanation = everything.explain();
  CHECK(explanation.passesKept == explanation.passesTotal);
  CHECK(explanation.sharedBytes == 0);
  // What no pass of the pipeline reads is told, but nothing is left out of the run.
  for (const LeftOut& one : explanation.leftOut) CHECK(one.level == LeftOut::Level::scene);
}

TEST_CASE("nothing runs again while nothing changes, and the image stays") {
  Fixture f;
  PipelineExecutor executor = f.executor(kGather);
  executor.render(0.0, 0, PipelineExecutor::Images::yes, PipelineExecutor::Timing::passes);
  f.techniques.takeRan();
  const FrameResult second = executor.render(1.0, 1);
  CHECK(f.techniques.takeRan().empty());
  CHECK(first(second, "diffuse") == 2.25f);
  for (const PassRecord& pass : second.passes) CHECK_FALSE(pass.ran);
  CHECK(second.passes[0].bytes == 8 * 8 * 8 * 16);
  CHECK_THAT(whyLeftOut(executor, LeftOut::Level::time, "voxels"), Tells("geometry"));
  CHECK(find(executor.explain(), LeftOut::Level::time, "voxels")->savedMs > 0.0);
}

TEST_CASE("what moves runs what reads it and what depends on that again, and nothing else") {
  const bool camera = GENERATE(true, false);
  Fixture f;
  if (camera)
    f.scene.cameras[0].keys = {{0.0, {0, 0, 1}, {0, 0, 0}}, {1.0, {0, 0, 2}, {0, 0, 0}}};
  else
    f.scene.objects[0].motion = RigidMotion{{0, 1, 0}, 1.0, {}, {}};
  PipelineExecutor executor = f.executor(kGather);
  executor.render(0.0);
  f.techniques.takeRan();
  CHECK(first(executor.render(1.0, 1), "diffuse") == 2.25f);
  // Where the view did not change, its image was kept because its reader runs again.
  CHECK(f.techniques.takeRan() == (camera ? Ran{"paint_camera", "gather"} : Ran{"voxels", "gather"}));
  CHECK(whyLeftOut(executor, LeftOut::Level::time, "voxels").empty() == !camera);
  CHECK(whyLeftOut(executor, LeftOut::Level::time, "gather").empty());
  // Frames of an animation do not need more and more memory.
  const std::uint64_t bytes = executor.explain().poolBytes;
  for (int frame = 2; frame < 6; ++frame) executor.render(0.1 * frame, frame);
  CHECK(executor.explain().poolBytes == bytes);
}

namespace {

/// Its image is the power of the first light.
struct PaintLight : Toy {
  using Toy::Toy;
  Out<Image> radiance{this, "radiance", Contributes::direct};
  Reads readsFrom() const override { return Reads::lights; }
  void run(PassContext& frame) override {
    Image image{frame.image("image")};
    image.texture->clear(glm::vec4(frame.snapshot().lights.at(0).power, 1.0f));
    radiance = image;
  }
};

}  // namespace

TEST_CASE("a light that changes runs what reads lights again, and is named where other passes stay") {
  Fixture f;
  f.techniques.add<PaintLight>("toy", "paint_light");
  Light lamp;
  lamp.name = "lamp";
  lamp.power = glm::vec3(3.0f);
  lamp.motion.emplace().interpolation = Interpolation::step;
  lamp.motion->keys.resize(1);
  lamp.motion->keys[0].time = 1.0;
  lamp.motion->keys[0].power = glm::vec3(0.0f);
  f.scene.lights = {lamp};
  PipelineExecutor executor = f.executor(
      "pass shines toy.paint_light { }\npass rests toy.paint { }\n"
      "output a shines.radiance\noutput b rests.radiance");
  CHECK(first(executor.render(0.0), "a") == 3.0f);
  CHECK(first(executor.render(1.0, 1), "a") == 0.0f);
  CHECK(whyLeftOut(executor, LeftOut::Level::time, "shines").empty());
  CHECK_THAT(whyLeftOut(executor, LeftOut::Level::time, "rests"), Tells("not", "change", "light", "lamp"));
}

TEST_CASE("a pass that reads a part of the camera runs again when that part changed, and only then") {
  Fixture f;
  f.techniques.add<SteppedGrid>("toy", "stepped_grid");
  PipelineExecutor executor = f.executor(
      "pass grid toy.stepped_grid { }\npass gather toy.gather { grid grid }\noutput o gather.diffuse",
      with(&RenderOptions::interactive));
  SceneSnapshot snapshot = snapshotOf(f.scene, 0.0);
  const auto ranAt = [&](const glm::vec3& eye) {
    snapshot.camera.eye = eye;
    CHECK(first(executor.render(snapshot), "o") == 0.25f);
    return f.techniques.takeRan();
  };
  const Ran both{"stepped_grid", "gather"};
  CHECK(ranAt(glm::vec3(0.2f)) == both);
  CHECK(ranAt({0.6f, 7.0f, 0.2f}) == Ran{"gather"});  // the same cell
  CHECK(ranAt({1.2f, 7.0f, 0.2f}) == both);           // another one
  CHECK(ranAt({0.3f, 7.0f, 0.2f}) == both);           // back: not what was computed last
  executor.invalidate();
  CHECK(ranAt({0.3f, 7.0f, 0.2f}) == both);
}

TEST_CASE("a camera that the viewer moves runs again what was given back, unless interactive") {
  // The scene is static, so the grid's memory is given back after the gather; the viewer then moves the
  // camera.
  const bool interactive = GENERATE(false, true);
  Fixture f;
  RenderOptions options;
  options.interactive = interactive;
  PipelineExecutor executor = f.executor(kGather, options);
  SceneSnapshot snapshot = snapshotOf(f.scene, 0.0);
  executor.render(snapshot);
  f.techniques.takeRan();
  snapshot.camera.eye.z += 1.0f;
  CHECK(first(executor.render(snapshot, 1), "diffuse") == 2.25f);
  CHECK(f.techniques.takeRan() ==
        (interactive ? Ran{"paint_camera", "gather"} : Ran{"voxels", "paint_camera", "gather"}));
}

TEST_CASE("sharing memory between short-lived resources needs less of it") {
  Fixture f;
  // A chain of four sums: two images are alive at any time, and the last one stays.
  const char* body =
      "pass a toy.paint { }\npass b toy.add { first a }\npass c toy.add { first b }\npass d toy.add { first "
      "c }\noutput o d.sum";
  constexpr std::uint64_t kImage = 4 * 4 * 16;
  PipelineExecutor shared = f.executor(body),
                   separate = f.executor(body, with(&RenderOptions::keepEverything));
  const FrameResult frame = shared.render(0.0);
  const Explanation explanation = shared.explain();
  CHECK(explanation.poolBytes == 2 * kImage);
  CHECK(explanation.sharedBytes == 2 * kImage);
  CHECK(find(explanation, LeftOut::Level::resource, "memory of its own")->savedBytes == 2 * kImage);
  CHECK(first(separate.render(0.0), "o") == first(frame, "o"));
  CHECK(separate.explain().poolBytes == 4 * kImage);
  for (const PassRecord& pass : frame.passes) CHECK(pass.bytes == kImage);
}

TEST_CASE("an output that is asked to be kept stays alive, with the pass that makes it") {
  Fixture f;
  PipelineExecutor executor = f.executor(std::string(kGather) + "\npass unread toy.paint { value 5 }");
  executor.render(0.0);
  CHECK(executor.output("voxels", "grid") == nullptr);
  executor.keepOutput("voxels", "grid");
  executor.keepOutput("unread", "radiance");
  executor.render(0.0);
  REQUIRE(executor.output("voxels", "grid") != nullptr);
  CHECK(executor.output("voxels", "grid")->textures().front()->downloadFloats().front() == 0.25f);
  REQUIRE(executor.output("unread", "radiance") != nullptr);
  CHECK_THROWS_MATCHES(executor.keepOutput("voxles", "grid"), Error, Tells("voxles"));
  CHECK_THROWS_MATCHES(executor.output("voxels", "grit"), Error, Tells("grit"));
}

TEST_CASE("the times of the passes and the time between them make up the frame") {
  Fixture f;
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
  Fixture f;
  timedByStamps(f, GENERATE(false, true));
  PipelineExecutor executor = f.executor(kGather);
  executor.render(0.0);
  CHECK(executor.timedPasses().empty());
  // More frames than are under way at a time; the second one runs nothing.
  for (int frame = 0; frame < 7; ++frame) {
    if (frame != 1) executor.invalidate();
    const FrameResult result =
        executor.render(0.0, 0, PipelineExecutor::Images::no, PipelineExecutor::Timing::passes);
    CHECK(std::isnan(result.frameMs));
    if (frame == 3) executor.render(0.0);  // a frame that is not timed comes between
  }
  const auto frames = executor.timedPasses();
  REQUIRE(frames.size() == 7);
  for (std::size_t frame = 0; frame < 7; ++frame) {
    REQUIRE(frames[frame].size() == 3);
    double sum = 0.0;
    for (const PassRecord& pass : frames[frame]) {
      CHECK(pass.ran == (frame != 1));
      CHECK(pass.deviceMs >= 0.0);
      sum += pass.deviceMs;
    }
    CHECK((sum > 0.0) == (frame != 1));
  }
  CHECK(frames[0][0].name == "voxels");
  CHECK(executor.timedPasses().empty());
}

TEST_CASE("a pass that fails while it draws fails alone: the next frame draws again") {
  Fixture f;
  timedByStamps(f, GENERATE(false, true));
  f.techniques.add<Interrupted>("toy", "interrupted");
  PipelineExecutor executor = f.executor("pass one toy.interrupted { }\noutput image one.image");
  const auto timed = [&] {
    return executor.render(0.0, 0, PipelineExecutor::Images::no, PipelineExecutor::Timing::passes);
  };
  CHECK_THROWS_MATCHES(timed(), Error, Tells("pass one", "the texture does not fit"));
  CHECK(executor.timedPasses().empty());
  CHECK(timed().passes.size() == 1);
  CHECK(executor.timedPasses().size() == 1);
  CHECK(first(executor.render(0.0), "image") == 0.0f);  // the drawing cleared it
}

TEST_CASE("a warning of a pass is told once per run, and its notes in each inspected frame alone") {
  Fixture f;
  f.techniques.add<Warner>("toy", "warner");
  const char* text = "pass dim toy.warner { }\noutput o dim.image";
  PipelineExecutor executor = f.executor(text);
  const LogCapture log;
  CHECK(executor.render(0.0).notes.empty());
  executor.render(1.0, 1);
  CHECK_THAT(log.text(), Tells("pass dim", "too dark"));
  CHECK(log.text().find("too dark") == log.text().rfind("too dark"));
  PipelineExecutor inspected = f.executor(text, with(&RenderOptions::health));
  for (int frame = 0; frame < 2; ++frame)
    CHECK(inspected.render(0.0, frame).notes == std::vector<std::string>{"pass dim: inspected"});
}

TEST_CASE("an unknown camera is refused when the pipeline is bound") {
  Fixture f;
  RenderOptions options;
  options.camera = "mian";
  CHECK_THROWS_MATCHES(f.executor(kGather, options), Error, Tells("main"));
}

TEST_CASE("the harness runs one pass on inputs made by a test") {
  Fixture f;
  const SceneSnapshot snapshot = snapshotOf(f.scene, 0.0);
  PassHarness harness(*f.device, f.techniques, "toy", "add", f.scene, snapshot);
  const auto constant = [&](float value) {
    Image image{harness.context().image("constant")};
    image.texture->clear(glm::vec4(value));
    return image;
  };
  CHECK_THROWS_MATCHES(harness.run(), Error, Tells("first"));
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
