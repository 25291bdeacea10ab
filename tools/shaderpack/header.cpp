// Writes the C++ header of a technique's shader interfaces.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>

#include "build.h"
#include "lumivox/base/error.h"

namespace lumivox::shaderpack {
namespace {

using shader::ConstantType;

/// ALPHA_MASK -> alphaMask
std::string axisMember(const std::string& axis) {
  std::string member;
  bool capital = false;
  for (const unsigned char c : axis) {
    if (c == '_') {
      capital = !member.empty();
    } else {
      member += static_cast<char>(capital ? std::toupper(c) : std::tolower(c));
      capital = false;
    }
  }
  return member;
}

std::string slotName(const shader::PackedBinding& binding) {
  std::string slot = binding.name;
  if (binding.kind == shader::BindingKind::storage || binding.kind == shader::BindingKind::uniform) {
    slot[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(slot[0])));
  }
  return slot;
}

std::string structText(const StructLayout& layout) {
  std::string text = fmt::format("struct alignas(16) {} {{\n", layout.name);
  for (const Member& member : layout.members) {
    // With std140's alignment on each member, the C++ compiler gives it its std140 offset.
    const std::string type = member.arrayLength > 0
                                 ? fmt::format("std::array<{}, {}>", member.type, member.arrayLength)
                                 : member.type;
    const bool vector = member.type.rfind("glm::", 0) == 0 && member.arrayLength == 0;
    text += fmt::format("  {}{} {}{};\n",
                        member.alignment > 4 ? fmt::format("alignas({}) ", member.alignment) : "", type,
                        member.name,
                        vector ? (member.type.find("::mat") == std::string::npos &&
                                          member.type.find("::vec") == std::string::npos
                                      ? "{0}"
                                      : "{0.0f}")
                               : "{}");
  }
  text += "};\n";
  for (const Member& member : layout.members) {
    text +=
        fmt::format("static_assert(offsetof({0}, {1}) == {2});\n", layout.name, member.name, member.offset);
  }
  return text + fmt::format("static_assert(sizeof({}) == {});\n", layout.name, layout.size);
}

std::string variantText(const shader::PackedProgram& program) {
  std::string members, enumerations, list;
  for (const shader::Axis& axis : program.axes) {
    const std::string member = axisMember(axis.name);
    if (axis.named) {
      std::string words;
      for (const std::string& value : axis.values) {
        std::string capital = value;
        capital[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(capital[0])));
        words += (words.empty() ? "" : ", ") + member + capital;
      }
      enumerations += fmt::format("  enum : int {{ {} }};\n", words);
    }
    members += fmt::format("  int {} = {};  // {}\n", member, axis.value(0), fmt::join(axis.values, ", "));
    list += (list.empty() ? "" : ", ") + member;
  }
  if (!list.empty()) list = "{" + list + "}";
  return fmt::format(
      "struct Variant {{\n  static constexpr shader::ProgramName kOf = kProgram;\n{}{}  std::array<int, {}> key() const {{ return {{{}}}; }}\n}};\n",
      enumerations, members, program.axes.size(), list);
}

std::string constantsText(const shader::PackedProgram& program) {
  std::string members, list;
  // Sorted by number: the members keep the order that the shader's author chose.
  std::vector<shader::PackedConstant> constants = program.constants;
  std::sort(constants.begin(), constants.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  for (const shader::PackedConstant& constant : constants) {
    const std::uint32_t bits = constant.defaultBits;
    switch (constant.type) {
      case ConstantType::boolean:
        members += fmt::format("  bool {} = {};\n", constant.name, bits != 0);
        list += fmt::format("{{{}, {} ? 1u : 0u}}, ", constant.id, constant.name);
        break;
      case ConstantType::integer:
        members += fmt::format("  std::int32_t {} = {};\n", constant.name, static_cast<std::int32_t>(bits));
        list += fmt::format("{{{}, static_cast<std::uint32_t>({})}}, ", constant.id, constant.name);
        break;
      case ConstantType::unsignedInteger:
        members += fmt::format("  std::uint32_t {} = {}u;\n", constant.name, bits);
        list += fmt::format("{{{}, {}}}, ", constant.id, constant.name);
        break;
      case ConstantType::real:
        // Written as bits, so that the default is exact and may be infinite.
        members += fmt::format("  float {} = std::bit_cast<float>(0x{:08x}u);  // {}\n", constant.name, bits,
                               std::bit_cast<float>(bits));
        list += fmt::format("{{{}, std::bit_cast<std::uint32_t>({})}}, ", constant.id, constant.name);
        break;
    }
  }
  if (!list.empty()) list = "{" + list.substr(0, list.size() - 2) + "}";
  return fmt::format(
      "struct Constants {{\n{}  std::array<gpu::SpecialisationValue, {}> values() const {{ return {{{}}}; "
      "}}\n}};\n",
      members, program.constants.size(), list);
}

std::string slotText(const shader::PackedBinding& binding, std::uint32_t elementBytes) {
  const char* type = nullptr;
  switch (binding.kind) {
    case shader::BindingKind::sampled:
      type = "SampledSlot";
      break;
    case shader::BindingKind::image:
      type = "ImageSlot";
      break;
    case shader::BindingKind::storage:
      type = "StorageSlot";
      break;
    case shader::BindingKind::uniform:
      type = "UniformSlot";
      break;
  }
  const std::string argument = binding.kind == shader::BindingKind::uniform ? "<" + binding.name + ">" : "";
  const std::string elements = elementBytes > 0 ? fmt::format(", {}", elementBytes) : "";
  return fmt::format("inline constexpr shader::{}{} {}{{\"{}\", {}{}}};  // {}\n", type, argument,
                     slotName(binding), binding.name, binding.binding, elements, binding.type);
}

void checkSlotNames(const std::string& technique, const shader::PackedProgram& program) {
  std::map<std::string, std::string> slots;
  for (const shader::PackedBinding& binding : program.bindings) {
    const auto [known, isNew] = slots.emplace(slotName(binding), binding.name);
    if (isNew || known->second == binding.name) continue;
    throw Error(
        fmt::format("shader program {}/{}: error: '{}' and '{}' would both be the C++ slot '{}'; rename one",
                    technique, program.name, known->second, binding.name, known->first));
  }
}

}  // namespace

std::string generateHeader(const BuildResult& result) {
  const shader::ShaderPack& pack = result.pack;
  // A block with the same layout in all programs becomes one C++ type that they share.
  std::map<std::string, StructLayout> shared;
  std::set<std::string> different;
  std::vector<std::string> order;
  for (const auto& [program, interface] : result.interfaces) {
    for (const StructLayout& layout : interface.structs) {
      const auto [known, isNew] = shared.emplace(layout.name, layout);
      if (isNew) order.push_back(layout.name);
      if (known->second != layout) different.insert(layout.name);
    }
  }
  // A struct with a member whose layout differs between programs differs between them too.
  for (bool grew = true; grew;) {
    grew = false;
    for (const auto& [name, layout] : shared) {
      const bool holds = std::any_of(layout.members.begin(), layout.members.end(),
                                     [&](const Member& m) { return different.contains(m.type); });
      if (holds && different.insert(name).second) grew = true;
    }
  }

  std::string text = fmt::format(
      "// The C++ side of shaders/{0}. Generated by shaderpack: edit the shaders, not this file.\n#pragma "
      "once\n\n#include <array>\n"
      "#include <bit>\n#include <cstddef>\n#include <cstdint>\n#include <glm/glm.hpp>\n\n"
      "#include \"lumivox/shader/slots.h\"\n\nnamespace lumivox::shaders::{0} {{\n\n",
      pack.technique);
  for (const std::string& name : order) {
    if (!different.contains(name)) text += structText(shared.at(name)) + "\n";
  }
  for (const shader::PackedProgram& program : pack.programs) {
    checkSlotNames(pack.technique, program);
    const ProgramInterface& interface = result.interfaces.at(program.name);
    text +=
        fmt::format("namespace {} {{\n\ninline constexpr shader::ProgramName kProgram{{\"{}\", \"{}\"}};\n",
                    program.name, pack.technique, program.name);
    if (!interface.groupSize.empty()) {
      text += fmt::format("inline constexpr glm::ivec3 kGroupSize{{{}}};\n",
                          fmt::join(interface.groupSize, ", "));
    }
    text += variantText(program) + constantsText(program);
    for (const StructLayout& layout : interface.structs) {
      text += different.contains(layout.name)
                  ? structText(layout)
                  : fmt::format("using {0} = shaders::{1}::{0};\n", layout.name, pack.technique);
    }
    std::set<std::string> written;  // a binding whose format depends on an axis occurs once per format
    for (const shader::PackedBinding& binding : program.bindings) {
      if (written.insert(binding.name).second)
        text += slotText(binding, interface.elementBytes.at(binding.name));
    }
    text += fmt::format("\n}}  // namespace {}\n\n", program.name);
  }
  return text + fmt::format("}}  // namespace lumivox::shaders::{}\n", pack.technique);
}

}  // namespace lumivox::shaderpack
