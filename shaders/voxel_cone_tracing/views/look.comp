#version 450
// Ray and cone casting of voxels that emit and absorb: thesis 004 Sec. 2.3, Fig. 14 and 57.
#include "common/cones.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const int kNearest = 0, kTrilinear = 1;
layout(constant_id = 0) const int filterRule = kNearest;
layout(constant_id = 1) const int castsCones = 0;
layout(constant_id = 2) const int shadesFaces = 0;

layout(std140, binding = 0) uniform Look {
  vec3 eyeWorld;
  float stepShare;   // step as a share of a voxel, or of a cone's voxels
  vec3 corner;       // direction through the upper left corner of the image, 1 along the view axis
  float coneWidth;   // diameter of the cone of a pixel at a depth of 1 m
  vec3 perColumn;
  float gain;        // of what is emitted
  vec3 perRow;
  float coarsest;    // level
  vec3 low;          // corner of voxel (0,0,0), m
  float voxelSize;   // m, of the shortest side
  vec3 voxelSides;   // m
  vec3 background;
};
layout(binding = 0) uniform sampler3D classified;
layout(binding = 0, rgba32f) uniform writeonly image2D radianceImage;

// A length of a voxel, seen in front of what comes behind it.
void pass(inout vec4 seen, vec4 value, float lengths, float shade) {
  if (value.a <= 0.0) {
    // What does not absorb emits by its length.
    seen.rgb += (1.0 - seen.a) * shade * lengths * value.rgb;
    return;
  }
  float opacity = stepOpacityOf(max(1.0 - value.a, 0.0), lengths);
  seen += (1.0 - seen.a) * vec4(shade * opacity / value.a * value.rgb, opacity);
}

// Voxel by voxel, each by the length of the ray in it.
vec4 throughCells(vec3 direction, vec2 inside) {
  ivec3 size = textureSize(classified, 0);
  vec3 slope = mix(direction, vec3(1e-12), lessThan(abs(direction), vec3(1e-12)));
  vec3 at = (eyeWorld + direction * inside.x - low) / voxelSides;
  ivec3 cell = clamp(ivec3(floor(at)), ivec3(0), size - 1), turn = ivec3(sign(slope));
  vec3 perCell = abs(voxelSides / slope);
  vec3 next = inside.x + (mix(vec3(cell) - at, vec3(cell) + 1.0 - at, greaterThan(slope, vec3(0.0)))) * voxelSides / slope;
  float distance = inside.x;
  // The face by which the box is entered: the one whose plane the point lies nearest to.
  vec3 toFace = min(abs(at), abs(vec3(size) - at));
  int face = toFace.x <= toFace.y && toFace.x <= toFace.z ? 0 : toFace.y <= toFace.z ? 1 : 2;
  vec4 seen = vec4(0.0);
  int most = size.x + size.y + size.z;
  for (int i = 0; i < most && distance < inside.y && seen.a < kOpaque; ++i) {
    int axis = next.x <= next.y && next.x <= next.z ? 0 : next.y <= next.z ? 1 : 2;
    float end = min(next[axis], inside.y);
    const vec3 kShades = vec3(0.8, 1.0, 0.65);
    if (end > distance) pass(seen, texelFetch(classified, cell, 0), (end - distance) / voxelSize, shadesFaces != 0 ? kShades[face] : 1.0);
    distance = max(distance, end);
    cell[axis] += turn[axis];
    next[axis] += perCell[axis];
    face = axis;
    if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, size))) break;
  }
  return seen;
}

vec4 march(vec3 direction, float depthPerMetre, vec2 inside) {
  vec3 extent = voxelSides * vec3(textureSize(classified, 0));
  vec4 seen = vec4(0.0);
  float distance = inside.x;
  while (distance < inside.y && seen.a < kOpaque) {
    float size = castsCones != 0 ? max(coneWidth * depthPerMetre * distance / voxelSize, 1.0) : 1.0, blend;
    float level = levelOf(size, coarsest, blend);
    float stride = min(stepShare * size * voxelSize, inside.y - distance);
    vec3 texcoord = (eyeWorld + direction * (distance + 0.5 * stride) - low) / extent;
    // The mean of opacities of the finest voxels' length stays one of that length.
    vec4 value;
    if (filterRule == kNearest) {
      ivec3 voxels = textureSize(classified, int(level));
      value = texelFetch(classified, clamp(ivec3(texcoord * vec3(voxels)), ivec3(0), voxels - 1), int(level));
    } else {
      value = textureLod(classified, texcoord, level + blend);
    }
    pass(seen, value, stride / voxelSize, 1.0);
    distance += stride;
  }
  return seen;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(radianceImage)))) return;
  vec3 direction = corner + (float(pixel.x) + 0.5) * perColumn + (float(pixel.y) + 0.5) * perRow;
  float size = length(direction);
  direction /= size;
  vec2 inside = insideVolume(low, voxelSides * vec3(textureSize(classified, 0)), eyeWorld, direction);
  inside.x = max(inside.x, 0.0);
  vec4 seen = vec4(0.0);
  if (inside.x < inside.y)
    seen = filterRule == kNearest && castsCones == 0 ? throughCells(direction, inside) : march(direction, 1.0 / size, inside);
  imageStore(radianceImage, pixel, vec4(gain * seen.rgb + (1.0 - seen.a) * background, 1.0));
}
