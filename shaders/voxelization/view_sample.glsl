// The fragment of a rasterized pixel, without its position. Gradients are those of the pixel, which is one voxel wide.
#define SCENE_MATERIALS
#include "common/scene.glsl"
#include "common/voxel.glsl"
#include "view_axis.glsl"

layout(location = 0) in vec3 posView;
layout(location = 1) in vec3 normalWorld;
#if TEXTURES || MASKS
layout(location = 2) in vec2 texcoord;
#endif
#include "common/textures.glsl"

VoxelFragment sampleView() {
  MaterialData material = materials[materialIndex];
  vec3 albedo = material.diffuse.rgb;
  float coverage = 1.0;
#if TEXTURES
  albedo *= texture(diffuseTexture, texcoord).rgb;
#endif
#if MASKS
  coverage = texture(maskTexture, texcoord).r;
#endif
  VoxelFragment fragment;
  fragment.voxel = fragment.offset = 0u;
  fragment.normal = packNormal(dot(normalWorld, normalWorld) > 0.0 ? normalize(normalWorld) : vec3(0.0, 1.0, 0.0));
  fragment.albedoRg = packHalves(albedo.rg);
  fragment.albedoBCoverage = packHalves(vec2(albedo.b, coverage));
  fragment.emission = packEmissionOrLobe(material.emission.rgb, material.specular);
  return fragment;
}
