#include <lumivox/base/error.h>
#include <lumivox/shader/library.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>

#include "shader/arithmetic.h"
#include "shader/glsl.h"
#include "support/facts.h"
#include "support/support.h"
#include "test_shaders_shaders.h"

using namespace lumivox;
using namespace lumivox::gpu;
using lumivox::test::Tells;
namespace code = lumivox::shaders::test_shaders;

namespace {

/// Allocations of C++ on this thread; the driver is C.
thread_local std::size_t allocations = 0;

}  // namespace

// Not inlined: the compiler would see a pointer of operator new given to free.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace {

std::filesystem::path packFile() {
  return test::binaryDirectory() / "tests/packs/test_shaders.shaderpack";
}

/// The test shaders on a device of their own, by one of the two routes.
struct Laboratory {
  explicit Laboratory(ShaderInput route = ShaderInput::automatic) : device({"auto", route}), library(device) {
    library.addPack(shader::readShaderPack(packFile()));
  }
  Device device;
  shader::ShaderLibrary library;
};

code::Waves someWaves() {
  code::Waves waves;
  waves.direction = {0.3f, -0.2f, 1.7f};
  waves.frequency = 12.9f;
  waves.offset = {5, -9};
  waves.seed = 11;
  waves.toGrid = glm::mat4(1.1f, 0.2f, 0.3f, 0.4f, -0.5f, 0.6f, 0.7f, 0.8f, 0.9f, 1.0f, 1.1f, 1.2f, 1.3f,
                           1.4f, 1.5f, 1.6f);
  waves.weights = {glm::vec4(0.1f, 0.7f, -0.3f, 0.11f), glm::vec4(0.0f, 0.0f, 2.5f, 0.0f), glm::vec4(0.0f)};
  return waves;
}

std::vector<glm::vec4> values(Laboratory& laboratory, const code::values::Variant& variant,
                              const code::values::Constants& constants, const code::Waves& waves) {
  namespace values = code::values;
  Buffer results(laboratory.device, 65 * sizeof(glm::vec4), "results");
  const auto& program = laboratory.library.program(values::kProgram, variant.key(), constants.values());
  laboratory.library.dispatch(program, {values::waves(waves), values::results(results)}, {2, 1, 1});
  laboratory.device.barrier();
  return results.downloadValues<glm::vec4>();
}

std::vector<float> triangle(Laboratory& laboratory, const code::triangle::Variant& variant) {
  namespace triangle = code::triangle;
  Buffer corners(laboratory.device, 3 * sizeof(glm::vec2), "corners");
  const glm::vec2 positions[] = {{-0.9f, -0.8f}, {0.95f, -0.3f}, {-0.1f, 0.9f}};
  corners.uploadValues(std::span<const glm::vec2>(positions));
  Texture shadow(laboratory.device, {TextureKind::d2Array, Format::depth32f, 4, 4, 1, 1}, "shadow");
  shadow.clear(glm::vec4(1.0f));
  const Texture target(laboratory.device, {TextureKind::d2, Format::rgba32f, 32, 32, 1, 1}, "target");
  const auto& program = laboratory.library.program(triangle::kProgram, variant.key());
  {
    const Drawing drawing = laboratory.device.drawTo({{{&target}}}, {});
    laboratory.library.draw(program,
                            {triangle::corners(corners), triangle::waves(someWaves()),
                             triangle::shadowMap(shadow, Sampling::shadow)},
                            3);
  }
  return target.downloadFloats();
}

bool lacksSpirv() {
  if (Device().info().spirv) return false;
  test::skip("this driver loads no SPIR-V");
  return true;
}

/// Textures of 4 x 4 x 4 for the program `volume`.
struct Volumes {
  explicit Volumes(Device& device)
      : radiance(device, {TextureKind::d3, Format::rgba16f, 4, 4, 4, 1}, "grid"),
        summed(device, {TextureKind::d3, Format::rgba16f, 4, 4, 4, 1}, "summed"),
        counts(device, {TextureKind::d3, Format::r32ui, 1, 1, 1, 1}, "counts") {}
  Texture radiance, summed, counts;
};

}  // namespace

TEST_CASE("a generated block reaches the shader member by member") {
  Laboratory laboratory;
  code::Waves waves = someWaves();
  const auto results = values(laboratory, {.shape = code::values::Variant::shapeSquare}, {}, waves);
  for (const int i : {0, 1, 31, 63}) {
    const double x = i * 0.37 + 0.01;
    const double wave = std::sin(x * waves.frequency) * 2.5 + 0.3 * x - 0.2 * x * x + 1.7 * std::sqrt(x);
    const glm::vec4& result = results[static_cast<std::size_t>(i) + 1];
    CHECK(result.x == Approx(wave).margin(1e-3));
    CHECK(result.y == Approx(x * x).epsilon(1e-5));
    const glm::vec4 transformed =
        waves.toGrid * glm::vec4(static_cast<float>(x * x), static_cast<float>(x), 1.0f, 1.0f);
    CHECK(result.z == Approx(glm::dot(transformed, waves.weights[0])).epsilon(1e-4));
    const double unitY = x * x / std::sqrt(x * x + x * x * x * x + 1);
    CHECK(result.w == Approx(std::exp(-x) + std::asin(x - std::floor(x)) + unitY - 9 + 11).epsilon(1e-4));
  }
  waves.inverted = 1;
  CHECK(values(laboratory, {}, {}, waves)[5].x == -results[5].x);
}

TEST_CASE("specialisation constants keep their defaults or take the values given, in all four types") {
  for (const ShaderInput route : {ShaderInput::spirv, ShaderInput::glsl}) {
    if (route == ShaderInput::spirv && lacksSpirv()) continue;
    CAPTURE(static_cast<int>(route));
    Laboratory laboratory(route);
    const code::Waves waves = someWaves();
    CHECK(values(laboratory, {}, {}, waves)[0] == glm::vec4(-3.0f, 7.0f, 0.1f, 0.0f));
    CHECK(values(laboratory, {}, {.count = -70000, .step = 12, .scale = 1.0f / 3.0f, .shifted = true},
                 waves)[0] == glm::vec4(-70000.0f, 12.0f, 1.0f / 3.0f, 1.0f));
  }
}

TEST_CASE("a variant computes what its axis values say") {
  Laboratory laboratory;
  using Variant = code::values::Variant;
  const float x = 40 * 0.37f + 0.01f;
  const auto at40 = [&](const Variant& variant) {
    return values(laboratory, variant, {}, someWaves())[41].y;
  };
  CHECK(at40({.shape = Variant::shapeLinear}) == Approx(x));
  CHECK(at40({.shape = Variant::shapeCubic}) == Approx(x * x * x));
  CHECK(at40({.doubled = 1, .shape = Variant::shapeSquare}) == Approx(2 * x * x));
}

TEST_CASE("fast arithmetic takes the marks that forbid contraction, and nothing else") {
  constexpr std::uint32_t kMark = (3u << 16) | 71u,
                          kNoContraction = 42;  // OpDecorate, SPIR-V 1.0, 3.20 and 3.32.3
  const auto marks = [&](const std::vector<std::uint32_t>& words) {
    std::size_t count = 0;
    for (std::size_t at = 5; at < words.size(); at += words[at] >> 16)
      count += words[at] == kMark && words[at + 2] == kNoContraction ? 1 : 0;
    return count;
  };
  std::size_t all = 0;
  for (const shader::PackedCode& code : shader::readShaderPack(packFile()).codes) {
    const std::vector<std::uint32_t> spirv = code.spirv(), fast = shader::withoutContractionMarks(spirv);
    CHECK(marks(fast) == 0);
    CHECK(fast.size() + 3 * marks(spirv) == spirv.size());
    all += marks(spirv);
    // As text, too: what is made of it says `precise` of nothing.
    CHECK((code.glsl().find("precise ") != std::string::npos) == (marks(spirv) > 0));
    CHECK(shader::glslOf(fast).find("precise ") == std::string::npos);
  }
  CHECK(all > 10);
}

TEST_CASE("fast arithmetic computes the same to rounding, by both routes, and the record says so") {
  for (const ShaderInput route : {ShaderInput::spirv, ShaderInput::glsl}) {
    if (route == ShaderInput::spirv && lacksSpirv()) continue;
    Laboratory exact(route);
    DeviceOptions options{"auto", route};
    options.arithmetic = Arithmetic::fast;
    Device device(options);
    CHECK(device.programRoute() == exact.device.programRoute() + " fast");
    CHECK_THAT(programRouteText(device), Tells("fast arithmetic"));
    shader::ShaderLibrary library(device);
    library.addPack(shader::readShaderPack(packFile()));
    namespace values = code::values;
    const code::Waves waves = someWaves();
    const values::Variant variant{.shape = values::Variant::shapeSquare};
    Buffer results(device, 65 * sizeof(glm::vec4), "results");
    library.dispatch(library.program(values::kProgram, variant.key()),
                     {values::waves(waves), values::results(results)}, {2, 1, 1});
    device.barrier();
    const auto fast = results.downloadValues<glm::vec4>(), slow = ::values(exact, variant, {}, waves);
    for (std::size_t i = 1; i < slow.size(); ++i) {
      for (int c = 0; c < 4; ++c) CHECK(fast[i][c] == Approx(slow[i][c]).epsilon(1e-3).margin(1e-3));
    }
  }
}

TEST_CASE("SPIR-V and GLSL give the same bits") {
  if (lacksSpirv()) return;
  Laboratory spirv(ShaderInput::spirv), glsl(ShaderInput::glsl);
  REQUIRE(spirv.device.shaderInput() == ShaderInput::spirv);
  REQUIRE(glsl.device.shaderInput() == ShaderInput::glsl);
  const code::Waves waves = someWaves();
  const code::values::Constants constants{.count = 5, .scale = 0.7f};
  for (const int shape : {0, 1, 2}) {
    const auto a = values(spirv, {.shape = shape}, constants, waves),
               b = values(glsl, {.shape = shape}, constants, waves);
    CHECK(std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
  }
  for (const int shadowed : {0, 1}) {
    const auto a = triangle(spirv, {.shadowed = shadowed}), b = triangle(glsl, {.shadowed = shadowed});
    CHECK(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0);
    CHECK(std::count_if(a.begin(), a.end(), [](float v) { return v != 0.0f; }) > 500);
  }
}

TEST_CASE("a raster program of three stages draws to layers") {
  const ShaderInput route = GENERATE(ShaderInput::spirv, ShaderInput::glsl);
  if (route == ShaderInput::spirv && lacksSpirv()) return;
  Laboratory laboratory(route);
  const Texture layers(laboratory.device, {TextureKind::d2Array, Format::r32f, 1, 1, 2, 1}, "layers");
  {
    const Drawing drawing = laboratory.device.drawTo({{{&layers}}}, {});
    laboratory.library.draw(laboratory.library.program(code::layers::kProgram, {}), {}, 3);
  }
  CHECK(layers.downloadFloats() == std::vector<float>{1.0f, 2.0f});
}

TEST_CASE("the format of an image may follow an axis, and the wrong one is refused") {
  namespace volume = code::volume;
  Laboratory laboratory;
  Volumes volumes(laboratory.device);
  volumes.radiance.clear({0.5f, 1.0f, 2.0f, 4.0f});
  volumes.counts.clear(glm::vec4(0.0f));
  const Texture full(laboratory.device, {TextureKind::d3, Format::rgba32f, 4, 4, 4, 1}, "full");
  const auto run = [&](int wide, const Texture& summed) {
    laboratory.library.dispatch(
        laboratory.library.program(volume::kProgram, volume::Variant{.wide = wide}.key()),
        {volume::radiance(volumes.radiance, Sampling::nearest), volume::counts(volumes.counts),
         volume::summed(summed)},
        {1, 1, 1});
    laboratory.device.barrier();
  };
  run(0, volumes.summed);
  run(1, full);
  CHECK(volumes.summed.downloadFloats()[63 * 4 + 3] == 4.0f);
  CHECK(full.downloadFloats()[63 * 4 + 2] == 2.0f);
  CHECK(volumes.counts.download()[0] == std::byte{128});
  CHECK_THROWS_MATCHES(run(0, full), Error, Tells("test_shaders/volume", "summed", "rgba32f", "rgba16f"));
}

TEST_CASE("what a variant uses must be given and must fit; what it does not use is dropped") {
  namespace volume = code::volume;
  Laboratory laboratory;
  const Volumes volumes(laboratory.device);
  const Texture flat(laboratory.device, {TextureKind::d2, Format::rgba16f, 4, 4, 1, 1}, "flat");
  const auto& plain = laboratory.library.program(volume::kProgram, volume::Variant{.textured = 0}.key());
  const auto& textured = laboratory.library.program(volume::kProgram, volume::Variant{.textured = 1}.key());
  const std::vector<ResourceBinding> common{volume::radiance(volumes.radiance, Sampling::nearest),
                                            volume::counts(volumes.counts), volume::summed(volumes.summed)};
  auto with = common;
  with.push_back(volume::albedo(flat, Sampling::linear));
  const auto select = [](const auto& program, const std::vector<ResourceBinding>& resources) {
    return shader::ShaderLibrary::select(program, resources).size();
  };
  CHECK(select(plain, with) == 3);
  CHECK(select(textured, with) == 4);
  CHECK_THROWS_MATCHES(select(textured, common), Error,
                       Tells("test_shaders/volume [WIDE=0 TEXTURED=1]", "albedo", "nothing"));
  with[0] = volume::radiance(flat, Sampling::nearest);
  CHECK_THROWS_MATCHES(select(plain, with), Error, Tells("flat", "image"));
  with[0] = volume::radiance(volumes.radiance, Sampling::shadow);
  CHECK_THROWS_MATCHES(select(plain, with), Error, Tells("depth"));

  const Buffer tooSmall(laboratory.device, 8, "too small");
  const auto& values = laboratory.library.program(code::values::kProgram, code::values::Variant{}.key());
  CHECK_THROWS_MATCHES(select(values, {code::values::waves(someWaves()), code::values::results(tooSmall)}),
                       Error, Tells("Results", "8 bytes", 16));
}

TEST_CASE("a draw and a dispatch whose programs are known allocate nothing") {
  namespace volume = code::volume;
  Laboratory laboratory;
  const Volumes volumes(laboratory.device);
  // A block as draws have them: what of, and a matrix.
  struct Block {
    glm::mat4 worldToClip{1.0f};
    glm::ivec4 draw{0};
  };
  const auto run = [&](int index) {
    Block block;
    block.draw.x = index;
    const shader::UniformSlot<Block> slot{"View", 3};
    laboratory.library.dispatch(laboratory.library.program(volume::kProgram, volume::Variant{}.key()),
                                {volume::radiance(volumes.radiance, Sampling::nearest),
                                 volume::counts(volumes.counts), volume::summed(volumes.summed), slot(block)},
                                {1, 1, 1});
    const Drawing drawing = laboratory.device.drawTo({.width = 2, .height = 2}, {});
    laboratory.library.draw(laboratory.library.program(code::layers::kProgram, {}), {slot(block)}, 3);
  };
  run(0);
  const std::size_t before = allocations;
  for (int i = 1; i <= 20; ++i) run(i);
  CHECK(allocations == before);
  // The counter counts.
  const auto one = std::make_unique<int>(1);
  CHECK(allocations == before + 1);
}

TEST_CASE("an unknown technique, program or excluded variant is an error that says what there is") {
  Laboratory laboratory;
  auto& library = laboratory.library;
  CHECK_THROWS_MATCHES(library.program({"unknown", "values"}, {}), Error, Tells("unknown"));
  CHECK_THROWS_MATCHES(library.program({"test_shaders", "value"}, {}), Error, Tells("value", "values"));
  const std::array excluded{1, 0};
  CHECK_THROWS_MATCHES(library.program(code::values::kProgram, excluded), Error,
                       Tells("DOUBLED=1 SHAPE=linear", "exclude"));
  CHECK_THROWS_MATCHES(library.program(code::values::kProgram, {}), Error, Tells("2 axes"));
  CHECK_THROWS_AS(library.addPack(shader::readShaderPack(packFile())), Error);
}

TEST_CASE("a program is linked once per variant and constants, and its use is recorded") {
  Laboratory laboratory;
  auto& library = laboratory.library;
  const auto& first = library.program(code::values::kProgram, std::array{0, 0});
  CHECK(&library.program(code::values::kProgram, std::array{0, 0}) == &first);
  CHECK(&library.program(code::values::kProgram, std::array{0, 0}, std::array{SpecialisationValue{0, 9}}) !=
        &first);
  library.program(code::values::kProgram, std::array{1, 1});
  const auto usage = library.usage().at("test_shaders/values");
  CHECK(usage.possible == 6);
  CHECK(usage.compiled == 4);  // DOUBLED = 1 only with SHAPE = square
  CHECK(usage.needed == std::set<std::vector<int>>{{0, 0}, {1, 1}});
  CHECK(library.usage().at("test_shaders/layers").needed.empty());
}

TEST_CASE("the work group size of the shader is known in C++") {
  CHECK(code::values::kGroupSize == glm::ivec3(32, 1, 1));
  CHECK(code::volume::kGroupSize == glm::ivec3(4, 4, 4));
}
