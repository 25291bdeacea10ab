#version 450
// Sec. 3.2 step 3 as published: interpolates the averaged lights of the points that each vertex refers to (Eq. 12, 13), on both sides of
// open surfaces. Positions are offsets from the vertex, so that no precision is lost far from the origin.
#pragma lumivox axis LOBE diffuse glossy
#pragma lumivox axis INTERPOLATE averaged plain
#pragma lumivox require LOBE == diffuse || INTERPOLATE == averaged
layout(local_size_x = 64) in;
#define SCENE_GEOMETRY
#include "common/list.glsl"
#include "common/scene.glsl"
#include "../interpolate.glsl"

struct VertexLight {
  vec4 light;   // w of a glossy light: 1 + exponent
  vec4 offset;  // xyz; w 1: the vertex has light
};
layout(std140, binding = 0) uniform Parameters {
  int vertices;
  int sides;      // sides per vertex; 1: only fronts have points
  int published;  // Eq. 13 as printed
};
layout(binding = 0) uniform sampler2D lights;
layout(binding = 1) uniform sampler2D places;
layout(std430, binding = 4) readonly buffer VertexObjects { uint vertexObjects[]; };
// `neighbours` points per side, by increasing distance in the rest pose; all bits set: no point.
layout(std430, binding = 5) readonly buffer VertexPoints { uint vertexPoints[]; };
layout(std430, binding = 8) writeonly buffer VertexLights { VertexLight vertexLights[]; };  // the sides of a vertex are adjacent

// The points to which a side of a vertex refers.
Nearest referredPoints(vec3 position, uint first) {
  Nearest nearest;
  nearest.count = 0;
  nearest.farthestSquared = 0.0;
  for (int i = 0; i < neighbours; ++i) {
    uint point = vertexPoints[first + uint(i)];
    if (point == 0xffffffffu) break;
    vec3 path = texelFetch(pointPosition, pointTexel(point), 0).xyz - position;
    nearest.points[i] = point;
    nearest.distancesSquared[i] = dot(path, path);
    nearest.farthestSquared = max(nearest.farthestSquared, nearest.distancesSquared[i]);
    nearest.count = i + 1;
  }
  return nearest;
}

void main() {
  uint vertex = listIndex();
  if (vertex >= uint(vertices)) return;
  ObjectData object = objects[vertexObjects[vertex]];
  uint at = 3u * vertex;
  vec3 position = (object.toWorld * vec4(positions[at], positions[at + 1u], positions[at + 2u], 1.0)).xyz;
  vec3 normal = mat3(object.normalToWorld) * vec3(normals[at], normals[at + 1u], normals[at + 2u]);
  float lengthSquared = dot(normal, normal);
  normal = lengthSquared > 0.0 ? normal * inversesqrt(lengthSquared) : vec3(0.0);
  for (int side = 0; side < sides; ++side) {
    uint index = vertex * uint(sides) + uint(side);
    SeenSurface seen = SeenSurface(position, side == 0 ? normal : -normal, 0.0);
    Nearest nearest = referredPoints(position, index * uint(neighbours));
    AveragedLight light = interpolated(seen, nearest, lights, places, LOBE == LOBE_GLOSSY, LOBE == LOBE_GLOSSY && published == 0,
                                       INTERPOLATE == INTERPOLATE_PLAIN);
#if LOBE == LOBE_DIFFUSE
    bool known = nearest.count > 0;
#else
    bool known = light.light.w > 0.0;  // points that reflect nothing towards the camera have 0
#endif
    vertexLights[index] = VertexLight(known ? light.light : vec4(0.0), known ? vec4(light.place - position, 1.0) : vec4(0.0));
  }
}
