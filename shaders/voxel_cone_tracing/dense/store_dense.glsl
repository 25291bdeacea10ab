// A dense grid of isotropic voxels: Crassin et al. 2011; thesis 004, Sec. 4.2.1, Listing 4.14.
layout(binding = 4) uniform sampler3D radianceGrid;

vec2 insideStore(vec3 origin, vec3 direction) { return insideVolume(storeLow, storeExtent, origin, direction); }

float finestVoxel(vec3 at) { return storeVoxel; }

float longestStep(float size) { return kNoLimit; }

bool readsLayers() { return false; }

#ifdef LOBES
#if LOBES
// Lobes of the normals of lit surfaces: thesis 004, Sec. 3.1.2 and its part on indirect illumination. C++ side: NormalLobes.
layout(binding = 12) uniform sampler3D lobeGrid;
layout(constant_id = 4) const int publishedLobes = 0;

// The cumulative normal distribution at x standard deviations (Page 1977), accurate to 3e-4.
float belowNormal(float x) { return 0.5 + 0.5 * tanh(clamp(0.79788456 * (x + 0.044715 * x * x * x), -20.0, 20.0)); }

// Factor on the light of voxels seen along a direction. The normals of the lit sides form a Gaussian lobe around their mean D, with the
// variance (1 - |D|) / |D|. The directions of the cone form a lobe whose standard deviation is the sine of its half angle (as printed the
// cosine, by which the narrowest cones would be the widest). The factor is the share of the convolution of both lobes that faces the cone,
// divided by the larger of the shares of the two sides. So the bright side keeps its radiance, the other side gets the share that the
// spread leaves it, and a voxel lit from all sides has the factor 1.
float facingShare(vec3 texcoord, vec3 direction, float level) {
  vec4 lobe = textureLod(lobeGrid, texcoord, level);
  float size = length(lobe.xyz);
  if (size <= 0.0) return 1.0;
  float share = min(size / lobe.w, 1.0);
  float spread = publishedLobes != 0 ? 1.0 / (1.0 + coneTangent * coneTangent)
                                     : coneTangent * coneTangent / (1.0 + coneTangent * coneTangent);
  float x = -dot(lobe.xyz, direction) / size * inversesqrt(max((1.0 - share) / share + spread, 1e-6));
  return belowNormal(x) / belowNormal(abs(x));
}
#endif
#endif

StoreSample readStore(vec3 at, vec3 direction, float size, float stride) {
  vec3 texcoord = (at - storeLow) / storeExtent;
  float blend, level = levelOf(max(size / storeVoxel, 1.0), storeCoarsest, blend);
  StoreSample result = StoreSample(textureLod(radianceGrid, texcoord, level + blend), 0.0);
  if (result.value.a <= 0.0) return result;
  result.opacity = opacityOfStep(result.value.a, stride, level, blend);
#ifdef LOBES
#if LOBES
  result.value.rgb *= facingShare(texcoord, direction, level + blend);
#endif
#endif
  return result;
}
