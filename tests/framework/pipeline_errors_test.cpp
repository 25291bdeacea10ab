// Errors inside a pass: every error names the pass, once.
#include <new>

#include "pipeline_toys.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;

namespace {

/// Throws when it is asked to.
class Failing : public Toy {
 public:
  using Toy::Toy;
  Param<bool> fail{this, "fail", true, "whether it does"};
  Out<Image> image{this, "image"};
  void run(PassContext& frame) override {
    if (fail) throw Error("the grid is on fire");
    image = paint(frame, 1.0f);
  }
};

/// Runs out of the host's memory when it holds a grid of 4 KiB.
class Greedy : public Toy {
 public:
  using Toy::Toy;
  Out<Image> image{this, "image"};
  void run(PassContext& frame) override {
    const gpu::BufferRef grid = frame.buffer(4096, "grid");
    throw std::bad_alloc();
  }
};

/// Makes the driver complain, and then asks it for more, or not.
class Clumsy : public Toy {
 public:
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

class Forgetful : public Toy {
 public:
  using Toy::Toy;
  Out<Image> image{this, "image"};
  void run(PassContext&) override {}
};

/// Half an image wide.
class Narrow : public Toy {
 public:
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
  if (!f) return;
  f.techniques.add<Failing>("toy", "failing");
  PipelineExecutor executor = f.executor("pass bad toy.failing { }\noutput o bad.image");
  for (int repeat = 0; repeat < 2; ++repeat) {
    CHECK(messageOf<Error>([&] { executor.render(0.0); }) == "pass bad: the grid is on fire");
  }
  PipelineExecutor good = f.executor("pass bad toy.failing { fail off }\noutput o bad.image");
  CHECK(first(good.render(0.0), "o") == 1.0f);
}

TEST_CASE("what the driver refuses carries the pass's name once, wherever in the pass it is noticed") {
  Fixture f;
  if (!f) return;
  f.device.reset();
  f.device = std::make_unique<gpu::Device>(gpu::DeviceOptions{"auto", gpu::ShaderInput::glsl});
  f.techniques.add<Clumsy>("toy", "clumsy");
  for (const std::string goesOn : {"on", "off"}) {
    PipelineExecutor executor =
        f.executor("pass bad toy.clumsy { goes_on " + goesOn + " }\noutput o bad.image");
    const std::string message = messageOf<Error>([&] { executor.render(0.0); });
    INFO(message);
    CHECK(message.rfind("pass bad: ", 0) == 0);
    CHECK(message.find("pass bad", 1) == std::string::npos);
    CHECK_THAT(message, Contains("the OpenGL driver reports"));
  }
}

TEST_CASE("a pass that runs out of memory says what it held and what there is") {
  Fixture f;
  if (!f) return;
  f.techniques.add<Greedy>("toy", "greedy");
  PipelineExecutor executor = f.executor(
      "pass view toy.paint { }\npass bad toy.greedy { }\noutput o bad.image\noutput v view.radiance");
  const std::string message = messageOf<Error>([&] { executor.render(0.0); });
  CHECK_THAT(message, Contains("pass bad: out of memory; ") && Contains(" are available") &&
                          Contains("of which this pass asked for 4.0 KiB, the last one 'grid'"));
}

TEST_CASE(
    "resources of a pass that fit alone but not together are refused with pass, resource, sum and limit") {
  Fixture f;
  if (!f) return;
  f.device.reset();
  gpu::DeviceOptions options;
  options.memoryBytes = 6 << 20;
  f.device = std::make_unique<gpu::Device>(options);
  RenderOptions size;
  size.width = size.height = 512;  // 4 MiB at 16 bytes a pixel
  const std::string one = "pass first toy.paint { }\noutput o first.radiance\n";
  CHECK(first(f.executor(one, size).render(0.0), "o") == 1.0f);
  const std::string two = one + "pass second toy.paint { }\noutput p second.radiance";
  const std::string message = messageOf<Error>([&] { f.executor(two, size).render(0.0); });
  CHECK_THAT(message, Contains("pass second: texture 'second: image' (512 x 512 texels of rgba32f") &&
                          Contains("needs 4.0 MiB, but only 2.0 MiB of the limit of 6.0 MiB are left beside "
                                   "the 4.0 MiB of all other textures and buffers"));
}

TEST_CASE("a pass that does not set a wanted output is an error that names both") {
  Fixture f;
  if (!f) return;
  f.techniques.add<Forgetful>("toy", "forgetful");
  PipelineExecutor executor = f.executor("pass bad toy.forgetful { }\noutput o bad.image");
  CHECK(messageOf<Error>([&] { executor.render(0.0); }) == "pass bad: it did not set its output 'image'");
}

TEST_CASE("an output that is not of the image's size is refused, as an image but not as an input") {
  Fixture f;
  if (!f) return;
  f.techniques.add<Narrow>("toy", "narrow");
  RenderOptions size;
  size.width = 8;
  size.height = 4;
  PipelineExecutor executor = f.executor("pass half toy.narrow { }\noutput o half.image", size);
  const std::string message = messageOf<Error>([&] { executor.render(0.0); });
  CHECK_THAT(message, Contains("output 'o'") && Contains("half.image has 4 x 4 texels; expected 8 x 4"));
  PipelineExecutor whole =
      f.executor("pass half toy.narrow { }\npass all toy.add { first half.image }\noutput o all.sum", size);
  CHECK(whole.render(0.0).outputs.at("o").width() == 8);
}
