#version 450
// Points as small lights: what arrived at each of them in the frame before leaves it again, by its diffuse albedo. Ours; Lensing & Broll
// 2013 end after the light of the map's texels.
layout(local_size_x = 64) in;
#include "common/list.glsl"
#include "common/constants.glsl"
#include "../surface_points.glsl"

layout(binding = 0) uniform sampler2D arrived;  // rgb irradiance / pi, W/(sr m^2): SparseLight of gather
layout(binding = 1) uniform sampler2D pointAlbedo;
layout(binding = 0, rgba32f) uniform writeonly image2DArray positionImage;
layout(binding = 1, rgba32f) uniform writeonly image2DArray normalImage;
layout(binding = 2, rgba32f) uniform writeonly image2DArray fluxImage;

void main() {
  uint index = listIndex();
  if (index >= uint(pointCount)) return;
  ivec2 texel = pointTexel(index);
  vec4 place = texelFetch(pointPosition, texel, 0);
  vec3 normal = texelFetch(pointNormal, texel, 0).xyz;
  // A point whose triangle has become a line has no side to which it could reflect.
  float area = normal == vec3(0.0) ? 0.0 : place.w;
  vec3 flux = texelFetch(pointAlbedo, texel, 0).rgb * texelFetch(arrived, texel, 0).rgb * (kPi * area);
  imageStore(positionImage, ivec3(texel, 0), vec4(place.xyz, area > 0.0 ? 1.0 : 0.0));
  imageStore(normalImage, ivec3(texel, 0), vec4(normal, area));
  imageStore(fluxImage, ivec3(texel, 0), vec4(flux, 0.0));
}
