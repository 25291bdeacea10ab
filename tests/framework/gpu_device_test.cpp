#include <lumivox/base/error.h>
#include <lumivox/gpu/device.h>

#include <chrono>
#include <cmath>
#include <map>

#include "support/support.h"

using namespace lumivox;
using namespace lumivox::gpu;

namespace {

/// Programs here are short GLSL texts; SPIR-V comes with the packs, see shader_library_test.
Device& device() {
  static Device instance({"auto", ShaderInput::glsl});
  return instance;
}

Program program(const std::string& name, const std::vector<std::pair<Stage, std::string>>& stages) {
  std::vector<std::string> texts;
  std::vector<StageCode> codes;
  for (const auto& [stage, body] : stages) texts.push_back("#version 450 core\n" + body);
  for (std::size_t i = 0; i < stages.size(); ++i) codes.push_back({stages[i].first, {}, texts[i]});
  return Program(device(), name, codes, {});
}

Program computeProgram(const std::string& name, const std::string& body) {
  return program(name, {{Stage::compute, body}});
}

ResourceBinding storage(std::uint32_t binding, const Buffer& buffer) {
  return {"buffer", binding, ResourceBinding::Storage{&buffer}};
}
ResourceBinding image(std::uint32_t binding, const Texture& texture, int level = 0) {
  return {"image", binding, ResourceBinding::StorageImage{&texture, level}};
}
ResourceBinding sampled(std::uint32_t binding, const Texture& texture, Sampling sampling) {
  return {"texture", binding, ResourceBinding::Sampled{&texture, sampling}};
}
template <class Block>
ResourceBinding uniform(std::uint32_t binding, const Block& block) {
  const auto bytes = std::as_bytes(std::span(&block, 1));
  return {"Block", binding, ResourceBinding::Uniform{{bytes.begin(), bytes.end()}}};
}

using Bindings = std::vector<ResourceBinding>;

TextureDescription picture(Format format, int width, int height, int levels = 1) {
  return {TextureKind::d2, format, width, height, 1, levels};
}

constexpr Format kAllFormats[] = {Format::r8,      Format::rgba8,  Format::r16f,     Format::rg16f,
                                  Format::rgba16f, Format::r32f,   Format::rg32f,    Format::rgba32f,
                                  Format::r32ui,   Format::rg32ui, Format::rgba32ui, Format::depth32f};

bool isInteger(Format format) {
  return format == Format::r32ui || format == Format::rg32ui || format == Format::rgba32ui;
}

/// The whole target, at depth z of clip space.
const std::string kWholeTarget = R"(
  layout(std140, binding = 0) uniform Block { float z; };
  void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, z, 1.0); })";
struct Depth {
  float z = 0.5f;
  float unused[3] = {};
};

}  // namespace

TEST_CASE("a compute dispatch writes one value per invocation") {
  const Program squaring = computeProgram("squares", R"(
    layout(local_size_x = 64) in;
    layout(std430, binding = 3) buffer Squares { uint squares[]; };
    void main() { squares[gl_GlobalInvocationID.x] = gl_GlobalInvocationID.x * gl_GlobalInvocationID.x; })");
  const Buffer squares(device(), 256 * 4, "squares");
  device().dispatch(squaring, Bindings{storage(3, squares)}, {4, 1, 1});
  device().barrier();
  const auto values = squares.downloadValues<std::uint32_t>();
  for (std::uint32_t i = 0; i < 256; ++i) REQUIRE(values[i] == i * i);
}

TEST_CASE("an indirect dispatch takes its group counts from a buffer") {
  const Program counting = computeProgram("count", R"(
    layout(local_size_x = 32) in;
    layout(std430, binding = 0) buffer Count { uint count; };
    void main() { atomicAdd(count, 1u); })");
  Buffer count(device(), 4, "count"), arguments(device(), 16, "arguments");
  count.clear();
  const std::uint32_t words[] = {7, 2, 3, 1};  // three words from the second on: 2 x 3 x 1 groups
  arguments.uploadValues(std::span<const std::uint32_t>(words));
  device().dispatchIndirect(counting, Bindings{storage(0, count)}, arguments, 4);
  device().barrier();
  CHECK(count.downloadValues<std::uint32_t>()[0] == 2 * 3 * 32);
}

TEST_CASE("image atomics in a volume count every invocation, in every slice") {
  const Program voting = computeProgram("vote", R"(
    layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
    layout(r32ui, binding = 2) uniform uimage3D votes;
    void main() { imageAtomicAdd(votes, ivec3(gl_GlobalInvocationID) / 2, gl_GlobalInvocationID.z + 1u); })");
  Texture votes(device(), {TextureKind::d3, Format::r32ui, 4, 4, 4, 1}, "votes");
  votes.clear(glm::vec4(0.0f));
  device().dispatch(voting, Bindings{image(2, votes)}, {2, 2, 2});
  device().barrier();
  const auto bytes = votes.download();
  std::vector<std::uint32_t> words(64);
  std::memcpy(words.data(), bytes.data(), bytes.size());
  // Voxel slice s receives the invocations z = 2s and 2s + 1, four of each: 4 (2s + 1) + 4 (2s + 2).
  for (std::uint32_t s = 0; s < 4; ++s) {
    for (std::uint32_t i = 0; i < 16; ++i) REQUIRE(words[s * 16 + i] == 16 * s + 12);
  }
}

TEST_CASE("every format gives back the bytes that were put in") {
  for (const Format format : kAllFormats) {
    CAPTURE(name(format));
    for (const TextureKind kind : {TextureKind::d2, TextureKind::d2Array, TextureKind::d3}) {
      if (kind == TextureKind::d3 && format == Format::depth32f) continue;
      const TextureDescription description{kind, format, 5, 3, kind == TextureKind::d2 ? 1 : 2, 2};
      Texture texture(device(), description, "round trip");
      // Level 1: 2 x 1 texels, the slices of a volume halved too.
      const std::size_t texels = kind == TextureKind::d2Array ? 4 : 2;
      std::vector<std::byte> bytes(texels * bytesPerTexel(format));
      for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * 7 % 50 + 10);
      texture.upload(1, bytes);
      CHECK(texture.download(1) == bytes);
      CHECK(texture.download(0).size() == 15 * bytesPerTexel(format) * (kind == TextureKind::d2 ? 1 : 2));
    }
  }
}

TEST_CASE("slices of a volume and layers of an array are the parts of the whole that they name") {
  for (const TextureKind kind : {TextureKind::d2Array, TextureKind::d3}) {
    Texture texture(device(), {kind, Format::rg16f, 6, 5, 9, 2}, "slices");
    for (int level = 0; level < 2; ++level) {
      std::vector<std::byte> bytes = texture.download(level);
      for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * 7 % 50 + i / 64);
      texture.upload(level, bytes);
      const int slices = kind == TextureKind::d2Array || level == 0 ? 9 : 4;
      const std::size_t sliceBytes = bytes.size() / static_cast<std::size_t>(slices);
      for (int first = 0; first < slices; ++first) {
        for (int count = 1; count <= slices - first; ++count) {
          const std::byte* expected = bytes.data() + sliceBytes * static_cast<std::size_t>(first);
          // A byte behind the slices shows that no more is written.
          std::vector<std::byte> some(sliceBytes * static_cast<std::size_t>(count) + 1, std::byte{77});
          texture.downloadSlices(level, first, count, std::span(some).first(some.size() - 1));
          REQUIRE(std::equal(some.begin(), some.end() - 1, expected));
          REQUIRE(some.back() == std::byte{77});
        }
      }
    }
  }
}

TEST_CASE("every format is cleared to the value, at every level") {
  for (const Format format : kAllFormats) {
    CAPTURE(name(format));
    Texture texture(device(), picture(format, 4, 4, format == Format::depth32f ? 1 : 3), "cleared");
    texture.clear(glm::vec4(1.0f, 0.0f, 1.0f, 0.0f));
    for (int level = 0; level < texture.description().levels; ++level) {
      std::vector<float> values;
      if (isInteger(format)) {
        const auto bytes = texture.download(level);
        for (std::size_t i = 0; i < bytes.size(); i += 4) {
          std::uint32_t word = 0;
          std::memcpy(&word, &bytes[i], 4);
          values.push_back(static_cast<float>(word));
        }
      } else {
        values = texture.downloadFloats(level);
      }
      const auto components = static_cast<std::size_t>(componentCount(format));
      for (std::size_t i = 0; i < values.size(); ++i)
        REQUIRE(values[i] == (i % components % 2 == 0 ? 1.0f : 0.0f));
    }
  }
}

TEST_CASE("clearing one level leaves the others alone") {
  Texture texture(device(), {TextureKind::d3, Format::r32f, 4, 4, 4, 3}, "levels");
  texture.clear(glm::vec4(1.0f));
  texture.clear(glm::vec4(5.0f), 1);
  CHECK(texture.downloadFloats(0)[63] == 1.0f);
  CHECK(texture.downloadFloats(1)[7] == 5.0f);
  CHECK(texture.downloadFloats(2)[0] == 1.0f);
}

TEST_CASE("half floats round to the nearest and keep infinity and subnormals") {
  Texture texture(device(), picture(Format::r16f, 6, 1), "halves");
  // 10 bits of fraction: the step at 1 is 2^-10. Greatest finite 65504, least subnormal 2^-24.
  const float step = std::ldexp(1.0f, -10);
  const float values[] = {
      1.0f + 0.75f * step, 1.0f + 0.25f * step, 65504.0f, INFINITY, std::ldexp(1.0f, -24), -0.5f};
  texture.uploadFloats(0, values);
  const auto back = texture.downloadFloats();
  CHECK(back == std::vector<float>{1.0f + step, 1.0f, 65504.0f, INFINITY, std::ldexp(1.0f, -24), -0.5f});
}

TEST_CASE("a texture is read as its sampling says, inside and outside") {
  Texture texture(device(), picture(Format::r32f, 2, 1, 2), "ramp");
  const float level0[] = {1.0f, 3.0f}, level1[] = {10.0f};
  texture.uploadFloats(0, level0);
  texture.uploadFloats(1, level1);
  const Program reading = computeProgram("read", R"(
    layout(local_size_x = 1) in;
    layout(binding = 1) uniform sampler2D source;
    layout(std430, binding = 0) buffer Values { float values[]; };
    void main() {
      values[0] = textureLod(source, vec2(0.5, 0.5), 0.0).r;
      values[1] = textureLod(source, vec2(-0.25, 0.5), 0.0).r;
      values[2] = textureLod(source, vec2(0.3, 0.5), 0.0).r;
      values[3] = textureLod(source, vec2(0.25, 0.5), 0.5).r;
    })");
  const Buffer values(device(), 16, "values");
  const auto read = [&](Sampling sampling) {
    device().dispatch(reading, Bindings{sampled(1, texture, sampling), storage(0, values)}, {1, 1, 1});
    device().barrier();
    return values.downloadValues<float>();
  };
  // Texel centres at u = 0.25 (1) and 0.75 (3): half-way 2; at u = 0.3 1.2. u = -0.25 is half a texel outside
  // of the first texel's centre: the edge continues (1), repeats (3) or is nothing (0). Half-way between the
  // levels at u = 0.25: (1 + 10) / 2.
  const auto close = [](float value, double expected) {
    return Approx(expected).margin(0.01) == value;
  };  // 8-bit weights
  const auto nearest = read(Sampling::nearest);
  CHECK(nearest[2] == 1.0f);
  CHECK(nearest[1] == 1.0f);
  const auto linear = read(Sampling::linear);
  CHECK(close(linear[0], 2.0));
  CHECK(close(linear[1], 1.0));
  CHECK(close(linear[2], 1.2));
  CHECK(close(linear[3], 1.0));
  CHECK(close(read(Sampling::linearMips)[3], 5.5));
  CHECK(close(read(Sampling::linearMipsRepeat)[1], 3.0));
  CHECK(close(read(Sampling::linearBorder)[1], 0.0));
  CHECK(close(read(Sampling::linearMipsBorder)[1], 0.0));
  // Level 1 has its only texel's centre at u = 0.5: three quarters of 10 are left at u = 0.25; (1 + 7.5) / 2.
  CHECK(close(read(Sampling::linearMipsBorder)[3], 4.25));
}

TEST_CASE("generated levels are box-filtered halves") {
  Texture texture(device(), picture(Format::r32f, 4, 2, 3), "mips");
  const float values[] = {0, 2, 4, 6, 8, 10, 12, 14};
  texture.uploadFloats(0, values);
  texture.generateLevels();
  // Level 1: (0 + 2 + 8 + 10) / 4 and (4 + 6 + 12 + 14) / 4; level 2: their mean.
  CHECK(texture.downloadFloats(1) == std::vector<float>{5.0f, 9.0f});
  CHECK(texture.downloadFloats(2) == std::vector<float>{7.0f});
}

TEST_CASE("row 0 is the top of the picture in raster and in compute passes alike") {
  const Program raster = program("raster rows", {{Stage::vertex, R"(
    layout(location = 0) out float clipY;
    layout(std140, binding = 0) uniform Block { float z; };
    void main() {
      gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, z, 1.0);
      clipY = gl_Position.y;
    })"},
                                                 {Stage::fragment, R"(
    layout(location = 0) in float clipY;
    layout(location = 0) out vec2 row;
    void main() { row = vec2(clipY, gl_FragCoord.y); })"}});
  const Program compute = computeProgram("compute rows", R"(
    layout(local_size_x = 1) in;
    layout(rg32f, binding = 0) uniform image2D rows;
    void main() { imageStore(rows, ivec2(gl_GlobalInvocationID.xy), vec4(1.0 - (gl_GlobalInvocationID.y + 0.5) / 2.0, gl_GlobalInvocationID.y + 0.5, 0.0, 0.0)); })");
  const Texture drawn(device(), picture(Format::rg32f, 1, 4), "drawn"),
      computed(device(), picture(Format::rg32f, 1, 4), "computed");
  device().beginDrawing({{{&drawn}}}, {});
  device().draw(raster, Bindings{uniform(0, Depth{})}, 3);
  device().endDrawing();
  device().dispatch(compute, Bindings{image(0, computed)}, {1, 4, 1});
  device().barrier();
  // Four rows in clip space from +1 (top) to -1: centres 0.75, 0.25, -0.25, -0.75; fragment coordinates count
  // from the top.
  const auto rows = drawn.downloadFloats();
  const std::vector<float> expected{0.75f, 0.5f, 0.25f, 1.5f, -0.25f, 2.5f, -0.75f, 3.5f};
  for (std::size_t i = 0; i < rows.size(); ++i) CHECK(rows[i] == Approx(expected[i]).margin(1e-6));
  CHECK(computed.downloadFloats() == expected);
}

TEST_CASE("a triangle that is counter-clockwise with y up shows its front") {
  const Program facing = program("facing", {{Stage::vertex, kWholeTarget}, {Stage::fragment, R"(
    layout(location = 0) out float front;
    void main() { front = gl_FrontFacing ? 1.0 : 2.0; })"}});
  const Texture target(device(), picture(Format::r32f, 2, 2), "facing");
  device().beginDrawing({{{&target}}}, {});
  device().draw(facing, Bindings{uniform(0, Depth{})}, 3);  // (-1,-1), (3,-1), (-1,3): counter-clockwise
  device().endDrawing();
  CHECK(target.downloadFloats()[0] == 1.0f);
}

TEST_CASE("indexed draws pull their attributes by the index") {
  const Program pulling = program("pulling", {{Stage::vertex, R"(
    layout(std430, binding = 4) readonly buffer Positions { vec2 positions[]; };
    void main() { gl_Position = vec4(positions[gl_VertexID], 0.5, 1.0); })"},
                                              {Stage::fragment, R"(
    layout(location = 0) out float covered;
    void main() { covered = 1.0; })"}});
  Buffer positions(device(), 6 * 8, "positions"), indices(device(), 6 * 4, "indices");
  const float corners[] = {-1, 1, 1, 1, 1, -1, -1, -1, 0, 0, 9, 9};
  const std::uint32_t triangle[] = {
      5, 5, 5, 0, 1, 4};  // from the fourth on: the upper quarter between two corners and the middle
  positions.uploadValues(std::span<const float>(corners));
  indices.uploadValues(std::span<const std::uint32_t>(triangle));
  const Texture target(device(), picture(Format::r32f, 4, 4), "covered");
  device().beginDrawing({{{&target}}}, {});
  device().drawIndexed(pulling, Bindings{storage(4, positions)}, indices, 3, 3);
  device().endDrawing();
  const auto covered = target.downloadFloats();
  CHECK(covered[1] == 1.0f);  // row 0: the top
  CHECK(covered[2] == 1.0f);
  CHECK(covered[4] == 0.0f);   // left of the triangle
  CHECK(covered[13] == 0.0f);  // the bottom
}

TEST_CASE("the nearer surface wins the depth test, and clamped depth keeps what lies outside the range") {
  const Program shading = program("depth", {{Stage::vertex, kWholeTarget}, {Stage::fragment, R"(
    layout(location = 0) out float depth;
    void main() { depth = gl_FragCoord.z; })"}});
  const Texture target(device(), picture(Format::r32f, 1, 1), "target"),
      depth(device(), picture(Format::depth32f, 1, 1), "depth");
  const auto draw = [&](std::vector<float> depths, RasterState state) {
    device().beginDrawing({{{&target}}, &depth}, state);
    for (const float z : depths) device().draw(shading, Bindings{uniform(0, Depth{z})}, 3);
    device().endDrawing();
  };
  draw({0.25f, 0.75f}, {.depthTest = true, .depthWrite = true});
  CHECK(target.downloadFloats()[0] == 0.25f);
  CHECK(depth.downloadFloats()[0] == 0.25f);
  draw({0.25f, 0.75f}, {});
  CHECK(target.downloadFloats()[0] == 0.75f);
  CHECK(depth.downloadFloats()[0] == 1.0f);
  draw({-0.5f}, {.depthTest = true, .depthWrite = true});
  CHECK(depth.downloadFloats()[0] == 1.0f);
  draw({-0.5f}, {.depthTest = true, .depthWrite = true, .depthClamp = true});
  CHECK(depth.downloadFloats()[0] == 0.0f);
  draw({0.5f}, {.depthTest = true, .depthWrite = true, .depthBiasConstant = 1000.0f});
  CHECK(depth.downloadFloats()[0] > 0.5f);
}

TEST_CASE("a shadow sampler gives the filtered share of texels that the reference does not lie behind") {
  Texture depth(device(), {TextureKind::d2Array, Format::depth32f, 2, 1, 2, 1}, "shadow map");
  const float depths[] = {0.4f, 0.6f, 0.1f, 0.1f};
  depth.uploadFloats(0, depths);
  const Program comparing = computeProgram("compare", R"(
    layout(local_size_x = 1) in;
    layout(binding = 0) uniform sampler2DArrayShadow map;
    layout(std430, binding = 0) buffer Values { float values[]; };
    void main() {
      values[0] = texture(map, vec4(0.5, 0.5, 0.0, 0.5));   // half-way between a nearer and a farther texel
      values[1] = texture(map, vec4(0.5, 0.5, 0.0, 0.4));   // equal counts as lit
      values[2] = texture(map, vec4(0.5, 0.5, 0.0, 0.7));
      values[3] = texture(map, vec4(0.5, 0.5, 1.0, 0.5));   // the other layer
    })");
  const Buffer values(device(), 16, "values");
  device().dispatch(comparing, Bindings{sampled(0, depth, Sampling::shadow), storage(0, values)}, {1, 1, 1});
  device().barrier();
  const auto read = values.downloadValues<float>();
  CHECK(read[0] == Approx(0.5).margin(0.01));
  CHECK(read[1] == 1.0f);
  CHECK(read[2] == 0.0f);
  CHECK(read[3] == 0.0f);
}

TEST_CASE("drawing reaches all layers by a geometry shader, and one layer alone") {
  const Program layering = program("layers", {{Stage::vertex, kWholeTarget},
                                              {Stage::geometry, R"(
    layout(triangles) in;
    layout(triangle_strip, max_vertices = 9) out;
    layout(location = 0) flat out int layerIndex;
    void main() {
      for (int layer = 0; layer < 3; ++layer) {
        for (int i = 0; i < 3; ++i) {
          gl_Position = gl_in[i].gl_Position;
          gl_Layer = layer;
          layerIndex = layer;
          EmitVertex();
        }
        EndPrimitive();
      }
    })"},
                                              {Stage::fragment, R"(
    layout(location = 0) flat in int layerIndex;
    layout(location = 0) out float value;
    void main() { value = float(layerIndex + 1); })"}});
  const Program flat = program("one layer", {{Stage::vertex, kWholeTarget}, {Stage::fragment, R"(
    layout(location = 0) out float value;
    void main() { value = 9.0; })"}});
  const Texture layers(device(), {TextureKind::d2Array, Format::r32f, 2, 2, 3, 1}, "layers");
  device().beginDrawing({{{&layers}}}, {});
  device().draw(layering, Bindings{uniform(0, Depth{})}, 3);
  device().endDrawing();
  CHECK(layers.downloadFloats() == std::vector<float>{1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3});
  device().beginDrawing({.colours = {{&layers, 1}}, .clear = false}, {});
  device().draw(flat, Bindings{uniform(0, Depth{})}, 3);
  device().endDrawing();
  CHECK(layers.downloadFloats() == std::vector<float>{1, 1, 1, 1, 9, 9, 9, 9, 3, 3, 3, 3});
}

TEST_CASE("drawing without any target runs one fragment per pixel of the given size") {
  const Program counting = program("count fragments", {{Stage::vertex, kWholeTarget}, {Stage::fragment, R"(
    layout(std430, binding = 0) buffer Count { uint count; };
    void main() { atomicAdd(count, 1u); })"}});
  Buffer count(device(), 4, "count");
  count.clear();
  device().beginDrawing({.width = 48, .height = 31}, {});
  device().draw(counting, Bindings{uniform(0, Depth{}), storage(0, count)}, 3);
  device().endDrawing();
  device().barrier();
  CHECK(count.downloadValues<std::uint32_t>()[0] == 48 * 31);
}

TEST_CASE("every dispatch sees its own uniform block, however many are under way") {
  const Program writing = computeProgram("write", R"(
    layout(local_size_x = 1) in;
    layout(std140, binding = 5) uniform Block { uvec4 index; uvec4 padding[255]; };
    layout(std430, binding = 0) buffer Values { uint values[]; };
    void main() { values[index.x] = index.y + padding[254].w; })");
  struct Block {
    glm::uvec4 index{0u};
    glm::uvec4 padding[255] = {};
  };
  constexpr std::uint32_t kCount = 2000;  // of 4 KiB each: the ring of 1 MiB goes round several times
  const Buffer values(device(), kCount * 4, "values");
  for (std::uint32_t i = 0; i < kCount; ++i) {
    Block block;
    block.index = glm::uvec4(i, i * 3, 0, 0);
    block.padding[254].w = i;
    device().dispatch(writing, Bindings{uniform(5, block), storage(0, values)}, {1, 1, 1});
  }
  device().barrier();
  const auto read = values.downloadValues<std::uint32_t>();
  for (std::uint32_t i = 0; i < kCount; ++i) REQUIRE(read[i] == 4 * i);
}

TEST_CASE("a buffer that took the name of a deleted one is bound anew") {
  const Program filling = computeProgram("fill", R"(
    layout(local_size_x = 1) in;
    layout(std430, binding = 0) buffer Values { uint values[]; };
    void main() { values[0] = 42u; })");
  for (int i = 0; i < 4; ++i) {
    Buffer buffer(device(), 4, "short-lived");
    buffer.clear();
    device().dispatch(filling, Bindings{storage(0, buffer)}, {1, 1, 1});
    device().barrier();
    REQUIRE(buffer.downloadValues<std::uint32_t>()[0] == 42);
  }
}

TEST_CASE("bytes that are alive are counted, and so is their peak") {
  const std::uint64_t before = device().allocatedBytes();
  device().resetPeak();
  {
    // 8 x 8 + 4 x 4 + 2 x 2 + 1 = 85 texels of 8 bytes.
    const Texture texture(device(), picture(Format::rgba16f, 8, 8, 4), "texture");
    CHECK(texture.sizeBytes() == 85 * 8);
    const Buffer buffer(device(), 1000, "buffer");
    CHECK(device().allocatedBytes() == before + 85 * 8 + 1000);
  }
  CHECK(device().allocatedBytes() == before);
  CHECK(device().peakBytes() == before + 85 * 8 + 1000);
  device().resetPeak();
  CHECK(device().peakBytes() == before);
}

TEST_CASE("what does not fit is refused before it is allocated, with its size") {
  const int limit = device().info().maxTextureSize3d;
  const std::string volume = test::messageOf<Error>([&] {
    Texture(device(), {TextureKind::d3, Format::r8, limit + 1, 1, 1, 1}, "radiance grid");
  });
  CHECK_THAT(volume, Catch::Contains("radiance grid") &&
                         Catch::Contains(std::to_string(limit + 1) + " x 1 x 1") &&
                         Catch::Contains("at most " + std::to_string(limit)));
  const std::string buffer =
      test::messageOf<Error>([&] { Buffer(device(), device().info().maxStorageBytes + 4, "fragment list"); });
  CHECK_THAT(buffer, Catch::Contains("fragment list") && Catch::Contains("at most"));
  if (device().info().software) {
    const std::string memory = test::messageOf<Error>([&] {
      Texture(device(), {TextureKind::d3, Format::rgba32f, limit, limit, limit, 1}, "huge grid");
    });
    CHECK_THAT(memory, Catch::Contains("huge grid") && Catch::Contains("GiB"));
  }
  CHECK_THROWS_AS(Buffer(device(), 0, "nothing"), Error);
  CHECK_THROWS_AS(Texture(device(), picture(Format::r8, 0, 1), "nothing"), Error);
  CHECK_THROWS_AS(Texture(device(), picture(Format::r8, 4, 4, 4), "too many levels"), Error);
}

TEST_CASE("an error of the driver names the pass that caused it") {
  const Program raster = program("raster", {{Stage::vertex, kWholeTarget}});
  device().enterPass("gather");
  const std::string message = test::messageOf<Error>([&] {
    device().dispatch(raster, Bindings{uniform(0, Depth{})}, {1, 1, 1});  // it has no compute stage
    device().leavePass();
  });
  CHECK_THAT(message, Catch::Contains("pass gather") && Catch::Contains("raster"));
  device().enterPass("next");
  CHECK_NOTHROW(device().leavePass());
}

TEST_CASE("targets that cannot be drawn to together are an error, after which drawing works") {
  const Texture layers(device(), {TextureKind::d2Array, Format::r32f, 2, 2, 3, 1}, "layers"),
      flat(device(), picture(Format::r32f, 2, 2), "flat");
  CHECK_THAT(test::messageOf<Error>([&] {
               device().beginDrawing({{{&layers}, {&flat}}}, {});
             }),
             Catch::Contains("layer"));
  CHECK_NOTHROW(device().beginDrawing({{{&flat}}}, {}));
  device().endDrawing();
}

TEST_CASE("a shader that the driver refuses is an error with its name and log") {
  const std::string message =
      test::messageOf<Error>([] { computeProgram("broken", "void main() { undeclared = 1; }"); });
  CHECK_THAT(message,
             Catch::Contains("broken") && Catch::Contains("undeclared") && Catch::Contains("compute stage"));
}

TEST_CASE("too many work groups are an error with the limit") {
  const Program idle = computeProgram("idle", "layout(local_size_x = 1) in; void main() {}");
  CHECK_THAT(test::messageOf<Error>([&] {
               device().dispatch(idle, {}, {0xffffffffu, 1, 1});
             }),
             Catch::Contains("at most"));
}

TEST_CASE("the device time of a pass agrees with a clock around a finished device") {
  const DeviceInfo& info = device().info();
  CHECK(info.timerNote.rfind(info.timerQueriesTrusted ? "timer queries" : "fenced clock", 0) == 0);
  const Program busy = program("busy", {{Stage::vertex, kWholeTarget}, {Stage::fragment, R"(
    layout(location = 0) out float value;
    void main() {
      float x = gl_FragCoord.x;
      for (int i = 0; i < 2000; ++i) x = sin(x) + gl_FragCoord.y;
      value = x;
    })"}});
  const Texture target(device(), picture(Format::r32f, 128, 128), "target");
  const auto draw = [&] {
    device().beginDrawing({{{&target}}}, {});
    device().draw(busy, Bindings{uniform(0, Depth{})}, 3);
    device().endDrawing();
  };
  device().time(draw);
  device().finish();
  const auto start = std::chrono::steady_clock::now();
  const Device::Elapsed elapsed = device().time(draw);
  device().finish();
  const double clockMs =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  CHECK(elapsed.deviceMs <= clockMs * 1.25);
  CHECK(elapsed.deviceMs >= clockMs * 0.5);
  CHECK(elapsed.hostMs <= clockMs);
}

TEST_CASE("a device is chosen by word or index, and a wrong choice says what there is") {
  CHECK_THAT(test::messageOf<Error>([] { Device({"fastest"}); }),
             Catch::Contains("fastest") && Catch::Contains("surfaceless"));
  CHECK_THAT(test::messageOf<AbsentError>([] { Device({"99"}); }), Catch::Contains("no EGL device 99"));
  try {
    Device software({"software"});
    CHECK(software.info().software);
  } catch (const AbsentError& error) {
    test::skip(error.what());
  }
}

TEST_CASE("two devices work in turn, and resources may outlive their device") {
  auto other = std::make_unique<Device>(DeviceOptions{"auto", ShaderInput::glsl});
  auto theirs = std::make_unique<Buffer>(*other, 8, "theirs");
  Buffer ours(device(), 8, "ours");
  const std::uint32_t one[] = {1, 1}, two[] = {2, 2};
  ours.uploadValues(std::span<const std::uint32_t>(one));
  theirs->uploadValues(std::span<const std::uint32_t>(two));
  CHECK(ours.downloadValues<std::uint32_t>()[0] == 1);
  CHECK(theirs->downloadValues<std::uint32_t>()[0] == 2);
  other.reset();
  CHECK(theirs->downloadValues<std::uint32_t>()[1] == 2);
  theirs.reset();
  CHECK(ours.downloadValues<std::uint32_t>()[1] == 1);
}

TEST_CASE("an empty framebuffer of several samples tells which of them a triangle covers") {
  const int samples = device().info().maxSamples;
  if (samples < 2) return test::skip("the device has one sample per pixel");
  // The half of a target of 8 x 8 pixels on the upper left of its diagonal.
  const std::string corner = R"(
    void main() { gl_Position = vec4(gl_VertexID == 1 ? 1.0 : -1.0, gl_VertexID == 2 ? -1.0 : 1.0, 0.5, 1.0); })";
  const Program counting = program("samples", {{Stage::vertex, corner}, {Stage::fragment, R"(
    layout(std430, binding = 0) buffer Pixels { uint masks[]; };
    void main() { masks[int(gl_FragCoord.y) * 8 + int(gl_FragCoord.x)] = uint(gl_SampleMaskIn[0]); })"}});
  Buffer masks(device(), 64 * 4, "masks");
  masks.clear();
  RenderTargets targets;
  targets.width = targets.height = 8;
  targets.samples = samples;
  device().beginDrawing(targets, {});
  device().draw(counting, Bindings{storage(0, masks)}, 3);
  device().endDrawing();
  device().barrier();
  const auto values = masks.downloadValues<std::uint32_t>();
  const std::vector<glm::vec2> positions = device().samplePositions(samples);
  REQUIRE(positions.size() == static_cast<std::size_t>(samples));
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      for (int i = 0; i < samples; ++i) {
        const glm::vec2 place = glm::vec2(x, y) + positions[static_cast<std::size_t>(i)];
        if (std::abs(place.x + place.y - 8.0f) < 0.01f) continue;  // on the edge: either is right
        INFO("pixel " << x << ", " << y << ", sample " << i);
        const bool covered = (values[static_cast<std::size_t>(8 * y + x)] >> i & 1) != 0;
        REQUIRE(covered == (place.x + place.y < 8.0f));
      }
    }
  }
}

TEST_CASE("more samples than the device has are refused with the number that it has") {
  RenderTargets targets;
  targets.width = targets.height = 4;
  targets.samples = device().info().maxSamples + 1;
  const std::string message = test::messageOf<Error>([&] { device().beginDrawing(targets, {}); });
  CHECK_THAT(message, Catch::Matchers::Contains(std::to_string(device().info().maxSamples)));
}
