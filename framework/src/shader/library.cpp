#include "lumivox/shader/library.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "lumivox/base/error.h"
#include "lumivox/base/installation.h"
#include "shader/arithmetic.h"
#include "shader/counting.h"
#include "shader/glsl.h"

namespace lumivox::shader {
namespace {

using gpu::ResourceBinding;

std::string programName(const BoundProgram& program) {
  return program.program->name();
}

BindingKind kindOf(const ResourceBinding& binding) {
  // In the order of the alternatives of ResourceBinding::resource.
  constexpr BindingKind kKinds[] = {BindingKind::sampled, BindingKind::image, BindingKind::storage,
                                    BindingKind::uniform};
  return kKinds[binding.resource.index()];
}

const char* name(gpu::TextureKind kind) {
  switch (kind) {
    case gpu::TextureKind::d2:
      return "an image";
    case gpu::TextureKind::d2Array:
      return "an array of images";
    case gpu::TextureKind::d3:
      return "a volume";
  }
  return "";
}

/// How a resource mismatches a binding; empty if it matches.
struct Mismatch {
  const PackedBinding& expected;

  std::string texture(const gpu::Texture* given) const {
    if (given == nullptr) return "no texture is given";
    const gpu::TextureDescription& d = given->description();
    if (d.kind != expected.textureKind) {
      return fmt::format("texture '{}' is {}, but the shader reads {}", given->label(), name(d.kind),
                         name(expected.textureKind));
    }
    return {};
  }

  std::string operator()(const ResourceBinding::Sampled& sampled) const {
    if (std::string wrong = texture(sampled.texture); !wrong.empty()) return wrong;
    if (expected.shadow != (sampled.sampling == gpu::Sampling::shadow)) {
      return expected.shadow ? "the shader compares depth; use Sampling::shadow"
                             : "the shader does not compare depth, as Sampling::shadow does";
    }
    return {};
  }
  std::string operator()(const ResourceBinding::StorageImage& image) const {
    if (std::string wrong = texture(image.texture); !wrong.empty()) return wrong;
    const gpu::TextureDescription& d = image.texture->description();
    if (expected.format && d.format != *expected.format) {
      return fmt::format("texture '{}' has the format {}, but the shader declares {}", image.texture->label(),
                         gpu::name(d.format), gpu::name(*expected.format));
    }
    if (image.level < 0 || image.level >= d.levels) {
      return fmt::format("texture '{}' has {} levels, and level {} is not one of them",
                         image.texture->label(), d.levels, image.level);
    }
    return {};
  }
  std::string operator()(const ResourceBinding::Storage& storage) const {
    if (storage.buffer == nullptr) return "no buffer is given";
    return block(storage.buffer->sizeBytes());
  }
  std::string operator()(const ResourceBinding::Uniform& uniform) const {
    return block(uniform.bytes.size());
  }

  std::string block(std::uint64_t bytes) const {
    if (bytes >= expected.minimumBytes) return {};
    return fmt::format("{} bytes are given, but the shader's block needs at least {}", bytes,
                       expected.minimumBytes);
  }
};

/// The key by which a program is requested, without copying anything.
struct ProgramRequest {
  std::string_view technique, program;
  std::span<const int> values;
  std::span<const gpu::SpecialisationValue> constants;
};

struct ProgramKey {
  std::string technique, program;
  std::vector<int> values;
  std::vector<gpu::SpecialisationValue> constants;
  ProgramRequest request() const { return {technique, program, values, constants}; }
};

/// The order of programs; it compares requests with keys without making a key.
struct ProgramOrder {
  using is_transparent = void;
  static const ProgramRequest& requestOf(const ProgramRequest& request) { return request; }
  static ProgramRequest requestOf(const ProgramKey& key) { return key.request(); }

  static std::strong_ordering compare(const ProgramRequest& a, const ProgramRequest& b) {
    if (const auto order = a.program <=> b.program; order != 0) return order;
    if (const auto order = a.technique <=> b.technique; order != 0) return order;
    if (const auto order = std::lexicographical_compare_three_way(a.values.begin(), a.values.end(),
                                                                  b.values.begin(), b.values.end());
        order != 0)
      return order;
    return std::lexicographical_compare_three_way(
        a.constants.begin(), a.constants.end(), b.constants.begin(), b.constants.end(),
        [](const auto& x, const auto& y) { return std::tie(x.id, x.bits) <=> std::tie(y.id, y.bits); });
  }
  template <class A, class B>
  bool operator()(const A& a, const B& b) const {
    return compare(requestOf(a), requestOf(b)) < 0;
  }
};

}  // namespace

struct ShaderLibrary::State {
  gpu::Device& device;
  std::map<std::string, ShaderPack> packs;
  std::map<ProgramKey, BoundProgram, ProgramOrder> programs;
  std::vector<ResourceBinding> selected;  ///< of the current command; a member to reuse its memory
  bool counts = false;
  Work work;
  gpu::Device::Transfers transfers, own;  ///< at the last takeWork(); those of counting itself since then

  /// Runs the transfers and clears of counting, which do not count as work.
  template <class Counting>
  void apart(Counting&& counting) {
    const gpu::Device::Transfers before = device.transfers();
    counting();
    own.downloaded += device.transfers().downloaded - before.downloaded;
    own.cleared += device.transfers().cleared - before.cleared;
  }
};

ShaderLibrary::ShaderLibrary(gpu::Device& device)
    : state_(new State{device, {}, {}, {}, false, {}, {}, {}}) {}
ShaderLibrary::~ShaderLibrary() = default;

void ShaderLibrary::addPack(ShaderPack pack) {
  const std::string technique = pack.technique;
  if (!state_->packs.emplace(technique, std::move(pack)).second) {
    throw Error(fmt::format("the shaders of technique {} are loaded already", technique));
  }
}

const BoundProgram& ShaderLibrary::program(const ProgramName& name, VariantKey variant,
                                           std::span<const gpu::SpecialisationValue> constants) {
  const ProgramRequest request{name.technique, name.program, variant, constants};
  if (const auto known = state_->programs.find(request); known != state_->programs.end())
    return known->second;

  auto pack = state_->packs.find(name.technique);
  if (pack == state_->packs.end()) {
    const std::filesystem::path own = frameworkPack(name.technique);
    if (!std::filesystem::exists(own))
      throw Error(fmt::format("the shaders of technique {} are not loaded", name.technique));
    pack = state_->packs.emplace(name.technique, readShaderPack(own)).first;
  }
  const PackedProgram& packed = pack->second.program(name.program);
  const std::vector<int> values(variant.begin(), variant.end());
  const PackedVariant* found = packed.find(variant);
  if (found == nullptr) {
    throw Error(fmt::format("shader program {}/{} has no variant {}: {}", name.technique, name.program,
                            values.empty() ? "without axis values" : packed.text(values),
                            values.size() != packed.axes.size()
                                ? fmt::format("it has {} axes", packed.axes.size())
                                : "its constraints exclude it"));
  }
  std::vector<gpu::StageCode> stages;
  // Expanded while the program is made; their addresses must not change.
  std::vector<std::pair<std::vector<std::uint32_t>, std::string>> codes;
  codes.reserve(found->stages.size());
  const bool takesText = state_->device.shaderInput() == gpu::ShaderInput::glsl;
  for (const PackedStage& stage : found->stages) {
    auto& [spirv, glsl] = codes.emplace_back(pack->second.codes[stage.code].spirv(), std::string());
    if (state_->device.arithmetic() == gpu::Arithmetic::fast) spirv = withoutContractionMarks(spirv);
    if (takesText) glsl = glslOf(spirv);
    stages.push_back({stage.stage, spirv, glsl});
  }
  std::shared_ptr<CountingProgram> counting;
  if (state_->counts) {
    state_->apart([&] { counting = std::make_shared<CountingProgram>(state_->device, packed, stages); });
    stages = counting->stages();
  }
  std::string label = fmt::format("{}/{}", name.technique, name.program);
  if (!values.empty()) label += " [" + packed.text(values) + "]";
  BoundProgram bound{std::make_unique<gpu::Program>(state_->device, std::move(label), stages, constants),
                     &packed, found, std::move(counting)};
  ProgramKey key{name.technique, name.program, values, {constants.begin(), constants.end()}};
  return state_->programs.emplace(std::move(key), std::move(bound)).first->second;
}

std::vector<ResourceBinding> ShaderLibrary::select(const BoundProgram& program,
                                                   const std::vector<ResourceBinding>& bindings) {
  std::vector<ResourceBinding> selected;
  selectInto(selected, program, bindings);
  return selected;
}

void ShaderLibrary::selectInto(std::vector<ResourceBinding>& selected, const BoundProgram& program,
                               Bindings bindings) {
  selected.clear();
  for (const std::uint32_t index : program.variant->bindingsUsed) {
    const PackedBinding& expected = program.packed->bindings[index];
    // Compares numbers first, and names only for equal numbers.
    const auto given = std::find_if(bindings.begin(), bindings.end(), [&](const ResourceBinding& binding) {
      return (binding.binding == expected.binding || binding.binding == kByName) &&
             kindOf(binding) == expected.kind && expected.name == binding.name;
    });
    const auto refuse = [&](const std::string& why) {
      throw Error(fmt::format("shader program {}: {} '{}' (binding {}): {}", programName(program),
                              shader::name(expected.kind), expected.name, expected.binding, why));
    };
    if (given == bindings.end()) {
      refuse("nothing is bound to it");
    } else {
      const std::string wrong = std::visit(Mismatch{expected}, given->resource);
      if (!wrong.empty()) refuse(wrong);
      selected.push_back(*given);
      selected.back().binding = expected.binding;
    }
  }
}

/// Runs a program with its bindings and, if it counts, its counters.
template <class Run>
void ShaderLibrary::run(const BoundProgram& program, Bindings bindings, Run&& run) {
  std::vector<ResourceBinding>& selected = state_->selected;
  selectInto(selected, program, bindings);
  if (!program.counting) {
    run(selected);
    return;
  }
  const std::vector<ResourceBinding> own = selected;
  selected.push_back(program.counting->counters());
  run(selected);
  state_->device.barrier();
  state_->apart([&] { add(state_->work, program.counting->take(own)); });
}

void ShaderLibrary::dispatch(const BoundProgram& program, Bindings bindings, glm::uvec3 groups) {
  run(program, bindings,
      [&](const auto& selected) { state_->device.dispatch(*program.program, selected, groups); });
}

void ShaderLibrary::dispatchIndirect(const BoundProgram& program, Bindings bindings,
                                     const gpu::Buffer& arguments, std::uint64_t offsetBytes) {
  run(program, bindings, [&](const auto& selected) {
    state_->device.dispatchIndirect(*program.program, selected, arguments, offsetBytes);
  });
}

void ShaderLibrary::drawIndexed(const BoundProgram& program, Bindings bindings, const gpu::Buffer& indices,
                                std::uint32_t firstIndex, std::uint32_t indexCount) {
  run(program, bindings, [&](const auto& selected) {
    state_->device.drawIndexed(*program.program, selected, indices, firstIndex, indexCount);
  });
  if (state_->counts) state_->work["triangles"] += indexCount / 3;
}

void ShaderLibrary::draw(const BoundProgram& program, Bindings bindings, std::uint32_t vertexCount) {
  run(program, bindings,
      [&](const auto& selected) { state_->device.draw(*program.program, selected, vertexCount); });
  if (state_->counts) state_->work["triangles"] += vertexCount / 3;
}

void ShaderLibrary::countWork() {
  if (state_->device.shaderInput() != gpu::ShaderInput::spirv)
    throw AbsentError(fmt::format("{} takes its programs as GLSL, and operations are counted in SPIR-V only",
                                  state_->device.info().renderer));
  state_->counts = true;
}

Work ShaderLibrary::takeWork() {
  State& s = *state_;
  Work work = std::exchange(s.work, {});
  const gpu::Device::Transfers before = s.transfers, own = std::exchange(s.own, {});
  s.transfers = s.device.transfers();
  const auto count = [&](const char* name, std::uint64_t bytes) {
    if (bytes > 0) work[name] += static_cast<double>(bytes);
  };
  count("upload_bytes", s.transfers.uploaded - before.uploaded);
  count("download_bytes", s.transfers.downloaded - before.downloaded - own.downloaded);
  count("clear_bytes", s.transfers.cleared - before.cleared - own.cleared);
  return work;
}

std::map<std::string, ShaderLibrary::Usage> ShaderLibrary::usage() const {
  std::map<std::string, Usage> usage;
  for (const auto& [technique, pack] : state_->packs) {
    for (const PackedProgram& program : pack.programs) {
      usage[technique + "/" + program.name] = {program.possible, program.variants.size(), {}};
    }
  }
  for (const auto& [key, bound] : state_->programs)
    usage[key.technique + "/" + key.program].needed.insert(key.values);
  return usage;
}

const std::map<std::string, ShaderPack>& ShaderLibrary::packs() const {
  return state_->packs;
}
gpu::Device& ShaderLibrary::device() {
  return state_->device;
}

}  // namespace lumivox::shader
