#version 450
// Dong et al. 2007, Sec. 4.3.1, per pixel: displays values of elements at visible surfaces. OF irradiance: reflected by the diffuse lobe.
// OF value: unchanged (openness, or light that the elements reflect by their own lobe). OF segments: one colour per segment (Fig. 3a).
// FROM neighbours: interpolates the elements around a pixel. FROM vertices: values interpolated over triangles (display_vertices.vert).
#pragma lumivox axis OF irradiance value segments
#pragma lumivox axis FROM neighbours vertices
#pragma lumivox axis ADDED 0 1
#pragma lumivox require !ADDED || OF != segments
#pragma lumivox require FROM == neighbours || OF != segments
#if FROM == FROM_NEIGHBOURS
#if OF == OF_SEGMENTS
#define KEEPS_NEAREST
#else
#define LEAF_VALUES
#endif
#include "neighbours.glsl"
#else
layout(binding = 4) uniform sampler2D interpolated;  // w 1: the pixel has a value
#endif
#include "common/constants.glsl"
#include "common/random.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const float empty = 0.0;  // value of pixels without a surface

layout(binding = 5) uniform sampler2D gPosition;
#if FROM == FROM_NEIGHBOURS
layout(binding = 6) uniform sampler2D gNormal;
#endif
layout(binding = 7) uniform sampler2D gDiffuse;
#if ADDED
layout(binding = 3) uniform sampler2D added;  // another image, which is added
#endif
#if OF == OF_SEGMENTS
layout(std430, binding = 0) readonly buffer Segments { uint segments[]; };  // segment of each leaf
#endif
layout(binding = 0, rgba32f) uniform writeonly image2D shownImage;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(shownImage)))) return;
  vec4 position = texelFetch(gPosition, pixel, 0);
  vec3 shown = vec3(empty);
  if (position.w != 0.0) {
#if FROM == FROM_NEIGHBOURS
    vec4 normal = texelFetch(gNormal, pixel, 0);
    Around around = findAround(SurfacePoint(position.xyz, normal.xyz, normal.w > 0.5));
    vec4 found = vec4(around.sum, around.weights);
#else
    vec4 found = texelFetch(interpolated, pixel, 0);
#endif
    if (found.w > 0.0) {
      shown = found.rgb / found.w;
#if OF == OF_IRRADIANCE
      shown *= texelFetch(gDiffuse, pixel, 0).rgb / kPi;
#elif OF == OF_SEGMENTS
      uvec4 hash = hash4(uvec4(segments[around.leaves[0]], 1u, 2u, 3u));
      shown = 0.1 + 0.9 * vec3(unitInterval(hash.xy), unitInterval(hash.zw).x);
#endif
    }
  }
#if ADDED
  shown += texelFetch(added, pixel, 0).rgb;
#endif
  imageStore(shownImage, pixel, vec4(shown, 1.0));
}
