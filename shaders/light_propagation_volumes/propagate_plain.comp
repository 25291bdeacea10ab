#version 450
// The same iteration in the structure of thesis 004 Listing 4.32: it loops over every face of every neighbour, computes direction, solid
// angle and harmonics on the fly, and visits every cell. It is the reference for propagate.comp, and has the published transfer.
// OCCLUSION normals: the lobe of the normal in a cell that is closest to the light's direction occludes the cell's light (Listing 4.33).
#pragma lumivox axis OCCLUSION faces normals
#include "propagation.glsl"
#if OCCLUSION == OCCLUSION_NORMALS
#include "packed_voxels.glsl"
layout(std430, binding = 3) readonly buffer Words { PackedVoxel words[]; };
#endif

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

// 1: the transfer of Listing 4.32. The solid angles are divided by 4 pi (printed: 0.0318842778 and 0.0336955972), and the flux is added as
// a clamped cosine that is not divided by pi: a quarter of the light that leaves arrives. Negative flux is dropped, and a cell also keeps
// its light, so that every iteration multiplies the sum by 5/4, and adds the dropped flux.
layout(constant_id = 1) const int publishedTransfer = 0;

const ivec3 kOffsets[6] =
    ivec3[6](ivec3(1, 0, 0), ivec3(-1, 0, 0), ivec3(0, 1, 0), ivec3(0, -1, 0), ivec3(0, 0, 1), ivec3(0, 0, -1));

#if OCCLUSION == OCCLUSION_NORMALS
// Coefficients of the occlusion of light that leaves a cell in a direction; 0 if the cell has no surface.
vec4 occlusionOf(ivec3 cell, vec3 direction) {
  int voxel = (cell.z * resolution.y + cell.y) * resolution.x + cell.x;
  if (words[voxel].albedo == 0u) return vec4(0.0);
  return shClampedCosine(closestNormal(uvec4(words[voxel].directions[0], words[voxel].directions[1], words[voxel].directions[2], words[voxel].directions[3]), direction));
}
#endif

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(cell, resolution))) return;
  vec4 sums[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
  if (publishedTransfer != 0) sums = vec4[3](texelFetch(red, cell, 0), texelFetch(green, cell, 0), texelFetch(blue, cell, 0));
  for (int n = 0; n < 6; ++n) {
    ivec3 source = cell + kOffsets[n];
    bool outside = any(lessThan(source, ivec3(0))) || any(greaterThanEqual(source, resolution));
    if (outside && mirrors == 0) continue;
    ivec3 read = outside ? cell : source;
    vec4 light[3] = vec4[3](texelFetch(red, read, 0), texelFetch(green, read, 0), texelFetch(blue, read, 0));
#if OCCLUSION == OCCLUSION_NORMALS
    vec4 occluding = outside ? vec4(0.0) : occlusionOf(source, -vec3(kOffsets[n]));
#else
    float open = outside ? 1.0 : openShare(texelFetch(occluded, max(cell, source), 0)[n >> 1]);
#endif
    for (int f = 0; f < 6; ++f) {
      // From the centre of the neighbour to the centre of a face of this cell.
      vec3 direction = 0.5 * vec3(kOffsets[f]) - vec3(kOffsets[n]);
      float distance = length(direction);
      direction /= distance;
      float solidAngle = distance < 0.75 ? 0.0 : distance > 1.25 ? kFarFace : kSideFace;  // the shared face gets no light
      vec4 basis = shBasis(direction);
      vec4 lobe = cosineLobe != 0 ? shClampedCosine(vec3(kOffsets[f])) / kPi : basis;
      if (publishedTransfer != 0) {
        solidAngle /= 4.0 * kPi;
        lobe = shClampedCosine(vec3(kOffsets[f]));
      }
#if OCCLUSION == OCCLUSION_NORMALS
      float open = openShare(dot(occluding, basis));
#endif
      for (int channel = 0; channel < 3; ++channel) {
        vec4 coefficients = light[channel];
        if (outside) coefficients.yzw *= 1.0 - 2.0 * abs(vec3(kOffsets[n].yzx));
        float flux = dot(coefficients, basis) * solidAngle * amplifier * open;
        if (publishedTransfer != 0) flux = max(0.0, flux);
        sums[channel] += lobe * flux;
      }
    }
  }
  store(cell, sums[0], sums[1], sums[2]);
}
