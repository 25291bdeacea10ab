// Running programs, memory, errors and time of a device.
#include <lumivox/base/error.h>
#include <unistd.h>

#include <chrono>
#include <fstream>

#include "support/facts.h"
#include "support/gpu_programs.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::gpu;
using namespace lumivox::test;

TEST_CASE("a compute dispatch writes one value per invocation") {
  const Program squaring = computeProgram("squares", R"(
    layout(local_size_x = 64) in;
    layout(std430, binding = 3) buffer Squares { uint squares[]; };
    void main() { squares[gl_GlobalInvocationID.x] = gl_GlobalInvocationID.x * gl_GlobalInvocationID.x; })");
  const Buffer squares(device(), 256 * 4, "squares");
  dispatch(squaring, Bindings{storage(3, squares)}, {4, 1, 1});
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
  dispatch(voting, Bindings{image(2, votes)}, {2, 2, 2});
  const auto bytes = votes.download();
  std::vector<std::uint32_t> words(64);
  std::memcpy(words.data(), bytes.data(), bytes.size());
  // Voxel slice s receives the invocations z = 2s and 2s + 1, four of each: 4 (2s + 1) + 4 (2s + 2).
  for (std::uint32_t s = 0; s < 4; ++s) {
    for (std::uint32_t i = 0; i < 16; ++i) REQUIRE(words[s * 16 + i] == 16 * s + 12);
  }
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
    dispatch(filling, Bindings{storage(0, buffer)}, {1, 1, 1});
    REQUIRE(buffer.downloadValues<std::uint32_t>()[0] == 42);
  }
}

TEST_CASE("bytes that are alive are counted, and so is their peak") {
  const std::uint64_t before = device().allocatedBytes();
  device().resetPeak();
  {
    // 8 x 8 + 4 x 4 + 2 x 2 + 1 = 85 texels of 8 bytes.
    const Texture texture(device(), image(Format::rgba16f, 8, 8, 4), "texture");
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
  const auto volume = [&](Format format, int width, int side) {
    return [=] { Texture(device(), {TextureKind::d3, format, width, side, side, 1}, "grid"); };
  };
  CHECK_THROWS_MATCHES(volume(Format::r8, limit + 1, 1)(), Error, Tells("grid", limit + 1, "at most", limit));
  CHECK_THROWS_MATCHES(Buffer(device(), device().info().maxStorageBytes + 4, "list"), Error,
                       Tells("list", "at most"));
  if (device().info().software)
    CHECK_THROWS_MATCHES(volume(Format::rgba32f, limit, limit)(), Error, Tells("grid", "GiB"));
  CHECK_THROWS_AS(Buffer(device(), 0, "nothing"), Error);
  CHECK_THROWS_AS(Texture(device(), image(Format::r8, 0, 1), "nothing"), Error);
  CHECK_THROWS_AS(Texture(device(), image(Format::r8, 4, 4, 4), "too many levels"), Error);
}

TEST_CASE("resources that fit alone but not together are refused with what is held and with the limit") {
  constexpr std::uint64_t kLimit = 1 << 20;
  Device small({"auto", ShaderInput::glsl, kLimit});
  const Buffer first(small, kLimit / 4, "first");
  auto second = std::make_unique<Texture>(small, image(Format::rgba32f, 128, 128), "second");
  REQUIRE(second->sizeBytes() == kLimit / 4);
  const auto third = [&] { return Texture(small, image(Format::rgba32f, 256, 160), "third").sizeBytes(); };
  CHECK_THAT(messageOf<Error>(third),
             Tells("texture 'third'", "640.0 KiB", "512.0 KiB", "limit", "1.0 MiB", "512.0 KiB"));
  CHECK_THROWS_MATCHES(Buffer(small, kLimit / 2 + 4, "fourth"), Error,
                       Tells("buffer 'fourth'", "limit", "1.0 MiB"));
  // Sizes that would read the same when rounded are given in bytes.
  CHECK_THROWS_MATCHES(Buffer(small, kLimit / 2 + 4, "fifth"), Error, Tells("524292 B", "524288 B", "limit"));
  second.reset();
  CHECK(third() == 640 << 10);
  CHECK(Buffer(small, kLimit * 3 / 4, "to the last byte").sizeBytes() == kLimit * 3 / 4);
}

TEST_CASE("a software device takes a resource's memory when it is made") {
  if (!device().info().software) return test::skip("the device has memory of its own");
  const auto residentBytes = [] {
    std::ifstream statistics("/proc/self/statm");
    std::uint64_t pages = 0, resident = 0;
    statistics >> pages >> resident;
    return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  };
  constexpr std::uint64_t kBytes = 64 << 20;
  const std::uint64_t before = residentBytes();
  const Texture texture(device(), {TextureKind::d3, Format::r32f, 256, 256, 256, 1}, "texture");
  REQUIRE(texture.sizeBytes() == kBytes);
  const std::uint64_t between = residentBytes();
  CHECK(between >= before + kBytes);
  const Buffer buffer(device(), kBytes, "buffer");
  CHECK(residentBytes() >= between + kBytes);
}

TEST_CASE("an error of the driver is told when the pass that caused it ends, and the next one starts clean") {
  const Program raster = program("raster", {{Stage::vertex, kWholeTarget}});
  device().enterPass("gather");
  const std::string message = test::messageOf<Error>([&] {
    device().dispatch(raster, Bindings{uniform(0, Depth{})}, {1, 1, 1});  // it has no compute stage
    device().leavePass();
  });
  CHECK_THAT(message, Tells("raster") && !Tells("gather"));  // whoever runs the pass names it, once
  device().enterPass("next");
  CHECK_NOTHROW(device().leavePass());
}

TEST_CASE("a shader that the driver refuses is an error with its name and log") {
  CHECK_THROWS_MATCHES(computeProgram("broken", "void main() { undeclared = 1; }"), Error,
                       Tells("broken", "compute stage", "undeclared"));
}

namespace {

Program writing(float value, const std::string& name = "write") {
  return computeProgram(name,
                        "layout(local_size_x = 1) in;\n"
                        "layout(std430, binding = 0) buffer Data { float data[]; };\n"
                        "void main() { data[0] = " +
                            std::to_string(value) + "; }");
}

float written(const Program& program) {
  Buffer data(device(), sizeof(float), "data");
  device().dispatch(program, Bindings{storage(0, data)}, {1, 1, 1});
  return data.downloadValues<float>().front();
}

}  // namespace

TEST_CASE("programs of the same name and code are linked once, also when the first is gone") {
  const Program other = writing(2.0f);
  std::uint32_t handle = 0;
  {
    const Program one = writing(1.0f), same = writing(1.0f);
    handle = one.handle();
    CHECK(same.handle() == handle);
    CHECK(same.groupSize() == glm::ivec3(1));
    CHECK(other.handle() != handle);
    CHECK(writing(1.0f, "elsewhere").handle() != handle);  // messages tell the name
  }
  const Program between = writing(2.5f);  // takes the name, were it free
  const Program again = writing(1.0f);
  CHECK(again.handle() == handle);
  CHECK(written(again) == 1.0f);
  CHECK(written(other) == 2.0f);
  // What is held stays as it is, however many come and go, and what had to go is linked again.
  for (int i = 0; i < 600; ++i) writing(3.0f + static_cast<float>(i));
  CHECK(written(again) == 1.0f);
  CHECK(written(writing(3.0f)) == 3.0f);
  CHECK(written(writing(602.0f)) == 602.0f);
}

TEST_CASE("too many work groups are an error with the limit") {
  const Program idle = computeProgram("idle", "layout(local_size_x = 1) in; void main() {}");
  CHECK_THROWS_MATCHES(device().dispatch(idle, {}, {0xffffffffu, 1, 1}), Error, Tells("at most"));
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
  const Texture target(device(), image(Format::r32f, 128, 128), "target");
  const auto drawn = [&] { draw({{{&target}}}, busy, Bindings{uniform(0, Depth{})}); };
  device().time(drawn);
  device().finish();
  const auto start = std::chrono::steady_clock::now();
  const Device::Elapsed elapsed = device().time(drawn);
  device().finish();
  const double clockMs =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  CHECK(elapsed.deviceMs <= clockMs * 1.25);
  CHECK(elapsed.deviceMs >= clockMs * 0.5);
  CHECK(elapsed.hostMs <= clockMs);
}

TEST_CASE("parts of frames are timed in order, and are read only when later frames are under way") {
  const Program busy = computeProgram("busy", R"(
    layout(local_size_x = 64) in;
    layout(std140, binding = 0) uniform Block { uint rounds; };
    layout(std430, binding = 0) buffer Words { uint words[]; };
    void main() {
      uint state = gl_GlobalInvocationID.x + 1u;
      for (uint i = 0u; i < rounds; ++i) state = state * 1664525u + 1013904223u;
      words[gl_GlobalInvocationID.x] = state;
    })");
  struct Rounds {
    std::uint32_t rounds;
    std::uint32_t unused[3] = {};
  };
  const Buffer words(device(), 4096 * 4, "words");
  const auto work = [&](std::uint32_t rounds) {
    dispatch(busy, Bindings{uniform(0, Rounds{rounds}), storage(0, words)}, {64, 1, 1});
  };
  work(1);
  constexpr std::size_t kUnderWay = 3;
  PassTimers timers(device(), kUnderWay);
  std::vector<PassTimers::Frame> known;
  for (int frame = 0; frame < 6; ++frame) {
    timers.beginFrame();
    // A frame that an error leaves is forgotten.
    if (frame == 2) {
      timers.begin();
      timers.beginFrame();
    }
    for (int part = 0; part <= frame; ++part) {
      timers.begin();
      if (part == frame) work(1000);
      timers.end();
    }
    timers.endFrame();
    for (PassTimers::Frame& one : timers.take()) known.push_back(std::move(one));
    CHECK(known.size() == static_cast<std::size_t>(std::max(0, frame + 1 - static_cast<int>(kUnderWay))));
  }
  for (PassTimers::Frame& one : timers.takeAll()) known.push_back(std::move(one));
  REQUIRE(known.size() == 6);
  // Frame n has n + 1 parts: each frame's times are its own.
  for (std::size_t frame = 0; frame < 6; ++frame) {
    REQUIRE(known[frame].size() == frame + 1);
    for (const double ms : known[frame]) CHECK(ms >= 0.0);
    CHECK(known[frame].back() > 0.0);
  }
  CHECK(timers.takeAll().empty());
}

TEST_CASE("without a debug context an error of the driver is told when the device is waited for") {
  DeviceOptions options{"auto", ShaderInput::glsl};
  REQUIRE(options.debugContext);  // of tests
  options.debugContext = false;
  Device plain(options);
  const std::string text = "#version 450 core\n" + kWholeTarget;
  const std::vector<StageCode> codes{{Stage::vertex, {}, text}};
  const Program raster(plain, "raster", codes, {});
  plain.enterPass("gather");
  plain.dispatch(raster, Bindings{uniform(0, Depth{})}, {1, 1, 1});  // it has no compute stage
  CHECK_NOTHROW(plain.leavePass());                                  // asking here would wait for the driver
  CHECK_THROWS_MATCHES(plain.finish(), Error, Tells("GL_INVALID_OPERATION", "--debug-context"));
  CHECK_NOTHROW(plain.finish());
}

TEST_CASE("a command whose uniform blocks do not fit together is refused with their size") {
  const Program idle = computeProgram("idle", "layout(local_size_x = 1) in; void main() {}");
  std::vector<std::byte> block(16384);
  Bindings blocks;
  for (std::uint32_t i = 0; i < 80; ++i)
    blocks.push_back({"Block", i, ResourceBinding::Uniform{BlockBytes(std::span<const std::byte>(block))}});
  CHECK_THROWS_MATCHES(device().dispatch(idle, blocks, {1, 1, 1}), Error, Tells(1310720));
}

TEST_CASE("a device is chosen by word or index, and a wrong choice says what there is") {
  CHECK_THROWS_MATCHES(Device({"fastest"}), Error, Tells("fastest", "surfaceless"));
  CHECK_THROWS_MATCHES(Device({"99"}), AbsentError, Tells("EGL", "device", 99));
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
