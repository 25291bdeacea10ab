#version 450
// Virtual content where it is nearer than what the depth camera saw, else its picture.
#pragma lumivox axis PICTURE 0 1
layout(local_size_x = 8, local_size_y = 8) in;
#include "distortion.glsl"

layout(std140, binding = 0) uniform Parameters {
  float tanHalfFov;
  int width, height;   // of the captured frame
  vec2 shift;          // of the view's rays, pixels
  vec2 focal, centre;  // of the depth camera, pixels
  vec4 radial;
  vec2 tangential;
  vec3 eye;            // posWorld
  vec3 forward;
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D virtualRadiance;
#if PICTURE
layout(binding = 2) uniform sampler2DArray capturedColour;
layout(binding = 3) uniform sampler2DArray capturedDepth;
#endif
layout(binding = 0, rgba32f) uniform writeonly image2D radianceImage;

#if PICTURE
// Known colours around a place of the picture, bilinear; black without any.
vec3 colourAt(vec2 place) {
  ivec2 first = ivec2(floor(place));
  vec2 share = place - vec2(first);
  vec4 sum = vec4(0.0);
  for (int corner = 0; corner < 4; ++corner) {
    ivec2 offset = ivec2(corner & 1, corner >> 1), texel = clamp(first + offset, ivec2(0), ivec2(width, height) - 1);
    vec4 colour = texelFetch(capturedColour, ivec3(texel, 0), 0);
    vec2 weight = mix(1.0 - share, share, vec2(offset));
    if (colour.w > 0.0) sum += weight.x * weight.y * vec4(colour.rgb, 1.0);
  }
  return sum.w > 0.0 ? sum.rgb / sum.w : vec3(0.0);
}
#endif

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(radianceImage);
  if (any(greaterThanEqual(pixel, size))) return;
  vec3 radiance = texelFetch(virtualRadiance, pixel, 0).rgb;
#if PICTURE
  vec2 slope = (2.0 * (vec2(pixel) + 0.5 + shift) - vec2(size)) / float(size.y) * tanHalfFov;
  vec2 place = focal * distortedRay(slope, radial, tangential) + centre;
  ivec2 nearest = ivec2(floor(place + 0.5));
  if (all(greaterThanEqual(nearest, ivec2(0))) && all(lessThan(nearest, ivec2(width, height)))) {
    vec4 position = texelFetch(gPosition, pixel, 0);
    float captured = texelFetch(capturedDepth, ivec3(nearest, 0), 0).r;
    // In a hole nothing is known, so that virtual content stays in front.
    bool isHidden = position.w > 0.0 && captured > 0.0 && dot(position.xyz - eye, forward) > captured;
    if (position.w == 0.0 || isHidden) radiance = colourAt(place);
  }
#endif
  imageStore(radianceImage, pixel, vec4(radiance, 1.0));
}
