// Toys that carry something from frame to frame.
#pragma once

#include <string>
#include <vector>

#include "pipeline_toys.h"

namespace lumivox::test {

inline gpu::TextureDescription smallImage(int side = 4) {
  gpu::TextureDescription description;
  description.format = gpu::Format::rgba32f;
  description.width = description.height = side;
  return description;
}

/// The mean over frames of `source` plus 0, 1, 2 ...: a progressive technique whose samples are known.
struct Progressive : Toy {
  using Toy::Toy;
  In<Image> source{this, "source", "what is there in every frame"};
  Param<int> side{this, "side", 4, {1, 64}, "of the history"};
  Out<Image> mean{this, "mean", Contributes::direct};
  Reads readsFrom() const override { return Reads::history; }
  int indirectBounces() const override { return 3; }
  void run(PassContext& frame) override {
    note();
    const int before = frame.accumulated();
    const History<gpu::TextureRef> sum = frame.history(smallImage(side), "sum");
    float value = valueOf(*source) + static_cast<float>(before);
    if (before > 0 && sum.previous) value += sum.previous->downloadFloats().front();
    sum.current->clear(glm::vec4(value));
    mean = paint(frame, value / static_cast<float>(before + 1));
  }
};

/// `light` plus half of what a pass made in the frame before.
struct Feedback : Toy {
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
struct Flicker : Toy {
  using Toy::Toy;
  Out<Image> scattered{this, "scattered", Contributes::scattered, Needs::medium};
  Reads readsFrom() const override { return Reads::time; }
  void run(PassContext& frame) override { scattered = paint(frame, 0.0f); }
};

/// A sum that leads back to its own first term.
inline const char* const kFeedback =
    "pass light toy.paint { value 1 }\n"
    "pass back toy.feedback { light light  previous sum.sum }\n"
    "pass sum toy.add { first back.radiance  second light }\n"
    "output radiance back.radiance\noutput sum sum.sum";

inline const char* const kProgressive =
    "param light 2 in 0..10\n"
    "pass view toy.paint_camera { value $light }\n"
    "pass still toy.paint { value 3 }\n"
    "pass a toy.progressive { source view }\n"
    "pass b toy.progressive { source still }\n"
    "output a a.mean\noutput b b.mean";

inline RenderOptions accumulating(bool keepEverything = false) {
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

inline std::vector<float> valuesOf(const FrameResult& frame) {
  std::vector<float> all;
  for (const auto& [name, image] : frame.outputs)
    all.insert(all.end(), image.values().begin(), image.values().end());
  return all;
}

}  // namespace lumivox::test
