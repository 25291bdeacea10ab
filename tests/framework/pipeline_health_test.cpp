// The scan for values that are NaN, infinite or negative, on passes that make them.
#include <algorithm>
#include <limits>

#include "pipeline_toys.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;

namespace {

/// Bad values at known places of a 4 x 4 image.
struct Sick : Toy {
  using Toy::Toy;
  Out<Image> image{this, "image"};
  void run(PassContext& frame) override {
    Image sick = paint(frame, 1.0f);
    std::vector<float> texels(4 * 4 * 4, 1.0f);
    texels[4 * (4 * 2 + 3)] = texels[4 * (4 * 3 + 0) + 1] = std::numeric_limits<float>::quiet_NaN();
    texels[4 * (4 * 1 + 2) + 2] = std::numeric_limits<float>::infinity();
    texels[4 * (4 * 0 + 1)] = -0.5f;
    sick.texture->uploadFloats(0, texels);
    image = sick;
  }
};

/// The same image as a pool, of which row 2 and above were never written.
struct ToyPool {
  Image image;
};

struct SickPool : Sick {
  using Sick::Sick;
  Out<ToyPool> pool{this, "pool"};
  void run(PassContext& frame) override {
    Sick::run(frame);
    pool = ToyPool{image.value()};
  }
};

}  // namespace

template <>
struct lumivox::PortTraits<ToyPool> {
  static PortKind kind() {
    return {"ToyPool", "an image of which half is in use", {{"texels", "d2 rgba32f", "a texel a place"}}};
  }
  static void contents(const ToyPool& port, PortContents& contents) {
    contents.texture("texels", port.image.texture, {.texels = [] {
                       std::vector<bool> lower(4 * 4);
                       std::fill_n(lower.begin(), 4 * 2, true);
                       return lower;
                     }});
  }
};

TEST_CASE("the health scan names pass, port, count and first place of bad values") {
  Fixture f;
  f.techniques.add<Sick>("toy", "sick");
  const RenderOptions options = with(&RenderOptions::health);
  PipelineExecutor executor = f.executor("pass ill toy.sick { }\noutput o ill.image", options);
  const FrameResult frame = executor.render(0.0);
  CHECK(frame.healthFindings ==
        std::vector<std::string>{"pass ill, port image: 2 NaN, first at pixel (3, 2)",
                                 "pass ill, port image: 1 infinite, first at pixel (2, 1)",
                                 "pass ill, port image: 1 negative, first at pixel (1, 0)"});
  PipelineExecutor healthy = f.executor(
      "pass voxels toy.voxels { }\npass gather toy.gather { grid voxels }\noutput o gather.diffuse", options);
  CHECK(healthy.render(0.0).healthFindings.empty());
}

TEST_CASE("the health scan leaves out texels of a pool that mean nothing, and no others") {
  Fixture f;
  f.techniques.add<SickPool>("toy", "sick_pool");
  PipelineExecutor executor =
      f.executor("pass ill toy.sick_pool { }\noutput o ill.image", with(&RenderOptions::health));
  executor.keepOutput("ill", "pool");
  std::vector<std::string> findings = executor.render(0.0).healthFindings;
  findings.erase(std::remove_if(findings.begin(), findings.end(),
                                [](const std::string& text) { return !Contains("port pool").match(text); }),
                 findings.end());
  // Its two NaN are in rows 2 and 3.
  CHECK(findings == std::vector<std::string>{"pass ill, port pool: 1 infinite, first at pixel (2, 1)",
                                             "pass ill, port pool: 1 negative, first at pixel (1, 0)"});
}
