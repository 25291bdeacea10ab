#version 450
// The real surfaces behind the view's pixels, white: whatever shades them gives irradiance over pi.
layout(local_size_x = 8, local_size_y = 8) in;
#include "picture.glsl"
#include "edge.glsl"

layout(binding = 0) uniform sampler2DArray capturedPosition;  // the newest layer of a captured map
layout(binding = 1) uniform sampler2DArray capturedNormal;
layout(binding = 0, rgba32f) uniform writeonly image2D positionImage;
layout(binding = 1, rgba32f) uniform writeonly image2D normalImage;
layout(binding = 2, rgba32f) uniform writeonly image2D geometricNormalImage;
layout(binding = 3, rgba32f) uniform writeonly image2D diffuseImage;

// On the view's ray, in the plane of the captured pixel; the captured place itself where the ray leaves the plane far from there.
vec3 onRay(vec2 slope, vec3 posWorld, vec3 normal) {
  vec3 ray = right * slope.x + down * slope.y + forward, path = posWorld - eye;
  float facing = dot(ray, normal), along = dot(path, normal);
  if (facing >= 0.0 || along >= 0.0) return posWorld;
  vec3 met = ray * (along / facing);
  return distance(met, path) <= kEdge * length(path) ? eye + met : posWorld;
}

const int kReach = 2;  // pixels

bool isSurface(ivec2 texel, out vec3 posWorld) {
  if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(width, height)))) return false;
  vec4 position = texelFetch(capturedPosition, ivec3(texel, 0), 0);
  posWorld = position.xyz;
  return position.w > 0.0;
}

// The surface of the captured pixel that is nearest to a place, of those around it; false without any. Holes of the sensor, and edges, would
// stay bright in a shadow.
bool surfaceNear(vec2 place, ivec2 nearest, out vec3 found) {
  float least = 1e30;
  for (int y = -kReach; y <= kReach; ++y)
    for (int x = -kReach; x <= kReach; ++x) {
      ivec2 texel = nearest + ivec2(x, y);
      vec3 posWorld;
      float apart = distance(vec2(texel), place);
      if (apart >= least || !isSurface(texel, posWorld)) continue;
      least = apart;
      found = posWorld;
    }
  return least < 1e30;
}

// The mean normal of the pixels around that lie near the place: a single one may be turned away from a light by noise, and would stay bright
// in its shadow.
vec3 normalAround(ivec2 nearest, vec3 found) {
  vec3 sum = vec3(0.0);
  for (int y = -kReach; y <= kReach; ++y)
    for (int x = -kReach; x <= kReach; ++x) {
      ivec2 texel = nearest + ivec2(x, y);
      vec3 posWorld;
      if (isSurface(texel, posWorld) && distance(posWorld, found) <= kEdge * dot(found - eye, forward))
        sum += texelFetch(capturedNormal, ivec3(texel, 0), 0).xyz;
    }
  return normalize(sum);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(positionImage), nearest;
  if (any(greaterThanEqual(pixel, size))) return;
  vec4 position = vec4(0.0), normal = vec4(0.0);
  vec2 slope = slopeOf(pixel, size), place = placeOf(slope);
  vec3 found;
  if (pixelAt(place, nearest) && surfaceNear(place, nearest, found)) {
    normal = vec4(normalAround(nearest, found), 1.0);
    position = vec4(onRay(slope, found, normal.xyz), 1.0);
  }
  imageStore(positionImage, pixel, position);
  imageStore(normalImage, pixel, normal);
  imageStore(geometricNormalImage, pixel, vec4(normal.xyz, 0.0));
  imageStore(diffuseImage, pixel, vec4(vec3(position.w), 1.0));
}
