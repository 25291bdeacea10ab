// The C++ side of a shader's interface. `shaderpack` generates one header per technique from reflection, made
// of these types, so that a binding with a wrong name, kind or block layout does not compile.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "lumivox/gpu/device.h"

namespace lumivox::shader {

struct SampledSlot {
  const char* name;
  std::uint32_t binding;
  gpu::ResourceBinding operator()(const gpu::Texture& texture, gpu::Sampling sampling) const {
    return {name, binding, gpu::ResourceBinding::Sampled{&texture, sampling}};
  }
};

struct ImageSlot {
  const char* name;
  std::uint32_t binding;
  gpu::ResourceBinding operator()(const gpu::Texture& texture, int level = 0) const {
    return {name, binding, gpu::ResourceBinding::StorageImage{&texture, level}};
  }
};

struct StorageSlot {
  const char* name;
  std::uint32_t binding;
  gpu::ResourceBinding operator()(const gpu::Buffer& buffer) const {
    return {name, binding, gpu::ResourceBinding::Storage{&buffer}};
  }
};

/// `Block` is the generated mirror of a std140 block; its offsets are static_asserted in the generated
/// header.
template <class Block>
struct UniformSlot {
  const char* name;
  std::uint32_t binding;
  gpu::ResourceBinding operator()(const Block& block) const {
    const auto bytes = std::as_bytes(std::span(&block, 1));
    return {name, binding, gpu::ResourceBinding::Uniform{gpu::BlockBytes(bytes)}};
  }
};

/// Which compiled variant of a program: one value per declared axis, in the order of declaration.
using VariantKey = std::span<const int>;

/// Names a program in a pack: "voxel_cone_tracing/gather".
struct ProgramName {
  const char* technique;  ///< folder under shaders/, and the pack's name
  const char* program;    ///< stem of its entry files
};

/* A generated header looks like this (namespace lumivox::shaders::<technique>::<program>):

     inline constexpr shader::ProgramName kProgram{"voxel_cone_tracing", "gather"};
     struct Variant {                       // one int per axis, 0 by default
       int glossy = 0;
       std::array<int, 1> key() const { return {{glossy}}; }
     };
     struct Constants {                     // specialisation constants with their defaults in the shader
       int coneCount = 5;
       std::array<gpu::SpecialisationValue, 1> values() const;
     };
     struct Parameters { glm::vec3 gridLow; float voxelSize; ... };   // std140 mirror
     inline constexpr shader::SampledSlot radiance{"radiance", 0};
     inline constexpr shader::UniformSlot<Parameters> parameters{"Parameters", 0};
*/

}  // namespace lumivox::shader
