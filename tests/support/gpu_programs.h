// Short GLSL programs and bindings for tests of the device.
#pragma once

#include <lumivox/gpu/device.h>

#include <string>
#include <utility>
#include <vector>

namespace lumivox::test {

/// A device for programs in GLSL; the tests of SPIR-V use packs, see shader_library_test.
inline gpu::Device& device() {
  static gpu::Device instance({"auto", gpu::ShaderInput::glsl});
  return instance;
}

inline gpu::Program program(const std::string& name,
                            const std::vector<std::pair<gpu::Stage, std::string>>& stages) {
  std::vector<std::string> texts;
  std::vector<gpu::StageCode> codes;
  for (const auto& [stage, body] : stages) texts.push_back("#version 450 core\n" + body);
  for (std::size_t i = 0; i < stages.size(); ++i) codes.push_back({stages[i].first, {}, texts[i]});
  return gpu::Program(device(), name, codes, {});
}

inline gpu::Program computeProgram(const std::string& name, const std::string& body) {
  return program(name, {{gpu::Stage::compute, body}});
}

using Bindings = std::vector<gpu::ResourceBinding>;

inline gpu::ResourceBinding storage(std::uint32_t binding, const gpu::Buffer& buffer) {
  return {"buffer", binding, gpu::ResourceBinding::Storage{&buffer}};
}
inline gpu::ResourceBinding image(std::uint32_t binding, const gpu::Texture& texture, int level = 0) {
  return {"image", binding, gpu::ResourceBinding::StorageImage{&texture, level}};
}
inline gpu::ResourceBinding sampled(std::uint32_t binding, const gpu::Texture& texture,
                                    gpu::Sampling sampling) {
  return {"texture", binding, gpu::ResourceBinding::Sampled{&texture, sampling}};
}
template <class Block>
gpu::ResourceBinding uniform(std::uint32_t binding, const Block& block) {
  const auto bytes = std::as_bytes(std::span(&block, 1));
  return {"Block", binding, gpu::ResourceBinding::Uniform{{bytes.begin(), bytes.end()}}};
}

inline gpu::TextureDescription image(gpu::Format format, int width, int height, int levels = 1) {
  return {gpu::TextureKind::d2, format, width, height, 1, levels};
}

/// A vertex shader that covers the whole target with one triangle at the clip-space depth of its block Depth.
inline const std::string kWholeTarget = R"(
  layout(std140, binding = 0) uniform Block { float z; };
  void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, z, 1.0); })";
struct Depth {
  float z = 0.5f;
  float unused[3] = {};
};

/// Draws a number of vertices to targets.
inline void draw(const gpu::RenderTargets& targets, const gpu::Program& program, const Bindings& bindings,
                 const gpu::RasterState& state = {}, std::uint32_t vertices = 3) {
  const gpu::Drawing drawing = device().drawTo(targets, state);
  device().draw(program, bindings, vertices);
}

/// Dispatches groups of a program, followed by a barrier.
inline void dispatch(const gpu::Program& program, const Bindings& bindings, const glm::uvec3& groups) {
  device().dispatch(program, bindings, groups);
  device().barrier();
}

}  // namespace lumivox::test
