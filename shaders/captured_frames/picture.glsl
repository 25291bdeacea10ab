// Where a pixel of the view lies in the captured picture, taken from the same eye.
#ifndef LUMIVOX_CAPTURED_PICTURE
#define LUMIVOX_CAPTURED_PICTURE
#include "distortion.glsl"

layout(std140, binding = 1) uniform Picture {
  float tanHalfFov;    // of the view
  int width, height;   // of the captured frame
  vec2 shift;          // of the view's rays, pixels
  vec2 focal, centre;  // of the depth camera, pixels
  vec4 radial;
  vec2 tangential;
  vec3 eye;            // posWorld
  vec3 right, down, forward;
};

// The ray (x, y, 1) of a pixel in the camera's space: x right, y down, z forward.
vec2 slopeOf(ivec2 pixel, ivec2 size) { return (2.0 * (vec2(pixel) + 0.5 + shift) - vec2(size)) / float(size.y) * tanHalfFov; }

// The place in the picture to which a ray belongs, pixels.
vec2 placeOf(vec2 slope) { return focal * distortedRay(slope, radial, tangential) + centre; }

// The captured pixel at a place; false outside the picture.
bool pixelAt(vec2 place, out ivec2 nearest) {
  nearest = ivec2(floor(place + 0.5));
  return all(greaterThanEqual(nearest, ivec2(0))) && all(lessThan(nearest, ivec2(width, height)));
}

#endif
