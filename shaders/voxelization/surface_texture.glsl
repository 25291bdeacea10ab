// Textures and masks at points of triangles, according to the axes TEXTURES and MASKS.
// Including files first declare the scene's geometry and include grid_corner.glsl.
#include "common/textures.glsl"

struct SurfaceTexture {
  vec3 albedo;  // factor on the albedo of the material
  float coverage;
};

// Textures at the point with these barycentric coordinates; the corners are in voxels.
SurfaceTexture surfaceTextureAt(int triangle, vec3 corners[3], vec3 weights) {
  SurfaceTexture result = SurfaceTexture(vec3(1.0), 1.0);
#if TEXTURES || MASKS
  vec2 texcoord[3];
  for (int k = 0; k < 3; ++k) {
    int vertex = 2 * int(indices[3 * triangle + k]);
    texcoord[k] = vec2(texcoords[vertex], 1.0 - texcoords[vertex + 1]);
  }
  // Gradients of the texture coordinates per voxel along two perpendicular directions in the triangle's plane: they select the mip level
  // that averages over a voxel.
  vec3 e1 = corners[1] - corners[0], e2 = corners[2] - corners[0];
  float width = max(length(e1), 1e-20);
  float along = dot(e1, e2) / width, height = max(length(cross(e1, e2)) / width, 1e-20);
  vec2 gradientX = (texcoord[1] - texcoord[0]) / width;
  vec2 gradientY = (texcoord[2] - texcoord[0] - gradientX * along) / height;
  vec2 place = texcoord[0] * weights.x + texcoord[1] * weights.y + texcoord[2] * weights.z;
#endif
#if TEXTURES
  result.albedo = textureGrad(diffuseTexture, place, gradientX, gradientY).rgb;
#endif
#if MASKS
  result.coverage = textureGrad(maskTexture, place, gradientX, gradientY).r;
#endif
  return result;
}
