#version 450
// Sec. 3.2 step 3 as published: the averaged lights of the nearest points at every vertex of the meshes (Eq. 12, 13), on both sides of what is
// open. Places are told as offsets from the vertex, so that nothing is lost far from the origin.
#pragma lumivox axis LOBE diffuse glossy
#pragma lumivox axis INTERPOLATE averaged plain
#pragma lumivox require LOBE == diffuse || INTERPOLATE == averaged
layout(local_size_x = 64) in;
#define SCENE_GEOMETRY
#define SCENE_MATERIALS
#include "common/list.glsl"
#include "common/scene.glsl"
#include "interpolate.glsl"

struct VertexOwner {
  uint object, material;
  float model;
};
struct VertexLight {
  vec4 light;   // of a glossy one w: 1 + exponent
  vec4 offset;  // xyz; w: 1 where there is light to be had
};
layout(std140, binding = 0) uniform Parameters {
  int vertices;
  int sides;      // 1: fronts alone have points
  int published;  // Eq. 13 as printed
};
layout(binding = 0) uniform sampler2D lights;
layout(binding = 1) uniform sampler2D places;
layout(std430, binding = 5) readonly buffer VertexOwners { VertexOwner owners[]; };
layout(std430, binding = 8) writeonly buffer VertexLights { VertexLight vertexLights[]; };  // sides of a vertex beside each other

void main() {
  uint vertex = listIndex();
  if (vertex >= uint(vertices)) return;
  VertexOwner owner = owners[vertex];
  uint at = 3u * vertex;
  vec3 position = (objects[owner.object].toWorld * vec4(positions[at], positions[at + 1u], positions[at + 2u], 1.0)).xyz;
  vec3 normal = mat3(objects[owner.object].normalToWorld) * vec3(normals[at], normals[at + 1u], normals[at + 2u]);
  float lengthSquared = dot(normal, normal);
  normal = lengthSquared > 0.0 ? normal * inversesqrt(lengthSquared) : vec3(0.0);
  for (int side = 0; side < sides; ++side) {
    SeenSurface seen = SeenSurface(position, side == 0 ? normal : -normal, owner.model);
#if LOBE == LOBE_DIFFUSE
    Nearest nearest = nearestPoints(seen, -1.0);
    AveragedLight light = interpolated(seen, nearest, lights, places, false, false, INTERPOLATE == INTERPOLATE_PLAIN);
    bool known = nearest.count > 0;
#else
    AveragedLight light = AveragedLight(vec4(0.0), position);
    vec4 specular = materials[owner.material].specular;
    if (any(greaterThan(specular.rgb, vec3(0.0))))
      light = interpolated(seen, nearestPoints(seen, specular.w), lights, places, true, published == 0, false);
    bool known = light.light.w > 0.0;  // points that reflect nothing towards the camera have 0
#endif
    vertexLights[vertex * uint(sides) + uint(side)] = VertexLight(known ? light.light : vec4(0.0), known ? vec4(light.place - position, 1.0) : vec4(0.0));
  }
}
