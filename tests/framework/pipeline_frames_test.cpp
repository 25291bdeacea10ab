// Frames in a row: what is made once while it stands still, and what stays when parameters or the scene
// change.
#include <fmt/format.h>

#include "frames_toys.h"
#include "gpu/state.h"
#include "lumivox/base/error.h"
#include "lumivox/pipeline/gpu_scene.h"
#include "support/facts.h"

using namespace lumivox;
using namespace lumivox::test;
using Images = PipelineExecutor::Images;

// ---- made once while it stands still -------------------------------------------------------------------

namespace {

/// A table for each metre that the camera stands in, and one of the scene in every second of them.
struct Tables : Toy {
  using Toy::Toy;
  Param<float> scale{this, "scale", 1.0f, {0.0f, 10.0f}, "", "of the values"};
  Out<Image> image{this, "image", Contributes::direct};
  Reads readsFrom() const override { return Reads::camera | Reads::materials; }
  void run(PassContext& frame) override {
    const int cell = static_cast<int>(std::floor(frame.snapshot().camera.eye.x));
    const auto make = [&] {
      note();
      return paint(frame, scale * static_cast<float>(cell)).texture;
    };
    const gpu::TextureRef table = frame.kept("table", cell, make);
    if (cell % 2 != 0) frame.kept("of the scene", true, [&] { return frame.buffer(4096, "of the scene"); });
    image =
        paint(frame, table->downloadFloats().front() + frame.sceneDescription().materials.front().diffuse.x);
  }
};

}  // namespace

TEST_CASE("what is kept is made once for its key, and told by explain") {
  FramesFixture f;
  f.techniques.add<Tables>("toy", "tables");
  const char* text = "param scale 1 in 0..10\npass a toy.tables { scale $scale }\noutput o a.image";
  RenderOptions options;
  options.interactive = true;
  PipelineExecutor executor = f.executor(text, options);
  SceneSnapshot snapshot = snapshotOf(f.scene, 0.0);
  const auto at = [&](float x) {
    snapshot.camera.eye.x = x;
    const float value = first(executor.render(snapshot), "o");
    return std::pair(value, f.techniques.takeRan().size());
  };
  CHECK(at(2.25f) == std::pair(2.5f, std::size_t{1}));
  CHECK(find(executor.explain(), LeftOut::Level::time, "a: table") == nullptr);
  CHECK(at(2.5f) == std::pair(2.5f, std::size_t{0}));
  REQUIRE(find(executor.explain(), LeftOut::Level::time, "a: table in later frames") != nullptr);
  CHECK(at(4.5f) == std::pair(4.5f, std::size_t{1}));
  CHECK(at(2.5f) == std::pair(2.5f, std::size_t{1}));  // not what was made last
  executor.invalidate();
  CHECK(at(2.75f) == std::pair(2.5f, std::size_t{1}));
  executor.setParameters({{"scale", {3.0, {}, {}}}});
  CHECK(at(2.5f) == std::pair(6.5f, std::size_t{1}));

  SECTION("what a run does not ask for is given back") {
    const std::uint64_t without = executor.explain().poolBytes;
    at(1.5f);
    CHECK(executor.explain().poolBytes == without + 4096);
    at(4.5f);
    CHECK(executor.explain().poolBytes == without);
  }
  SECTION("with keep-everything it is made in every frame") {
    options.keepEverything = true;
    PipelineExecutor whole = f.executor(text, options);
    for (int i = 0; i < 3; ++i) whole.render(snapshot, i);
    CHECK(f.techniques.takeRan().size() == 3);
    for (const LeftOut& one : whole.explain().leftOut) CHECK(one.level == LeftOut::Level::scene);
  }
  SECTION("another scene forgets it") {
    Scene other = f.scene;
    other.materials[0].diffuse.x = 0.75f;
    executor.setScene(other);
    CHECK(at(2.5f) == std::pair(6.75f, std::size_t{1}));
  }
}

// ---- parameters and scene ------------------------------------------------------------------------------

TEST_CASE("other parameters run again what depends on them, with a new executor's bits") {
  FramesFixture f;
  const std::string text =
      "param near 1 in 0..10\nparam side 8 in 1..64\n"
      "pass voxels toy.voxels { resolution $side }\npass view toy.paint_camera { value $near }\n"
      "pass gather toy.gather { grid voxels  view view }\noutput diffuse gather.diffuse";
  PipelineExecutor executor = f.executor(text);
  executor.render(0.0);
  f.techniques.takeRan();
  const auto set = [&](double nearValue, double side) {
    const ParameterValues values{{"near", {nearValue, {}, {}}}, {"side", {side, {}, {}}}};
    executor.setParameters(values);
    const std::vector<float> changed = valuesOf(executor.render(0.0));
    const Ran ran = f.techniques.takeRan();
    RenderOptions options;
    options.parameters = values;
    PipelineExecutor fresh = f.executor(text, options);
    CHECK(changed == valuesOf(fresh.render(0.0)));
    f.techniques.takeRan();
    return ran;
  };
  CHECK(set(1, 8).empty());  // what it has
  CHECK(set(3, 8) ==
        Ran{"voxels", "paint_camera", "gather"});  // the grid was given back after the first frame
  executor.keepOutput("voxels", "grid");
  executor.render(0.0);
  f.techniques.takeRan();
  CHECK(set(4, 8) == Ran{"paint_camera", "gather"});
  CHECK(set(4, 16) == Ran{"voxels", "paint_camera", "gather"});
  executor.keepOutput("view", "radiance");
  executor.render(0.0);
  f.techniques.takeRan();
  CHECK(set(4, 8) == Ran{"voxels", "gather"});

  CHECK_THROWS_MATCHES(executor.setParameters({{"side", {65.0, {}, {}}}}), Error, Tells("1..64"));
  CHECK_THROWS_MATCHES(executor.setParameters({{"sied", {8.0, {}, {}}}}), Error, Tells("sied"));
  CHECK(first(executor.render(0.0), "diffuse") == 4.25f);  // as it was
  CHECK(f.techniques.takeRan().empty());
}

namespace {

/// Reads one thing of the scene; shows it.
template <int What>
struct Watcher : Toy {
  using Toy::Toy;
  Out<Image> image{this, "image", Contributes::direct};
  Reads readsFrom() const override {
    constexpr Reads kAll[] = {Reads::materials, Reads::environment, Reads::media, Reads::lights,
                              Reads::geometry};
    return kAll[What];
  }
  void run(PassContext& frame) override {
    note();
    const Scene& scene = frame.sceneDescription();
    float value = 0.0f;
    if (What == 0) value = scene.materials[0].diffuse.x;
    if (What == 1) value = scene.environment.x;
    if (What == 2) value = scene.media.empty() ? 0.0f : scene.media[0].extinction.x;
    if (What == 3)
      value =
          scene.materials[0].emission.x + (scene.lights.empty() ? 0.0f : frame.snapshot().lights[0].power.x);
    if (What == 4) value = frame.scene().positions().template downloadValues<float>()[3];
    image = paint(frame, value);
  }
};

}  // namespace

TEST_CASE("another scene runs again what reads what differs, with the bits of a new executor") {
  FramesFixture f;
  f.techniques.add<Watcher<0>>("toy", "materials");
  f.techniques.add<Watcher<1>>("toy", "environment");
  f.techniques.add<Watcher<2>>("toy", "media");
  f.techniques.add<Watcher<3>>("toy", "lights");
  f.techniques.add<Watcher<4>>("toy", "geometry");
  std::string text;
  for (const char* pass : {"materials", "environment", "media", "lights", "geometry"})
    text += fmt::format("pass {0} toy.{0} {{ }}\noutput {0} {0}.image\n", pass);
  // Of everything something, so that no trait comes or goes.
  f.scene.environment = glm::vec3(1.0f);
  f.scene.media.emplace_back().extinction = glm::vec3(1.0f);
  f.scene.materials[0].emission = glm::vec3(1.0f);
  f.scene.lights.emplace_back().power = glm::vec3(1.0f);
  PipelineExecutor executor = f.executor(text);
  executor.render(0.0);
  f.techniques.takeRan();
  std::vector<std::unique_ptr<Scene>> scenes;  // an executor's scene must outlive it
  const auto changed = [&](const auto& change) {
    scenes.push_back(std::make_unique<Scene>(scenes.empty() ? f.scene : *scenes.back()));
    change(*scenes.back());
    executor.setScene(*scenes.back());
    const std::vector<float> values = valuesOf(executor.render(0.0));
    const Ran ran = f.techniques.takeRan();
    PipelineExecutor fresh(*f.device, f.techniques, *scenes.back(), pipelineOf(text), {});
    CHECK(values == valuesOf(fresh.render(0.0)));
    f.techniques.takeRan();
    return ran;
  };
  CHECK(changed([](Scene&) {}).empty());
  CHECK(changed([](Scene& s) { s.environment.x = 2.0f; }) == Ran{"environment"});
  CHECK(changed([](Scene& s) { s.media[0].extinction.x = 3.0f; }) == Ran{"media"});
  CHECK(changed([](Scene& s) { s.lights[0].power.x = 4.0f; }) == Ran{"lights"});
  // Emissive objects have the material or the triangles, so the lights may change too.
  CHECK(changed([](Scene& s) { s.materials[0].diffuse.x = 0.25f; }) == Ran{"materials", "lights"});
  CHECK(changed([](Scene& s) { s.positions[1].x = 5.0f; }) == Ran{"lights", "geometry"});
  // With the last light a trait goes, and one more object that shines is one more area light: all begins
  // anew.
  CHECK(changed([](Scene& s) { s.lights.clear(); }).size() == 5);
  CHECK(changed([](Scene& s) { s.objects.push_back(s.objects[0]); }).size() == 5);
  Scene lacking = *scenes.back();
  lacking.cameras[0].name = "other";
  RenderOptions named;
  named.camera = "main";
  PipelineExecutor withCamera = f.executor(text, named);
  CHECK_THROWS_MATCHES(withCamera.setScene(lacking), Error, Tells("main"));
  CHECK(valuesOf(withCamera.render(0.0)).size() == 5 * 4 * 4 * 3);
}

TEST_CASE("an output models as many bounces as the most of its passes, direct light one") {
  FramesFixture f;
  PipelineExecutor executor = f.executor(
      "pass a toy.paint { }\npass b toy.progressive { source a }\npass c toy.add { first a  second b }\n"
      "output one a.radiance\noutput mean b.mean\noutput sum c.sum");
  CHECK(executor.render(0.0).indirectBounces ==
        std::map<std::string, int>{{"one", 1}, {"mean", 1}, {"sum", 3}});
  CHECK(executor.indirectBounces() == executor.render(0.0).indirectBounces);
}

// ---- useless inputs ------------------------------------------------------------------------------------

namespace {

/// `share` of one term and the rest of the other; with 0 or 1 one of them is useless.
struct Blend : Toy {
  using Toy::Toy;
  In<Image> a{this, "a", "one term"};
  In<Image> b{this, "b", "the other"};
  Param<float> share{this, "share", 0.5f, {0.0f, 1.0f}, "", "of b"};
  Out<Image> sum{this, "sum", Contributes::final};
  bool uses(const InBase& input) const override {
    return (&input != &a || share < 1.0f) && (&input != &b || share > 0.0f);
  }
  void run(PassContext& frame) override {
    note();
    float value = 0.0f;
    if (share < 1.0f) value += (1.0f - share) * valueOf(*a);
    if (share > 0.0f) value += share * valueOf(*b);
    sum = paint(frame, value);
  }
};

}  // namespace

TEST_CASE("an input that the parameters make useless is left out like one that the scene makes useless") {
  FramesFixture f;
  f.techniques.add<Blend>("toy", "blend");
  const std::string text =
      "param share 0.5 in 0..1\npass one toy.paint { value 2 }\npass two toy.paint_camera { value 4 }\n"
      "pass mix toy.blend { a one  b two  share $share }\noutput o mix.sum";
  PipelineExecutor executor = f.executor(text);
  const auto with = [&](double share) {
    executor.setParameters({{"share", {share, {}, {}}}});
    const FrameResult lean = executor.render(0.0);
    const Ran ran = f.techniques.takeRan();
    RenderOptions options;
    options.keepEverything = true;
    options.parameters = {{"share", {share, {}, {}}}};
    PipelineExecutor whole = f.executor(text, options);
    CHECK(valuesOf(lean) == valuesOf(whole.render(0.0)));
    CHECK(f.techniques.takeRan().size() == 3);
    return ran;
  };
  CHECK(with(0.5) == Ran{"paint", "paint_camera", "blend"});
  CHECK(with(0.0) == Ran{"paint", "blend"});
  CHECK_THAT(whyLeftOut(executor, LeftOut::Level::pass, "two"), Tells("parameters", "mix", "b", "useless"));
  CHECK(with(1.0) == Ran{"paint_camera", "blend"});
  CHECK(with(0.25) == Ran{"paint", "paint_camera", "blend"});
  // A useless input that is required may be left out by the scene, too.
  PipelineExecutor foggy = f.executor(
      "pass one toy.paint { value 2 }\npass fog toy.fog { }\npass mix toy.blend { a one  b fog  share 0 }\n"
      "output o mix.sum");
  CHECK(first(foggy.render(0.0), "o") == 2.0f);
}

namespace {

/// Hands two images on, each for the sake of one of its outputs alone.
struct Pair : Toy {
  using Toy::Toy;
  In<Image> left{this, "left", "one"};
  In<Image> right{this, "right", "the other"};
  Out<Image> ofLeft{this, "of_left"};
  Out<Image> ofRight{this, "of_right"};
  bool uses(const InBase& input) const override {
    return &input == &left ? ofLeft.wanted() : ofRight.wanted();
  }
  void run(PassContext& frame) override {
    note();
    if (ofLeft.wanted()) ofLeft = paint(frame, valueOf(*left));
    if (ofRight.wanted()) ofRight = paint(frame, valueOf(*right));
  }
};

}  // namespace

TEST_CASE("an input that only unwanted outputs read is left out, through as many passes as there are") {
  const auto [wanted, keepEverything, ran] = GENERATE(table<std::vector<std::string>, bool, std::size_t>(
      {{{"l"}, false, 3}, {{"r"}, false, 3}, {{"l", "r"}, false, 4}, {{"l"}, true, 4}}));
  FramesFixture f;
  f.techniques.add<Pair>("toy", "pair");
  RenderOptions options;
  options.wanted = wanted;
  options.keepEverything = keepEverything;
  options.accumulate = GENERATE(false, true);
  PipelineExecutor executor = f.executor(
      "pass one toy.paint { value 2 }\npass two toy.paint_camera { value 4 }\n"
      "pass near toy.pair { left one  right two }\n"
      "pass far toy.pair { left near.of_left  right near.of_right }\n"
      "output l far.of_left\noutput r far.of_right",
      options);
  const FrameResult frame = executor.render(0.0);
  for (const std::string& name : wanted) CHECK(first(frame, name) == (name == "l" ? 2.0f : 4.0f));
  const Ran found = f.techniques.takeRan();
  CHECK(found.size() == ran);
  if (ran == 4) return;
  CHECK(found == Ran{wanted.front() == "l" ? "paint" : "paint_camera", "pair", "pair"});
  const bool left = wanted.front() == "l";
  CHECK_THAT(whyLeftOut(executor, LeftOut::Level::pass, left ? "two" : "one"),
             Tells("near", "wanted", left ? "right" : "left", "useless"));
}

namespace {

/// Needs a medium unless it is told not to.
struct Gated : Paint {
  using Paint::Paint;
  Param<bool> open{this, "open", true, "makes its image without a medium, too"};
  Needs needs() const override { return open ? Needs::nothing : Needs::medium; }
};

}  // namespace

TEST_CASE("a reader runs again when a parameter of its source has that left out") {
  FramesFixture f;
  f.techniques.add<Gated>("toy", "gated");
  PipelineExecutor executor = f.executor(
      "param open on\npass one toy.paint { value 2 }\npass gate toy.gated { value 4  open $open }\n"
      "pass sum toy.add { first one  second gate }\noutput o sum.sum");
  CHECK(first(executor.render(0.0), "o") == 6.0f);
  executor.setParameters({{"open", {0.0, "off", {}}}});
  CHECK(first(executor.render(0.0), "o") == 2.0f);
  executor.setParameters({});
  CHECK(first(executor.render(0.0), "o") == 6.0f);
}

// ---- ambient occlusion, the host -----------------------------------------------------------------------

namespace {

struct Occlusion : Toy {
  using Toy::Toy;
  Out<Image> open{this, "open", Contributes::ambientOcclusion, Needs::medium};
  void run(PassContext& frame) override { open = paint(frame, 0.5f); }
};

/// Works for a while on the host alone.
struct OnHost : Paint {
  using Paint::Paint;
  bool worksOnHost() const override { return true; }
};

}  // namespace

TEST_CASE("ambient occlusion that is left out is 1 everywhere, in one channel: nothing is occluded") {
  FramesFixture f;
  f.techniques.add<Occlusion>("toy", "occlusion");
  const FrameResult frame = f.executor("pass a toy.occlusion { }\noutput o a.open").render(0.0);
  CHECK(frame.outputs.at("o").channels() == 1);
  CHECK(frame.components.at("o") == Contributes::ambientOcclusion);
  CHECK(frame.outputs.at("o").values() == std::vector<float>(4 * 4, 1.0f));
}

TEST_CASE("a pass that works on the host is timed by the host's clock, among passes that the device times") {
  FramesFixture f;
  f.techniques.add<OnHost>("toy", "on_host");
  f.device->info();
  if (GENERATE(false, true)) f.device->state()->info.timerQueriesTrusted = true;
  PipelineExecutor executor = f.executor(
      "pass a toy.paint { }\npass b toy.on_host { }\npass c toy.add { first a  second b }\noutput o c.sum");
  for (int n = 0; n < 6; ++n) {
    executor.invalidate();
    executor.render(0.0, 0, Images::no, PipelineExecutor::Timing::passes);
  }
  const auto frames = executor.timedPasses();
  REQUIRE(frames.size() == 6);
  for (const auto& passes : frames) {
    REQUIRE(passes.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) CHECK(passes[i].onHost == (i == 1));
    // By one clock: until the last command was given, and until it was done.
    CHECK(passes[1].deviceMs >= passes[1].hostMs);
    CHECK(passes[1].deviceMs > 0.0);
  }
}

// ---- check reads ---------------------------------------------------------------------------------------

namespace {

/// Shows where the camera is, and says that it reads the geometry.
struct Liar : Toy {
  using Toy::Toy;
  Out<Image> image{this, "image", Contributes::direct};
  Reads readsFrom() const override { return Reads::geometry; }
  void run(PassContext& frame) override { image = paint(frame, frame.snapshot().camera.eye.x); }
};

/// Shines without the medium that it says it needs.
struct Needy : Toy {
  using Toy::Toy;
  Out<Image> image{this, "image", Contributes::direct, Needs::medium};
  void run(PassContext& frame) override { image = paint(frame, 3.0f); }
};

/// Keeps what depends on the camera under a key that does not.
struct BadKey : Toy {
  using Toy::Toy;
  Out<Image> image{this, "image", Contributes::direct};
  Reads readsFrom() const override { return Reads::camera; }
  void run(PassContext& frame) override {
    image =
        Image{frame.kept("image", 0, [&] { return paint(frame, frame.snapshot().camera.eye.x).texture; })};
  }
};

}  // namespace

TEST_CASE("checking reads names the pass that was not run again though what it reads changed") {
  FramesFixture f;
  f.techniques.add<Liar>("toy", "liar");
  f.techniques.add<Needy>("toy", "needy");
  f.techniques.add<BadKey>("toy", "bad_key");
  PipelineExecutor executor = f.executor(
      "pass view toy.paint_camera { value 2 }\npass lies toy.liar { }\n"
      "pass follows toy.add { first lies  second view }\npass shines toy.needy { }\npass keeps toy.bad_key { }\n"
      "output o follows.sum\noutput n shines.image\noutput k keeps.image",
      with(&RenderOptions::interactive, &RenderOptions::checkReads));
  SceneSnapshot snapshot = snapshotOf(f.scene, 0.0);
  const Tells needs("pass shines", "port image", 48, 48, "neutral", "medium", "Needs");
  std::vector<std::string> findings = executor.render(snapshot).readsFindings;
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0], needs);
  snapshot.camera.eye.x = 7.0f;
  findings = executor.render(snapshot, 1).readsFindings;
  REQUIRE(findings.size() == 3);
  CHECK_THAT(findings[0], Tells("pass lies", "port image", "readsFrom()", "geometry"));
  CHECK_THAT(findings[1], Tells("pass keeps", "port image", "key"));
  CHECK_THAT(findings[2], needs);
}

namespace {

/// Adds a second image that it says it does not use.
struct Denier : Add {
  using Add::Add;
  bool uses(const InBase& input) const override { return &input != &second; }
};

}  // namespace

TEST_CASE("checking reads names the input that was left out though the pass reads it") {
  FramesFixture f;
  f.techniques.add<Denier>("toy", "denier");
  PipelineExecutor executor = f.executor(
      "pass one toy.paint { }\npass two toy.paint { value 2 }\npass sum toy.denier { first one  second two }\n"
      "pass after toy.add { first sum }\noutput o after.sum",
      with(&RenderOptions::checkReads));
  const std::vector<std::string> findings = executor.render(0.0).readsFindings;
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0], Tells("pass sum", "port sum", 48, 48, "Needs", "uses()", "second", "sum",
                                "two.radiance", "parameters", "useless"));
}

TEST_CASE("checking reads finds nothing in passes that say what they read, with histories too") {
  FramesFixture f;
  for (const bool accumulate : {false, true}) {
    RenderOptions options;
    options.interactive = options.checkReads = true;
    options.accumulate = accumulate;
    PipelineExecutor executor =
        f.executor(std::string(kProgressive) + "\npass fog toy.fog { }\noutput fog fog.scattered", options);
    SceneSnapshot snapshot = snapshotOf(f.scene, 0.0);
    for (int n = 0; n < 6; ++n) {
      if (n == 2 || n == 4) snapshot.camera.eye.x += 1.0f;
      if (n == 3) snapshot.objects[0].toWorld[3].x += 1.0f;
      if (n == 5) executor.setParameters({{"light", {4.0, {}, {}}}});
      CAPTURE(accumulate, n);
      CHECK(executor.render(snapshot, n).readsFindings.empty());
    }
  }
}
