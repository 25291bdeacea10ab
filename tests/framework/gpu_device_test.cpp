#include <lumivox/base/error.h>
#include <lumivox/gpu/device.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "support/support.h"

using namespace lumivox;
using namespace lumivox::gpu;

namespace {

Device& glslDevice() {
  static Device device({"auto", ShaderInput::glsl});
  return device;
}

Program computeProgram(Device& device, const std::string& name, const std::string& body) {
  const std::string text = "#version 450 core\n" + body;
  const StageCode code{Stage::compute, {}, text};
  return Program(device, name, std::span(&code, 1), {});
}

ResourceBinding storage(std::uint32_t binding, const Buffer& buffer) { return {"buffer", binding, ResourceBinding::Storage{&buffer}}; }
[[maybe_unused]] ResourceBinding image(std::uint32_t binding, const Texture& texture, int level = 0) {
  return {"image", binding, ResourceBinding::StorageImage{&texture, level}};
}

}  // namespace

TEST_CASE("a compute dispatch writes one value per invocation") {
  Device& device = glslDevice();
  const Program program = computeProgram(device, "squares", R"(
    layout(local_size_x = 64) in;
    layout(std430, binding = 3) buffer Squares { uint squares[]; };
    void main() { squares[gl_GlobalInvocationID.x] = gl_GlobalInvocationID.x * gl_GlobalInvocationID.x; })");
  Buffer squares(device, 256 * 4, "squares");
  const ResourceBinding bindings[] = {storage(3, squares)};
  device.dispatch(program, bindings, {4, 1, 1});
  device.barrier();
  const auto values = squares.downloadValues<std::uint32_t>();
  for (std::uint32_t i = 0; i < 256; ++i) REQUIRE(values[i] == i * i);
}

TEST_CASE("the device says where its times come from") {
  const DeviceInfo& info = glslDevice().info();
  INFO(info.timerNote << " | " << info.renderer << " | " << info.platform << " | spirv " << info.spirv);
  WARN(info.timerNote << " | " << info.renderer << " | " << info.platform << " | spirv " << info.spirv << " 3d " << info.maxTextureSize3d << " ssbo " << info.maxStorageBytes);
  CHECK(info.timerNote.rfind(info.timerQueriesTrusted ? "timer queries" : "fenced clock", 0) == 0);
}
