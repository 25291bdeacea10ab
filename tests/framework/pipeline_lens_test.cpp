// A camera with a lens: which passes see through it, and what is said where none does.
#include <cmath>

#include "lumivox/base/log.h"
#include "pipeline_toys.h"
#include "support/facts.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;

namespace {

/// Paints the aperture.
struct PaintLens : Toy {
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

constexpr const char* kPinhole = "pass view toy.paint_camera { }\noutput direct view.radiance";
constexpr const char* kLens =
    "pass view toy.paint_camera { }\npass lens toy.paint_lens { }\n"
    "output direct view.radiance\noutput final lens.radiance";

/// Sees media and the environment.
struct PaintAir : Toy {
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

}  // namespace

TEST_CASE("a pipeline without a pass that sees through the lens says that its image is a pinhole's") {
  LensFixture fixture;
  PipelineExecutor executor = fixture.executor(kPinhole);
  LogCapture log;
  executor.render(0.0);
  CHECK_THAT(log.text(), Tells("test", "lens", "main", 0.05, "pinhole"));
  CHECK(std::string(name(LeftOut::Level::camera)) == "camera");
  CHECK_THAT(whyLeftOut(executor, LeftOut::Level::camera, "the lens of camera 'main'"),
             Tells("no pass", "lens"));
}

TEST_CASE("a seen lens, a pinhole and a run without images are not told of") {
  LensFixture fixture;
  LogCapture log;
  PipelineExecutor sees = fixture.executor(kLens);
  CHECK(first(sees.render(0.0), "final") == 0.05f);
  RenderOptions noImages;
  noImages.wantsOutputs = false;
  fixture.executor(kPinhole, noImages).render(0.0, 0, PipelineExecutor::Images::no);
  fixture.scene.cameras.front().aperture = 0.0;
  PipelineExecutor pinhole = fixture.executor(kPinhole);
  pinhole.render(0.0);
  for (const PipelineExecutor* one : {&sees, &pinhole})
    CHECK(whyLeftOut(*one, LeftOut::Level::camera, "").empty());
  CHECK_THAT(log.text(), !Contains("lens") && !Contains("pinhole"));
}

TEST_CASE("the pass that sees through the lens counts only where it runs") {
  LensFixture fixture;
  RenderOptions options;
  options.wanted = {"direct"};
  PipelineExecutor executor = fixture.executor(kLens, options);
  LogCapture log;
  executor.render(0.0);
  CHECK_THAT(log.text(), Tells("leaves out the lens"));
}

TEST_CASE("another lens runs again what sees through it, and nothing else") {
  LensFixture fixture;
  PipelineExecutor executor = fixture.executor(kLens, with(&RenderOptions::interactive));
  SceneSnapshot snapshot = snapshotOf(fixture.scene, 0.0);
  const auto ran = [&] {
    CHECK(first(executor.render(snapshot), "final") == snapshot.camera.aperture);
    return fixture.techniques.takeRan();
  };
  CHECK(ran() == Ran{"paint_camera", "paint_lens"});
  snapshot.camera.aperture = 0.1f;
  CHECK(ran() == Ran{"paint_lens"});
  snapshot.camera.focus = 3.0f;
  CHECK(ran() == Ran{"paint_lens"});
  snapshot.camera.eye.x += 1.0f;
  CHECK(ran() == Ran{"paint_camera"});
}

TEST_CASE("media and environment that no pass reads are said once, by the frame and by the explanation") {
  AirFixture fixture;
  PipelineExecutor executor = fixture.executor(kPinhole);
  LogCapture log;
  executor.render(0.0);
  CHECK_THAT(log.text(), Tells("environment", "no pass", "media 'mist', 'fog'", "no pass"));
  for (const char* what : {"media 'mist', 'fog'", "the environment"})
    CHECK_THAT(whyLeftOut(executor, LeftOut::Level::scene, what), Tells("no pass"));
}

TEST_CASE("a trait counts as read by a pass that runs alone, and belongs to images of light alone") {
  AirFixture fixture;
  const auto said = [&](const std::vector<std::string>& wanted) {
    RenderOptions options;
    options.wanted = wanted;
    PipelineExecutor executor = fixture.executor(kAir, options);
    LogCapture log;
    executor.render(0.0);
    CHECK(whyLeftOut(executor, LeftOut::Level::scene, "the environment").empty() ==
          (log.text().find("environment") == std::string::npos));
    return log.text();
  };
  CHECK_THAT(said({}), !Contains("media") && !Contains("environment"));
  CHECK_THAT(said({"direct"}), Tells("environment", "mist", "fog"));
  CHECK_THAT(said({"occlusion"}), !Contains("media") && !Contains("environment") && !Contains("light"));
  fixture.scene.media.clear();
  fixture.scene.environment = glm::vec3(0.0f);
  CHECK_THAT(said({"direct"}), !Contains("medi") && !Contains("environment"));
}
