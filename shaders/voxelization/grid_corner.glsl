// Corners of triangles, in voxels. Including files first declare the scene's geometry and the grid (gridLow, voxelSize).
layout(std430, binding = 6) readonly buffer Indices { uint indices[]; };

// Corner `k` of a triangle of the scene's index buffer.
vec3 cornerInGrid(int triangle, int k) {
  int vertex = 3 * int(indices[3 * triangle + k]);
  vec3 local = vec3(positions[vertex], positions[vertex + 1], positions[vertex + 2]);
  return ((objects[objectIndex].toWorld * vec4(local, 1.0)).xyz - gridLow) / voxelSize;
}
