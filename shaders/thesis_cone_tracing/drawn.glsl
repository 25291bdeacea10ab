// One vertex per voxel of a volume, instead of one invocation of a compute shader. C++ side: techniques/thesis_cone_tracing/drawn.h.

// The voxel of this vertex, with x fastest; outside the volume for the vertices that complete the last triangle.
ivec3 voxelOfVertex(ivec3 size) {
  int id = gl_VertexID;
  return ivec3(id % size.x, id / size.x % size.y, id / (size.x * size.y));
}

// A position outside the clip volume.
void drawNothing() { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); }
