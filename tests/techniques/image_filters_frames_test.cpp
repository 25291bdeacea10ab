// Filters of light over frames and by the light's variance (Schied et al. 2017): closed forms on g-buffers
// made by hand, and the motion of a scene.
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/passes.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kSize = 64;
constexpr double kFov = 0.8;
const auto kHalf = static_cast<float>(std::tan(0.5 * kFov));

/// What a pixel sees from the origin of a plane z = -depth.
SeenSurface facing(int x, int y, float depth = 2.0f) {
  const auto across = [](int i) { return (static_cast<float>(i) + 0.5f) / kSize * 2.0f - 1.0f; };
  return {{kHalf * across(x) * depth, -kHalf * across(y) * depth, -depth}, {0, 0, 1}};
}
Scene emptyScene() {
  SceneBuilder builder;
  builder.look({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, kFov, kSize, kSize);
  return builder.scene;
}
GBuffer plane() {
  return gbufferWhere({kSize, kSize}, [](int x, int y) { return facing(x, y); });
}
using Values = std::function<float(int, int)>;
Image imageWhere(const Values& values) {
  return Image{
      pixelsWhere({kSize, kSize}, [&](int x, int y) { return glm::vec4(glm::vec3(values(x, y)), 1.0f); })};
}

/// Noise of the mean 1 and this deviation, other in each frame.
class Noise {
 public:
  explicit Noise(float deviation) : normal_(1.0f, deviation) {}
  Image frame() {
    return imageWhere([&](int, int) { return normal_(random_); });
  }

 private:
  std::mt19937 random_{3};
  std::normal_distribution<float> normal_;
};

LonePass accumulating(const Settings& settings) {
  LonePass pass("image_filters.accumulate", emptyScene(), settings);
  pass.in("gbuffer", plane()).harness().accumulate();
  return pass;
}
const Setting kPublished("as_published", "on");
const Settings kForms[] = {Settings{}, Settings{kPublished}};

std::vector<float> valuesOf(LonePass& pass, const char* output) {
  const ImageBuffer image = pass.image(output);
  return {image.values().begin(), image.values().end()};
}

/// Mean and variance of an image without its border.
std::pair<double, double> momentsOf(const ImageBuffer& image, int border) {
  double sum = 0.0, squares = 0.0;
  int count = 0;
  for (int y = border; y < kSize - border; ++y)
    for (int x = border; x < kSize - border; ++x, ++count) {
      sum += image.at(x, y, 0);
      squares += std::pow(image.at(x, y, 0), 2);
    }
  const double mean = sum / count;
  return {mean, squares / count - mean * mean};
}

ImageBuffer filtered(const GBuffer& gbuffer, const Image& light, const Image& variance,
                     const Settings& settings) {
  return LonePass("image_filters.atrous", emptyScene(), settings)
      .in("gbuffer", gbuffer)
      .in("diffuse", light)
      .in("variance", variance)
      .image("diffuse");
}

}  // namespace

TEST_CASE(
    "constant light comes back from one frame and from many, with the variance 0, and through all levels") {
  for (const Settings& form : kForms) {
    LonePass pass = accumulating(form);
    for (int frame = 0; frame < 8; ++frame) {
      pass.in("diffuse", imageWhere([](int, int) { return 0.7f; })).run();
      const ImageBuffer light = pass.image("diffuse"), variance = pass.image("variance");
      for (const float value : light.values()) REQUIRE(value == Approx(0.7f).epsilon(1e-6));
      for (const float value : variance.values()) REQUIRE(value == Approx(0.0f).margin(1e-6));
      const ImageBuffer all =
          filtered(plane(), pass.out<Image>("diffuse"), pass.out<Image>("variance"), form);
      for (const float value : all.values()) REQUIRE(value == Approx(0.7f).epsilon(1e-6));
    }
  }
}

TEST_CASE(
    "noise falls with one over the frames, or to alpha over two minus alpha, and its variance is told") {
  constexpr float kDeviation = 0.1f, kVariance = kDeviation * kDeviation;
  struct Form {
    Settings settings;
    int frames;
    double left, told;
  };
  for (const Form& form :
       {Form{Settings{Setting("change", 0)}, 8, 1.0 / 8.0, 1.0 / 8.0}, Form{{}, 16, 1.0 / 16.0, 1.0 / 16.0},
        Form{{{"frames", 1}, {"change", 0}}, 8, 1.0 / 1.0, 1.0},
        Form{Settings{kPublished}, 40, 0.2 / 1.8, 1.0 - 0.2 / 1.8}}) {
    LonePass pass = accumulating(form.settings);
    Noise noise(kDeviation);
    for (int frame = 0; frame < form.frames; ++frame) pass.in("diffuse", noise.frame()).run();
    CAPTURE(form.frames, form.left);
    CHECK(momentsOf(pass.image("diffuse"), 0).first == Approx(1.0).epsilon(0.01));
    if (form.left < 1.0) {
      CHECK(momentsOf(pass.image("diffuse"), 0).second == Approx(form.left * kVariance).epsilon(0.12));
      CHECK(momentsOf(pass.image("variance"), 0).first == Approx(form.told * kVariance).epsilon(0.12));
    }
  }
}

TEST_CASE("few frames take their variance from the pixels around") {
  for (const Settings& form : kForms) {
    LonePass pass = accumulating(form);
    pass.in("diffuse", Noise(0.1f).frame()).run();
    CHECK(momentsOf(pass.image("variance"), 4).first == Approx(0.01).epsilon(0.12));
  }
}

TEST_CASE("levels leave the share of the noise that the squares of their joint kernel add up to") {
  // Along each axis the kernels (1, 4, 6, 4, 1) / 16 with gaps of 1, 2, 4 follow one another.
  std::vector<double> joint{1.0};
  for (int level = 0; level < 3; ++level) {
    std::vector<double> next(joint.size() + (4u << level), 0.0);
    const double spline[] = {1.0 / 16.0, 0.25, 0.375, 0.25, 1.0 / 16.0};
    for (std::size_t i = 0; i < joint.size(); ++i)
      for (std::size_t k = 0; k < 5; ++k) next[i + (k << level)] += joint[i] * spline[k];
    joint = next;
    double energy = 0.0;
    for (const double weight : joint) energy += weight * weight;
    for (const char* guide : {"plane", "depth"}) {
      // The response to one bright pixel is the joint kernel: independent noise keeps the sum of its squares.
      const ImageBuffer image =
          filtered(plane(), imageWhere([](int x, int y) { return x == 32 && y == 32 ? 1.0f : 0.0f; }),
                   imageWhere([](int, int) { return 1e12f; }), {{"levels", level + 1}, {"guide", guide}});
      double sum = 0.0, squares = 0.0;
      for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
          sum += image.at(x, y, 0);
          squares += std::pow(image.at(x, y, 0), 2);
        }
      CAPTURE(level, guide);
      CHECK(sum == Approx(1.0).epsilon(1e-3));
      CHECK(squares == Approx(energy * energy).epsilon(1e-3));
    }
  }
}

TEST_CASE("a level hands on the variance that the squares of its weights leave, over their sum squared") {
  // One row of pixels alone, so that the weights of a level do not sum to one: the second level of a ramp
  // compares lights in deviations that the first one left. The same in double precision.
  constexpr int kRow = 30;
  constexpr double kVariance = 0.02;
  const auto lightAt = [](int x) { return std::sin(0.7 * x) + 0.1 * x; };
  const GBuffer row = gbufferWhere({kSize, kSize}, [](int x, int y) {
    SeenSurface seen = facing(x, y);
    seen.hit = y == kRow;
    return seen;
  });
  std::vector<double> light(kSize), variance(kSize, kVariance);
  for (int x = 0; x < kSize; ++x) light[static_cast<std::size_t>(x)] = lightAt(x);
  const double spline[] = {3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0};
  for (const int apart : {1, 2}) {
    std::vector<double> nextLight(kSize), nextVariance(kSize);
    const auto around = [&](int x) {
      double sum = 0.0, weights = 0.0;
      for (int i = std::max(x - 1, 0); i <= std::min(x + 1, kSize - 1); ++i) {
        const double weight = i == x ? 1.0 : 0.5;
        sum += weight * variance[static_cast<std::size_t>(i)];
        weights += weight;
      }
      return sum / weights;
    };
    for (int x = 0; x < kSize; ++x) {
      const auto at = static_cast<std::size_t>(x);
      double weights = 0.0;
      for (int k = -2; k <= 2; ++k) {
        const int other = x + apart * k;
        if (other < 0 || other >= kSize) continue;
        const auto there = static_cast<std::size_t>(other);
        double weight = spline[0] * spline[std::abs(k)];
        if (k != 0)
          weight *= std::exp(-std::abs(light[there] - light[at]) /
                             (4.0 * std::sqrt(0.5 * (around(x) + variance[there]))));
        nextLight[at] += weight * light[there];
        nextVariance[at] += weight * weight * variance[there];
        weights += weight;
      }
      nextLight[at] /= weights;
      nextVariance[at] /= weights * weights;
    }
    light = nextLight;
    variance = nextVariance;
  }
  const ImageBuffer image =
      filtered(row, imageWhere([&](int x, int) { return static_cast<float>(lightAt(x)); }),
               imageWhere([](int, int) { return static_cast<float>(kVariance); }), {{"levels", 2}});
  for (int x = 0; x < kSize; ++x)
    REQUIRE(image.at(x, kRow, 0) == Approx(light[static_cast<std::size_t>(x)]).margin(2e-3));
}

TEST_CASE("a variance that rounding made negative counts as zero and leaves finite light") {
  const Image step = imageWhere([](int x, int) { return x < kSize / 2 ? 1.0f : 0.0f; });
  for (const Settings& form : kForms) {
    const ImageBuffer light = filtered(plane(), step, imageWhere([](int, int) { return -1e-9f; }), form);
    for (const float value : light.values()) REQUIRE((value >= 0.0f && value <= 1.0f));
  }
}

TEST_CASE("the light's own edges stay where the variance is small, and vanish where it is large") {
  const Image step = imageWhere([](int x, int) { return x < kSize / 2 ? 1.0f : 0.0f; });
  for (const Settings& form : kForms) {
    const auto left = [&](float variance) {
      return filtered(plane(), step, imageWhere([&](int, int) { return variance; }), form)
          .at(kSize / 2, 30, 0);
    };
    CHECK(left(1e-6f) < 1e-3f);
    CHECK(left(1.0f) > 0.2f);
  }
}

TEST_CASE("an edge in depth is not crossed by any level, and light of the background counts nothing") {
  const Values light = [](int x, int) { return x < 20 ? 1.0f : x < 50 ? 0.25f : 1e6f; };
  const GBuffer gbuffer = gbufferWhere({kSize, kSize}, [](int x, int y) {
    SeenSurface seen = facing(x, y, x < 20 ? 1.0f : 2.0f);
    seen.hit = x < 50;
    return seen;
  });
  for (const Settings& form : kForms) {
    const ImageBuffer image =
        filtered(gbuffer, imageWhere(light), imageWhere([](int, int) { return 1e6f; }), form);
    for (int y = 0; y < kSize; y += 7)
      for (int x = 0; x < kSize; ++x)
        REQUIRE(image.at(x, y, 0) == Approx(x < 50 ? light(x, y) : 0.0f).margin(1e-3));
  }
}

TEST_CASE("a surface that was hidden, of another depth, direction or object, starts anew; the others go on") {
  const auto other = [](int what) {
    GBuffer result = gbufferWhere({kSize, kSize}, [&](int x, int y) {
      SeenSurface seen = facing(x, y, what == 0 && x < 20 ? 1.9f : 2.0f);
      if (what == 1 && x < 20) seen.normal = glm::normalize(glm::vec3(1, 0, 1));
      return seen;
    });
    if (what == 2)
      result.geometricNormal =
          pixelsWhere({kSize, kSize}, [](int x, int) { return glm::vec4(0, 0, 1, x < 20 ? 1 : 0); });
    return result;
  };
  SceneBuilder builder;
  builder.look({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, kFov, kSize, kSize);
  builder.box({-3, -3, -3}, {3, 3, 3}, builder.lambert(0.5f), false);  // so that the origin is the eye
  builder.quad({-1, -1, -2}, {2, 0, 0}, {0, 2, 0}, builder.lambert(0.5f)).motion =
      RigidMotion{{0, 1, 0}, 0.0, {0, 0, 0}, {1, 0, 0}};
  for (const int what : {0, 1, 2}) {
    LonePass pass("image_filters.accumulate", builder.scene, Settings{Setting("change", 0)});
    pass.in("gbuffer", plane()).harness().accumulate();
    for (int frame = 0; frame < 3; ++frame)
      pass.in("diffuse", imageWhere([](int, int) { return 3.0f; })).run();
    pass.in("gbuffer", other(what)).in("diffuse", imageWhere([](int, int) { return 1.0f; })).run();
    const ImageBuffer light = pass.image("diffuse"), motion = pass.image("motion");
    CAPTURE(what);
    for (int x = 0; x < kSize; ++x) {
      CHECK(light.at(x, 32, 0) == Approx(x < 20 ? 1.0 : 2.5));
      CHECK(motion.at(x, 32, 2) == Approx(x < 20 ? 0.0 : 3.0));
    }
  }
}

TEST_CASE("light that goes out is gone at once, and as published to a hundredth after 21 frames") {
  for (const bool published : {false, true}) {
    LonePass pass = accumulating(kForms[published ? 1 : 0]);
    Noise noise(0.1f);
    for (int frame = 0; frame < 30; ++frame) pass.in("diffuse", noise.frame()).run();
    const auto dark = [&](int frames) {
      for (int frame = 0; frame < frames; ++frame)
        pass.in("diffuse", imageWhere([](int, int) { return 0.0f; })).run();
      return momentsOf(pass.image("diffuse"), 0).first;
    };
    if (published) {
      CHECK(dark(20) > 0.010);  // 0.8^20 = 0.0115
      CHECK(dark(1) < 0.010);
    } else {
      CHECK(dark(1) < 0.001);
    }
  }
}

TEST_CASE("one frame of NaN and Inf harms neither its own image nor those that follow") {
  for (const Settings& form : kForms) {
    LonePass pass = accumulating(form);
    const auto steady = [](int, int) { return 2.0f; };
    const auto bad = [](int x, int y) {
      return x % 3 != 0   ? 2.0f
             : y % 2 == 0 ? std::numeric_limits<float>::quiet_NaN()
                          : std::numeric_limits<float>::infinity();
    };
    for (const bool first : {true, false}) {
      pass.in("diffuse", imageWhere(bad)).run();
      for (const float value : valuesOf(pass, "diffuse"))
        REQUIRE((value == Approx(2.0f) || (first && value == 0.0f)));
      for (int frame = 0; frame < 2; ++frame) pass.in("diffuse", imageWhere(steady)).run();
      for (const float value : valuesOf(pass, "diffuse")) REQUIRE(value == Approx(2.0f));
      for (const float value : valuesOf(pass, "variance")) REQUIRE(value == Approx(0.0f).margin(1e-6));
    }
  }
}

TEST_CASE(
    "ten frames of a moving camera and object are followed to a tenth of a pixel, and their history grows") {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.quad({-9, -9, -3}, {18, 0, 0}, {0, 18, 0}, grey);
  // Moves 1.3 pixels to the right and 0.4 down in each of its frames, at the depth 2.
  const double pixel = 2.0 * 2.0 * std::tan(0.5 * kFov) / kSize, rate = 24.0;
  builder.quad({-0.5f, -0.3f, -2}, {0.6f, 0, 0}, {0, 0.6f, 0}, grey).motion =
      RigidMotion{{0, 1, 0}, 0.0, {0, 0, 0}, {1.3 * pixel * rate, -0.4 * pixel * rate, 0}};
  builder.light(LightKind::directional, glm::vec3(3.0f), {0, 0, 0}, {0, 0, -1});
  builder.look({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, kFov, kSize, kSize);
  // The camera moves 0.6 pixels of the wall to the left.
  builder.scene.cameras.front().motion = RigidMotion{{0, 1, 0}, 0.0, {0, 0, 0}, {-0.9 * pixel * rate, 0, 0}};
  const Pipeline text = Pipeline::parse(
      "pipeline \"moving\" {\n"
      "  pass gbuffer direct_lighting.gbuffer { }\n"
      "  pass shadow direct_lighting.shadow_map { }\n"
      "  pass direct direct_lighting.shade {\n    gbuffer gbuffer\n    shadow shadow.depth\n  }\n"
      "  pass accumulate image_filters.accumulate {\n    gbuffer gbuffer\n    diffuse direct.radiance\n  }\n"
      "  pass atrous image_filters.atrous {\n    gbuffer gbuffer\n    diffuse accumulate.diffuse\n"
      "    variance accumulate.variance\n  }\n"
      "  output direct direct.radiance\n  output indirect_diffuse atrous.diffuse\n}\n",
      "moving.pipeline");
  RenderOptions options = sized(kSize, kSize);
  options.accumulate = true;
  PipelineExecutor executor(device(), techniques(), builder.scene, text, options);
  executor.keepOutput("accumulate", "motion");
  glm::dvec2 wall(0), object(0);
  for (int frame = 0; frame <= 10; ++frame) {
    executor.render(frame / rate, frame);
    const ImageBuffer motion = imageOf(*kept<Image>(executor, "accumulate", "motion").texture, 3);
    if (frame == 0) continue;
    wall += glm::dvec2(motion.at(50, 5, 0), motion.at(50, 5, 1));
    const int x = 24 + static_cast<int>(2.2 * frame), y = 32 + static_cast<int>(0.4 * frame);
    object += glm::dvec2(motion.at(x, y, 0), motion.at(x, y, 1));
    CHECK(motion.at(50, 5, 2) == Approx(frame).epsilon(1e-4));
    CHECK(motion.at(x, y, 2) == Approx(frame).epsilon(1e-4));
  }
  // What the camera leaves to the left moves to the right: the surface was to the left of where it is.
  CHECK(std::abs(wall.x + 10 * 0.6) < 0.1);
  CHECK(std::abs(wall.y) < 0.1);
  CHECK(std::abs(object.x + 10 * 2.2) < 0.1);
  CHECK(std::abs(object.y + 10 * 0.4) < 0.1);
}

TEST_CASE("images of another size are refused with their name and the size expected") {
  const Image small{pixelsWhere({3, 2}, [](int, int) { return glm::vec4(1.0f); })};
  LonePass accumulate("image_filters.accumulate", emptyScene());
  CHECK(messageOf<Error>([&] {
          accumulate.in("gbuffer", plane()).in("diffuse", small).run();
        }).find("3 x 2 samples") != std::string::npos);
  CHECK(messageOf<Error>([&] {
          filtered(plane(), imageWhere([](int, int) { return 1.0f; }), small, {});
        }).find("'variance' has 3 x 2 samples for 64 x 64 pixels") != std::string::npos);
}
