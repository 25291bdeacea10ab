#version 450
// Traces one ray of one path per pixel, as published: textures store every surface of the path (thesis Gomes 2015, Fig. 41), one layer per
// surface, and bring_back.comp carries the light back over them.
#include "path.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 1, rgba32f) uniform image2DArray vertexPlace;       // xyz voxels; w 1: a surface
layout(binding = 2, rgba32f) uniform image2DArray vertexNormal;      // xyz
layout(binding = 3, rgba32f) uniform image2DArray vertexLight;       // rgb direct light reflected along the path, or the environment
layout(binding = 4, rgba32f) uniform image2DArray vertexReflection;  // rgb albedo; then the weight of the ray from there
#if GLOSSY
layout(binding = 5, rgba32f) uniform image2DArray vertexSpecular;    // Phong albedo and exponent
layout(binding = 6, rgba32f) uniform image2DArray vertexToViewer;    // xyz back along the path
#endif
layout(binding = 7, rgba32f) uniform image2D firstWeights;           // of the visible surface: r for arriving light, g for its Phong lobe

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, textureSize(gPosition, 0)))) return;
  ivec3 from = ivec3(at, bounce - 2), to = ivec3(at, bounce - 1);
  Surface surface;
  bool isThere;
  if (bounce == 1) {
    isThere = visibleSurface(at, surface);
  } else {
    vec4 place = imageLoad(vertexPlace, from);
    isThere = place.w > 0.0;
    surface.place = place.xyz;
    surface.normal = surface.outwards = imageLoad(vertexNormal, from).xyz;
    surface.toViewer = surface.normal;
    surface.diffuse = imageLoad(vertexReflection, from).rgb;
    surface.specular = vec4(0.0);
#if GLOSSY
    surface.specular = imageLoad(vertexSpecular, from);
    surface.toViewer = imageLoad(vertexToViewer, from).xyz;
#endif
  }
  vec4 light = vec4(0.0), placed = vec4(0.0);
  if (isThere) {
    Choice choice = chosen(at, surface, bounce - 1);
    if (bounce == 1) imageStore(firstWeights, at, vec4(choice.diffuse, choice.glossy, 0.0, 0.0));
    else imageStore(vertexReflection, from, vec4(survived(at, reflectedBy(surface, choice), bounce - 1), 1.0));
    Meeting meeting = followed(startOf(surface, bounce > 1), choice.direction);
    light.rgb = meeting.light;
    if (meeting.isSurface) {
      placed = vec4(meeting.surface.place, 1.0);
      imageStore(vertexNormal, to, vec4(meeting.surface.normal, 0.0));
      imageStore(vertexReflection, to, vec4(meeting.surface.diffuse, 1.0));
#if GLOSSY
      imageStore(vertexSpecular, to, meeting.surface.specular);
      imageStore(vertexToViewer, to, vec4(meeting.surface.toViewer, 0.0));
#endif
    }
  } else if (bounce == 1) {
    imageStore(firstWeights, at, vec4(0.0));
  }
  imageStore(vertexPlace, to, placed);
  imageStore(vertexLight, to, light);
}
