// Drawing: coordinates, depth, layers, samples.
#include <lumivox/base/error.h>

#include <cmath>

#include "support/facts.h"
#include "support/gpu_programs.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::gpu;
using namespace lumivox::test;

TEST_CASE("row 0 is the top of the image in raster and in compute passes alike") {
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
  const Texture drawn(device(), image(Format::rg32f, 1, 4), "drawn"),
      computed(device(), image(Format::rg32f, 1, 4), "computed");
  draw({{{&drawn}}}, raster, Bindings{uniform(0, Depth{})});
  dispatch(compute, Bindings{image(0, computed)}, {1, 4, 1});
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
  const Texture target(device(), image(Format::r32f, 2, 2), "facing");
  draw({{{&target}}}, facing, Bindings{uniform(0, Depth{})});  // (-1,-1), (3,-1), (-1,3): counter-clockwise
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
  const Texture target(device(), image(Format::r32f, 4, 4), "covered");
  {
    const Drawing drawing = device().drawTo({{{&target}}}, {});
    device().drawIndexed(pulling, Bindings{storage(4, positions)}, indices, 3, 3);
  }
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
  const Texture target(device(), image(Format::r32f, 1, 1), "target"),
      depth(device(), image(Format::depth32f, 1, 1), "depth");
  const auto draw = [&](std::vector<float> depths, RasterState state) {
    {
      const Drawing drawing = device().drawTo({{{&target}}, &depth}, state);
      for (const float z : depths) device().draw(shading, Bindings{uniform(0, Depth{z})}, 3);
    }
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
  draw({{{&layers}}}, layering, Bindings{uniform(0, Depth{})});
  CHECK(layers.downloadFloats() == std::vector<float>{1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3});
  draw({.colours = {{&layers, 1}}, .clear = false}, flat, Bindings{uniform(0, Depth{})});
  CHECK(layers.downloadFloats() == std::vector<float>{1, 1, 1, 1, 9, 9, 9, 9, 3, 3, 3, 3});
}

TEST_CASE("drawing without any target runs one fragment per pixel of the given size") {
  const Program counting = program("count fragments", {{Stage::vertex, kWholeTarget}, {Stage::fragment, R"(
    layout(std430, binding = 0) buffer Count { uint count; };
    void main() { atomicAdd(count, 1u); })"}});
  Buffer count(device(), 4, "count");
  count.clear();
  draw({.width = 48, .height = 31}, counting, Bindings{uniform(0, Depth{}), storage(0, count)});
  device().barrier();
  CHECK(count.downloadValues<std::uint32_t>()[0] == 48 * 31);
}

TEST_CASE("targets that cannot be drawn to together are an error, after which drawing works") {
  const Texture layers(device(), {TextureKind::d2Array, Format::r32f, 2, 2, 3, 1}, "layers"),
      flat(device(), image(Format::r32f, 2, 2), "flat");
  CHECK_THROWS_MATCHES(device().drawTo({{{&layers}, {&flat}}}, {}), Error, Tells("layer"));
  CHECK_NOTHROW(device().drawTo({{{&flat}}}, {}));
}

TEST_CASE("a drawing that an error leaves is over, and the next one begins") {
  const Texture target(device(), image(Format::r32f, 2, 2), "target");
  const Program filling = program("filling", {{Stage::vertex, kWholeTarget}, {Stage::fragment, R"(
    layout(location = 0) out float value;
    void main() { value = 3.0; })"}});
  CHECK_THROWS_AS(
      [&] {
        const Drawing drawing = device().drawTo({{{&target}}}, {});
        throw Error("a texture of this draw does not fit");
      }(),
      Error);
  draw({{{&target}}}, filling, Bindings{uniform(0, Depth{})});
  CHECK(target.downloadFloats()[3] == 3.0f);
}

TEST_CASE("a texture that took the name of a deleted target is drawn to, and at its own size") {
  const Program filling = program("filling", {{Stage::vertex, kWholeTarget}, {Stage::fragment, R"(
    layout(location = 0) out float value;
    void main() { value = gl_FragCoord.x; })"}});
  for (const int side : {2, 5, 3}) {
    const Texture target(device(), image(Format::r32f, side, side), "short-lived");
    for (int repeat = 0; repeat < 2; ++repeat) {  // the second finds the framebuffer of the first
      const Drawing drawing = device().drawTo({{{&target}}}, {});
      device().draw(filling, Bindings{uniform(0, Depth{})}, 3);
    }
    const std::vector<float> values = target.downloadFloats();
    CHECK(values.back() == static_cast<float>(side) - 0.5f);
  }
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
  draw(targets, counting, Bindings{storage(0, masks)});
  device().barrier();
  const auto values = masks.downloadValues<std::uint32_t>();
  const std::vector<glm::vec2> positions = device().samplePositions(samples);
  REQUIRE(positions.size() == static_cast<std::size_t>(samples));
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      for (int i = 0; i < samples; ++i) {
        const glm::vec2 place = glm::vec2(x, y) + positions[static_cast<std::size_t>(i)];
        if (std::abs(place.x + place.y - 8.0f) < 0.01f) continue;  // on the edge: either is right
        INFO("pixel " << x << ", " << y << ", sample " << i << " of " << samples << " at " << place.x - x
                      << ", " << place.y - y << ", covered samples "
                      << values[static_cast<std::size_t>(8 * y + x)]);
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
  CHECK_THROWS_MATCHES(device().drawTo(targets, {}), Error, Tells(device().info().maxSamples));
}
