#version 450
// Conservative voxelization in the manner of Schwarz & Seidel 2010, Sec. 4: data-parallel over triangles, without rasterisation.
// LARGE 0: one thread per triangle. It first tests all voxels of the triangle's bounding box and records the results as bits, then writes
// the fragments, so that threads in lockstep do not diverge. A triangle with more voxels than bits is put aside, as rows of tiles.
// LARGE 1: one work group per row of tiles of 8 x 8 columns, one thread per column, so that no large triangle occupies a single thread
// (Sec. 4.3 of the paper splits by tiles as well).
#pragma lumivox axis TEXTURES 0 1
#pragma lumivox axis MASKS 0 1
#pragma lumivox axis LARGE 0 1
#define SCENE_GEOMETRY
#define SCENE_MATERIALS
#include "common/scene.glsl"
#include "fragment_list.glsl"

layout(local_size_x = 64) in;
#include "common/list.glsl"

layout(std430, binding = 6) readonly buffer Indices { uint indices[]; };
layout(std140, binding = 1) uniform Limits { int rowCapacity; };
// 1: every voxel of the column that the triangle touches; 0: only the voxel that contains the triangle at the column's centre.
layout(constant_id = 0) const int depthRange = 1;

// Triangles of one draw, for one work group: first index, number of triangles, object, material. In a uniform block, so that a group loads
// its object and material once instead of once per thread.
const int kMostBatches = 1024;  // 16 KiB, the size of a uniform block that OpenGL guarantees
layout(std140, binding = 2) uniform Batches { uvec4 batches[kMostBatches]; };
// Rows of tiles that were put aside: first index, batch, first column along y.
struct TileRow {
  uint firstIndex, batch;
  int y;
};
layout(std430, binding = 9) buffer Rows {
  uint rowCount;
  uint rowGroupsX, rowGroupsY, rowGroupsZ;  // of the dispatch over them
  TileRow rows[];
};
#include "common/corners.glsl"
#include "common/column_sample.glsl"

const int kTile = 8;
const int kBits = 64;             // largest number of voxels of a triangle for one thread

void put(uint index, ColumnSample s, ivec3 voxel, int axis) {
  if (index < uint(capacity)) fragments[index] = fragmentAt(s, voxel, axis);
}

// Appends the fragments of all touched voxels of one column.
void appendColumn(TriangleCorners t, Overlap o, MaterialData material, VoxelFragment base, ivec2 column) {
  if (!touchesColumn(o, column)) return;
  ColumnSample s = sampleColumn(t.corners, t.normals, t.texcoords, material, base, column);
  if (isHole(s)) return;
  ivec2 depths = depthsOfColumn(o, t.corners, column);
  if (depthRange == 0) depths = ivec2(max(depths.x, int(floor(s.centre.z))), min(depths.y, int(floor(s.centre.z))));
  for (int depth = depths.x; depth <= depths.y; ++depth) {
    if (touchesInColumn(o, ivec3(column, depth))) put(atomicAdd(fragmentCount, 1u), s, ivec3(column, depth), t.axis);
  }
}

#if LARGE

void main() {
  ivec2 lane = ivec2(gl_LocalInvocationID.x % uint(kTile), gl_LocalInvocationID.x / uint(kTile));
  uint count = min(rowCount, uint(rowCapacity));
  for (uint r = gl_WorkGroupID.x; r < count; r += gl_NumWorkGroups.x) {
    TileRow row = rows[r];
    uvec4 batch = batches[row.batch];
    TriangleCorners t = loadCorners(row.firstIndex, int(batch.z));
    Overlap o = overlapOf(t.corners, permute(resolution, t.axis));
    MaterialData material = materials[batch.w];
    VoxelFragment base = fragmentOf(material);
    int y = row.y + lane.y;
    if (y > o.high.y) continue;
    for (int x = o.low.x + lane.x; x <= o.high.x; x += kTile) appendColumn(t, o, material, base, ivec2(x, y));
  }
}

#else

// Bit i of a triangle is voxel low + (x, y, z), with i = (z * size.y + y) * size.x + x.
ivec3 voxelOfBit(int bit, ivec3 low, vec3 size) {
  float i = float(bit) + 0.5;
  float row = floor(i / size.x), slice = floor((row + 0.5) / size.y);
  return low + ivec3(int(i - row * size.x), int(row - slice * size.y), int(slice));
}

uvec2 touchedBits(TriangleCorners t, Overlap o, ivec3 size) {
  uvec2 bits = uvec2(0u);
  int bit = 0;
  int voxels = size.x * size.y * size.z;
  ivec3 voxel = o.low;
  for (; bit < voxels; ++bit) {
    bool touched = touchesColumn(o, voxel.xy) && touchesInColumn(o, voxel);
    if (depthRange == 0) touched = touched && voxel.z == int(floor((t.corners * barycentric(t.corners, vec2(voxel.xy) + 0.5)).z));
    uint one = touched ? 1u << (bit & 31) : 0u;
    if (bit < 32) bits.x |= one; else bits.y |= one;
    ++voxel.x;
    if (voxel.x > o.high.x) {
      voxel.x = o.low.x;
      ++voxel.y;
    }
    if (voxel.y > o.high.y) {
      voxel.y = o.low.y;
      ++voxel.z;
    }
  }
  return bits;
}

void putRowsAside(uint firstIndex, uint batch, TriangleCorners t, Overlap o, MaterialData material, VoxelFragment base) {
  int count = (o.high.y - o.low.y) / kTile + 1;
  uint first = atomicAdd(rowCount, uint(count));
  atomicMax(rowGroupsX, min(first + uint(count), kMostGroups));
  for (int i = 0; i < count; ++i) {
    int y = o.low.y + kTile * i;
    if (first + uint(i) < uint(rowCapacity)) {
      rows[first + uint(i)] = TileRow(firstIndex, batch, y);
      continue;
    }
    // No room to put the row aside: this thread does it, slowly but completely.
    for (int line = y; line < min(y + kTile, o.high.y + 1); ++line)
      for (int x = o.low.x; x <= o.high.x; ++x) appendColumn(t, o, material, base, ivec2(x, line));
  }
}

void main() {
  uint group = gl_WorkGroupID.x;
  uvec4 batch = batches[group];
  if (gl_LocalInvocationID.x >= batch.y) return;
  uint firstIndex = batch.x + 3u * gl_LocalInvocationID.x;
  TriangleCorners t = loadCorners(firstIndex, int(batch.z));
  Overlap o = overlapOf(t.corners, permute(resolution, t.axis));
  ivec3 size = o.high - o.low + 1;
  if (any(lessThan(size, ivec3(1)))) return;
  MaterialData material = materials[batch.w];
  VoxelFragment base = fragmentOf(material);
  if (size.x > kBits || size.y > kBits || size.x * size.y > kBits || size.x * size.y * size.z > kBits) {
    putRowsAside(firstIndex, group, t, o, material, base);
    return;
  }
  uvec2 bits = touchedBits(t, o, size);
#if !MASKS
  uint index = atomicAdd(fragmentCount, uint(bitCount(bits.x) + bitCount(bits.y)));
#endif
  while ((bits.x | bits.y) != 0u) {
    int bit = bits.x != 0u ? findLSB(bits.x) : 32 + findLSB(bits.y);
    if (bits.x != 0u) bits.x &= bits.x - 1u; else bits.y &= bits.y - 1u;
    ivec3 voxel = voxelOfBit(bit, o.low, vec3(size));
    ColumnSample s = sampleColumn(t.corners, t.normals, t.texcoords, material, base, voxel.xy);
#if MASKS
    if (isHole(s)) continue;
    uint index = atomicAdd(fragmentCount, 1u);
#endif
    put(index, s, voxel, t.axis);
#if !MASKS
    ++index;
#endif
  }
}

#endif
