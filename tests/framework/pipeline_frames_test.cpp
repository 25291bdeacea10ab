// Frames in a row: histories, accumulation, what is made once while it stands still, and what stays when
// parameters or the scene change.
#include <cmath>

#include "gpu/state.h"
#include "lumivox/base/error.h"
#include "lumivox/pipeline/gpu_scene.h"
#include "pipeline_toys.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;
using Ran = std::vector<std::string>;
using Pictures = PipelineExecutor::Pictures;

namespace {

gpu::TextureDescription smallPicture(int side = 4) {
  gpu::TextureDescription description;
  description.format = gpu::Format::rgba32f;
  description.width = description.height = side;
  return description;
}

/// The mean over frames of `source` plus 0, 1, 2 ...: a progressive technique whose samples are known.
class Progressive : public Toy {
 public:
  using Toy::Toy;
  In<Image> source{this, "source", "what is there in every frame"};
  Param<int> side{this, "side", 4, {1, 64}, "of the history"};
  Out<Image> mean{this, "mean", Contributes::direct};
  Reads readsFrom() const override { return Reads::history; }
  int indirectBounces() const override { return 3; }
  void run(PassContext& frame) override {
    note();
    const int before = frame.accumulated();
    const History<gpu::TextureRef> sum = frame.history(smallPicture(side), "sum");
    float value = valueOf(*source) + static_cast<float>(before);
    if (before > 0 && sum.previous) value += sum.previous->downloadFloats().front();
    sum.current->clear(glm::vec4(value));
    mean = paint(frame, value / static_cast<float>(before + 1));
  }
};

/// `light` plus half of what a pass made in the frame before.
class Feedback : public Toy {
 public:
  using Toy::Toy;
  In<Image> light{this, "light", "new light"};
  In<Image> previous{this, "previous", Presence::history, "all light of the frame before"};
  Out<Image> radiance{this, "radiance", Contributes::indirectDiffuse};
  void run(PassContext& frame) override {
    note();
    radiance = paint(frame, valueOf(*light) + (previous ? 0.5f * valueOf(*previous) : 0.0f));
  }
};

/// Light of a medium that changes with time: none where there is no medium.
class Flicker : public Toy {
 public:
  using Toy::Toy;
  Out<Image> scattered{this, "scattered", Contributes::scattered, Needs::medium};
  Reads readsFrom() const override { return Reads::time; }
  void run(PassContext& frame) override { scattered = paint(frame, 0.0f); }
};

/// A sum that leads back to its own first term.
const char* const kFeedback =
    "pass light toy.paint { value 1 }\n"
    "pass back toy.feedback { light light  previous sum.sum }\n"
    "pass sum toy.add { first back.radiance  second light }\n"
    "output radiance back.radiance\noutput sum sum.sum";

const char* const kProgressive =
    "param light 2 in 0..10\n"
    "pass view toy.paint_camera { value $light }\n"
    "pass still toy.paint { value 3 }\n"
    "pass a toy.progressive { source view }\n"
    "pass b toy.progressive { source still }\n"
    "output a a.mean\noutput b b.mean";

RenderOptions accumulating(bool keepEverything = false) {
  RenderOptions options;
  options.accumulate = true;
  options.interactive = true;
  options.keepEverything = keepEverything;
  return options;
}

struct FramesFixture : Fixture {
  FramesFixture() {
    techniques.add<Progressive>("toy", "progressive");
    techniques.add<Feedback>("toy", "feedback");
    techniques.add<Flicker>("toy", "flicker");
  }
};

std::vector<float> valuesOf(const FrameResult& frame) {
  std::vector<float> all;
  for (const auto& [name, picture] : frame.outputs)
    all.insert(all.end(), picture.values().begin(), picture.values().end());
  return all;
}

const LeftOut* find(const Explanation& explanation, LeftOut::Level level, const std::string& what) {
  for (const LeftOut& one : explanation.leftOut)
    if (one.level == level && one.what.rfind(what, 0) == 0) return &one;
  return nullptr;
}

}  // namespace

// ---- histories -----------------------------------------------------------------------------------------

TEST_CASE("a progressive pass finds its sum of the frame before: the mean of 2, 3, 4 ... is 2 + N / 2") {
  FramesFixture f;
  if (!f) return;
  for (const bool keepEverything : {false, true}) {
    PipelineExecutor executor = f.executor(kProgressive, accumulating(keepEverything));
    for (int n = 0; n < 5; ++n)
      CHECK(first(executor.render(0.0, 0), "a") == 2.0f + 0.5f * static_cast<float>(n));
  }
}

TEST_CASE("without accumulation no frame finds a history, so that frame N alone is frame N of a sequence") {
  FramesFixture f;
  if (!f) return;
  for (const char* text : {kProgressive, kFeedback}) {
    PipelineExecutor sequence = f.executor(text);
    for (int n = 0; n < 3; ++n) {
      PipelineExecutor alone = f.executor(text);
      CHECK(valuesOf(sequence.render(0.1 * n, n)) == valuesOf(alone.render(0.1 * n, n)));
    }
  }
  PipelineExecutor feedback = f.executor(kFeedback);
  for (int n = 0; n < 3; ++n) CHECK(first(feedback.render(0.0, n), "radiance") == 1.0f);
}

TEST_CASE("a history is what a later pass made in the frame before: a geometric series") {
  FramesFixture f;
  if (!f) return;
  // r(n) = 1 + (r(n-1) + 1) / 2, from r(0) = 1: r(n) = 3 - 2 / 2^n.
  PipelineExecutor executor = f.executor(kFeedback, accumulating());
  for (int n = 0; n < 6; ++n) {
    const FrameResult frame = executor.render(0.0, n);
    CHECK(first(frame, "radiance") == 3.0f - 2.0f / static_cast<float>(1 << n));
    CHECK(first(frame, "sum") == 4.0f - 2.0f / static_cast<float>(1 << n));
  }
}

TEST_CASE("a pass may read its own output of the frame before") {
  FramesFixture f;
  if (!f) return;
  PipelineExecutor executor = f.executor(
      "pass light toy.paint { }\npass back toy.feedback { light light  previous back.radiance }\n"
      "output o back.radiance",
      accumulating());
  // 1, 1.5, 1.75: 2 - 1 / 2^n
  for (int n = 0; n < 4; ++n)
    CHECK(first(executor.render(0.0, n), "o") == 2.0f - 1.0f / static_cast<float>(1 << n));
}

TEST_CASE("what only a history wants is made for its sake, and not without accumulation") {
  FramesFixture f;
  if (!f) return;
  const char* text =
      "pass light toy.paint { }\npass back toy.feedback { light light  previous later.sum }\n"
      "pass later toy.add { first far }\npass far toy.paint_camera { value 4 }\noutput o back.radiance";
  PipelineExecutor alone = f.executor(text);
  CHECK(first(alone.render(0.0), "o") == 1.0f);
  CHECK(f.techniques.takeRan() == Ran{"paint", "feedback"});
  PipelineExecutor executor = f.executor(text, accumulating());
  CHECK(first(executor.render(0.0, 0), "o") == 1.0f);
  CHECK(first(executor.render(0.0, 1), "o") == 3.0f);
  CHECK(first(executor.render(0.0, 2), "o") == 3.0f);
}

TEST_CASE("leaving out and keeping everything give the same bits in every frame with histories") {
  FramesFixture f;
  if (!f) return;
  const std::string text =
      std::string(kProgressive) +
      "\npass fog toy.fog { }\npass clock toy.feedback { light view  previous fin.sum }\n"
      "pass fin toy.add { first a.mean  second fog }\noutput c clock.radiance\n"
      "pass unread toy.progressive { source fin.sum }\n"
      "pass flicker toy.flicker { }\npass lit toy.add { first still  second flicker }\n"
      "pass d toy.progressive { source lit.sum }\noutput d d.mean";
  PipelineExecutor lean = f.executor(text, accumulating()), whole = f.executor(text, accumulating(true));
  SceneSnapshot snapshot = snapshotOf(f.scene, 0.0);
  for (int n = 0; n < 12; ++n) {
    if (n == 3 || n == 4 || n == 9) snapshot.camera.eye.x += 0.25f;
    if (n == 5) snapshot.time = 1.0;
    if (n == 6) snapshot.objects[0].toWorld[3].x += 1.0f;
    if (n == 7) {
      lean.invalidate();
      whole.invalidate();
    }
    if (n == 10) snapshot.camera.width = 6;
    CAPTURE(n);
    const FrameResult a = lean.render(snapshot, n / 2), b = whole.render(snapshot, n / 2);
    REQUIRE(a.outputs.size() == 4);
    CHECK(valuesOf(a) == valuesOf(b));
    // The medium is not there, so that time alone does not begin the mean of d anew.
    if (n == 4) CHECK(first(a, "d") == 3.0f + 0.5f * 4.0f);
  }
}

TEST_CASE("frames in a row are counted while nothing changes that the pass depends on") {
  FramesFixture f;
  if (!f) return;
  for (const bool keepEverything : {false, true}) {
    CAPTURE(keepEverything);
    PipelineExecutor executor = f.executor(kProgressive, accumulating(keepEverything));
    SceneSnapshot snapshot = snapshotOf(f.scene, 0.0);
    // The mean of 2 + 0, 1 ... n is 2 + n / 2: it tells n.
    const auto counts = [&] {
      const FrameResult frame = executor.render(snapshot);
      return std::pair(2.0f * (first(frame, "a") - 2.0f), 2.0f * (first(frame, "b") - 3.0f));
    };
    CHECK(counts() == std::pair(0.0f, 0.0f));
    CHECK(counts() == std::pair(1.0f, 1.0f));
    snapshot.camera.eye.x += 1.0f;  // which b does not depend on
    CHECK(counts() == std::pair(0.0f, 2.0f));
    CHECK(counts() == std::pair(1.0f, 3.0f));
    executor.invalidate();  // forgets results, but nothing has changed
    CHECK(counts() == std::pair(2.0f, 4.0f));
    executor.emptyHistories();
    CHECK(counts() == std::pair(0.0f, 0.0f));
    CHECK(counts() == std::pair(1.0f, 1.0f));
    executor.setSeed(1);  // the one that it has
    CHECK(counts() == std::pair(2.0f, 2.0f));
    executor.setSeed(9);
    CHECK(counts() == std::pair(0.0f, 0.0f));
    CHECK(counts() == std::pair(1.0f, 1.0f));
    snapshot.camera.width = 6;
    CHECK(counts() == std::pair(0.0f, 0.0f));
    CHECK(counts() == std::pair(1.0f, 1.0f));
    executor.setParameters({{"light", {2.0, {}, {}}}});  // as it was
    CHECK(counts() == std::pair(2.0f, 2.0f));
    executor.keepOutput("still", "radiance");
    CHECK(counts() == std::pair(0.0f, 0.0f));
  }
}

TEST_CASE("a changed parameter empties all histories") {
  FramesFixture f;
  if (!f) return;
  PipelineExecutor executor = f.executor(kProgressive, accumulating());
  for (int n = 0; n < 3; ++n) executor.render(0.0);
  executor.setParameters({{"light", {5.0, {}, {}}}});
  const FrameResult frame = executor.render(0.0);
  CHECK(first(frame, "a") == 5.0f);
  CHECK(first(frame, "b") == 3.0f);
}

namespace {

/// Asks for two histories of which one is there in odd frames only; tells what it found.
class Sporadic : public Toy {
 public:
  using Toy::Toy;
  Out<Image> found{this, "found", Contributes::direct};
  Reads readsFrom() const override { return Reads::history | Reads::time; }
  void run(PassContext& frame) override {
    float value = 0.0f;
    if (frame.history(64, "words").previous) value += 1.0f;
    if (frame.frameIndex() % 3 != 2 && frame.history(smallPicture(), "picture").previous) value += 2.0f;
    if (frame.history(smallPicture(frame.frameIndex() < 4 ? 4 : 8), "grows").previous) value += 4.0f;
    found = paint(frame, value);
  }
};

}  // namespace

TEST_CASE("a history is gone when a frame does not ask for it, or asks for another shape") {
  FramesFixture f;
  if (!f) return;
  f.techniques.add<Sporadic>("toy", "sporadic");
  PipelineExecutor executor = f.executor("pass a toy.sporadic { }\noutput o a.found", accumulating());
  std::vector<float> found;
  for (int n = 0; n < 6; ++n) found.push_back(first(executor.render(0.0, n), "o"));
  CHECK(found == std::vector<float>{0, 7, 5, 5, 3, 5});
}

namespace {

/// Finds in the second frame that it had too little room.
class Cramped : public Toy {
 public:
  using Toy::Toy;
  Out<Image> sum{this, "sum", Contributes::direct};
  Reads readsFrom() const override { return Reads::history | Reads::time; }
  void run(PassContext& frame) override {
    note();
    const History<gpu::TextureRef> kept = frame.history(smallPicture(), "sum");
    const float value = 1.0f + (kept.previous ? kept.previous->downloadFloats().front() : 0.0f);
    kept.current->clear(glm::vec4(value));
    const gpu::BufferRef count = frame.buffer(4, "count");
    count->clear(static_cast<std::uint32_t>(frame.frameIndex()));
    frame.judgeLater(count, 0, [this](PassContext&, std::uint32_t index) {
      return index != 1 || std::exchange(roomy_, true);
    });
    sum = paint(frame, value + 100.0f * static_cast<float>(frame.accumulated()));
  }

 private:
  bool roomy_ = false;
};

/// Fails in its second frame.
class Failing : public Toy {
 public:
  using Toy::Toy;
  Out<Image> sum{this, "sum", Contributes::direct};
  Reads readsFrom() const override { return Reads::history; }
  void run(PassContext& frame) override {
    const History<gpu::TextureRef> kept = frame.history(smallPicture(), "sum");
    if (++runs_ == 3) throw Error("it does not fit");
    sum = paint(frame, (kept.previous ? 1.0f : 0.0f) + 10.0f * static_cast<float>(frame.accumulated()));
  }

 private:
  int runs_ = 0;
};

}  // namespace

TEST_CASE("a frame that is rendered again for want of room finds the history that it found before") {
  FramesFixture f;
  if (!f) return;
  f.techniques.add<Cramped>("toy", "cramped");
  PipelineExecutor executor = f.executor("pass a toy.cramped { }\noutput o a.sum", accumulating());
  CHECK(first(executor.render(0.0, 0), "o") == 1.0f);
  f.techniques.takeRan();
  CHECK(first(executor.render(0.0, 1), "o") == 2.0f);  // time changed
  CHECK(f.techniques.takeRan().size() == 2);
  CHECK(first(executor.render(0.0, 1), "o") == 103.0f);
}

TEST_CASE("a frame that fails leaves no history") {
  FramesFixture f;
  if (!f) return;
  f.techniques.add<Failing>("toy", "failing");
  PipelineExecutor executor = f.executor("pass a toy.failing { }\noutput o a.sum", accumulating());
  CHECK(first(executor.render(0.0), "o") == 0.0f);
  CHECK(first(executor.render(0.0), "o") == 11.0f);
  CHECK_THAT(messageOf<Error>([&] { executor.render(0.0); }), Contains("pass a: it does not fit"));
  CHECK(first(executor.render(0.0), "o") == 0.0f);
  CHECK(first(executor.render(0.0), "o") == 11.0f);
}

namespace {

/// Uses what it does not declare.
class Undeclared : public Toy {
 public:
  using Toy::Toy;
  Param<bool> counts{this, "counts", false, "asks for the number of frames"};
  Out<Image> picture{this, "picture"};
  void run(PassContext& frame) override {
    if (counts)
      picture = paint(frame, static_cast<float>(frame.accumulated()));
    else
      picture = Image{frame.history(smallPicture(), "x").current};
  }
};

/// The same history twice.
class Twice : public Toy {
 public:
  using Toy::Toy;
  Out<Image> picture{this, "picture"};
  Reads readsFrom() const override { return Reads::history; }
  void run(PassContext& frame) override {
    frame.history(smallPicture(), "x");
    picture = Image{frame.history(smallPicture(), "x").current};
  }
};

}  // namespace

TEST_CASE("a pass that does not declare that it reads histories is refused them, by name") {
  FramesFixture f;
  if (!f) return;
  f.techniques.add<Undeclared>("toy", "undeclared");
  f.techniques.add<Twice>("toy", "twice");
  const auto told = [&](const std::string& pass, const RenderOptions& options) {
    PipelineExecutor executor = f.executor("pass a toy." + pass + "\noutput o a.picture", options);
    return messageOf<Error>([&] { executor.render(0.0); });
  };
  CHECK(told("undeclared { }", {}) ==
        "pass a: it calls history(), but its readsFrom() does not return Reads::history");
  CHECK_THAT(told("undeclared { counts on }", {}), Contains("pass a: it calls accumulated()"));
  CHECK_THAT(told("twice { }", accumulating()), Contains("pass a: it asks for the history 'x' twice"));
}

TEST_CASE("the harness carries histories from run to run when it is told to") {
  FramesFixture f;
  if (!f) return;
  const SceneSnapshot snapshot = snapshotOf(f.scene, 0.0);
  PassHarness harness(*f.device, f.techniques, "toy", "progressive", f.scene, snapshot);
  Image image{harness.context().image(gpu::Format::rgba32f, "constant")};
  image.texture->clear(glm::vec4(1.0f));
  harness.setInput<Image>("source", image);
  const auto mean = [&] {
    harness.run();
    return harness.output<Image>("mean").texture->downloadFloats().front();
  };
  CHECK(mean() == 1.0f);
  CHECK(mean() == 1.0f);
  harness.accumulate();
  for (int n = 0; n < 3; ++n) CHECK(mean() == 1.0f + 0.5f * static_cast<float>(n));
  CHECK(harness.pass().indirectBounces() == 3);

  PassHarness feedback(*f.device, f.techniques, "toy", "feedback", f.scene, snapshot);
  feedback.setInput<Image>("light", image);
  feedback.run();
  CHECK(feedback.output<Image>("radiance").texture->downloadFloats().front() == 1.0f);
  feedback.setInput<Image>("previous", image);
  feedback.run();
  CHECK(feedback.output<Image>("radiance").texture->downloadFloats().front() == 1.5f);
}

// ---- made once while it stands still -------------------------------------------------------------------

namespace {

/// A table for each metre that the camera stands in, and one of the scene in every second of them.
class Tables : public Toy {
 public:
  using Toy::Toy;
  Param<float> scale{this, "scale", 1.0f, {0.0f, 10.0f}, "", "of the values"};
  Out<Image> picture{this, "picture", Contributes::direct};
  Reads readsFrom() const override { return Reads::camera | Reads::materials; }
  void run(PassContext& frame) override {
    const int cell = static_cast<int>(std::floor(frame.snapshot().camera.eye.x));
    const auto make = [&] {
      note();
      Image image = paint(frame, scale * static_cast<float>(cell));
      return image.texture;
    };
    const gpu::TextureRef table = frame.kept("table", cell, make);
    if (cell % 2 != 0) frame.kept("of the scene", true, [&] { return frame.buffer(4096, "of the scene"); });
    picture =
        paint(frame, table->downloadFloats().front() + frame.sceneDescription().materials.front().diffuse.x);
  }
};

}  // namespace

TEST_CASE("what is kept is made once for its key, and told by explain") {
  FramesFixture f;
  if (!f) return;
  f.techniques.add<Tables>("toy", "tables");
  const char* text = "param scale 1 in 0..10\npass a toy.tables { scale $scale }\noutput o a.picture";
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
    CHECK(whole.explain().leftOut.empty());
  }
  SECTION("another scene forgets it") {
    Scene other = f.scene;
    other.materials[0].diffuse.x = 0.75f;
    executor.setScene(other);
    CHECK(at(2.5f) == std::pair(6.75f, std::size_t{1}));
  }
}

// ---- parameters and scene ------------------------------------------------------------------------------

TEST_CASE(
    "other parameters run again what they change and what depends on it, with the bits of a new executor") {
  FramesFixture f;
  if (!f) return;
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

  CHECK_THAT(messageOf<Error>([&] {
               executor.setParameters({{"side", {65.0, {}, {}}}});
             }),
             Contains("1..64"));
  CHECK_THAT(messageOf<Error>([&] { executor.setParameters({{"sied", {8.0, {}, {}}}}); }), Contains("sied"));
  CHECK(first(executor.render(0.0), "diffuse") == 4.25f);  // as it was
  CHECK(f.techniques.takeRan().empty());
}

namespace {

/// Reads one thing of the scene; shows it.
template <int What>
class Watcher : public Toy {
 public:
  using Toy::Toy;
  Out<Image> picture{this, "picture", Contributes::direct};
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
    picture = paint(frame, value);
  }
};

}  // namespace

TEST_CASE("another scene runs again what reads what differs, with the bits of a new executor") {
  FramesFixture f;
  if (!f) return;
  f.techniques.add<Watcher<0>>("toy", "materials");
  f.techniques.add<Watcher<1>>("toy", "environment");
  f.techniques.add<Watcher<2>>("toy", "media");
  f.techniques.add<Watcher<3>>("toy", "lights");
  f.techniques.add<Watcher<4>>("toy", "geometry");
  std::string text;
  for (const char* pass : {"materials", "environment", "media", "lights", "geometry"})
    text += fmt::format("pass {} toy.{} {{ }}\noutput {} {}.picture\n", pass, pass, pass, pass);
  // Of everything something, so that no trait comes or goes.
  f.scene.environment = glm::vec3(1.0f);
  f.scene.media.push_back({});
  f.scene.media[0].extinction = glm::vec3(1.0f);
  f.scene.materials[0].emission = glm::vec3(1.0f);
  f.scene.lights.push_back({});
  f.scene.lights[0].power = glm::vec3(1.0f);
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
  // What shines has the material or the triangles, so lights may be others too.
  CHECK(changed([](Scene& s) { s.materials[0].diffuse.x = 0.25f; }) == Ran{"materials", "lights"});
  CHECK(changed([](Scene& s) { s.positions[1].x = 5.0f; }) == Ran{"lights", "geometry"});
  // With the last light a trait goes: everything begins anew.
  CHECK(changed([](Scene& s) { s.lights.clear(); }).size() == 5);
  // One more object that shines is one more area light.
  CHECK(changed([](Scene& s) { s.objects.push_back(s.objects[0]); }).size() == 5);
  Scene lacking = *scenes.back();
  lacking.cameras[0].name = "other";
  RenderOptions named;
  named.camera = "main";
  PipelineExecutor withCamera = f.executor(text, named);
  CHECK_THAT(messageOf<Error>([&] { withCamera.setScene(lacking); }), Contains("main"));
  CHECK(valuesOf(withCamera.render(0.0)).size() == 5 * 4 * 4 * 3);
}

TEST_CASE("an output models as many bounces as its pass or the one before it that models most") {
  FramesFixture f;
  if (!f) return;
  PipelineExecutor executor = f.executor(
      "pass a toy.paint { }\npass b toy.progressive { source a }\npass c toy.add { first a  second b }\n"
      "output one a.radiance\noutput three b.mean\noutput sum c.sum");
  CHECK(executor.render(0.0).indirectBounces ==
        std::map<std::string, int>{{"one", 1}, {"three", 3}, {"sum", 3}});
}

// ---- useless inputs ------------------------------------------------------------------------------------

namespace {

/// `share` of one term and the rest of the other; with 0 or 1 one of them is useless.
class Blend : public Toy {
 public:
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
  if (!f) return;
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
  const Explanation explanation = executor.explain();
  const LeftOut* two = find(explanation, LeftOut::Level::pass, "two");
  REQUIRE(two != nullptr);
  CHECK(two->why == "the parameters of 'mix' make its input 'b' useless");
  CHECK(with(1.0) == Ran{"paint_camera", "blend"});
  CHECK(with(0.25) == Ran{"paint", "paint_camera", "blend"});
  // A useless input that is required may be left out by the scene, too.
  PipelineExecutor foggy = f.executor(
      "pass one toy.paint { value 2 }\npass fog toy.fog { }\npass mix toy.blend { a one  b fog  share 0 }\n"
      "output o mix.sum");
  CHECK(first(foggy.render(0.0), "o") == 2.0f);
}

namespace {

/// Needs a medium unless it is told not to.
class Gated : public Paint {
 public:
  using Paint::Paint;
  Param<bool> open{this, "open", true, "makes its picture without a medium, too"};
  Needs needs() const override { return open ? Needs::nothing : Needs::medium; }
};

}  // namespace

TEST_CASE("a reader runs again when a parameter of its source has that left out") {
  FramesFixture f;
  if (!f) return;
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

class Occlusion : public Toy {
 public:
  using Toy::Toy;
  Out<Image> open{this, "open", Contributes::ambientOcclusion, Needs::medium};
  void run(PassContext& frame) override { open = paint(frame, 0.5f); }
};

/// Works for a while on the host alone.
class OnHost : public Paint {
 public:
  using Paint::Paint;
  bool worksOnHost() const override { return true; }
};

}  // namespace

TEST_CASE("ambient occlusion that is left out is 1 everywhere, in one channel: nothing is occluded") {
  FramesFixture f;
  if (!f) return;
  f.techniques.add<Occlusion>("toy", "occlusion");
  PipelineExecutor executor = f.executor("pass a toy.occlusion { }\noutput o a.open");
  const FrameResult frame = executor.render(0.0);
  CHECK(frame.outputs.at("o").channels() == 1);
  CHECK(frame.outputs.at("o").values() == std::vector<float>(4 * 4, 1.0f));
  CHECK(neutralElement(Contributes::ambientOcclusion) == 1.0f);
  CHECK(neutralElement(Contributes::indirectDiffuse) == 0.0f);
}

TEST_CASE("a pass that works on the host is timed by the host's clock, among passes that the device times") {
  for (const bool stamps : {false, true}) {
    CAPTURE(stamps);
    FramesFixture f;
    if (!f) return;
    f.techniques.add<OnHost>("toy", "on_host");
    f.device->info();
    if (stamps) f.device->state()->info.timerQueriesTrusted = true;
    PipelineExecutor executor = f.executor(
        "pass a toy.paint { }\npass b toy.on_host { }\npass c toy.add { first a  second b }\noutput o c.sum");
    for (int n = 0; n < 6; ++n) {
      executor.invalidate();
      executor.render(0.0, 0, Pictures::no, PipelineExecutor::Timing::passes);
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
}

// ---- check reads ---------------------------------------------------------------------------------------

namespace {

/// Shows where the camera is, and says that it reads the geometry.
class Liar : public Toy {
 public:
  using Toy::Toy;
  Out<Image> picture{this, "picture", Contributes::direct};
  Reads readsFrom() const override { return Reads::geometry; }
  void run(PassContext& frame) override { picture = paint(frame, frame.snapshot().camera.eye.x); }
};

/// Shines without the medium that it says it needs.
class Needy : public Toy {
 public:
  using Toy::Toy;
  Out<Image> picture{this, "picture", Contributes::direct, Needs::medium};
  void run(PassContext& frame) override { picture = paint(frame, 3.0f); }
};

/// Keeps what depends on the camera under a key that does not.
class BadKey : public Toy {
 public:
  using Toy::Toy;
  Out<Image> picture{this, "picture", Contributes::direct};
  Reads readsFrom() const override { return Reads::camera; }
  void run(PassContext& frame) override {
    picture =
        Image{frame.kept("picture", 0, [&] { return paint(frame, frame.snapshot().camera.eye.x).texture; })};
  }
};

}  // namespace

TEST_CASE("checking reads names the pass that was not run again though what it reads changed") {
  FramesFixture f;
  if (!f) return;
  f.techniques.add<Liar>("toy", "liar");
  f.techniques.add<Needy>("toy", "needy");
  f.techniques.add<BadKey>("toy", "bad_key");
  RenderOptions options;
  options.interactive = options.checkReads = true;
  PipelineExecutor executor = f.executor(
      "pass view toy.paint_camera { value 2 }\npass lies toy.liar { }\n"
      "pass follows toy.add { first lies  second view }\npass shines toy.needy { }\npass keeps toy.bad_key { }\n"
      "output o follows.sum\noutput n shines.picture\noutput k keeps.picture",
      options);
  SceneSnapshot snapshot = snapshotOf(f.scene, 0.0);
  const std::string needs =
      "pass shines, port picture: 48 of 48 values are not its neutral element, but it was left out (every "
      "output of it needs a medium, which the scene does not have): Needs ask for too much";
  CHECK(executor.render(snapshot).readsFindings == std::vector<std::string>{needs});
  snapshot.camera.eye.x = 7.0f;
  const std::vector<std::string> findings = executor.render(snapshot, 1).readsFindings;
  REQUIRE(findings.size() == 3);
  CHECK_THAT(findings[0],
             Contains("pass lies, port picture: ") &&
                 Contains("it was not run again: it reads more than its readsFrom() says (geometry)"));
  CHECK_THAT(findings[1], Contains("pass keeps, port picture: ") && Contains("whose key leaves out"));
  CHECK(findings[2] == needs);
}

namespace {

/// Adds a second picture that it says it does not use.
class Denier : public Add {
 public:
  using Add::Add;
  bool uses(const InBase& input) const override { return &input != &second; }
};

}  // namespace

TEST_CASE("checking reads names the input that was left out though the pass reads it") {
  FramesFixture f;
  if (!f) return;
  f.techniques.add<Denier>("toy", "denier");
  RenderOptions options;
  options.checkReads = true;
  PipelineExecutor executor = f.executor(
      "pass one toy.paint { }\npass two toy.paint { value 2 }\npass sum toy.denier { first one  second two }\n"
      "pass after toy.add { first sum }\noutput o after.sum",
      options);
  CHECK(
      executor.render(0.0).readsFindings ==
      std::vector<std::string>{
          "pass sum, port sum: 48 of 48 values differ from a run that leaves nothing out; Needs or uses() leave "
          "out too much: input 'second' of sum (from two.radiance: the parameters of 'sum' make its input 'second' "
          "useless)"});
}

TEST_CASE("checking reads finds nothing in passes that say what they read, with histories too") {
  FramesFixture f;
  if (!f) return;
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
