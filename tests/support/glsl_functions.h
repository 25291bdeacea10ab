// Functions of shader includes, called from C++ for many inputs at once.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "lumivox/base/file.h"
#include "lumivox/gpu/device.h"
#include "support/support.h"

namespace lumivox::test {

/// The folder of the tree's shaders, or of those that tests/mutation/mutate has changed.
inline std::filesystem::path shaderDirectory() {
  const char* changed = std::getenv("LUMIVOX_TEST_SHADERS");
  return changed != nullptr ? std::filesystem::path(changed) : sourceDirectory() / "shaders";
}

/// Runs the statements `body` for every input: they read `given` (inputs[i]) and write `found` (results[i]),
/// both vec4. The functions of `files` below shaders/ are in scope; list each file after those that it
/// includes.
inline std::vector<glm::vec4> evaluated(const std::vector<std::string>& files, const std::string& body,
                                        const std::vector<glm::vec4>& inputs) {
  static gpu::Device glsl({"auto", gpu::ShaderInput::glsl});
  std::string text = "#version 450 core\nlayout(local_size_x = 64) in;\n";
  for (const std::string& file : files)
    text += std::regex_replace(readFile(shaderDirectory() / file), std::regex("#include[^\n]*"), "");
  text += R"(
    layout(std430, binding = 0) buffer Inputs { vec4 inputs[]; };
    layout(std430, binding = 1) buffer Results { vec4 results[]; };
    void main() {
      uint i = gl_GlobalInvocationID.x;
      if (i >= inputs.length()) return;
      vec4 given = inputs[i], found = vec4(0.0);
      )" + body +
          R"(
      results[i] = found;
    })";
  const std::vector<gpu::StageCode> code{{gpu::Stage::compute, {}, text}};
  const gpu::Program program(glsl, "functions", code, {});
  gpu::Buffer in(glsl, inputs.size() * sizeof(glm::vec4)), out(glsl, inputs.size() * sizeof(glm::vec4));
  in.uploadValues(std::span<const glm::vec4>(inputs));
  const std::vector<gpu::ResourceBinding> bindings{{"inputs", 0, gpu::ResourceBinding::Storage{&in}},
                                                   {"results", 1, gpu::ResourceBinding::Storage{&out}}};
  glsl.dispatch(program, bindings, {static_cast<int>((inputs.size() + 63) / 64), 1, 1});
  glsl.barrier();
  return out.downloadValues<glm::vec4>();
}

}  // namespace lumivox::test
