// Boxes in the shadow views of lights.
#ifndef LUMIVOX_BOXES_IN_VIEWS
#define LUMIVOX_BOXES_IN_VIEWS

// The part of one view that a box covers.
struct Cast {
  vec4 rectangle;  // low and high x, y in clip space
  vec2 depths;     // nearest and farthest
};
const Cast kNothing = Cast(vec4(1e30, 1e30, -1e30, -1e30), vec2(0.0));

Cast castOf(mat4 view, vec3 low, vec3 high) {
  Cast result = kNothing;
  result.depths = vec2(1e30, -1e30);
  bvec4 outside = bvec4(true);
  bool crosses = false, isBehind = true;
  for (int i = 0; i < 8; ++i) {
    vec4 clip = view * vec4(mix(low, high, vec3(i & 1, i >> 1 & 1, i >> 2)), 1.0);
    outside = bvec4(outside.x && clip.x < -clip.w, outside.y && clip.x > clip.w, outside.z && clip.y < -clip.w, outside.w && clip.y > clip.w);
    crosses = crosses || clip.w <= 0.0;
    if (clip.w <= 0.0) continue;
    isBehind = false;
    vec3 at = clip.xyz / clip.w;
    result.rectangle = vec4(min(result.rectangle.xy, at.xy), max(result.rectangle.zw, at.xy));
    result.depths = vec2(min(result.depths.x, at.z), max(result.depths.y, at.z));
  }
  if (isBehind || any(outside)) return kNothing;
  // A box that reaches behind the light may cover any part of the view.
  return crosses ? Cast(vec4(-1.0, -1.0, 1.0, 1.0), vec2(-1e30, 1e30)) : result;
}

#endif
