#include "lumivox/pipeline/gpu_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "gpu/memory.h"
#include "lumivox/scene/model_animation.h"
#include "lumivox/scene/models.h"
#include "scene/octahedral_environment.h"

namespace lumivox {
namespace {

gpu::TextureDescription descriptionOf(const SurfaceTexture& source) {
  gpu::TextureDescription description;
  description.format = source.mask ? gpu::Format::r16f : gpu::Format::rgba16f;
  description.width = source.width;
  description.height = source.height;
  description.levels = gpu::fullLevelCount(source.width, source.height);
  return description;
}

/// A surface texture with all mip levels. Diffuse maps are rgba16f, because 8 bits of linear values lose dark
/// tones.
std::unique_ptr<gpu::Texture> upload(gpu::Device& device, const SurfaceTexture& source) {
  const gpu::TextureDescription description = descriptionOf(source);
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
  // OpenGL allows no buffer of zero bytes, so an empty scene has one element.
  const std::uint64_t size = std::max<std::size_t>(values.size(), 1) * sizeof(T);
  auto buffer = std::make_unique<gpu::Buffer>(device, size, label);
  if (!values.empty()) buffer->upload(std::as_bytes(std::span(values)));
  return buffer;
}

/// The same for buffers that no shader writes.
template <class T>
std::shared_ptr<const gpu::Buffer> sharedBufferOf(gpu::Device& device, const std::vector<T>& values,
                                                  const char* label) {
  return gpu::sharedResource<gpu::Buffer>(device, Hasher().add(std::uint64_t{sizeof(T)}).add(values).finish(),
                                          [&] { return bufferOf(device, values, label); });
}

std::shared_ptr<const gpu::Texture> sharedTextureOf(gpu::Device& device, const SurfaceTexture& source) {
  return gpu::sharedResource<gpu::Texture>(
      device, Hasher().add(source.mask).add(source.width).add(source.height).add(source.values).finish(),
      [&] { return upload(device, source); });
}

/// 1 x 1 texel.
std::shared_ptr<const gpu::Texture> whiteTextureOf(gpu::Device& device) {
  return gpu::sharedResource<gpu::Texture>(device, hashOf("white"), [&] {
    auto texture = std::make_unique<gpu::Texture>(device, gpu::TextureDescription{}, "white");
    texture->clear(glm::vec4(1.0f));
    return texture;
  });
}

std::vector<glm::vec4> paddedOf(const std::vector<glm::vec3>& colours) {
  std::vector<glm::vec4> values;
  values.reserve(colours.size());
  for (const glm::vec3& colour : colours) values.emplace_back(colour, 1.0f);
  return values;
}

std::shared_ptr<const gpu::Buffer> environmentLevelsOf(gpu::Device& device, const EnvironmentMap& map) {
  return gpu::sharedResource<gpu::Buffer>(
      device, Hasher().add("environment levels").add(map.hash.high).add(map.hash.low).finish(), [&] {
        const OctahedralEnvironment levels(map);
        std::vector<glm::vec4> values = paddedOf(levels.radiance());
        const std::array<std::int32_t, 4> header{levels.side(), levels.levels(), 0, 0};
        glm::vec4 first;
        std::memcpy(&first, header.data(), sizeof(first));
        values.insert(values.begin(), first);
        return bufferOf(device, values, "environment by direction");
      });
}

std::shared_ptr<const gpu::Texture> environmentTexelsOf(gpu::Device& device, const EnvironmentMap& map) {
  return gpu::sharedResource<gpu::Texture>(
      device, Hasher().add("environment texels").add(map.hash.high).add(map.hash.low).finish(), [&] {
        auto texture = std::make_unique<gpu::Texture>(
            device,
            gpu::TextureDescription{gpu::TextureKind::d2, gpu::Format::rgba32f, map.width, map.height},
            "environment texels");
        const std::vector<glm::vec4> texels = paddedOf(map.radiance);
        texture->upload(0, std::as_bytes(std::span(texels)));
        return texture;
      });
}

/// A map of one texel.
std::shared_ptr<const EnvironmentMap> constantMap(const glm::vec3& radiance) {
  auto map = std::make_shared<EnvironmentMap>();
  map->width = map->height = 1;
  map->radiance = {radiance};
  map->finish();
  return map;
}

bool deforms(const Scene& scene) {
  return std::any_of(scene.objects.begin(), scene.objects.end(),
                     [](const Object& object) { return deforms(object); });
}

}  // namespace

struct GpuScene::State {
  /// Positions and normals of deforming objects; null while no vertex moves in object space.
  std::unique_ptr<gpu::Buffer> ownPositions, ownNormals;
  std::unique_ptr<gpu::Buffer> objects;
  std::shared_ptr<const gpu::Buffer> positions, normals, texcoords, indices, materials;
  std::shared_ptr<const gpu::Texture> white;
  std::vector<std::shared_ptr<const gpu::Texture>> textures;
  std::vector<SceneDraw> draws;
  std::vector<std::uint32_t> firstVertices;  ///< of each object
  gpu::Device* device = nullptr;
  std::shared_ptr<const EnvironmentMap> environmentMap;
  std::shared_ptr<const gpu::Buffer> environmentLevels;  ///< null until it is asked for
  std::shared_ptr<const gpu::Texture> environmentTexels;
};

GpuScene::GpuScene(gpu::Device& device, const Scene& scene) : state_(new State{}) {
  State& s = *state_;
  s.device = &device;
  s.environmentMap = scene.environmentMap ? scene.environmentMap : constantMap(scene.environment);
  static_assert(sizeof(glm::vec3) == 12 && sizeof(glm::vec2) == 8);
  if (deforms(scene)) {
    s.ownPositions = bufferOf(device, scene.positions, "scene positions");
    s.ownNormals = bufferOf(device, scene.normals, "scene normals");
  } else {
    s.positions = sharedBufferOf(device, scene.positions, "scene positions");
    s.normals = sharedBufferOf(device, scene.normals, "scene normals");
  }
  s.texcoords = sharedBufferOf(device, scene.texcoords, "scene texture coordinates");
  s.indices = sharedBufferOf(device, scene.indices, "scene indices");
  std::vector<MaterialData> materials;
  for (const Material& material : scene.materials) {
    materials.push_back({glm::vec4(material.diffuse, 0.0f), glm::vec4(material.specular, material.exponent),
                         glm::vec4(material.emission, 0.0f)});
  }
  s.materials = sharedBufferOf(device, materials, "scene materials");
  s.objects = bufferOf(device, std::vector<ObjectData>(scene.objects.size()), "scene objects");
  s.white = whiteTextureOf(device);
  for (const SurfaceTexture& texture : scene.textures) s.textures.push_back(sharedTextureOf(device, texture));

  const std::vector<std::uint32_t> models = modelsOf(scene);
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    s.firstVertices.push_back(scene.objects[o].firstVertex);
    for (const Part& part : scene.objects[o].parts) {
      const Material& material = scene.materials[static_cast<std::size_t>(part.material)];
      const auto textureOf = [&](int index) {
        return index < 0 ? nullptr : s.textures[static_cast<std::size_t>(index)].get();
      };
      s.draws.push_back({static_cast<int>(o), part.material, part.firstIndex, part.indexCount,
                         textureOf(material.diffuseTexture), textureOf(material.maskTexture),
                         scene.objects[o].animated(), models[o]});
    }
  }
}

GpuScene::~GpuScene() = default;

void GpuScene::update(const SceneSnapshot& snapshot) {
  State& s = *state_;
  assert(snapshot.objects.size() == s.firstVertices.size());
  std::vector<ObjectData> objects;
  for (std::size_t o = 0; o < snapshot.objects.size(); ++o) {
    const ObjectState& state = snapshot.objects[o];
    objects.push_back({state.toWorld, glm::mat4(state.normalToWorld)});
    if (state.positions.empty()) continue;
    assert(s.ownPositions != nullptr);
    const std::uint64_t offset = std::uint64_t{s.firstVertices[o]} * sizeof(glm::vec3);
    s.ownPositions->upload(std::as_bytes(std::span(state.positions)), offset);
    s.ownNormals->upload(std::as_bytes(std::span(state.normals)), offset);
  }
  if (!objects.empty()) s.objects->upload(std::as_bytes(std::span(objects)));
}

const gpu::Buffer& GpuScene::positions() const {
  return state_->ownPositions ? *state_->ownPositions : *state_->positions;
}
const gpu::Buffer& GpuScene::normals() const {
  return state_->ownNormals ? *state_->ownNormals : *state_->normals;
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
const gpu::Buffer& GpuScene::environmentLevels() {
  State& s = *state_;
  if (!s.environmentLevels) s.environmentLevels = environmentLevelsOf(*s.device, *s.environmentMap);
  return *s.environmentLevels;
}
const gpu::Texture& GpuScene::environmentTexels() {
  State& s = *state_;
  if (!s.environmentTexels) s.environmentTexels = environmentTexelsOf(*s.device, *s.environmentMap);
  return *s.environmentTexels;
}
const std::vector<SceneDraw>& GpuScene::draws() const {
  return state_->draws;
}

}  // namespace lumivox
