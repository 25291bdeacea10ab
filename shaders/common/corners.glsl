// The corners of one triangle in voxels, permuted so that z is the dominant axis of its normal.
// Including files first declare the scene's geometry (common/scene.glsl), the indices, and the position of the grid (gridLow, voxelSize).
#ifndef LUMIVOX_CORNERS
#define LUMIVOX_CORNERS
#include "common/triangle.glsl"

struct TriangleCorners {
  mat3 corners, normals;  // a column per corner; normals in world space, not permuted
  vec2 texcoords[3];
  int axis;
};

TriangleCorners loadCorners(uint firstOfThree, int object) {
  TriangleCorners result;
  vec3 corner[3];
  for (int k = 0; k < 3; ++k) {
    int vertex = int(indices[firstOfThree + uint(k)]);
    vec3 local = vec3(positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]);
    corner[k] = ((objects[object].toWorld * vec4(local, 1.0)).xyz - gridLow) / voxelSize;
    vec3 normal = vec3(normals[3 * vertex], normals[3 * vertex + 1], normals[3 * vertex + 2]);
    result.normals[k] = mat3(objects[object].normalToWorld) * normal;
#if TEXTURES || MASKS
    result.texcoords[k] = vec2(texcoords[2 * vertex], 1.0 - texcoords[2 * vertex + 1]);
#else
    result.texcoords[k] = vec2(0.0);
#endif
  }
  result.axis = dominantAxisOf(corner[0], corner[1], corner[2]);
  for (int k = 0; k < 3; ++k) result.corners[k] = permute(corner[k], result.axis);
  return result;
}

#endif
