#include "lumivox/pipeline/gpu_scene.h"

#include <fmt/format.h>

#include <cassert>

namespace lumivox {
namespace {

/// A surface texture with all mips; diffuse maps as rgba16f, since their linear values would lose the darks
/// in 8 bits.
std::unique_ptr<gpu::Texture> upload(gpu::Device& device, const SurfaceTexture& source) {
  gpu::TextureDescription description;
  description.format = source.mask ? gpu::Format::r16f : gpu::Format::rgba16f;
  description.width = source.width;
  description.height = source.height;
  description.levels = gpu::fullLevelCount(source.width, source.height);
  auto texture = std::make_unique<gpu::Texture>(device, description, source.name);
  if (source.mask) {
    texture->uploadFloats(0, source.values);
  } else {
    const std::size_t texels = source.values.size() / 3;
    std::vector<float> rgba(texels * 4, 1.0f);
    for (std::size_t i = 0; i < texels; ++i) {
      for (std::size_t c = 0; c < 3; ++c) rgba[4 * i + c] = source.values[3 * i + c];
    }
    texture->uploadFloats(0, rgba);
  }
  texture->generateLevels();
  return texture;
}

template <class T>
std::unique_ptr<gpu::Buffer> bufferOf(gpu::Device& device, const std::vector<T>& values, const char* label) {
  // A buffer of zero bytes is not allowed; one element stands in for an empty scene.
  const std::uint64_t size = std::max<std::size_t>(values.size(), 1) * sizeof(T);
  auto buffer = std::make_unique<gpu::Buffer>(device, size, label);
  if (!values.empty()) buffer->upload(std::as_bytes(std::span(values)));
  return buffer;
}

}  // namespace

struct GpuScene::State {
  gpu::Device& device;
  const Scene& scene;
  std::unique_ptr<gpu::Buffer> positions, normals, texcoords, indices, materials, objects;
  std::unique_ptr<gpu::Texture> white;
  std::vector<std::unique_ptr<gpu::Texture>> textures;
  std::vector<SceneDraw> draws;
};

GpuScene::GpuScene(gpu::Device& device, const Scene& scene)
    : state_(new State{device, scene, {}, {}, {}, {}, {}, {}, {}, {}, {}}) {
  State& s = *state_;
  static_assert(sizeof(glm::vec3) == 12 && sizeof(glm::vec2) == 8);
  s.positions = bufferOf(device, scene.positions, "scene positions");
  s.normals = bufferOf(device, scene.normals, "scene normals");
  s.texcoords = bufferOf(device, scene.texcoords, "scene texture coordinates");
  s.indices = bufferOf(device, scene.indices, "scene indices");
  std::vector<MaterialData> materials;
  for (const Material& material : scene.materials) {
    materials.push_back({glm::vec4(material.diffuse, 0.0f), glm::vec4(material.specular, material.exponent),
                         glm::vec4(material.emission, 0.0f)});
  }
  s.materials = bufferOf(device, materials, "scene materials");
  s.objects = bufferOf(device, std::vector<ObjectData>(scene.objects.size()), "scene objects");

  gpu::TextureDescription one;
  one.format = gpu::Format::rgba16f;
  s.white = std::make_unique<gpu::Texture>(device, one, "white");
  s.white->clear(glm::vec4(1.0f));
  for (const SurfaceTexture& texture : scene.textures) s.textures.push_back(upload(device, texture));

  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    for (const Part& part : scene.objects[o].parts) {
      const Material& material = scene.materials[static_cast<std::size_t>(part.material)];
      const auto textureOf = [&](int index) {
        return index < 0 ? nullptr : s.textures[static_cast<std::size_t>(index)].get();
      };
      s.draws.push_back({static_cast<int>(o), part.material, part.firstIndex, part.indexCount,
                         textureOf(material.diffuseTexture), textureOf(material.maskTexture),
                         scene.objects[o].animated()});
    }
  }
}

GpuScene::~GpuScene() = default;

void GpuScene::update(const SceneSnapshot& snapshot) {
  State& s = *state_;
  assert(snapshot.objects.size() == s.scene.objects.size());
  std::vector<ObjectData> objects;
  for (std::size_t o = 0; o < snapshot.objects.size(); ++o) {
    const ObjectState& state = snapshot.objects[o];
    objects.push_back({state.toWorld, glm::mat4(state.normalToWorld)});
    if (state.positions.empty()) continue;
    const std::uint64_t offset = std::uint64_t{s.scene.objects[o].firstVertex} * sizeof(glm::vec3);
    s.positions->upload(std::as_bytes(std::span(state.positions)), offset);
    s.normals->upload(std::as_bytes(std::span(state.normals)), offset);
  }
  if (!objects.empty()) s.objects->upload(std::as_bytes(std::span(objects)));
}

const gpu::Buffer& GpuScene::positions() const {
  return *state_->positions;
}
const gpu::Buffer& GpuScene::normals() const {
  return *state_->normals;
}
const gpu::Buffer& GpuScene::texcoords() const {
  return *state_->texcoords;
}
const gpu::Buffer& GpuScene::indices() const {
  return *state_->indices;
}
const gpu::Buffer& GpuScene::materials() const {
  return *state_->materials;
}
const gpu::Buffer& GpuScene::objects() const {
  return *state_->objects;
}
const gpu::Texture& GpuScene::whiteTexture() const {
  return *state_->white;
}
const std::vector<SceneDraw>& GpuScene::draws() const {
  return state_->draws;
}

std::uint64_t GpuScene::sizeBytes() const {
  const State& s = *state_;
  std::uint64_t total = s.white->sizeBytes();
  for (const auto* buffer : {&s.positions, &s.normals, &s.texcoords, &s.indices, &s.materials, &s.objects})
    total += (*buffer)->sizeBytes();
  for (const auto& texture : s.textures) total += texture->sizeBytes();
  return total;
}

}  // namespace lumivox
