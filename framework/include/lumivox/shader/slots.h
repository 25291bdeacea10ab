// The C++ side of a shader's interface. `shaderpack` generates one header per technique from reflection, made
// of these types, so that a binding with a wrong name, kind or block layout does not compile.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lumivox/gpu/device.h"

namespace lumivox::shader {

/// In place of a binding's number: the number in the program that is run, by name and kind. For bindings that
/// many shaders have under one name.
inline constexpr std::uint32_t kByName = ~0u;

// A slot takes the resource itself, or a reference that may be null. Null binds nothing, which is an error
// only if the variant needs the binding. Temporaries do not compile: they would be destroyed before the
// command runs.

struct SampledSlot {
  const char* name;
  std::uint32_t binding = kByName;
  gpu::ResourceBinding operator()(const gpu::TextureRef& texture, gpu::Sampling sampling) const {
    return {name, binding, gpu::ResourceBinding::Sampled{texture.get(), sampling}};
  }
  gpu::ResourceBinding operator()(gpu::TextureRef&& texture, gpu::Sampling sampling) const = delete;
  gpu::ResourceBinding operator()(const gpu::Texture& texture, gpu::Sampling sampling) const {
    return {name, binding, gpu::ResourceBinding::Sampled{&texture, sampling}};
  }
};

struct ImageSlot {
  const char* name;
  std::uint32_t binding = kByName;
  gpu::ResourceBinding operator()(const gpu::TextureRef& texture, int level = 0) const {
    return {name, binding, gpu::ResourceBinding::StorageImage{texture.get(), level}};
  }
  gpu::ResourceBinding operator()(gpu::TextureRef&& texture, int level = 0) const = delete;
  gpu::ResourceBinding operator()(const gpu::Texture& texture, int level = 0) const {
    return {name, binding, gpu::ResourceBinding::StorageImage{&texture, level}};
  }
};

struct StorageSlot {
  const char* name;
  std::uint32_t binding = kByName;
  std::uint64_t elementBytes = 0;  ///< of the array of open length at its end, from one to the next; 0: none
  gpu::ResourceBinding operator()(const gpu::BufferRef& buffer) const {
    return {name, binding, gpu::ResourceBinding::Storage{buffer.get()}};
  }
  gpu::ResourceBinding operator()(gpu::BufferRef&& buffer) const = delete;
  gpu::ResourceBinding operator()(const gpu::Buffer& buffer) const {
    return {name, binding, gpu::ResourceBinding::Storage{&buffer}};
  }
};

/// `Block` is the generated mirror of a std140 block; its offsets are static_asserted in the generated
/// header.
template <class Block>
struct UniformSlot {
  const char* name;
  std::uint32_t binding = kByName;
  gpu::ResourceBinding operator()(const Block& block) const {
    const auto bytes = std::as_bytes(std::span(&block, 1));
    return {name, binding, gpu::ResourceBinding::Uniform{gpu::BlockBytes(bytes)}};
  }
};

/// The arguments of a command: bindings and sets of them, in braces. Bindings that the variant lacks are
/// dropped, so that the same set fits every variant.
class BindingSet {
 public:
  class Item {
   public:
    Item(gpu::ResourceBinding binding) : own_{std::move(binding)} {}
    Item(const BindingSet& set) : own_(set.bindings_) {}

   private:
    friend class BindingSet;
    std::vector<gpu::ResourceBinding> own_;
  };

  BindingSet() = default;
  BindingSet(std::initializer_list<Item> items) {
    for (const Item& item : items) add(item);
  }
  void add(const Item& item) { bindings_.insert(bindings_.end(), item.own_.begin(), item.own_.end()); }
  operator std::span<const gpu::ResourceBinding>() const { return bindings_; }

 private:
  std::vector<gpu::ResourceBinding> bindings_;
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
