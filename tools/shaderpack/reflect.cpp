// The interface of a stage to the C++ side, found by SPIRV-Cross in its SPIR-V.
#include <fmt/format.h>

#include <algorithm>
#include <spirv_cross/spirv_cross.hpp>

#include "stage.h"

namespace lumivox::shaderpack {
namespace {

using shader::BindingKind;
using shader::PackedBinding;
using spirv_cross::SPIRType;

[[noreturn]] void fail(const StageSource& source, const std::string& identifier, const std::string& what) {
  throw Error(fmt::format("{}: error: {}", source.source->placeOf(identifier).text(), what));
}

std::uint32_t roundUp(std::uint32_t value, std::uint32_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

std::string scalarPrefix(SPIRType::BaseType base) {
  switch (base) {
    case SPIRType::Float:
      return "";
    case SPIRType::Int:
      return "i";
    case SPIRType::UInt:
      return "u";
    default:
      return "?";
  }
}

std::optional<gpu::Format> imageFormat(spv::ImageFormat format) {
  switch (format) {
    case spv::ImageFormatR8:
      return gpu::Format::r8;
    case spv::ImageFormatRgba8:
      return gpu::Format::rgba8;
    case spv::ImageFormatR16f:
      return gpu::Format::r16f;
    case spv::ImageFormatRg16f:
      return gpu::Format::rg16f;
    case spv::ImageFormatRgba16f:
      return gpu::Format::rgba16f;
    case spv::ImageFormatR32f:
      return gpu::Format::r32f;
    case spv::ImageFormatRg32f:
      return gpu::Format::rg32f;
    case spv::ImageFormatRgba32f:
      return gpu::Format::rgba32f;
    case spv::ImageFormatR32ui:
      return gpu::Format::r32ui;
    case spv::ImageFormatRg32ui:
      return gpu::Format::rg32ui;
    case spv::ImageFormatRgba32ui:
      return gpu::Format::rgba32ui;
    default:
      return std::nullopt;
  }
}

const char* formatName(gpu::Format format) {
  // The names of gpu::name() in the order of the enumeration: this program does not link the gpu library.
  constexpr const char* kNames[] = {"r8",    "rgba8",   "r16f",  "rg16f",  "rgba16f",  "r32f",
                                    "rg32f", "rgba32f", "r32ui", "rg32ui", "rgba32ui", "depth32f"};
  return kNames[static_cast<std::size_t>(format)];
}

class Reflection {
 public:
  Reflection(const std::vector<std::uint32_t>& declared, const std::vector<std::uint32_t>& optimised,
             const StageSource& source, Artifact& artifact)
      : declared_(declared), optimised_(optimised), source_(source), artifact_(artifact) {}

  void run() {
    rejectPlainUniforms();
    const spirv_cross::ShaderResources all = declared_.get_shader_resources();
    for (const auto& resource : all.sampled_images)
      artifact_.bindings.push_back(texture(resource, BindingKind::sampled));
    for (const auto& resource : all.storage_images)
      artifact_.bindings.push_back(texture(resource, BindingKind::image));
    for (const auto& resource : all.storage_buffers)
      artifact_.bindings.push_back(block(resource, BindingKind::storage));
    for (const auto& resource : all.uniform_buffers) {
      artifact_.bindings.push_back(block(resource, BindingKind::uniform));
      addStruct(declared_.get_type(resource.base_type_id), artifact_.bindings.back().name,
                artifact_.bindings.back().name);
    }
    if (!all.atomic_counters.empty()) {
      fail(source_, all.atomic_counters[0].name,
           "atomic counters are not supported; use atomics on a storage buffer");
    }
    for (const PackedBinding& binding : artifact_.bindings)
      artifact_.layouts.push_back(layouts_[binding.name]);
    for (const PackedBinding& binding : artifact_.bindings)
      artifact_.elementBytes.push_back(elementBytes_[binding.name]);
    markUsed();
    constants();
    stageVariables();
    if (source_.stage == gpu::Stage::compute) groupSize();
  }

 private:
  void rejectPlainUniforms() {
    for (const spirv_cross::VariableID id : declared_.get_active_interface_variables()) {
      if (declared_.get_storage_class(id) != spv::StorageClassUniformConstant) continue;
      const SPIRType& type = declared_.get_type_from_variable(id);
      if (type.basetype == SPIRType::SampledImage || type.basetype == SPIRType::Image) continue;
      const std::string name = declared_.get_name(id);
      fail(source_, name,
           fmt::format("uniform '{}' is in no block; put it into 'layout(std140, binding = n) uniform "
                       "Parameters {{ ... }}'",
                       name));
    }
  }

  PackedBinding texture(const spirv_cross::Resource& resource, BindingKind kind) {
    const std::string& name = resource.name;
    const SPIRType& type = declared_.get_type(resource.type_id);
    if (!type.array.empty()) {
      fail(source_, name,
           fmt::format("'{}' is an array of textures, which some drivers cannot index; declare them one by "
                       "one and choose by branches",
                       name));
    }
    PackedBinding binding;
    binding.name = name;
    binding.kind = kind;
    binding.binding = declared_.get_decoration(resource.id, spv::DecorationBinding);
    const bool isVolume = type.image.dim == spv::Dim3D;
    if ((type.image.dim != spv::Dim2D && !isVolume) || type.image.ms) {
      fail(source_, name,
           fmt::format(
               "'{}' is of a kind that the framework has no textures for; there are 2D, 2DArray and 3D",
               name));
    }
    binding.textureKind = isVolume             ? gpu::TextureKind::d3
                          : type.image.arrayed ? gpu::TextureKind::d2Array
                                               : gpu::TextureKind::d2;
    binding.shadow = kind == BindingKind::sampled && type.image.depth;
    binding.type = scalarPrefix(declared_.get_type(type.image.type).basetype) +
                   (kind == BindingKind::sampled ? "sampler" : "image") + (isVolume ? "3D" : "2D") +
                   (type.image.arrayed ? "Array" : "") + (binding.shadow ? "Shadow" : "");
    if (kind == BindingKind::image && type.image.format != spv::ImageFormatUnknown) {
      binding.format = imageFormat(type.image.format);
      if (!binding.format)
        fail(source_, name,
             fmt::format("image '{}' has a format that the framework has no textures for", name));
      binding.type += std::string(" ") + formatName(*binding.format);
    }
    return binding;
  }

  PackedBinding block(const spirv_cross::Resource& resource, BindingKind kind) {
    PackedBinding binding;
    binding.name = declared_.get_name(resource.base_type_id);
    binding.kind = kind;
    binding.binding = declared_.get_decoration(resource.id, spv::DecorationBinding);
    binding.type = binding.name;
    const SPIRType& type = declared_.get_type(resource.base_type_id);
    if (!declared_.get_type(resource.type_id).array.empty()) {
      fail(source_, binding.name,
           fmt::format("'{}' is an array of blocks, which is not supported", binding.name));
    }
    if (binding.name.empty() || binding.name[0] < 'A' || binding.name[0] > 'Z') {
      fail(source_, binding.name,
           fmt::format(
               "the name of block '{}' must begin with a capital; its C++ slot begins with a small letter",
               binding.name));
    }
    binding.minimumBytes = declared_.get_declared_struct_size(type);
    layouts_[binding.name] = layoutOf(type);
    const auto last = static_cast<std::uint32_t>(type.member_types.size() - 1);
    const SPIRType& lastType = declared_.get_type(type.member_types[last]);
    if (kind == BindingKind::storage && !lastType.array.empty() && lastType.array.back() == 0)
      elementBytes_[binding.name] = declared_.type_struct_member_array_stride(type, last);
    return binding;
  }

  std::string layoutOf(const SPIRType& type) {
    std::string text;
    for (std::uint32_t i = 0; i < type.member_types.size(); ++i) {
      const SPIRType& member = declared_.get_type(type.member_types[i]);
      text += fmt::format("{}@{}:", declared_.get_member_name(type.self, i),
                          declared_.type_struct_member_offset(type, i));
      text += member.basetype == SPIRType::Struct
                  ? "{" + layoutOf(member) + "}"
                  : fmt::format("{}{}x{}", static_cast<int>(member.basetype), member.vecsize, member.columns);
      for (std::size_t d = 0; d < member.array.size(); ++d) text += fmt::format("[{}]", member.array[d]);
      text += ';';
    }
    return text;
  }

  /// C++ type, size and alignment of one element of a member.
  struct Element {
    std::string type;
    std::uint32_t size, alignment;
  };
  Element elementOf(const SPIRType& holder, std::uint32_t index, const SPIRType& type,
                    const std::string& name, const std::string& block) {
    if (type.basetype == SPIRType::Struct) {
      const std::string structName = declared_.get_name(type.self);
      addStruct(declared_.get_type(type.self), structName, block);
      const auto found = std::find_if(artifact_.structs.begin(), artifact_.structs.end(),
                                      [&](const auto& s) { return s.name == structName; });
      return {structName, found->size, 16};
    }
    const bool isFloat = type.basetype == SPIRType::Float && type.width == 32;
    if (!isFloat && type.basetype != SPIRType::Int && type.basetype != SPIRType::UInt) {
      fail(source_, name,
           fmt::format("member '{}' of uniform block {} is neither float, int, uint nor made of them", name,
                       block));
    }
    if (type.columns > 1) {
      if (type.vecsize != 4 || declared_.has_member_decoration(holder.self, index, spv::DecorationRowMajor)) {
        fail(source_, name,
             fmt::format("matrix '{}' of uniform block {} must be column-major with four rows (std140 pads "
                         "the others); use mat4",
                         name, block));
      }
      return {type.columns == 4 ? "glm::mat4" : fmt::format("glm::mat{}x4", type.columns), type.columns * 16,
              16};
    }
    if (type.vecsize == 1)
      return {isFloat ? "float" : type.basetype == SPIRType::Int ? "std::int32_t" : "std::uint32_t", 4, 4};
    return {fmt::format("glm::{}vec{}", scalarPrefix(type.basetype), type.vecsize), type.vecsize * 4,
            type.vecsize == 2 ? 8u : 16u};
  }

  void addStruct(const SPIRType& type, const std::string& name, const std::string& block) {
    StructLayout layout{name, 0, {}};
    std::uint32_t end = 0;
    for (std::uint32_t i = 0; i < type.member_types.size(); ++i) {
      const SPIRType& memberType = declared_.get_type(type.member_types[i]);
      Member member;
      member.name = declared_.get_member_name(type.self, i);
      const Element element = elementOf(type, i, memberType, member.name, block);
      member.type = element.type;
      member.alignment = element.alignment;
      member.offset = declared_.type_struct_member_offset(type, i);
      std::uint32_t size = element.size;
      if (memberType.array.size() > 1 ||
          (memberType.array.size() == 1 && !memberType.array_size_literal[0])) {
        fail(source_, member.name,
             fmt::format("array '{}' of uniform block {} must have one dimension of a fixed size",
                         member.name, block));
      }
      if (memberType.array.size() == 1) {
        member.arrayLength = memberType.array[0];
        member.alignment = 16;
        if (element.size % 16 != 0) {
          fail(source_, member.name,
               fmt::format("std140 pads every element of array '{}' of uniform block {} to 16 bytes; use "
                           "elements of vec4",
                           member.name, block));
        }
        size *= member.arrayLength;
      }
      if (member.offset != roundUp(end, member.alignment)) {
        fail(source_, member.name,
             fmt::format("member '{}' of uniform block {} is at {} bytes, not where std140 puts it ({}); "
                         "leave out layout(offset), layout(align) and std430",
                         member.name, block, member.offset, roundUp(end, member.alignment)));
      }
      end = member.offset + size;
      layout.members.push_back(std::move(member));
    }
    layout.size = roundUp(end, 16);
    const auto known = std::find_if(artifact_.structs.begin(), artifact_.structs.end(),
                                    [&](const auto& s) { return s.name == name; });
    if (known == artifact_.structs.end()) artifact_.structs.push_back(std::move(layout));
  }

  void markUsed() {
    artifact_.used.assign(artifact_.bindings.size(), 0);
    const auto live = optimised_.get_shader_resources(optimised_.get_active_interface_variables());
    const auto mark = [&](const auto& resources, BindingKind kind) {
      for (const auto& resource : resources) {
        const std::uint32_t binding = optimised_.get_decoration(resource.id, spv::DecorationBinding);
        const bool isBlock = kind == BindingKind::storage || kind == BindingKind::uniform;
        const std::string name = isBlock ? optimised_.get_name(resource.base_type_id) : resource.name;
        for (std::size_t i = 0; i < artifact_.bindings.size(); ++i) {
          const PackedBinding& candidate = artifact_.bindings[i];
          if (candidate.kind == kind && candidate.binding == binding && candidate.name == name)
            artifact_.used[i] = 1;
        }
      }
    };
    mark(live.sampled_images, BindingKind::sampled);
    mark(live.storage_images, BindingKind::image);
    mark(live.storage_buffers, BindingKind::storage);
    mark(live.uniform_buffers, BindingKind::uniform);
  }

  void constants() {
    for (const auto& specialisation : declared_.get_specialization_constants()) {
      const spirv_cross::SPIRConstant& constant = declared_.get_constant(specialisation.id);
      const SPIRType& type = declared_.get_type(constant.constant_type);
      shader::PackedConstant packed;
      packed.name = declared_.get_name(specialisation.id);
      packed.id = specialisation.constant_id;
      packed.defaultBits = constant.scalar();
      switch (type.basetype) {
        case SPIRType::Boolean:
          packed.type = shader::ConstantType::boolean;
          break;
        case SPIRType::Int:
          packed.type = shader::ConstantType::integer;
          break;
        case SPIRType::UInt:
          packed.type = shader::ConstantType::unsignedInteger;
          break;
        default:
          packed.type = shader::ConstantType::real;
      }
      if (type.width > 32)
        fail(source_, packed.name,
             fmt::format("specialisation constant '{}' is wider than 32 bits", packed.name));
      if (packed.name.empty()) packed.name = groupSizeName(packed.id);
      artifact_.constants.push_back(std::move(packed));
    }
  }

  /// layout(local_size_x_id = n) makes a constant without a name.
  std::string groupSizeName(std::uint32_t id) {
    spirv_cross::SpecializationConstant axes[3];
    declared_.get_work_group_size_specialization_constants(axes[0], axes[1], axes[2]);
    for (int axis = 0; axis < 3; ++axis) {
      if (axes[axis].id != 0 && axes[axis].constant_id == id) return std::string("groupSize") + "XYZ"[axis];
    }
    return fmt::format("constant{}", id);
  }

  void groupSize() {
    spirv_cross::SpecializationConstant axes[3];
    declared_.get_work_group_size_specialization_constants(axes[0], axes[1], axes[2]);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      artifact_.groupSize.push_back(
          axes[axis].id != 0 ? 0 : declared_.get_execution_mode_argument(spv::ExecutionModeLocalSize, axis));
    }
  }

  void stageVariables() {
    const auto live = optimised_.get_shader_resources(optimised_.get_active_interface_variables());
    for (const auto& input : live.stage_inputs)
      addVariable(optimised_, input, source_.stage == gpu::Stage::geometry, artifact_.inputs);
    for (const auto& output : declared_.get_shader_resources().stage_outputs)
      addVariable(declared_, output, false, artifact_.outputs);
  }

  static std::string variableType(const SPIRType& type) {
    return fmt::format("{}vec{}", scalarPrefix(type.basetype), type.vecsize);
  }

  void addVariable(const spirv_cross::Compiler& module, const spirv_cross::Resource& resource, bool perVertex,
                   std::vector<StageVariable>& list) {
    const SPIRType& type = module.get_type(resource.type_id);
    std::uint32_t location = module.get_decoration(resource.id, spv::DecorationLocation);
    std::uint32_t count = 1;
    const std::size_t dimensions = type.array.size() - (perVertex && !type.array.empty() ? 1 : 0);
    for (std::size_t i = 0; i < dimensions; ++i) count *= std::max(1u, type.array[i]);
    for (std::uint32_t element = 0; element < count; ++element) {
      if (type.basetype != SPIRType::Struct) {
        for (std::uint32_t column = 0; column < type.columns; ++column)
          list.push_back({location++, variableType(type), resource.name});
        continue;
      }
      for (std::uint32_t i = 0; i < type.member_types.size(); ++i) {
        const SPIRType& member = module.get_type(type.member_types[i]);
        if (module.has_member_decoration(type.self, i, spv::DecorationLocation)) {
          location = module.get_member_decoration(type.self, i, spv::DecorationLocation);
        }
        std::uint32_t slots = member.columns;
        for (const std::uint32_t length : member.array) slots *= std::max(1u, length);
        for (std::uint32_t slot = 0; slot < slots; ++slot) {
          list.push_back({location++, variableType(member), module.get_member_name(type.self, i)});
        }
      }
    }
  }

  spirv_cross::Compiler declared_, optimised_;
  const StageSource& source_;
  Artifact& artifact_;
  std::map<std::string, std::string> layouts_;         // of blocks, by name
  std::map<std::string, std::uint32_t> elementBytes_;  // of storage blocks, by name
};

}  // namespace

void reflect(const std::vector<std::uint32_t>& declared, const std::vector<std::uint32_t>& optimised,
             const StageSource& source, Artifact& artifact) {
  try {
    Reflection(declared, optimised, source, artifact).run();
  } catch (const spirv_cross::CompilerError& error) {
    throw Error(fmt::format("{}: error: SPIRV-Cross cannot reflect it: {}", source.source->entry.string(),
                            error.what()));
  }
}

}  // namespace lumivox::shaderpack
