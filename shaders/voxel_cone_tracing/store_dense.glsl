// A dense grid of isotropic voxels: Crassin et al. 2011; thesis 004, Sec. 4.2.1, Listing 4.14.
layout(binding = 4) uniform sampler3D radianceGrid;

vec2 insideStore(vec3 origin, vec3 direction) { return insideVolume(storeLow, storeExtent, origin, direction); }

float finestVoxel(vec3 at) { return storeVoxel; }

float longestStep(float size) { return kNoLimit; }

StoreSample readStore(vec3 at, vec3 direction, float size, float stride) {
  vec3 texcoord = (at - storeLow) / storeExtent;
  float blend, level = levelOf(max(size / storeVoxel, 1.0), storeCoarsest, blend);
  StoreSample result = StoreSample(textureLod(radianceGrid, texcoord, level + blend), 0.0);
  if (result.value.a > 0.0) result.opacity = opacityOfStep(result.value.a, stride, level, blend);
  return result;
}

vec4 readStoreAsPublished(vec3 at, vec3 direction, float size) {
  return textureLod(radianceGrid, (at - storeLow) / storeExtent, log2(size / storeVoxel));
}
