#version 450
// Virtual content where it is nearer than what the depth camera saw, else its picture. RELIT: the picture times the change of irradiance that
// virtual content causes (Debevec 1998, differential rendering, as a ratio, since the albedo of real surfaces is not known).
#pragma lumivox axis PICTURE 0 1
#pragma lumivox axis RELIT 0 1
#pragma lumivox require !RELIT || PICTURE
layout(local_size_x = 8, local_size_y = 8) in;
#if PICTURE
#include "picture.glsl"
#endif
#if RELIT
#include "change.glsl"
#endif

layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D virtualRadiance;
#if PICTURE
layout(binding = 2) uniform sampler2DArray capturedColour;
layout(binding = 3) uniform sampler2DArray capturedDepth;
#endif
#if RELIT
layout(binding = 4) uniform sampler2D beforeRadiance;  // what white real surfaces reflect without virtual content
layout(binding = 5) uniform sampler2D afterRadiance;   // with it
layout(binding = 6) uniform sampler2D addedRadiance;   // of its own light
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
  vec2 place = placeOf(slopeOf(pixel, size));
  ivec2 nearest;
  if (pixelAt(place, nearest)) {
    vec4 position = texelFetch(gPosition, pixel, 0);
    float captured = texelFetch(capturedDepth, ivec3(nearest, 0), 0).r;
    // In a hole nothing is known, so that virtual content stays in front.
    bool isHidden = position.w > 0.0 && captured > 0.0 && dot(position.xyz - eye, forward) > captured;
    if (position.w == 0.0 || isHidden) {
      radiance = colourAt(place);
#if RELIT
      radiance *= changeOf(texelFetch(beforeRadiance, pixel, 0).rgb,
                           texelFetch(afterRadiance, pixel, 0).rgb + texelFetch(addedRadiance, pixel, 0).rgb);
#endif
    }
  }
#endif
  imageStore(radianceImage, pixel, vec4(radiance, 1.0));
}
