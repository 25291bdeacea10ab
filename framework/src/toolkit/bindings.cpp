#include "lumivox/toolkit/bindings.h"

namespace lumivox {

using gpu::Sampling;
using shader::SampledSlot;
using shader::StorageSlot;

namespace {

/// Block Draw of common/scene.glsl.
struct alignas(16) DrawBlock {
  std::int32_t object = 0, material = 0;
};

}  // namespace

SceneBinding::SceneBinding(PassContext& frame, const gpu::Texture* diffuse, const gpu::Texture* mask)
    : textures(frame.keepsEverything() || diffuse != nullptr),
      masks(frame.keepsEverything() || mask != nullptr) {
  GpuScene& scene = frame.scene();
  add(StorageSlot{"Positions"}(scene.positions()));
  add(StorageSlot{"Normals"}(scene.normals()));
  add(StorageSlot{"Texcoords"}(scene.texcoords()));
  add(StorageSlot{"Objects"}(scene.objects()));
  add(StorageSlot{"Materials"}(scene.materials()));
  add(StorageSlot{"Indices"}(scene.indices()));
  const gpu::Texture& white = scene.whiteTexture();
  add(SampledSlot{"diffuseTexture"}(diffuse != nullptr ? *diffuse : white, Sampling::linearMipsRepeat));
  add(SampledSlot{"maskTexture"}(mask != nullptr ? *mask : white, Sampling::linearMipsRepeat));
}

SceneBinding::SceneBinding(PassContext& frame, const SceneDraw& draw)
    : SceneBinding(frame, draw.diffuseTexture, draw.maskTexture) {
  add(shader::UniformSlot<DrawBlock>{"Draw"}({draw.object, draw.material}));
}

GBufferBinding::GBufferBinding(const GBuffer& gbuffer)
    : BindingSet{SampledSlot{"gPosition"}(gbuffer.position, Sampling::nearest),
                 SampledSlot{"gNormal"}(gbuffer.normal, Sampling::nearest),
                 SampledSlot{"gGeometricNormal"}(gbuffer.geometricNormal, Sampling::nearest),
                 SampledSlot{"gDiffuse"}(gbuffer.diffuse, Sampling::nearest),
                 SampledSlot{"gSpecular"}(gbuffer.specular, Sampling::nearest),
                 SampledSlot{"gEmission"}(gbuffer.emission, Sampling::nearest)} {}

LightBinding::LightBinding(const In<ShadowMap>& shadow) {
  if (!shadow.present()) return;
  count = shadow->lightCount;
  add(StorageSlot{"Lights"}(shadow->lights));
  add(StorageSlot{"Views"}(shadow->views));
  add(SampledSlot{"shadowDepth"}(shadow->depth, Sampling::shadow));
}

ReflectiveShadowMapBinding::ReflectiveShadowMapBinding(const ReflectiveShadowMap& map)
    : BindingSet{StorageSlot{"Lights"}(map.lights), StorageSlot{"Views"}(map.views),
                 SampledSlot{"rsmPosition"}(map.position, Sampling::nearest),
                 SampledSlot{"rsmNormal"}(map.normal, Sampling::nearest),
                 SampledSlot{"rsmFlux"}(map.flux, Sampling::nearest)} {}

FragmentBinding::FragmentBinding(const VoxelFragments& list)
    : BindingSet{StorageSlot{"FragmentCount"}(list.count), StorageSlot{"Fragments"}(list.fragments)} {}

void forEachFragment(PassContext& frame, const shader::BoundProgram& program,
                     const shader::BindingSet& bindings, const VoxelFragments& list) {
  frame.dispatchIndirect(program, {bindings, FragmentBinding(list)}, *list.count,
                         VoxelFragments::kArgumentsBytes);
}

}  // namespace lumivox
