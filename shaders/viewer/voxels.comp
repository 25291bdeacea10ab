#version 450
// A camera's view of the voxels of a grid. Cubes: the first voxel on a pixel's ray that holds anything, with its value; voxels on the way
// are found exactly (Amanatides & Woo 1987, "A fast voxel traversal algorithm for ray tracing"). Lobes: in each voxel the surface
// |p| = s max(0, f(p / |p|)) around its centre, f the luminance of its spherical harmonics and s such that the lobe reaches the nearest
// side of the voxel; its value is that of the harmonics in the direction of the point, channel by channel.
#pragma lumivox axis SHAPE cubes lobes
#pragma lumivox axis SOURCE texels bits
#pragma lumivox require SHAPE == cubes || SOURCE == texels
#include "common/spherical_harmonics.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Parameters {
  vec3 gridLow;        // m
  float unit;          // that the number 1 stands for
  vec3 voxelSize;      // m
  int level;           // of the textures
  ivec3 resolution;
  float above;         // voxels whose values are all at most this far from 0 are not drawn
  vec3 eye;            // m
  float pixelAngle;    // rad, in the middle of the image
  vec3 corner;         // direction through the upper left corner of the image
  int channels;        // of a value: 1 or 3
  vec3 right;          // from one pixel's direction to the next
  vec3 down;
  ivec3 textureOf;     // of each channel: texture and component
  ivec3 componentOf;
};
#if SOURCE == SOURCE_BITS
layout(binding = 0) uniform usampler2DArray stacks;
const int kStack = 128;  // voxels in a texel: BinaryGrid
#else
layout(binding = 1) uniform sampler3D first;
layout(binding = 2) uniform sampler3D second;
layout(binding = 3) uniform sampler3D third;
#endif
layout(binding = 0, rgba32f) uniform writeonly image2D values;  // w: brightness of the face, 0 where no voxel is seen

#if SOURCE == SOURCE_TEXELS
vec4 texelOf(int which, ivec3 voxel) {
  if (which == 0) return texelFetch(first, voxel, level);
  if (which == 1) return texelFetch(second, voxel, level);
  return texelFetch(third, voxel, level);
}
#endif

vec3 valueOf(ivec3 voxel) {
#if SOURCE == SOURCE_BITS
  uvec4 words = texelFetch(stacks, ivec3(voxel.xy, voxel.z / kStack), level);
  int inside = voxel.z % kStack;
  return vec3(words[inside / 32] >> uint(inside % 32) & 1u);
#else
  vec3 value = vec3(texelOf(textureOf.x, voxel)[componentOf.x]);
  if (channels == 3) {
    value.y = texelOf(textureOf.y, voxel)[componentOf.y];
    value.z = texelOf(textureOf.z, voxel)[componentOf.z];
  }
  return value * unit;
#endif
}

#if SHAPE == SHAPE_LOBES
const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);  // Rec. 709
const int kSteps = 32, kHalvings = 12;

// From `from` to `to` along the ray in the voxel, whether the lobe is met; then value and brightness of the first point.
bool meetsLobe(ivec3 voxel, vec3 direction, float from, float to, out vec4 seen) {
  seen = vec4(0.0);
  vec4 harmonics[3];
  vec4 shape = vec4(0.0);
  for (int c = 0; c < 3; ++c) {
    harmonics[c] = texelOf(textureOf[c], voxel) * unit;
    shape += kLuminance[c] * harmonics[c];
  }
  float mean = kY0 * shape.x;
  vec3 slope = kY1 * shape.wyz;
  float most = mean + length(slope);
  if (!(most > above)) return false;
  float reach = 0.5 * min(voxelSize.x, min(voxelSize.y, voxelSize.z)), scale = reach / most;
  // The sphere around the lobe.
  vec3 offset = eye - (gridLow + (vec3(voxel) + 0.5) * voxelSize);
  float along = -dot(offset, direction), apart = dot(offset, offset) - along * along;
  if (apart >= reach * reach) return false;
  float chord = sqrt(reach * reach - apart);
  from = max(from, along - chord);
  to = min(to, along + chord);
  if (from >= to) return false;
  // Inside: |p|^2 below scale (mean |p| + slope . p).
  float before = from, at = from;
  bool met = false;
  for (int i = 0; i <= kSteps && !met; ++i) {
    before = at;
    at = mix(from, to, float(i) / float(kSteps));
    vec3 p = offset + at * direction;
    met = dot(p, p) <= scale * (mean * length(p) + dot(slope, p));
  }
  if (!met) return false;
  for (int i = 0; i < kHalvings; ++i) {
    float middle = 0.5 * (before + at);
    vec3 p = offset + middle * direction;
    if (dot(p, p) <= scale * (mean * length(p) + dot(slope, p))) at = middle;
    else before = middle;
  }
  vec3 p = offset + at * direction;
  float distance = max(length(p), 1e-20);
  vec4 basis = shBasis(p / distance);
  vec3 normal = 2.0 * p - scale * (mean * p / distance + slope);
  seen.rgb = vec3(dot(harmonics[0], basis), dot(harmonics[1], basis), dot(harmonics[2], basis));
  seen.a = 0.4 + 0.6 * clamp(-dot(normal, direction) / max(length(normal), 1e-20), 0.0, 1.0);
  return true;
}
#endif

// Sides of cubes differ, so that they are told apart; edges of those that are large enough are dark.
float brightnessOf(int axis, vec3 inside, float distance) {
  const vec3 kSides = vec3(0.8, 1.0, 0.62);
  float brightness = kSides[axis];
  vec3 edge = min(inside, 1.0 - inside) * voxelSize;
  edge[axis] = 1e30;
  float pixel = pixelAngle * distance, smallest = min(voxelSize.x, min(voxelSize.y, voxelSize.z));
  if (smallest > 4.0 * pixel && min(edge.x, min(edge.y, edge.z)) < max(0.02 * smallest, 0.5 * pixel)) brightness *= 0.4;
  return brightness;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(values)))) return;
  vec4 seen = vec4(0.0);
  vec3 direction = normalize(corner + (float(pixel.x) + 0.5) * right + (float(pixel.y) + 0.5) * down);
  // In voxels; no component is 0, so that every plane is met somewhere.
  vec3 start = (eye - gridLow) / voxelSize, way = direction / voxelSize;
  for (int axis = 0; axis < 3; ++axis)
    if (abs(way[axis]) < 1e-9) way[axis] = way[axis] < 0.0 ? -1e-9 : 1e-9;
  vec3 towardsLow = -start / way, towardsHigh = (vec3(resolution) - start) / way;
  vec3 near = min(towardsLow, towardsHigh), far = max(towardsLow, towardsHigh);
  float enter = max(near.x, max(near.y, near.z)), leave = min(far.x, min(far.y, far.z));
  if (leave > max(enter, 0.0)) {
    int axis = near.x >= near.y && near.x >= near.z ? 0 : near.y >= near.z ? 1 : 2;
    float now = max(enter, 0.0);
    bool aroundEye = enter <= 0.0;  // the voxel in which the eye is hides nothing
    ivec3 voxel = clamp(ivec3(floor(start + now * way)), ivec3(0), resolution - 1);
    ivec3 stride = ivec3(sign(way));
    vec3 next = (vec3(voxel) + vec3(greaterThan(way, vec3(0.0))) - start) / way, apart = abs(1.0 / way);
    for (int left = resolution.x + resolution.y + resolution.z; left > 0; --left) {
      float end = min(next.x, min(next.y, next.z));
#if SHAPE == SHAPE_LOBES
      if (!aroundEye && meetsLobe(voxel, direction, now, end, seen)) break;
#else
      vec3 value = valueOf(voxel);
      // What is no number is drawn as well.
      if (!aroundEye && !all(lessThanEqual(abs(value), vec3(above)))) {
        seen = vec4(value, brightnessOf(axis, start + now * way - vec3(voxel), now));
        break;
      }
#endif
      aroundEye = false;
      axis = next.x <= next.y && next.x <= next.z ? 0 : next.y <= next.z ? 1 : 2;
      now = end;
      voxel[axis] += stride[axis];
      next[axis] += apart[axis];
      if (voxel[axis] < 0 || voxel[axis] >= resolution[axis]) break;
    }
  }
  imageStore(values, pixel, seen);
}
