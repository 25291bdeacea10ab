// A camera with a lens: which passes see through it, and what is said where none does.
#include <cmath>

#include "lumivox/base/log.h"
#include "pipeline_toys.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;

namespace {

/// Paints the aperture.
class PaintLens : public Toy {
 public:
  using Toy::Toy;
  Out<Image> radiance{this, "radiance", Contributes::direct};
  Reads readsFrom() const override { return Reads::lens; }
  void run(PassContext& frame) override {
    note();
    radiance = paint(frame, frame.snapshot().camera.aperture);
  }
};

struct LensFixture : Fixture {
  LensFixture() {
    techniques.add<PaintLens>("toy", "paint_lens");
    scene.cameras.front().aperture = 0.05;
    scene.cameras.front().focus = 2.0;
  }
};

const LeftOut* lensLeftOut(const Explanation& explanation) {
  for (const LeftOut& one : explanation.leftOut)
    if (one.level == LeftOut::Level::camera) return &one;
  return nullptr;
}

constexpr const char* kPinhole = "pass view toy.paint_camera { }\noutput direct view.radiance";
constexpr const char* kLens =
    "pass view toy.paint_camera { }\npass lens toy.paint_lens { }\n"
    "output direct view.radiance\noutput final lens.radiance";

}  // namespace

TEST_CASE("a pipeline without a pass that sees through the lens says that its image is a pinhole's") {
  LensFixture fixture;
  if (!fixture) return;
  PipelineExecutor executor = fixture.executor(kPinhole);
  LogCapture log;
  executor.render(0.0);
  CHECK_THAT(log.text(), Contains("pipeline \"test\" leaves out the lens of camera 'main', 0.05 m wide") &&
                             Contains("the image is that of a pinhole"));
  const Explanation explanation = executor.explain();
  const LeftOut* lens = lensLeftOut(explanation);
  REQUIRE(lens != nullptr);
  CHECK(std::string(name(lens->level)) == "camera");
  CHECK_THAT(lens->what, Contains("the lens of camera 'main'"));
  CHECK_THAT(lens->why, Contains("no pass sees through a lens"));
}

TEST_CASE(
    "nothing is said of a lens where a pass sees through it, nor of a pinhole, nor where no image is made") {
  LensFixture fixture;
  if (!fixture) return;
  LogCapture log;
  PipelineExecutor sees = fixture.executor(kLens);
  CHECK(first(sees.render(0.0), "final") == 0.05f);
  CHECK(lensLeftOut(sees.explain()) == nullptr);
  RenderOptions noImages;
  noImages.wantsOutputs = false;
  fixture.executor(kPinhole, noImages).render(0.0, 0, PipelineExecutor::Images::no);
  fixture.scene.cameras.front().aperture = 0.0;
  PipelineExecutor pinhole = fixture.executor(kPinhole);
  pinhole.render(0.0);
  CHECK(lensLeftOut(pinhole.explain()) == nullptr);
  CHECK_THAT(log.text(), !Contains("lens") && !Contains("pinhole"));
}

TEST_CASE("the pass that sees through the lens counts only where it runs") {
  LensFixture fixture;
  if (!fixture) return;
  RenderOptions options;
  options.wanted = {"direct"};
  PipelineExecutor executor = fixture.executor(kLens, options);
  LogCapture log;
  executor.render(0.0);
  CHECK_THAT(log.text(), Contains("leaves out the lens"));
}

TEST_CASE("another lens runs again what sees through it, and nothing else") {
  LensFixture fixture;
  if (!fixture) return;
  RenderOptions options;
  options.interactive = true;
  PipelineExecutor executor = fixture.executor(kLens, options);
  SceneSnapshot snapshot = snapshotOf(fixture.scene, 0.0);
  executor.render(snapshot);
  CHECK(fixture.techniques.takeRan() == std::vector<std::string>{"paint_camera", "paint_lens"});
  snapshot.camera.aperture = 0.1f;
  CHECK(first(executor.render(snapshot), "final") == 0.1f);
  CHECK(fixture.techniques.takeRan() == std::vector<std::string>{"paint_lens"});
  snapshot.camera.focus = 3.0f;
  executor.render(snapshot);
  CHECK(fixture.techniques.takeRan() == std::vector<std::string>{"paint_lens"});
  snapshot.camera.eye.x += 1.0f;
  executor.render(snapshot);
  CHECK(fixture.techniques.takeRan() == std::vector<std::string>{"paint_camera"});
}

// ---- other traits ----------------------------------------------------------------------------------------

namespace {

/// Sees media and the environment.
class PaintAir : public Toy {
 public:
  using Toy::Toy;
  Out<Image> radiance{this, "radiance", Contributes::scattered};
  Out<Image> occlusion{this, "occlusion", Contributes::ambientOcclusion};
  Reads readsFrom() const override { return Reads::media | Reads::environment; }
  void run(PassContext& frame) override {
    note();
    if (radiance.wanted()) radiance = paint(frame, 0.0f);
    if (occlusion.wanted()) occlusion = paint(frame, 1.0f);
  }
};

struct AirFixture : Fixture {
  AirFixture() {
    techniques.add<PaintAir>("toy", "paint_air");
    scene.environment = glm::vec3(1.0f);
    for (const char* name : {"mist", "fog"}) {
      scene.media.emplace_back();
      scene.media.back().name = name;
    }
  }
};

constexpr const char* kAir =
    "pass view toy.paint_camera { }\npass air toy.paint_air { }\n"
    "output direct view.radiance\noutput scattered air.radiance\noutput occlusion air.occlusion";

bool isLeftOut(const Explanation& explanation, const std::string& what) {
  for (const LeftOut& one : explanation.leftOut)
    if (one.level == LeftOut::Level::scene && one.what == what) return true;
  return false;
}

}  // namespace

TEST_CASE("media and environment that no pass reads are said once, by the frame and by the explanation") {
  AirFixture fixture;
  if (!fixture) return;
  PipelineExecutor executor = fixture.executor(kPinhole);
  LogCapture log;
  executor.render(0.0);
  CHECK_THAT(log.text(), Contains("leaves out media 'mist', 'fog': no pass reads media") &&
                             Contains("leaves out the environment: no pass reads the environment"));
  const Explanation explanation = executor.explain();
  CHECK(isLeftOut(explanation, "media 'mist', 'fog'"));
  CHECK(isLeftOut(explanation, "the environment"));
}

TEST_CASE("a trait counts as read by a pass that runs alone, and belongs to images of light alone") {
  AirFixture fixture;
  if (!fixture) return;
  const auto said = [&](const std::vector<std::string>& wanted) {
    RenderOptions options;
    options.wanted = wanted;
    PipelineExecutor executor = fixture.executor(kAir, options);
    LogCapture log;
    executor.render(0.0);
    CHECK(isLeftOut(executor.explain(), "the environment") ==
          (log.text().find("environment") != std::string::npos));
    return log.text();
  };
  CHECK_THAT(said({}), !Contains("media") && !Contains("environment"));
  CHECK_THAT(said({"direct"}), Contains("media 'mist', 'fog'") && Contains("the environment"));
  CHECK_THAT(said({"occlusion"}), !Contains("media") && !Contains("environment") && !Contains("light"));
  fixture.scene.media.clear();
  fixture.scene.environment = glm::vec3(0.0f);
  CHECK_THAT(said({"direct"}), !Contains("medi") && !Contains("environment"));
}
