// Bindings of shaders that include a file of shaders/common, as sets inside the braces of a dispatch
// or a draw beside the pass's own bindings. They go by name: each program has its own numbers.
#pragma once

#include "lumivox/pipeline/gpu_scene.h"
#include "lumivox/pipeline/pass.h"

namespace lumivox {

/// One invocation a pixel of the image.
inline glm::ivec3 pixels(const PassContext& frame) {
  return {frame.snapshot().camera.width, frame.snapshot().camera.height, 1};
}

/// The seed as shaders take it (common/random.glsl).
inline glm::uvec2 seedWords(const PassContext& frame) {
  return {static_cast<std::uint32_t>(frame.seed()), static_cast<std::uint32_t>(frame.seed() >> 32)};
}

/// The scene's geometry and materials (common/scene.glsl) for one draw. A missing texture is replaced by a
/// white one.
class SceneBinding : public shader::BindingSet {
 public:
  SceneBinding(PassContext& frame, const SceneDraw& draw);
  /// For shaders that take several draws at a time: those with these textures (null: none).
  SceneBinding(PassContext& frame, const gpu::Texture* diffuse, const gpu::Texture* mask);
  /// Values of the shader's axes TEXTURES and MASKS: 1 if the draw's material needs them, and with
  /// --keep-everything.
  int textures = 0, masks = 0;
  /// A generated Variant with those of the two that it has.
  template <class Variant>
  Variant in(Variant variant) const {
    if constexpr (requires { variant.textures; }) variant.textures = textures;
    variant.masks = masks;
    return variant;
  }
};

/// Draws one part of the scene, which is bound besides, by the variant with the axes TEXTURES and MASKS that
/// its material needs.
template <class Variant>
void drawPart(PassContext& frame, const SceneDraw& draw, const Variant& variant,
              const shader::BindingSet& bindings) {
  const SceneBinding scene(frame, draw);
  frame.shaders().drawIndexed(frame.program(scene.in(variant)), {scene, bindings}, frame.scene().indices(),
                              draw.firstIndex, draw.indexCount);
}

/// The texture of an image that may be missing; null then.
template <class ImagePort>
const gpu::TextureRef& textureOf(const ImagePort& image) {
  static const gpu::TextureRef none;
  return image ? image->texture : none;
}

/// A g-buffer: gPosition, gNormal, gGeometricNormal, gDiffuse, gSpecular, gEmission.
class GBufferBinding : public shader::BindingSet {
 public:
  explicit GBufferBinding(const GBuffer& gbuffer);
};

/// Lights and their visibility (common/lights.glsl). An input that is not present binds nothing.
class LightBinding : public shader::BindingSet {
 public:
  explicit LightBinding(const In<ShadowMap>& shadow);
  int count = 0;  ///< of lights
};

/// Reflective shadow maps (common/rsm.glsl): rsmPosition, rsmNormal, rsmFlux, the lights with their views.
class ReflectiveShadowMapBinding : public shader::BindingSet {
 public:
  explicit ReflectiveShadowMapBinding(const ReflectiveShadowMap& map);
};

/// A list of fragments and their number (common/fragments.glsl).
class FragmentBinding : public shader::BindingSet {
 public:
  explicit FragmentBinding(const VoxelFragments& list);
};

/// Binds a list, and runs one invocation for each of its fragments; a barrier follows.
void forEachFragment(PassContext& frame, const shader::BoundProgram& program,
                     const shader::BindingSet& bindings, const VoxelFragments& list);

}  // namespace lumivox
