#version 450
// The voxels of a list as cubes, seen by the camera: a line of sight walks through the grid voxel by voxel (Amanatides & Woo 1987).
layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Parameters {
  vec3 eyeGrid;  // voxels
  float pixelWidth;  // at distance 1
  vec3 right;
  float imageWidth;  // pixels
  vec3 up;
  float imageHeight;
  vec3 forward;
  float cut;  // voxels: what lies nearer to the camera's plane is not seen
  ivec3 resolution;
};
layout(binding = 0, r32ui) uniform readonly uimage3D words;
layout(binding = 1, rgba32f) uniform writeonly image2D image;

const vec3 kNoVoxel = vec3(0.02);
// Sides across x, y and z have a brightness each, and so has what the cut lays open.
const float kBrightness[4] = float[4](0.35, 0.75, 0.52, 0.95);
const int kCutOpen = 3;

// `pixel`: its width there, in voxels. Edges are drawn darker, so that cubes can be told apart, where they are wide enough.
vec3 shaded(int side, vec3 position, float pixel) {
  vec3 toEdge = min(fract(position), 1.0 - fract(position));
  if (side != kCutOpen) toEdge[side] = 0.5;
  float nearest = min(toEdge.x, min(toEdge.y, toEdge.z));
  float line = side != kCutOpen && nearest < max(0.03, 0.6 * pixel) ? clamp(1.0 - 4.0 * pixel, 0.0, 1.0) : 0.0;
  return vec3(kBrightness[side] * (1.0 - 0.65 * line));
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(image)))) return;
  vec2 centre = vec2(pixel) + 0.5 - 0.5 * vec2(imageWidth, imageHeight);
  vec3 direction = normalize(forward + pixelWidth * (centre.x * right - centre.y * up));
  // A component of zero would divide by zero.
  direction = mix(direction, vec3(1e-6), lessThan(abs(direction), vec3(1e-6)));
  vec3 low = -eyeGrid / direction, high = (vec3(resolution) - eyeGrid) / direction;
  vec3 enter = min(low, high), leave = max(low, high);
  float cutAt = cut / dot(direction, forward);
  float start = max(max(enter.x, max(enter.y, enter.z)), cutAt), end = min(leave.x, min(leave.y, leave.z));
  vec3 colour = kNoVoxel;
  int side = enter.x >= start ? 0 : enter.y >= start ? 1 : enter.z >= start ? 2 : kCutOpen;
  ivec3 way = ivec3(sign(direction));
  ivec3 cell = clamp(ivec3(floor(eyeGrid + direction * start)), ivec3(0), resolution - 1);
  vec3 next = (vec3(cell + max(way, 0)) - eyeGrid) / direction, across = abs(1.0 / direction);
  float at = start;
  while (start < end && all(greaterThanEqual(cell, ivec3(0))) && all(lessThan(cell, resolution))) {
    if ((imageLoad(words, ivec3(cell.xy, cell.z >> 5)).r >> (cell.z & 31) & 1u) != 0u) {
      colour = shaded(side, eyeGrid + direction * at, at * pixelWidth);
      break;
    }
    side = next.x <= next.y && next.x <= next.z ? 0 : next.y <= next.z ? 1 : 2;
    at = next[side];
    next[side] += across[side];
    cell[side] += way[side];
  }
  imageStore(image, pixel, vec4(colour, 1.0));
}
