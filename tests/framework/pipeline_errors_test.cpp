// Errors inside a pass: every error names the pass, once.
#include <new>

#include "pipeline_toys.h"
#include "support/facts.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Throws when it is asked to.
struct Failing : Toy {
  using Toy::Toy;
  Param<bool> fail{this, "fail", true, "whether it does"};
  Out<Image> image{this, "image"};
  void run(PassContext& frame) override {
    if (fail) throw Error("the grid is on fire");
    image = paint(frame, 1.0f);
  }
};

/// Runs out of the host's memory when it holds a grid of 4 KiB.
struct Greedy : Toy {
  using Toy::Toy;
  Out<Image> image{this, "image"};
  void run(PassContext& frame) override {
    const gpu::BufferRef grid = frame.buffer(4096, "grid");
    throw std::bad_alloc();
  }
};

/// Makes the driver complain, and then asks it for more, or not.
struct Clumsy : Toy {
  using Toy::Toy;
  Param<bool> goesOn{this, "goes_on", true, "whether it allocates"};
  Out<Image> image{this, "image"};
  void run(PassContext& frame) override {
    const gpu::StageCode vertex{
        gpu::Stage::vertex, {}, "#version 450 core\nvoid main() { gl_Position = vec4(0); }"};
    const gpu::Program raster(frame.device(), "raster", {&vertex, 1}, {});
    frame.device().dispatch(raster, {}, {1, 1, 1});  // it has no compute stage
    image = goesOn ? paint(frame, 1.0f) : Image{};
  }
};

struct Forgetful : Toy {
  using Toy::Toy;
  Out<Image> image{this, "image"};
  void run(PassContext&) override {}
};

/// Half an image wide.
struct Narrow : Toy {
  using Toy::Toy;
  Out<Image> image{this, "image"};
  void run(PassContext& frame) override {
    gpu::TextureDescription half;
    half.format = gpu::Format::rgba32f;
    half.width = frame.snapshot().camera.width / 2;
    half.height = frame.snapshot().camera.height;
    image = Image{frame.texture(half, "half an image")};
  }
};

}  // namespace

TEST_CASE("an error in a pass carries the pass's name, and the next frame starts afresh") {
  Fixture f;
  f.techniques.add<Failing>("toy", "failing");
  f.techniques.add<Forgetful>("toy", "forgetful");
  PipelineExecutor executor = f.executor("pass bad toy.failing { }\noutput o bad.image");
  for (int repeat = 0; repeat < 2; ++repeat)
    CHECK(messageOf<Error>([&] { executor.render(0.0); }) == "pass bad: the grid is on fire");
  PipelineExecutor good = f.executor("pass bad toy.failing { fail off }\noutput o bad.image");
  CHECK(first(good.render(0.0), "o") == 1.0f);
  PipelineExecutor unset = f.executor("pass bad toy.forgetful { }\noutput o bad.image");
  CHECK_THROWS_MATCHES(unset.render(0.0), Error, Tells("pass bad", "not set", "image"));
}

TEST_CASE("what the driver refuses carries the pass's name once, wherever in the pass it is noticed") {
  Fixture f;
  f.device.reset();
  f.device = std::make_unique<gpu::Device>(gpu::DeviceOptions{"auto", gpu::ShaderInput::glsl});
  f.techniques.add<Clumsy>("toy", "clumsy");
  const std::string goesOn = GENERATE("on", "off");
  PipelineExecutor executor =
      f.executor("pass bad toy.clumsy { goes_on " + goesOn + " }\noutput o bad.image");
  const std::string message = messageOf<Error>([&] { executor.render(0.0); });
  CHECK(message.rfind("pass bad: ") == 0);
  CHECK_THAT(message, Tells("pass bad", "OpenGL"));
}

TEST_CASE("a pass that runs out of memory says what it held and what there is") {
  Fixture f;
  f.techniques.add<Greedy>("toy", "greedy");
  PipelineExecutor executor = f.executor(
      "pass view toy.paint { }\npass bad toy.greedy { }\noutput o bad.image\noutput v view.radiance");
  CHECK_THROWS_MATCHES(executor.render(0.0), Error,
                       Tells("pass bad", "memory", "available", "4.0 KiB", "grid"));
}

TEST_CASE("resources that fit alone but not together are refused with pass, sum and limit") {
  Fixture f;
  f.device.reset();
  gpu::DeviceOptions options;
  options.memoryBytes = 6 << 20;
  f.device = std::make_unique<gpu::Device>(options);
  RenderOptions size;
  size.width = size.height = 512;  // 4 MiB at 16 bytes a pixel
  const std::string one = "pass first toy.paint { }\noutput o first.radiance\n";
  CHECK(first(f.executor(one, size).render(0.0), "o") == 1.0f);
  const std::string two = one + "pass second toy.paint { }\noutput p second.radiance";
  CHECK_THROWS_MATCHES(
      f.executor(two, size).render(0.0), Error,
      Tells("pass second", "image", "512 x 512", "4.0 MiB", "2.0 MiB", "6.0 MiB", "4.0 MiB"));
}

TEST_CASE("an output that is not of the image's size is refused, as an image but not as an input") {
  Fixture f;
  f.techniques.add<Narrow>("toy", "narrow");
  RenderOptions size;
  size.width = 8;
  size.height = 4;
  PipelineExecutor executor = f.executor("pass half toy.narrow { }\noutput o half.image", size);
  CHECK_THROWS_MATCHES(executor.render(0.0), Error, Tells("o", "half.image", "4 x 4", "8 x 4"));
  PipelineExecutor whole =
      f.executor("pass half toy.narrow { }\npass all toy.add { first half.image }\noutput o all.sum", size);
  CHECK(whole.render(0.0).outputs.at("o").width() == 8);
}
