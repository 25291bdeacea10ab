// Six directional grids: Crassin et al. 2011, Sec. 8.1; thesis 004, Sec. 3.1.3 and 4.2.1, Listing 4.15. The finest level may be one
// isotropic grid. A cone sees the three faces of a voxel that face against its direction.
#include "../cones/faces.glsl"
layout(binding = 4) uniform sampler3D finestGrid;

vec2 insideStore(vec3 origin, vec3 direction) { return insideVolume(storeLow, storeExtent, origin, direction); }

float finestVoxel(vec3 at) { return storeVoxel; }

// Listing 4.15: all faces at the point itself, filtered along all axes.
vec4 interpolated(vec3 posWorld, vec3 direction, float level) {
  vec3 texcoord = (posWorld - storeLow) / storeExtent, weights = faceWeights(direction);
  float levelOfFaces = level - storeFirstLevelOfFaces;
  vec4 faces = vec4(0.0);
  if (levelOfFaces > -1.0)
    faces = weights.x * seenAlongX(direction, texcoord, max(levelOfFaces, 0.0)) +
            weights.y * seenAlongY(direction, texcoord, max(levelOfFaces, 0.0)) +
            weights.z * seenAlongZ(direction, texcoord, max(levelOfFaces, 0.0));
  return levelOfFaces >= 0.0 ? faces : mix(faces, textureLod(finestGrid, texcoord, 0.0), -levelOfFaces);
}

vec4 layers(vec3 posWorld, vec3 direction, float level, float stride) {
  vec3 texcoord = (posWorld - storeLow) / storeExtent;
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
  // Only for the finest voxels is the wall assumed in the middle of its layer.
  return throughFaces(x, y, z, direction, texcoord * voxels, (coneApex - storeLow) / storeExtent * voxels, level == 0.0,
                      stride / (exp2(level) * storeVoxel));
}

#include "../cones/read_faces.glsl"
