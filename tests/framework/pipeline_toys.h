// A technique of trivial passes, made in the test: they paint constant images and write down that they ran.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/pipeline.h"
#include "support/support.h"

namespace lumivox::test {

/// Techniques that live in the test program.
struct TestTechniques : TechniqueSource {
  template <class PassType>
  void add(const std::string& techniqueName, const std::string& pass) {
    Technique* technique = nullptr;
    for (const auto& one : techniques_) {
      if (one->name == techniqueName) technique = one.get();
    }
    if (technique == nullptr) {
      techniques_.push_back(std::make_unique<Technique>());
      technique = techniques_.back().get();
      technique->name = techniqueName;
    }
    technique->passes.push_back(
        {pass, "a toy", [this, pass] { return std::make_unique<PassType>(ran_, pass); }});
  }
  void addSkipped(const std::string& library, const std::string& reason) {
    skipped_.push_back({library, reason});
  }

  const Technique* technique(const std::string& wanted) override {
    for (const auto& one : techniques_) {
      if (one->name == wanted) return one.get();
    }
    return nullptr;
  }
  std::vector<std::string> available() const override {
    std::vector<std::string> names;
    for (const auto& one : techniques_) names.push_back(one->name);
    return names;
  }
  const std::vector<SkippedTechnique>& skipped() const override { return skipped_; }

  /// Names of the kinds of pass that ran since the last call, in order.
  std::vector<std::string> takeRan() { return std::exchange(ran_, {}); }

 private:
  std::vector<std::unique_ptr<Technique>> techniques_;
  std::vector<SkippedTechnique> skipped_;
  std::vector<std::string> ran_;
};

struct Toy : Pass {
  Toy(std::vector<std::string>& ran, std::string kind) : ran_(&ran), kind_(std::move(kind)) {}

 protected:
  void note() { ran_->push_back(kind_); }
  /// An image of one value.
  static Image paint(PassContext& frame, float value) {
    Image image{frame.image("image")};
    image.texture->clear(glm::vec4(value));
    return image;
  }
  /// The value of an image of one value.
  static float valueOf(const Image& image) { return image.texture->downloadFloats().front(); }

 private:
  std::vector<std::string>* ran_;
  std::string kind_;
};

/// Paints `value`; what it reads is up to the subclass.
struct Paint : Toy {
  using Toy::Toy;
  Param<float> value{this, "value", 1.0f, {-10.0f, 10.0f}, "", "radiance"};
  Out<Image> radiance{this, "radiance", Contributes::direct};
  void run(PassContext& frame) override {
    note();
    radiance = paint(frame, value);
  }
};

struct PaintCamera : Paint {
  using Paint::Paint;
  Reads readsFrom() const override { return Reads::camera; }
};

/// Stands for the voxelization of static geometry.
struct Voxels : Toy {
  using Toy::Toy;
  Param<int> resolution{this, "resolution", 8, {1, 64}, "voxels along each side"};
  Param<float> width{this, "width", 1.0f, {0.1f, 100.0f}, "m", "of the grid"};
  Param<bool> smooth{this, "smooth", false, "whether it is smoothed"};
  enum class Layout { dense, sparse };
  Param<Layout> layout{this, "layout", Layout::dense, "of the memory"};
  Out<RadianceGrid> grid{this, "grid", "radiance"};
  Reads readsFrom() const override { return Reads::geometry; }
  std::string checkParameters() const override {
    return smooth && layout == Layout::sparse ? "a sparse grid cannot be smooth" : "";
  }
  void run(PassContext& frame) override {
    note();
    gpu::TextureDescription description{gpu::TextureKind::d3, gpu::Format::rgba32f, resolution,
                                        resolution,           resolution,           1};
    RadianceGrid value;
    value.radiance = frame.texture(description, "grid");
    value.radiance->clear(glm::vec4(0.25f));
    grid = value;
  }
};

/// Two outputs, one of which needs something glossy.
struct Gather : Toy {
  using Toy::Toy;
  In<RadianceGrid> grid{this, "grid", "radiance"};
  In<Image> view{this, "view", Presence::optional, "what the camera sees"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse};
  Out<Image> glossy{this, "glossy", Contributes::indirectGlossy, Needs::glossyMaterial};
  Reads readsFrom() const override { return Reads::camera; }
  void run(PassContext& frame) override {
    note();
    const float fromGrid = grid->radiance->downloadFloats().front();
    diffuse = paint(frame, fromGrid + (view ? valueOf(*view) : 0.0f));
    // A scene without anything glossy has no glossy light: black.
    if (glossy.wanted())
      glossy = paint(frame, frame.sceneDescription().materials.front().glossy() ? 2.0f : 0.0f);
  }
};

/// The sum of a required and an optional image.
struct Add : Toy {
  using Toy::Toy;
  In<Image> first{this, "first", "one term"};
  In<Image> second{this, "second", Presence::optional, "another term"};
  Out<Image> sum{this, "sum", Contributes::final};
  void run(PassContext& frame) override {
    note();
    sum = paint(frame, valueOf(*first) + (second ? valueOf(*second) : 0.0f));
  }
};

struct Fog : Toy {
  using Toy::Toy;
  Out<Image> scattered{this, "scattered", Contributes::scattered};
  Needs needs() const override { return Needs::medium; }
  void run(PassContext& frame) override {
    note();
    scattered = paint(frame, frame.sceneDescription().media.empty() ? 0.0f : 3.0f);
  }
};

/// One triangle of one material, a camera that does not move; 4 x 4 pixels.
inline Scene triangleScene() {
  Scene scene;
  scene.name = "triangle";
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  scene.texcoords = {{0, 0}, {1, 0}, {0, 1}};
  scene.indices = {0, 1, 2};
  Material material;
  material.name = "grey";
  material.diffuse = glm::vec3(0.5f);
  scene.materials.push_back(material);
  Object object;
  object.name = "triangle";
  object.vertexCount = 3;
  object.parts.push_back({0, 0, 3});
  scene.objects.push_back(object);
  Camera camera;
  camera.name = "main";
  camera.width = camera.height = 4;
  scene.cameras.push_back(camera);
  return scene;
}

inline TestTechniques& addToys(TestTechniques& techniques) {
  techniques.add<Paint>("toy", "paint");
  techniques.add<PaintCamera>("toy", "paint_camera");
  techniques.add<Voxels>("toy", "voxels");
  techniques.add<Gather>("toy", "gather");
  techniques.add<Add>("toy", "add");
  techniques.add<Fog>("toy", "fog");
  return techniques;
}

inline Pipeline pipelineOf(const std::string& body) {
  return Pipeline::parse("pipeline \"test\" {\n" + body + "\n}\n", "test.pipeline");
}

/// Toys on a device of their own.
struct Fixture {
  std::unique_ptr<gpu::Device> device = std::make_unique<gpu::Device>();
  TestTechniques techniques;
  Scene scene = triangleScene();

  Fixture() { addToys(techniques); }
  PipelineExecutor executor(const std::string& body, RenderOptions options = {}) {
    return PipelineExecutor(*device, techniques, scene, pipelineOf(body), options);
  }
};

/// Options with these flags on.
template <class... Flags>
RenderOptions with(Flags... flags) {
  RenderOptions options;
  ((options.*flags = true), ...);
  return options;
}

using Ran = std::vector<std::string>;

inline const LeftOut* find(const Explanation& explanation, LeftOut::Level level, const std::string& what) {
  for (const LeftOut& one : explanation.leftOut)
    if (one.level == level && one.what.rfind(what, 0) == 0) return &one;
  return nullptr;
}

/// Why something was left out; empty: it was not.
inline std::string whyLeftOut(const PipelineExecutor& executor, LeftOut::Level level,
                              const std::string& what) {
  const Explanation explanation = executor.explain();
  const LeftOut* const one = find(explanation, level, what);
  return one == nullptr ? "" : one->why;
}

/// The first value of an output's image.
inline float first(const FrameResult& frame, const std::string& output) {
  return frame.outputs.at(output).at(0, 0, 0);
}

}  // namespace lumivox::test
