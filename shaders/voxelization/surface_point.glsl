// Points of triangles as voxel fragments: shared by points.comp and the atlas passes.
#define SCENE_GEOMETRY
#define SCENE_MATERIALS
#include "common/scene.glsl"
#include "fragment_list.glsl"
#include "grid_corner.glsl"
#include "surface_texture.glsl"

// Appends the point with these barycentric coordinates of a triangle. `triangle`: in the scene's index buffer; `corners`: in voxels.
void appendPoint(int triangle, vec3 corners[3], vec3 weights) {
  vec3 posGrid = corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z;
  ivec3 voxel = ivec3(floor(posGrid));
  if (any(lessThan(voxel, ivec3(0))) || any(greaterThanEqual(voxel, resolution))) return;

  SurfaceTexture painted = surfaceTextureAt(triangle, corners, weights);
  if (painted.coverage <= 0.0) return;
  vec3 normal = vec3(0.0);
  for (int k = 0; k < 3; ++k) {
    int vertex = 3 * int(indices[3 * triangle + k]);
    normal += weights[k] * vec3(normals[vertex], normals[vertex + 1], normals[vertex + 2]);
  }
  normal = mat3(objects[objectIndex].normalToWorld) * normal;
  // Opposite normals of corners may cancel.
  float size = length(normal);
  normal = size > 0.0 ? normal / size : vec3(0.0, 1.0, 0.0);
  MaterialData material = materials[materialIndex];
  vec3 albedo = material.diffuse.rgb * painted.albedo;

  uint index = atomicAdd(fragmentCount, 1u);
  if (index >= uint(capacity)) return;
  VoxelFragment fragment;
  fragment.voxel = packVoxel(voxel);
  fragment.offset = packOffset(posGrid - vec3(voxel));
  fragment.normal = packNormal(normal);
  fragment.albedoRg = packHalves(albedo.rg);
  fragment.albedoBCoverage = packHalves(vec2(albedo.b, painted.coverage));
  fragment.emission = packEmissionOrLobe(material.emission.rgb, material.specular);
  fragments[index] = fragment;
}
