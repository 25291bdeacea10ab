#version 450
// Dong et al. 2007, Sec. 4.3, for glossy elements: outgoing radiance of leaves in the bins of a cube, reflected by the Phong lobe. OF
// links: light over the links (with ENVIRONMENT also in bins without a link). OF lights: light of the lights, by their shadow maps.
#pragma lumivox axis OF links lights
#pragma lumivox axis ENVIRONMENT 0 1
#pragma lumivox axis OUTGOING 0 1
#pragma lumivox require OF == links || (!ENVIRONMENT && !OUTGOING)
#include "nodes.glsl"
#include "common/brdf.glsl"
#if OF == OF_LINKS
#include "sent.glsl"
#else
#define SHADOW_VIEWS
#include "common/lights.glsl"
#include "common/two_sided_light.glsl"
#include "leaf_points.glsl"
#endif
#if ENVIRONMENT
#include "environment_of_bin.glsl"
#endif
#if !OUTGOING
#include "../links/direction_bins.glsl"
#endif

// Each invocation of a group handles one outgoing direction of the same leaf; the group loads the arriving light together.
layout(local_size_x = 32) in;
#include "common/list.glsl"
const uint kTogether = 32u;

layout(constant_id = 0) const bool adds = false;       // adds to the values of the image
layout(constant_id = 1) const bool sums = false;       // another image holds the sum over bounces
layout(constant_id = 2) const bool addsToSum = false;  // false: begins it
layout(constant_id = 3) const int samplesPerSide = 1;  // points of an element at which lights are evaluated

layout(std140, binding = 1) uniform Reflection {
  vec3 environment;       // W/(sr m^2)
  int glossyLeaves;       // number of leaf rows, which come first
  int side;               // bins along a side of a face of the cube
  int arrivals;               // number of bins, or of lights
  float largestExponent;  // limit of exponents, that of the lobes that bins resolve
};
layout(std430, binding = 3) readonly buffer OutgoingNodes { uint outgoingNodes[]; };  // of rows
layout(binding = 3) uniform sampler2D speculars;
layout(binding = 0, rgba32f) uniform image2D outgoingImage;
layout(binding = 1, rgba32f) uniform image2D sumImage;

struct Arrival {
  vec3 irradiance;  // W/m^2
  vec3 from;        // unit length
  float weight;     // projected solid angle, sr, with the sign of its side; for a light only the sign counts
};
shared Arrival arrived[kTogether];

#if OF == OF_LINKS
Arrival arrivalOf(uint bin, uint leaf, vec4 place, vec3 normal) {
  uvec4 entry = first[leaf];
  float weight = binWeight(bin, normal, uintBitsToFloat(entry.z));
  uint i = linkFrom(entry.xy, bin);
  vec3 radiance = vec3(0.0);
  if (i < entry.y && linkBin(links[entry.x + i]) == bin) radiance = sentOver(links[entry.x + i], place.xyz);
#if ENVIRONMENT
  else radiance = environmentOfBin(environment, bin);
#endif
  return Arrival(abs(weight) * radiance, directions[bin].xyz, weight);
}
#else
// All light of a lamp arrives from its direction at the centre of the leaf.
Arrival arrivalOf(uint light, uint leaf, vec4 place, vec3 normal) {
  vec3 toLight, front = vec3(0.0), back = vec3(0.0);
  arrivingIrradiance(lights[light], place.xyz, toLight);
  LeafSquare square = squareOf(place, normal);
  for (int i = 0; i < samplesPerSide * samplesPerSide; ++i)
    addArrivingFrom(lights[light], pointOf(square, i, samplesPerSide), normal, true, 0, front, back);
  float cosine = dot(normal, toLight);
  return Arrival((cosine < 0.0 ? back : front) / float(samplesPerSide * samplesPerSide), toLight, cosine);
}
#endif

void main() {
  uint all = uint(6 * side * side), groupsOfLeaf = (all + kTogether - 1u) / kTogether;
  uint group = listIndex() / kTogether, lane = gl_LocalInvocationID.x;
  uint row = group / groupsOfLeaf, bin = group % groupsOfLeaf * kTogether + lane;
  if (row >= uint(glossyLeaves)) return;  // the whole group
  uint leaf = outgoingNodes[row];
  vec4 place = texelFetch(elementPosition, texelOf(leaf), 0), specular = texelFetch(speculars, texelOf(leaf), 0);
  vec3 normal = texelFetch(elementNormal, texelOf(leaf), 0).xyz;
  bool isFront = dot(directionOfBin(min(bin, all - 1u), side, true), normal) >= 0.0;
  vec3 facing = isFront ? normal : -normal;
  // The lobe is averaged over the bin: over those of its four quarters that are on the side of the bin's centre.
  vec3 towards[4];
  float quarters = 0.0;
  uint line = bin / uint(side), column = bin % uint(side);  // counted through all faces
  for (uint k = 0u; k < 4u; ++k) {
    towards[k] = directionOfBin((2u * line + k / 2u) * uint(2 * side) + 2u * column + k % 2u, 2 * side, true);
    if (dot(towards[k], facing) > 0.0) quarters += 1.0;
    else towards[k] = vec3(0.0);
  }
  float exponent = min(specular.w, largestExponent), weights = 0.0;
  vec3 sum = vec3(0.0);
  for (uint begin = 0u; begin < uint(arrivals); begin += kTogether) {
    if (begin + lane < uint(arrivals)) arrived[lane] = arrivalOf(begin + lane, leaf, place, normal);
    barrier();
    uint count = min(kTogether, uint(arrivals) - begin);
    for (uint i = 0u; i < count; ++i) {
      Arrival arrival = arrived[i];
      if (arrival.weight > 0.0 != isFront) continue;
      float lobe = 0.0;
      for (int k = 0; k < 4; ++k)
        if (towards[k] != vec3(0.0)) lobe += phongLobe(vec3(1.0), exponent, facing, towards[k], arrival.from).x;
      sum += lobe * arrival.irradiance;
      weights += lobe * abs(arrival.weight);
    }
    barrier();
  }
  if (bin >= all) return;
  sum *= specular.rgb / max(quarters, 1.0);
#if OF == OF_LINKS
  // Normalised, so that the sampled lobe reflects at most its albedo.
  sum /= max(weights / max(quarters, 1.0), 1.0);
#endif
  ivec2 texel = texelOf(row * all + bin);
  imageStore(outgoingImage, texel, vec4(sum + (adds ? imageLoad(outgoingImage, texel).rgb : vec3(0.0)), 1.0));
  if (sums) imageStore(sumImage, texel, vec4(sum + (addsToSum ? imageLoad(sumImage, texel).rgb : vec3(0.0)), 1.0));
}
