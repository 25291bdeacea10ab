// Six directional grids: Crassin et al. 2011, Sec. 8.1; thesis 004, Sec. 3.1.3 and 4.2.1, Listing 4.15. The finest level may be one
// isotropic grid. A cone sees the three faces of a voxel whose normals are against it.
#include "faces.glsl"
layout(binding = 4) uniform sampler3D finestGrid;

vec2 insideStore(vec3 origin, vec3 direction) { return insideVolume(storeLow, storeExtent, origin, direction); }

float finestVoxel(vec3 at) { return storeVoxel; }

// No step skips a layer of the finer of the two levels that are read.
float longestStep(float size) { return storeLayers != 0 ? storeVoxel * exp2(floor(log2(max(size / storeVoxel, 1.0)))) : kNoLimit; }

// Listing 4.15: all faces at the point itself, filtered along all axes.
vec4 interpolated(vec3 texcoord, vec3 direction, float level) {
  vec3 weights = faceWeights(direction);
  float levelOfFaces = level - storeFirstLevelOfFaces;
  vec4 faces = vec4(0.0);
  if (levelOfFaces > -1.0)
    faces = weights.x * seenAlongX(direction, texcoord, max(levelOfFaces, 0.0)) +
            weights.y * seenAlongY(direction, texcoord, max(levelOfFaces, 0.0)) +
            weights.z * seenAlongZ(direction, texcoord, max(levelOfFaces, 0.0));
  return levelOfFaces >= 0.0 ? faces : mix(faces, textureLod(finestGrid, texcoord, 0.0), -levelOfFaces);
}

// Deviates from Listing 4.15: a step of `stride` through one level takes of each face the layer of voxels across its axis that its middle
// lies in, filtered across that axis alone, and multiplies what the faces let through. Filtered along all axes the opacity of a wall falls
// linearly to both sides, and steps through it let exp(-2 / cos) through (see the card); so no wall is missed, while an opening has the
// edges that filtering gives it. A uniform medium of opacity a lets (1-a)^lengths through either way, since the weights sum to 1.
vec4 layers(vec3 texcoord, vec3 direction, float level, float stride) {
  float levelOfFaces = level - storeFirstLevelOfFaces;
  vec3 voxels = vec3(max(ivec3(storeVoxels) >> int(level), 1));
  vec3 centre = (floor(texcoord * voxels) + 0.5) / voxels;
  vec3 atX = vec3(centre.x, texcoord.yz), atY = vec3(texcoord.x, centre.y, texcoord.z), atZ = vec3(texcoord.xy, centre.z);
  vec4 x, y, z;
  if (levelOfFaces >= 0.0) {
    x = seenAlongX(direction, atX, levelOfFaces);
    y = seenAlongY(direction, atY, levelOfFaces);
    z = seenAlongZ(direction, atZ, levelOfFaces);
  } else {
    x = textureLod(finestGrid, atX, 0.0);
    y = textureLod(finestGrid, atY, 0.0);
    z = textureLod(finestGrid, atZ, 0.0);
  }
  // Only the finest voxels tell where in the voxel a wall lies.
  return throughFaces(x, y, z, direction, texcoord * voxels, (coneApex - storeLow) / storeExtent * voxels, level == 0.0,
                      stride / (exp2(level) * storeVoxel));
}

StoreSample readStore(vec3 at, vec3 direction, float size, float stride) {
  vec3 texcoord = (at - storeLow) / storeExtent;
  float blend, level = levelOf(max(size / storeVoxel, 1.0), storeCoarsest, blend);
  if (storeLayers != 0) {
    if (blend <= 0.0) {
      vec4 value = layers(texcoord, direction, level, stride);
      return StoreSample(value, value.a);
    }
    // Where the coarser level is empty the finer one is: its voxels are what that one was made of. Most of a room is.
    vec4 coarser = layers(texcoord, direction, level + 1.0, stride);
    if (coarser.a <= 0.0) return StoreSample(vec4(0.0), 0.0);
    vec4 value = mix(layers(texcoord, direction, level, stride), coarser, blend);
    return StoreSample(value, value.a);
  }
  StoreSample result = StoreSample(interpolated(texcoord, direction, level + blend), 0.0);
  if (result.value.a > 0.0) result.opacity = opacityOfStep(result.value.a, stride, level, blend);
  return result;
}

vec4 readStoreAsPublished(vec3 at, vec3 direction, float size) {
  return interpolated((at - storeLow) / storeExtent, direction, log2(size / storeVoxel));
}
