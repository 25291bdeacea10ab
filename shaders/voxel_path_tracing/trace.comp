#version 450
// Traces some rays of one path per pixel, one after another. Between dispatches, textures keep the state of the path: origin and direction
// of its next ray, and its throughput. Light is added at each hit.
#pragma lumivox axis ARRIVING 0 1
#pragma lumivox axis REFLECTED 0 1
#pragma lumivox require ARRIVING || REFLECTED
#pragma lumivox require GLOSSY || !REFLECTED
#pragma lumivox axis PLANES 0 1  // 1: by one walk, since all but the printed one find the same voxels
#pragma lumivox require !PLANES || BIT_RULE == hierarchy
#if PLANES
#include "common/bit_grid.glsl"
#include "common/voxel_planes.glsl"
#endif
#include "path.glsl"
#include "sums.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 1, rgba32f) uniform image2D pathStart;       // xyz voxels; w weight of its light in what arrives
layout(binding = 2, rgba32f) uniform image2D pathDirection;   // xyz; w weight of its light in what the Phong lobe reflects
layout(binding = 3, rgba32f) uniform image2D pathThroughput;  // rgb; w 0: the path has ended

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, textureSize(gPosition, 0)))) return;
  vec4 start, direction, throughput;
  if (bounce == 1) {
    Surface surface;
    throughput = vec4(1.0, 1.0, 1.0, visibleSurface(at, surface) ? 1.0 : 0.0);
    Choice choice = chosen(at, surface, 0);
    start = vec4(startOf(surface, false), choice.diffuse);
    direction = vec4(choice.direction, choice.glossy);
  } else {
    start = imageLoad(pathStart, at);
    direction = imageLoad(pathDirection, at);
    throughput = imageLoad(pathThroughput, at);
  }
  int last = min(bounce + raysAtOnce - 1, bounces);
  for (int ray = bounce; ray <= last && throughput.w > 0.0; ++ray) {
    Meeting meeting = followed(start.xyz, direction.xyz);
    vec3 light = throughput.rgb * meeting.light;
#if ARRIVING
    addTo(kArriving, at, start.w * light);
#endif
#if REFLECTED
    addTo(kReflected, at, direction.w * light);
#endif
    throughput.w = 0.0;
    if (!meeting.isSurface || ray == bounces) break;
    Choice choice = chosen(at, meeting.surface, ray);
    start.xyz = startOf(meeting.surface, true);
    direction.xyz = choice.direction;
    throughput.rgb = survived(at, throughput.rgb * reflectedBy(meeting.surface, choice), ray);
    throughput.w = throughput.rgb == vec3(0.0) ? 0.0 : 1.0;
  }
  if (last == bounces) return;
  imageStore(pathThroughput, at, throughput);
  if (!(throughput.w > 0.0)) return;
  imageStore(pathStart, at, start);
  imageStore(pathDirection, at, direction);
}
