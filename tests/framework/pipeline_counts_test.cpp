// Counts that the device finds: no pass waits for them, and no frame with too little room is given out.
#include "pipeline_toys.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;

namespace {

/// Counts to `wanted`, with room for one at first; paints how much room it had. It needs more from the second
/// frame on.
struct Counter : Toy {
  using Toy::Toy;
  Param<int> wanted{this, "wanted", 1, {0, 1000000}, "how far it counts from frame 1 on"};
  Param<bool> learns{this, "learns", true, "whether it takes the room that it turned out to need"};
  Out<Image> image{this, "image", Contributes::direct};
  Reads readsFrom() const override { return Reads::time; }
  void run(PassContext& frame) override {
    note();
    const std::array<std::uint32_t, 2> words{
        77u, frame.frameIndex() == 0 ? 1u : static_cast<std::uint32_t>(wanted)};
    const gpu::BufferRef counts = frame.buffer(sizeof(words), "counts");
    counts->uploadValues(std::span<const std::uint32_t>(words));
    image = paint(frame, static_cast<float>(room_));
    frame.checkAfterFrame(counts, sizeof(std::uint32_t), [this](PassContext& done, std::uint32_t count) {
      if (count <= room_) return true;
      if (learns) room_ = count;
      done.warn("it was too little");
      return false;
    });
  }

 private:
  std::uint32_t room_ = 1;
};

/// Runs again only when its input does.
struct Double : Toy {
  using Toy::Toy;
  In<Image> half{this, "half", "an image"};
  Out<Image> image{this, "image", Contributes::direct};
  void run(PassContext& frame) override {
    note();
    image = paint(frame, 2.0f * valueOf(*half));
  }
};

const char* const kCounted =
    "pass counter toy.counter { wanted 5 }\npass twice toy.twice { half counter }\noutput direct twice.image";

struct Counted : Fixture {
  Counted() {
    techniques.add<Counter>("toy", "counter");
    techniques.add<Double>("toy", "twice");
  }
};

}  // namespace

TEST_CASE("a frame whose pass had too little room is rendered again before anything of it is given out") {
  Counted f;
  PipelineExecutor executor = f.executor(kCounted);
  CHECK(first(executor.render(0.0, 0), "direct") == 2.0f);
  CHECK(f.techniques.takeRan() == std::vector<std::string>{"counter", "twice"});
  // The count grows in the middle of the sequence: the image is that of the room that it needs.
  CHECK(first(executor.render(0.1, 1), "direct") == 10.0f);
  CHECK(f.techniques.takeRan() == std::vector<std::string>{"counter", "twice", "counter", "twice"});
  // From then on there is room.
  CHECK(first(executor.render(0.2, 2), "direct") == 10.0f);
  CHECK(f.techniques.takeRan() == std::vector<std::string>{"counter", "twice"});
}

TEST_CASE("a pass that never has enough room ends in an error with its name, and no frame goes on for ever") {
  Counted f;
  PipelineExecutor executor =
      f.executor("pass counter toy.counter { wanted 5 learns off }\noutput direct counter.image");
  executor.render(0.0, 0);
  CHECK_THROWS_WITH(executor.render(0.1, 1), Contains("pass counter: no room for its count (5)"));
  // The error left nothing behind: frame 0 is there again.
  CHECK(first(executor.render(0.0, 0), "direct") == 1.0f);
}
