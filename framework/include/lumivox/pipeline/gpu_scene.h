// A scene on the device: vertex, index and material buffers, textures, and drawing. Shared by all passes;
// uploaded on first use. Read-only resources with equal bits are on a device once. GLSL side:
// shaders/common/scene.glsl.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/scene/scene.h"
#include "lumivox/shader/library.h"

namespace lumivox {

/// Mirror of MaterialData in shaders/common/scene.glsl (std430).
struct MaterialData {
  glm::vec4 diffuse;   ///< rgb albedo, w unused
  glm::vec4 specular;  ///< rgb Phong albedo, w exponent
  glm::vec4 emission;  ///< rgb radiance, w unused
};

/// Mirror of ObjectData in shaders/common/scene.glsl (std430).
struct ObjectData {
  glm::mat4 toWorld;        ///< relative to the snapshot's origin
  glm::mat4 normalToWorld;  ///< upper 3x3 used
};

/// One draw: triangles of one part of one object.
struct SceneDraw {
  int object = 0, material = 0;
  std::uint32_t firstIndex = 0, indexCount = 0;
  const gpu::Texture* diffuseTexture = nullptr;  ///< null: none
  const gpu::Texture* maskTexture = nullptr;
  bool moving = false;
  std::uint32_t model = 0;  ///< modelsOf() of scene/models.h
};

class GpuScene {
 public:
  /// The scene may go afterwards.
  GpuScene(gpu::Device& device, const Scene& scene);
  ~GpuScene();

  /// Brings transforms and deforming vertices to this snapshot.
  void update(const SceneSnapshot& snapshot);

  const gpu::Buffer& positions() const;  ///< 3 floats per vertex, object space
  const gpu::Buffer& normals() const;    ///< 3 floats per vertex
  const gpu::Buffer& texcoords() const;  ///< 2 floats per vertex
  const gpu::Buffer& indices() const;
  const gpu::Buffer& materials() const;      ///< MaterialData each
  const gpu::Buffer& objects() const;        ///< ObjectData each
  const gpu::Texture& whiteTexture() const;  ///< 1x1 white: the neutral diffuse texture and mask
  const std::vector<SceneDraw>& draws() const;
  /// Radiance of the environment by direction of the world, at several widths: block Environment of
  /// shaders/common/environment.glsl. Without a map: one texel of the constant radiance.
  const gpu::Buffer& environmentLevels();
  /// The texels of the map in latitude and longitude, rgba32f (scene/environment.h). Without a map: one
  /// texel.
  const gpu::Texture& environmentTexels();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lumivox
