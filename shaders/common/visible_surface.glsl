// Rasterisation of the surfaces that a camera sees: all programs that use it cover the same pixels at
// the same depths. Included after scene.glsl.
// C++ side: framework/include/lumivox/toolkit/visible_surface.h.
#ifndef LUMIVOX_VISIBLE_SURFACE
#define LUMIVOX_VISIBLE_SURFACE

layout(std140, binding = 1) uniform View { mat4 worldToClip; };
layout(std140, binding = 3) uniform Drawn {
  float model;  // number of the model that is drawn, a set of triangles that move together
};

#ifdef SCENE_VERTICES
invariant gl_Position;

void placeVertex(vec3 posWorld) { gl_Position = worldToClip * vec4(posWorld, 1.0); }
#else
layout(std140, binding = 2) uniform Eye {
  vec3 eyeWorld;
  vec2 imageSize;  // pixels
};

#if MASKS
layout(binding = 1) uniform sampler2D maskTexture;
bool isHole(vec2 texcoord) { return texture(maskTexture, texcoord).r < kMaskThreshold; }
#endif

// Whether this pixel's ray misses the surface. A triangle whose plane contains the eye has no area in the image, but the rasteriser snaps
// its corners to sub-pixel steps, so that its fragments may lie anywhere in its plane.
bool isElsewhere(vec3 posWorld) {
  const float kTolerance = 2.0;  // pixels: more than rounding moves a visible triangle
  // A depth below this share of the coordinates is lost in their rounding.
  const float kNearest = 1e-5;
  vec4 clip = worldToClip * vec4(posWorld, 1.0);
  vec2 pixel = (0.5 + vec2(0.5, -0.5) * clip.xy / clip.w) * imageSize;
  return !(clip.w > kNearest * (length(posWorld) + length(eyeWorld)) && all(lessThan(abs(pixel - gl_FragCoord.xy), vec2(kTolerance))));
}
#endif
#endif
