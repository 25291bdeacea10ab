// The contract of a pass: ports that register themselves, and the small helpers of its context.
#include "lumivox/pipeline/pass.h"

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
  // An environment counts as a light: it arrives at surfaces like any other, so leaving it out would change
  // the picture.
  const bool anyLight =
      traits.directionalLights + traits.pointLights + traits.spotLights + traits.areaLights > 0 ||
      traits.emission || traits.environment;
  const Need all[] = {{Needs::anyLight, anyLight, "a light"},
                      {Needs::glossyMaterial, traits.glossy, "a glossy material"},
                      {Needs::environment, traits.environment, "an environment"},
                      {Needs::medium, traits.medium, "a medium"},
                      {Needs::emission, traits.emission, "an emissive material"},
                      {Needs::textures, traits.textures, "a texture"},
                      {Needs::movingGeometry, traits.movingGeometry, "moving geometry"},
                      {Needs::triangles, traits.triangles, "triangles"},
                      {Needs::particles, traits.particles, "particles"}};
  for (const Need& need : all) {
    const bool asked = (static_cast<std::uint32_t>(needs) & static_cast<std::uint32_t>(need.flag)) != 0;
    if (asked && !need.met) return need.words;
  }
  return {};
}

// ---- ports ---------------------------------------------------------------------------------------------

PortBase::PortBase(std::string name, std::string portKind, std::string meaning)
    : name_(std::move(name)), portKind_(std::move(portKind)), meaning_(std::move(meaning)) {}

OutBase::OutBase(Pass* pass, std::string name, std::string portKind, Contributes contributes, Needs needs,
                 std::string meaning)
    : PortBase(std::move(name), std::move(portKind), std::move(meaning)),
      contributes_(contributes),
      needs_(needs) {
  pass->outputs_.push_back(this);
}

InBase::InBase(Pass* pass, std::string name, std::string portKind, Presence presence, std::string meaning,
               Needs needs)
    : PortBase(std::move(name), std::move(portKind), std::move(meaning)), presence_(presence), needs_(needs) {
  pass->inputs_.push_back(this);
}

void InBase::connect(const OutBase* source) {
  assert(source == nullptr || source->portKind() == portKind());
  source_ = source;
}

namespace {

std::vector<gpu::TextureRef> existing(std::initializer_list<gpu::TextureRef> textures) {
  std::vector<gpu::TextureRef> result;
  for (const gpu::TextureRef& texture : textures) {
    if (texture) result.push_back(texture);
  }
  return result;
}

}  // namespace

std::vector<gpu::TextureRef> texturesOf(const Image& image) {
  return existing({image.texture});
}
std::vector<gpu::TextureRef> texturesOf(const GBuffer& buffer) {
  return existing({buffer.position, buffer.normal, buffer.geometricNormal, buffer.diffuse, buffer.specular,
                   buffer.emission});
}
std::vector<gpu::TextureRef> texturesOf(const ShadowMap& map) {
  return existing({map.depth});
}
std::vector<gpu::TextureRef> texturesOf(const ReflectiveShadowMap& map) {
  return existing({map.position, map.normal, map.flux});
}
std::vector<gpu::TextureRef> texturesOf(const VoxelFragments&) {
  return {};
}
std::vector<gpu::TextureRef> texturesOf(const BinaryGrid&) {
  return {};  // bits are never unhealthy
}
std::vector<gpu::TextureRef> texturesOf(const AttributeGrid& grid) {
  return existing({grid.albedo, grid.normal, grid.emission});
}
std::vector<gpu::TextureRef> texturesOf(const OccupancyGrid& grid) {
  return existing({grid.opacity});
}
std::vector<gpu::TextureRef> texturesOf(const RadianceGrid& grid) {
  return existing({grid.radiance});
}
std::vector<gpu::TextureRef> texturesOf(const ShGrid& grid) {
  std::vector<gpu::TextureRef> result;
  for (const ShGrid::Level& level : grid.levels) {
    for (const gpu::TextureRef& channel : level.coefficients) result.push_back(channel);
  }
  return result;
}
std::vector<gpu::TextureRef> texturesOf(const Particles&) {
  return {};
}
std::vector<gpu::TextureRef> texturesOf(const ScatteringGrid& grid) {
  std::vector<gpu::TextureRef> result;
  for (const ScatteringGrid::Medium& medium : grid.media) {
    if (medium.density) result.push_back(medium.density);
  }
  return result;
}

// ---- context -------------------------------------------------------------------------------------------

void PassContext::dispatch(const shader::BoundProgram& program, shader::ShaderLibrary::Bindings bindings,
                           glm::ivec3 items, glm::ivec3 groupSize) {
  assert(groupSize.x > 0 && groupSize.y > 0 && groupSize.z > 0);
  if (items.x <= 0 || items.y <= 0 || items.z <= 0) return;
  shaders().dispatch(program, bindings, glm::uvec3((items + groupSize - 1) / groupSize));
  device().barrier();
}

gpu::TextureRef PassContext::image(gpu::Format format, const std::string& label) {
  gpu::TextureDescription description;
  description.format = format;
  description.width = snapshot().camera.width;
  description.height = snapshot().camera.height;
  return texture(description, label);
}

const PassEntry* Technique::find(const std::string& pass) const {
  for (const PassEntry& entry : passes) {
    if (entry.name == pass) return &entry;
  }
  return nullptr;
}

}  // namespace lumivox
