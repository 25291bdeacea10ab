// A vertex for each voxel of a volume, in place of an invocation of a compute shader. C++ side: techniques/thesis_cone_tracing/drawn.h.

// Numbered along x first; beyond the volume for the last vertices, which fill up a triangle.
ivec3 voxelOfVertex(ivec3 size) {
  int id = gl_VertexID;
  return ivec3(id % size.x, id / size.x % size.y, id / (size.x * size.y));
}

// Nothing is seen of it.
void drawNothing() { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); }
