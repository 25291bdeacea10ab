// Geometry and materials on the device. C++ side: framework/include/lumivox/pipeline/gpu_scene.h.
// Attributes are pulled by gl_VertexID, so that every pass reads the same buffers whatever its vertex layout.
#ifndef LUMIVOX_SCENE
#define LUMIVOX_SCENE

struct MaterialData {
  vec4 diffuse;   // rgb albedo
  vec4 specular;  // rgb Phong albedo, w exponent
  vec4 emission;  // rgb radiance, W/(sr m^2)
};

struct ObjectData {
  mat4 toWorld;        // metres relative to the snapshot's origin
  mat4 normalToWorld;  // upper 3x3
};

// The data of one draw.
layout(std140, binding = 0) uniform Draw {
  int objectIndex;
  int materialIndex;
};

#if defined(SCENE_VERTICES) || defined(SCENE_GEOMETRY)
layout(std430, binding = 0) readonly buffer Positions { float positions[]; };
layout(std430, binding = 1) readonly buffer Normals { float normals[]; };
layout(std430, binding = 2) readonly buffer Texcoords { float texcoords[]; };
layout(std430, binding = 3) readonly buffer Objects { ObjectData objects[]; };
#endif

// For vertex shaders only.
#ifdef SCENE_VERTICES
vec3 vertexPosWorld() {
  int i = 3 * gl_VertexID;
  return (objects[objectIndex].toWorld * vec4(positions[i], positions[i + 1], positions[i + 2], 1.0)).xyz;
}
vec3 vertexNormalWorld() {
  int i = 3 * gl_VertexID;
  return mat3(objects[objectIndex].normalToWorld) * vec3(normals[i], normals[i + 1], normals[i + 2]);
}
vec2 vertexTexcoord() {
  int i = 2 * gl_VertexID;
  return vec2(texcoords[i], 1.0 - texcoords[i + 1]);  // row 0 of an image is its top, v = 1
}
#endif

#ifdef SCENE_MATERIALS
layout(std430, binding = 4) readonly buffer Materials { MaterialData materials[]; };
#endif

// A mask value below this is a hole: the same threshold as in the path tracer.
const float kMaskThreshold = 0.5;

#endif
