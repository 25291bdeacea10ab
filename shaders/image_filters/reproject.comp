#version 450
// Finds each pixel's surface in the last frame, and blends the history of the pixels that saw it there (Schied et al. 2017, Sec. 4.1). A
// surface that none of the four saw starts anew: its history has the length 0.

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Reprojection {
  vec3 eye;
  float pixelAngle;   // width of a pixel at a distance of 1
  float tolerance;    // distance from the surface's plane at which a pixel saw another, in widths of a pixel
  float leastCosine;  // between normals of one surface
};
// World to clip space, then for each model (0: what stands still) its matrix to the world and the inverse.
layout(std430, binding = 0) readonly buffer PlacesNow { mat4 placesNow[]; };
layout(std430, binding = 1) readonly buffer PlacesThen { mat4 placesThen[]; };
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 2) uniform sampler2D gGeometricNormal;
layout(binding = 4) uniform sampler2D positionThen;  // the same two of the last frame
layout(binding = 5) uniform sampler2D normalThen;
layout(binding = 6) uniform sampler2D lightThen;
layout(binding = 7) uniform sampler2D momentsThen;
layout(binding = 8) uniform sampler2D feedbackThen;  // the light that goes on: lightThen itself, or filtered
layout(binding = 0, rgba32f) uniform writeonly image2D pastLight;
layout(binding = 1, rgba32f) uniform writeonly image2D pastMoments;
layout(binding = 2, rgba32f) uniform writeonly image2D motionImage;

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = textureSize(gPosition, 0);
  if (any(greaterThanEqual(at, size))) return;
  vec4 position = texelFetch(gPosition, at, 0), normal = texelFetch(gGeometricNormal, at, 0);
  vec4 light = vec4(0.0), moments = vec4(0.0);
  vec2 moved = vec2(0.0);
  if (position.w > 0.0) {
    int model = int(normal.w + 0.5);
    mat4 back = placesThen[1 + 2 * model] * placesNow[2 + 2 * model];
    vec3 before = (back * vec4(position.xyz, 1.0)).xyz, facing = mat3(back) * normal.xyz;
    vec4 clip = placesThen[0] * vec4(before, 1.0);
    vec2 there = (0.5 + vec2(0.5, -0.5) * clip.xy / clip.w) * vec2(size) - 0.5;
    float width = tolerance * pixelAngle * distance(position.xyz, eye), weights = 0.0;
    if (clip.w > 0.0 && all(greaterThan(there, vec2(-1.0))) && all(lessThan(there, vec2(size)))) {
      moved = there - vec2(at);
      ivec2 first = ivec2(floor(there));
      vec2 share = there - vec2(first);
      for (int i = 0; i < 4; ++i) {
        ivec2 corner = ivec2(i & 1, i >> 1), texel = first + corner;
        if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, size))) continue;
        vec4 position2 = texelFetch(positionThen, texel, 0), normal2 = texelFetch(normalThen, texel, 0);
        vec4 light2 = texelFetch(lightThen, texel, 0);
        if (!(position2.w > 0.0) || int(normal2.w + 0.5) != model || !(light2.w > 0.0) || dot(normal2.xyz, facing) < leastCosine ||
            abs(dot(position2.xyz - before, facing)) > width)
          continue;
        vec2 near = mix(1.0 - share, share, vec2(corner));
        light += near.x * near.y * vec4(texelFetch(feedbackThen, texel, 0).rgb, light2.w);
        moments += near.x * near.y * texelFetch(momentsThen, texel, 0);
        weights += near.x * near.y;
      }
    }
    const float kLeast = 0.01;  // share of the four that must have seen the surface
    if (weights > kLeast) {
      light /= weights;
      moments /= weights;
    } else {
      light = moments = vec4(0.0);
    }
  }
  imageStore(pastLight, at, light);
  imageStore(pastMoments, at, moments);
  imageStore(motionImage, at, vec4(moved, light.w, 1.0));
}
