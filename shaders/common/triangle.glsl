// Overlap test of a triangle with the voxels of a grid. Rasterisation and compute passes share it, so that they find the same voxels.
// Coordinates are in voxels, permuted so that z is the dominant axis of the triangle's normal; a column is a row of voxels along z.
#ifndef LUMIVOX_TRIANGLE
#define LUMIVOX_TRIANGLE

// Relative rounding error of float arithmetic. A corner is accurate to this times the side of the grid, an edge to this times its length.
// Smaller distances count as touching, so that no voxel is lost.
const float kRounding = 3e-7;

vec3 permute(vec3 v, int axis) { return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v; }
vec3 unpermute(vec3 v, int axis) { return axis == 0 ? v.zxy : axis == 1 ? v.yzx : v; }
ivec3 permute(ivec3 v, int axis) { return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v; }
ivec3 unpermute(ivec3 v, int axis) { return axis == 0 ? v.zxy : axis == 1 ? v.yzx : v; }

int dominantAxisOf(vec3 a, vec3 b, vec3 c) {
  vec3 normal = abs(cross(b - a, c - a));
  return normal.x > normal.y && normal.x > normal.z ? 0 : normal.y > normal.z ? 1 : 2;
}

// Separating axes of the triangle and a voxel (Schwarz & Seidel 2010, Sec. 3.1): three of the box, the plane, nine of the edges. Deviates:
// each axis has an interval in which the voxel's centre must project, instead of one oriented half space, so that the orientation of a
// sliver does not matter.
struct Overlap {
  vec3 origin;              // corner of a voxel near the triangle: all below is relative to it, so that differences lose no precision
  ivec3 low, high;          // range of voxels inside the grid that the triangle's bounding box touches
  vec3 normal;
  vec2 plane;               // interval of normal . centre
  mat3 xyAxis, yzAxis, zxAxis;  // a column per edge: axis in x and y; z unused
  mat3 xyRange, yzRange, zxRange;  // a column per edge: interval in x and y
};

void edgeAxes(vec2 a, vec2 b, vec2 c, float halfSide, out mat3 axes, out mat3 ranges) {
  vec2 corner[3] = vec2[3](a, b, c);
  for (int i = 0; i < 3; ++i) {
    vec2 edge = corner[i == 2 ? 0 : i + 1] - corner[i];
    vec2 axis = vec2(-edge.y, edge.x);
    // Both ends of the edge project to one value.
    float onEdge = dot(axis, corner[i]), opposite = dot(axis, corner[i == 0 ? 2 : i - 1]);
    float reach = halfSide * (abs(axis.x) + abs(axis.y));
    axes[i] = vec3(axis, 0.0);
    ranges[i] = vec3(min(onEdge, opposite) - reach, max(onEdge, opposite) + reach, 0.0);
  }
}

// Overlap with the voxels from `first` on and before `end`. `side`: voxels along the longest side of the whole grid; the tolerance depends
// on it, so that every box of one grid finds the same voxels.
Overlap overlapIn(mat3 corners, ivec3 first, ivec3 end, float side) {
  vec3 least = min(corners[0], min(corners[1], corners[2])), most = max(corners[0], max(corners[1], corners[2]));
  vec3 extent = most - least;
  float tolerance = kRounding * (side + max(extent.x, max(extent.y, extent.z)));
  float halfSide = 0.5 + tolerance;
  Overlap o;
  o.origin = floor(least);
  // Clamped as floats: coordinates far outside the box overflow an integer.
  o.low = ivec3(clamp(floor(least - tolerance), vec3(first), vec3(end)));
  o.high = ivec3(clamp(floor(most + tolerance), vec3(first) - 1.0, vec3(end) - 1.0));
  vec3 a = corners[0] - o.origin, b = corners[1] - o.origin, c = corners[2] - o.origin;
  o.normal = cross(b - a, c - a);
  // The normal of a needle is the small difference of large products, so its rounding error is that of the products.
  float rounding = kRounding * length(b - a) * length(c - a) * (extent.x + extent.y + extent.z + 1.0);
  float reach = halfSide * (abs(o.normal.x) + abs(o.normal.y) + abs(o.normal.z)) + rounding;
  o.plane = dot(o.normal, a) + vec2(-reach, reach);
  edgeAxes(a.xy, b.xy, c.xy, halfSide, o.xyAxis, o.xyRange);
  edgeAxes(a.yz, b.yz, c.yz, halfSide, o.yzAxis, o.yzRange);
  edgeAxes(a.zx, b.zx, c.zx, halfSide, o.zxAxis, o.zxRange);
  return o;
}

// `size`: voxels of the grid along the permuted axes.
Overlap overlapOf(mat3 corners, ivec3 size) { return overlapIn(corners, ivec3(0), size, float(max(size.x, max(size.y, size.z)))); }

// False if a value is NaN.
bool within(mat3 axes, mat3 ranges, vec2 centre) {
  vec3 value = vec3(dot(axes[0].xy, centre), dot(axes[1].xy, centre), dot(axes[2].xy, centre));
  return value.x >= ranges[0].x && value.x <= ranges[0].y && value.y >= ranges[1].x && value.y <= ranges[1].y && value.z >= ranges[2].x &&
         value.z <= ranges[2].y;
}

bool touchesColumn(Overlap o, ivec2 column) { return within(o.xyAxis, o.xyRange, vec2(column) + 0.5 - o.origin.xy); }

// Whether the triangle touches a voxel in o.low..o.high whose column it touches.
bool touchesInColumn(Overlap o, ivec3 voxel) {
  vec3 centre = vec3(voxel) + 0.5 - o.origin;
  float height = dot(o.normal, centre);
  return height >= o.plane.x && height <= o.plane.y && within(o.yzAxis, o.yzRange, centre.yz) && within(o.zxAxis, o.zxRange, centre.zx);
}

// First and last voxel of a column between which all touched voxels lie. The plane of a needle is only rounding error: the range is then
// that of its bounding box.
ivec2 depthsOfColumn(Overlap o, mat3 corners, ivec2 column) {
  vec3 e0 = corners[1] - corners[0], e1 = corners[2] - corners[0], e2 = corners[2] - corners[1];
  float longest = max(dot(e0, e0), max(dot(e1, e1), dot(e2, e2)));
  if (!(dot(o.normal, o.normal) > kNeedle * kNeedle * longest * longest)) return ivec2(o.low.z, o.high.z);
  // Depths at which the centre of a voxel lies within the plane's interval.
  vec2 centre = vec2(column) + 0.5 - o.origin.xy;
  vec2 depth = (o.plane - dot(o.normal.xy, centre)) / o.normal.z;
  // A hundredth of a voxel more than rounding could need: touchesInColumn() decides exactly.
  vec2 range = floor(o.origin.z + vec2(min(depth.x, depth.y) - 0.51, max(depth.x, depth.y) - 0.49));
  range = clamp(range, vec2(-1.0), vec2(o.high.z + 1));
  return ivec2(max(int(range.x), o.low.z), min(int(range.y), o.high.z));
}

#endif
