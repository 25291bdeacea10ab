// Runs one pass alone on inputs that tests make (parameters, textures, buffers, g-buffers), and reads the
// records of frames.
#pragma once

#include <algorithm>
#include <memory>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "lumivox/pipeline/pass.h"
#include "support/scene_builder.h"
#include "support/techniques.h"

namespace lumivox::test {

/// A parameter of a pass: a number or a word.
class Setting {
 public:
  template <class Value>
  Setting(std::string name, const Value& value) : name_(std::move(name)) {
    if constexpr (std::is_arithmetic_v<Value>)
      value_ = static_cast<double>(value);
    else
      value_ = std::string(value);
  }
  void apply(PassHarness& harness) const {
    std::visit([&](const auto& value) { harness.setParameter(name_, value); }, value_);
  }
  const std::string& name() const { return name_; }
  /// As in a pipeline text: "name value".
  std::string text() const {
    std::ostringstream result;
    std::visit([&](const auto& value) { result << name_ << ' ' << value; }, value_);
    return result.str();
  }

 private:
  std::string name_;
  std::variant<double, std::string> value_;
};
using Settings = std::vector<Setting>;

/// The pass "technique.pass" on a copy of a scene at a time.
class LonePass {
 public:
  LonePass(const std::string& name, const Scene& scene, const Settings& settings = {}, double time = 0.0)
      : LonePass(name, scene, settings, snapshotOf(scene, time)) {}
  LonePass(const std::string& name, const Scene& scene, const Settings& settings,
           const SceneSnapshot& snapshot)
      : scene_(std::make_unique<Scene>(scene)),
        harness_(std::make_unique<PassHarness>(device(), techniques(), name.substr(0, name.find('.')),
                                               name.substr(name.find('.') + 1), *scene_, snapshot)) {
    with(settings);
  }
  LonePass& with(const Settings& settings) {
    for (const Setting& one : settings) one.apply(*harness_);
    ran_ = false;
    return *this;
  }
  LonePass& keepOnly(const std::string& output) {
    harness_->keepOnly(output);
    ran_ = false;
    return *this;
  }
  template <class Port>
  LonePass& in(const std::string& input, Port value) {
    harness_->setInput(input, std::move(value));
    ran_ = false;
    return *this;
  }
  LonePass& run(std::uint64_t seed = 1) {
    harness_->run(seed);
    ran_ = true;
    return *this;
  }
  /// An output of the pass, which runs first if an input or parameter was set since its last run.
  template <class Port>
  const Port& out(const std::string& output) {
    if (!ran_) run();
    return harness_->output<Port>(output);
  }
  ImageBuffer image(const std::string& output, int channels = 3) {
    return imageOf(*out<Image>(output).texture, channels);
  }
  std::vector<float> floats(const std::string& output) {
    return out<Image>(output).texture->downloadFloats(0);
  }
  PassHarness& harness() { return *harness_; }

 private:
  std::unique_ptr<Scene> scene_;  // the harness refers to it
  std::unique_ptr<PassHarness> harness_;
  bool ran_ = false;
};

inline GBuffer gbufferOf(const Scene& scene, double time = 0.0) {
  return LonePass("direct_lighting.gbuffer", scene, {}, time).out<GBuffer>("gbuffer");
}
inline ShadowMap shadowsOf(const Scene& scene, const Settings& settings = {}) {
  return LonePass("direct_lighting.shadow_map", scene, settings).out<ShadowMap>("depth");
}
/// The fragments of the conservative voxelizer.
inline VoxelFragments fragmentsIn(const Scene& scene, const Settings& settings = {}) {
  return LonePass("voxelization.conservative", scene, settings).out<VoxelFragments>("fragments");
}
inline BinaryGrid bitsIn(const Scene& scene, int resolution) {
  return LonePass("voxelization.average", scene)
      .in("fragments", fragmentsIn(scene, {{"resolution", resolution}}))
      .out<BinaryGrid>("bits");
}

inline gpu::TextureDescription pixels(int width, int height) {
  return {.format = gpu::Format::rgba32f, .width = width, .height = height};
}
inline gpu::TextureDescription layers(int width, int height, int count) {
  return {gpu::TextureKind::d2Array, gpu::Format::rgba32f, width, height, count, 1};
}
inline gpu::TextureDescription volumeOf(const glm::ivec3& size, gpu::Format format = gpu::Format::rgba32f,
                                        int levels = 1) {
  return {gpu::TextureKind::d3, format, size.x, size.y, size.z, levels};
}
inline gpu::TextureRef filled(const gpu::TextureDescription& description, const glm::vec4& value) {
  auto texture = std::make_shared<gpu::Texture>(device(), description, "made by a test");
  texture->clear(value);
  return texture;
}
inline gpu::TextureRef textureOf(const gpu::TextureDescription& description,
                                 const std::vector<float>& values) {
  auto texture = std::make_shared<gpu::Texture>(device(), description, "made by a test");
  texture->uploadFloats(0, values);
  return texture;
}
/// A texture with `value(x, y)`, a vec4, in each pixel.
template <class Value>
gpu::TextureRef pixelsWhere(const glm::ivec2& size, const Value& value) {
  std::vector<float> values;
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const glm::vec4 own = value(x, y);
      for (int c = 0; c < 4; ++c) values.push_back(own[c]);
    }
  return textureOf(pixels(size.x, size.y), values);
}
template <class T>
gpu::BufferRef bufferOf(const std::vector<T>& values) {
  auto buffer = std::make_shared<gpu::Buffer>(device(), std::max(values.size(), std::size_t{1}) * sizeof(T),
                                              "made by a test");
  if (!values.empty()) buffer->uploadValues(std::span<const T>(values));
  return buffer;
}

/// The surface that a pixel sees; nothing if it sees none.
struct SeenSurface {
  glm::vec3 position{0.0f}, normal{0, 1, 0};
  glm::vec3 diffuse{1.0f};
  glm::vec4 specular{0.0f};  ///< albedo, exponent
  bool hit = true;
};
/// A g-buffer with `seen(x, y)` in each pixel.
template <class Seen>
GBuffer gbufferWhere(const glm::ivec2& size, const Seen& seen) {
  const auto image = [&](const auto& value) {
    return pixelsWhere(size, [&](int x, int y) { return value(SeenSurface(seen(x, y))); });
  };
  GBuffer result;
  result.position =
      image([](const SeenSurface& one) { return glm::vec4(one.position, one.hit ? 1.0f : 0.0f); });
  result.normal = image([](const SeenSurface& one) { return glm::vec4(one.normal, 1.0f); });
  result.geometricNormal = image([](const SeenSurface& one) { return glm::vec4(one.normal, 0.0f); });
  result.diffuse = image([](const SeenSurface& one) { return glm::vec4(one.diffuse, 1.0f); });
  result.specular = image([](const SeenSurface& one) { return one.specular; });
  return result;
}
inline GBuffer gbufferAt(const SeenSurface& seen, const glm::ivec2& size = {8, 8}) {
  return gbufferWhere(size, [&](int, int) { return seen; });
}

/// An output of a pass in the last frame; the executor must keep it.
template <class Port>
const Port& kept(const PipelineExecutor& executor, const std::string& pass, const std::string& port) {
  const auto* output = dynamic_cast<const Out<Port>*>(executor.output(pass, port));
  REQUIRE(output != nullptr);
  return output->value();
}
/// The passes of a frame that were not left out.
inline std::set<std::string> passesOf(const FrameResult& frame) {
  std::set<std::string> names;
  for (const PassRecord& pass : frame.passes) names.insert(pass.name);
  return names;
}
inline bool ran(const FrameResult& frame, const std::string& pass) {
  return std::any_of(frame.passes.begin(), frame.passes.end(),
                     [&](const PassRecord& record) { return record.name == pass && record.ran; });
}
/// Whether the last frame reused this from an earlier frame.
inline bool reused(const PipelineExecutor& executor, const std::string& what) {
  const std::vector<LeftOut> all = executor.explain().leftOut;
  return std::any_of(all.begin(), all.end(), [&](const LeftOut& left) {
    return left.level == LeftOut::Level::time && left.what.find(what) != std::string::npos;
  });
}

inline RenderOptions sized(int width, int height) {
  RenderOptions options;
  options.width = width;
  options.height = height;
  return options;
}
/// One frame of a pipeline with these settings, "name=value".
inline FrameResult rendered(const Scene& scene, const Pipeline& text,
                            const std::vector<std::string>& settings = {}, RenderOptions options = {}) {
  options.parameters = text.settings(settings);
  return renderOnce(scene, text, options);
}

inline Scene committed(const std::string& name) {
  return loadScene(sourceDirectory() / "scenes" / (name + ".scene"));
}

inline double sumOf(std::span<const float> values) {
  double sum = 0.0;
  for (const float value : values) sum += static_cast<double>(value);
  return sum;
}
inline double meanOf(std::span<const float> values) {
  return sumOf(values) / static_cast<double>(values.size());
}
inline double meanOf(const ImageBuffer& image) {
  return meanOf(std::span<const float>(image.values()));
}
/// Root mean square difference of two images.
inline double rmsBetween(const ImageBuffer& a, const ImageBuffer& b) {
  double squares = 0.0;
  for (std::size_t i = 0; i < a.values().size(); ++i)
    squares += std::pow(static_cast<double>(a.values()[i]) - static_cast<double>(b.values()[i]), 2.0);
  return std::sqrt(squares / static_cast<double>(a.values().size()));
}

}  // namespace lumivox::test
