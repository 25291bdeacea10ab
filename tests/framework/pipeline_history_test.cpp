// Frames in a row: histories, and how many frames have accumulated.
#include "frames_toys.h"
#include "lumivox/base/error.h"
#include "support/facts.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("a progressive pass finds its sum of the frame before: the mean of 2, 3, 4 ... is 2 + N / 2") {
  FramesFixture f;
  for (const bool keepEverything : {false, true}) {
    PipelineExecutor executor = f.executor(kProgressive, accumulating(keepEverything));
    for (int n = 0; n < 5; ++n)
      CHECK(first(executor.render(0.0, 0), "a") == 2.0f + 0.5f * static_cast<float>(n));
  }
}

TEST_CASE("without accumulation no frame finds a history, so that frame N alone is frame N of a sequence") {
  FramesFixture f;
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

TEST_CASE("a history is what a later pass made in the frame before, or the pass itself: geometric series") {
  FramesFixture f;
  // r(n) = 1 + (r(n-1) + 1) / 2, from r(0) = 1: r(n) = 3 - 2 / 2^n.
  PipelineExecutor executor = f.executor(kFeedback, accumulating());
  PipelineExecutor own = f.executor(
      "pass light toy.paint { }\npass back toy.feedback { light light  previous back.radiance }\n"
      "output o back.radiance",
      accumulating());
  for (int n = 0; n < 6; ++n) {
    const float half = 1.0f / static_cast<float>(1 << n);
    const FrameResult frame = executor.render(0.0, n);
    CHECK(first(frame, "radiance") == 3.0f - 2.0f * half);
    CHECK(first(frame, "sum") == 4.0f - 2.0f * half);
    CHECK(first(own.render(0.0, n), "o") == 2.0f - half);  // 1, 1.5, 1.75
  }
}

TEST_CASE("a pass whose input of the last frame is not connected is not run again while nothing changes") {
  FramesFixture f;
  for (const bool connected : {false, true}) {
    PipelineExecutor executor =
        f.executor(std::string("pass light toy.paint { }\npass back toy.feedback { light light ") +
                       (connected ? "previous back.radiance " : "") + "}\noutput o back.radiance",
                   accumulating());
    executor.render(0.0, 0);
    f.techniques.takeRan();
    executor.render(0.0, 1);
    CHECK(f.techniques.takeRan() == (connected ? Ran{"feedback"} : Ran{}));
  }
}

TEST_CASE("what only a history wants is made for its sake, and not without accumulation") {
  FramesFixture f;
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
  PipelineExecutor executor = f.executor(kProgressive, accumulating());
  for (int n = 0; n < 3; ++n) executor.render(0.0);
  executor.setParameters({{"light", {5.0, {}, {}}}});
  const FrameResult frame = executor.render(0.0);
  CHECK(first(frame, "a") == 5.0f);
  CHECK(first(frame, "b") == 3.0f);
}

namespace {

/// Asks for two histories of which one is there in odd frames only; tells what it found.
struct Sporadic : Toy {
  using Toy::Toy;
  Out<Image> found{this, "found", Contributes::direct};
  Reads readsFrom() const override { return Reads::history | Reads::time; }
  void run(PassContext& frame) override {
    float value = 0.0f;
    if (frame.history(64, "words").previous) value += 1.0f;
    if (frame.frameIndex() % 3 != 2 && frame.history(smallImage(), "image").previous) value += 2.0f;
    if (frame.history(smallImage(frame.frameIndex() < 4 ? 4 : 8), "grows").previous) value += 4.0f;
    found = paint(frame, value);
  }
};

/// Finds in the second frame that it had too little room.
struct Cramped : Toy {
  using Toy::Toy;
  Out<Image> sum{this, "sum", Contributes::direct};
  Reads readsFrom() const override { return Reads::history | Reads::time; }
  void run(PassContext& frame) override {
    note();
    const History<gpu::TextureRef> kept = frame.history(smallImage(), "sum");
    const float value = 1.0f + (kept.previous ? kept.previous->downloadFloats().front() : 0.0f);
    kept.current->clear(glm::vec4(value));
    const gpu::BufferRef count = frame.buffer(4, "count");
    count->clear(static_cast<std::uint32_t>(frame.frameIndex()));
    frame.checkAfterFrame(count, 0, [this](PassContext&, std::uint32_t index) {
      return index != 1 || std::exchange(roomy_, true);
    });
    sum = paint(frame, value + 100.0f * static_cast<float>(frame.accumulated()));
  }

 private:
  bool roomy_ = false;
};

/// Fails in its second frame.
struct Failing : Toy {
  using Toy::Toy;
  Out<Image> sum{this, "sum", Contributes::direct};
  Reads readsFrom() const override { return Reads::history; }
  void run(PassContext& frame) override {
    const History<gpu::TextureRef> kept = frame.history(smallImage(), "sum");
    if (++runs_ == 3) throw Error("it does not fit");
    sum = paint(frame, (kept.previous ? 1.0f : 0.0f) + 10.0f * static_cast<float>(frame.accumulated()));
  }

 private:
  int runs_ = 0;
};

/// Uses what it does not declare.
struct Undeclared : Toy {
  using Toy::Toy;
  Param<bool> counts{this, "counts", false, "asks for the number of frames"};
  Out<Image> image{this, "image"};
  void run(PassContext& frame) override {
    if (counts)
      image = paint(frame, static_cast<float>(frame.accumulated()));
    else
      image = Image{frame.history(smallImage(), "x").current};
  }
};

/// The same history twice.
struct Twice : Toy {
  using Toy::Toy;
  Out<Image> image{this, "image"};
  Reads readsFrom() const override { return Reads::history; }
  void run(PassContext& frame) override {
    frame.history(smallImage(), "x");
    image = Image{frame.history(smallImage(), "x").current};
  }
};

}  // namespace

TEST_CASE("a history is gone when a frame does not ask for it, or asks for another shape") {
  FramesFixture f;
  f.techniques.add<Sporadic>("toy", "sporadic");
  PipelineExecutor executor = f.executor("pass a toy.sporadic { }\noutput o a.found", accumulating());
  std::vector<float> found;
  for (int n = 0; n < 6; ++n) found.push_back(first(executor.render(0.0, n), "o"));
  CHECK(found == std::vector<float>{0, 7, 5, 5, 3, 5});
}

TEST_CASE("a frame that is rendered again for want of room finds the history that it found before") {
  FramesFixture f;
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
  f.techniques.add<Failing>("toy", "failing");
  PipelineExecutor executor = f.executor("pass a toy.failing { }\noutput o a.sum", accumulating());
  for (int repeat = 0; repeat < 2; ++repeat) {
    CHECK(first(executor.render(0.0), "o") == 0.0f);
    CHECK(first(executor.render(0.0), "o") == 11.0f);
    if (repeat == 0) CHECK_THROWS_MATCHES(executor.render(0.0), Error, Tells("pass a", "it does not fit"));
  }
}

TEST_CASE("a pass that does not declare that it reads histories is refused them, by name") {
  const auto [pass, accumulate, told] = GENERATE(table<std::string, bool, Tells>({
      {"undeclared { }", false, Tells("pass a", "history()", "readsFrom()", "Reads::history")},
      {"undeclared { counts on }", false, Tells("pass a", "accumulated()")},
      {"twice { }", true, Tells("pass a", "x", "twice")},
  }));
  FramesFixture f;
  f.techniques.add<Undeclared>("toy", "undeclared");
  f.techniques.add<Twice>("toy", "twice");
  PipelineExecutor executor =
      f.executor("pass a toy." + pass + "\noutput o a.image", accumulate ? accumulating() : RenderOptions());
  CHECK_THROWS_MATCHES(executor.render(0.0), Error, told);
}

TEST_CASE("the harness carries histories from run to run when it is told to") {
  FramesFixture f;
  const SceneSnapshot snapshot = snapshotOf(f.scene, 0.0);
  PassHarness harness(*f.device, f.techniques, "toy", "progressive", f.scene, snapshot);
  Image image{harness.context().image("constant")};
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
