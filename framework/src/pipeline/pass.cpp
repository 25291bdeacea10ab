// The contract of a pass: ports that register themselves, and the small helpers of its context.
#include "lumivox/pipeline/pass.h"

#include <algorithm>
#include <cassert>

#include "lumivox/pipeline/technique_source.h"

namespace lumivox {

const char* name(Contributes component) {
  switch (component) {
    case Contributes::nothing:
      return "nothing";
    case Contributes::direct:
      return "direct";
    case Contributes::indirectDiffuse:
      return "indirect_diffuse";
    case Contributes::indirectGlossy:
      return "indirect_glossy";
    case Contributes::ambientOcclusion:
      return "ambient_occlusion";
    case Contributes::scattered:
      return "scattered";
    case Contributes::final:
      return "final";
  }
  assert(false);
  return "";
}

float neutralElement(Contributes component) {
  return component == Contributes::ambientOcclusion ? 1.0f : 0.0f;
}

int channelsOf(Contributes component) {
  return component == Contributes::ambientOcclusion ? 1 : 3;
}

std::string unmetNeed(Needs needs, const SceneTraits& traits) {
  struct Need {
    Needs flag;
    bool met;
    const char* words;
  };
  // An environment and captured frames count as lights: they arrive at surfaces like any other, so leaving
  // them out would change the image.
  const bool anyLight =
      traits.directionalLights + traits.pointLights + traits.spotLights + traits.areaLights > 0 ||
      traits.emission || traits.environment || traits.captures;
  const Need all[] = {{Needs::anyLight, anyLight, "a light"},
                      {Needs::glossyMaterial, traits.glossy, "a glossy material"},
                      {Needs::environment, traits.environment, "an environment"},
                      {Needs::medium, traits.medium, "a medium"},
                      {Needs::emission, traits.emission, "an emissive material"},
                      {Needs::textures, traits.textures, "a texture"},
                      {Needs::movingGeometry, traits.movingGeometry, "moving geometry"},
                      {Needs::triangles, traits.triangles, "triangles"},
                      {Needs::particles, traits.particles, "particles"},
                      {Needs::capturedFrame, traits.captures, "a captured frame"}};
  for (const Need& need : all) {
    const bool asked = (static_cast<std::uint32_t>(needs) & static_cast<std::uint32_t>(need.flag)) != 0;
    if (asked && !need.met) return need.words;
  }
  return {};
}

// ---- ports ---------------------------------------------------------------------------------------------

PortBase::PortBase(std::string name, const PortKind& kind, std::string meaning)
    : name_(std::move(name)), meaning_(std::move(meaning)), kind_(&kind) {}

OutBase::OutBase(Pass* pass, std::string name, const PortKind& kind, Contributes contributes, Needs needs,
                 std::string meaning, Levels levels)
    : PortBase(std::move(name), kind, std::move(meaning)),
      contributes_(contributes),
      needs_(needs),
      levels_(levels) {
  pass->outputs_.push_back(this);
}

InBase::InBase(Pass* pass, std::string name, const PortKind& kind, Presence presence, std::string meaning,
               Needs needs, Expects expects)
    : PortBase(std::move(name), kind, std::move(meaning)),
      presence_(presence),
      needs_(needs),
      expects_(expects) {
  pass->inputs_.push_back(this);
}

void InBase::connect(const OutBase* source) {
  assert(source == nullptr || takes(source->kind()));
  source_ = source;
}

const PortKind& InVoxels::anyVoxels() {
  static const PortKind kind{"any voxels", "any kind of port with exported fields"};
  return kind;
}

std::vector<gpu::TextureRef> OutBase::textures() const {
  std::vector<gpu::TextureRef> result;
  const PortContents held = contents();
  for (const PortContents::Resource& resource : held.resources())
    if (resource.texture) result.push_back(resource.texture);
  return result;
}

// ---- context -------------------------------------------------------------------------------------------

void PassContext::dispatch(const shader::BoundProgram& program, const shader::BindingSet& bindings,
                           glm::ivec3 items) {
  if (items.x <= 0 || items.y <= 0 || items.z <= 0) return;
  const glm::ivec3& group = program.program->groupSize();
  shaders().dispatch(program, bindings, glm::uvec3((items + group - 1) / group));
  device().barrier();
}

void PassContext::dispatchList(const shader::BoundProgram& program, const shader::BindingSet& bindings,
                               std::uint64_t items) {
  // Work groups along an axis that OpenGL promises (4.5, table 23.72); kMostGroups of list.glsl.
  constexpr std::uint64_t kMostGroups = 65535;
  if (items == 0) return;
  const auto group = static_cast<std::uint64_t>(program.program->groupSize().x);
  const std::uint64_t groups = (items + group - 1) / group, rows = (groups + kMostGroups - 1) / kMostGroups;
  assert(rows <= kMostGroups);
  shaders().dispatch(program, bindings, glm::uvec3(std::min(groups, kMostGroups), rows, 1));
  device().barrier();
}

void PassContext::dispatchIndirect(const shader::BoundProgram& program, const shader::BindingSet& bindings,
                                   const gpu::Buffer& arguments, std::uint64_t offsetBytes) {
  shaders().dispatchIndirect(program, bindings, arguments, offsetBytes);
  device().barrier();
}

gpu::TextureRef PassContext::image(const std::string& label, gpu::Format format) {
  gpu::TextureDescription description;
  description.format = format;
  description.width = snapshot().camera.width;
  description.height = snapshot().camera.height;
  return texture(description, label);
}

gpu::TextureRef PassContext::volume(const glm::ivec3& size, gpu::Format format, const std::string& label,
                                    int levels) {
  return texture({gpu::TextureKind::d3, format, size.x, size.y, size.z, levels}, label);
}

gpu::TextureRef PassContext::emptyVolume(const glm::ivec3& size, gpu::Format format,
                                         const std::string& label) {
  gpu::TextureRef result = volume(size, format, label);
  result->clear(glm::vec4(0.0f));
  return result;
}

gpu::BufferRef PassContext::elements(const shader::StorageSlot& block, std::uint64_t count,
                                     const std::string& label) {
  assert(block.elementBytes > 0);
  return buffer(std::max<std::uint64_t>(count, 1) * block.elementBytes, label);
}

gpu::BufferRef PassContext::emptyElements(const shader::StorageSlot& block, std::uint64_t count,
                                          const std::string& label) {
  gpu::BufferRef result = elements(block, count, label);
  result->clear();
  return result;
}

const PassEntry* Technique::find(const std::string& pass) const {
  for (const PassEntry& entry : passes) {
    if (entry.name == pass) return &entry;
  }
  return nullptr;
}

}  // namespace lumivox
