// What flows between passes. A port carries a meaning, not just a format, so that stages of different papers
// fit together. All are cheap to copy: they share their resources. Picture-sized textures have row 0 at the
// TOP of the picture.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/scene/scene.h"

namespace lumivox {

/// A picture-sized result. rgba16f or rgba32f: radiance in W/(sr m^2) in rgb; ambient occlusion in r.
struct Image {
  static constexpr const char* kPortKind = "Image";
  gpu::TextureRef texture;
};

/// What the camera sees, per pixel. Positions are metres relative to the snapshot's origin.
struct GBuffer {
  static constexpr const char* kPortKind = "GBuffer";
  gpu::TextureRef position;  ///< rgba32f: posWorld; w = 1 where something was hit, else 0
  gpu::TextureRef normal;    ///< rgba32f: unit shading normal facing the camera; w = 1 when the front side is
                             ///< seen, 0 back side
  gpu::TextureRef geometricNormal;  ///< rgba32f: unit normal of the triangle facing the camera
  gpu::TextureRef diffuse;          ///< rgba32f: diffuse albedo
  gpu::TextureRef
      specular;  ///< rgba32f: Phong albedo, exponent in w; absent (null) when pruned: nothing glossy
  gpu::TextureRef emission;  ///< rgba32f: emitted radiance towards the camera; absent when nothing emits
};

/// All direct light as point samples: lights without extent are one sample each, emissive triangles several.
/// Each sample has zero or more shadow views (directional and spot 1, point and area 6 cube faces) that are
/// layers of one depth array.
struct ShadowMap {
  static constexpr const char* kPortKind = "ShadowMap";
  gpu::BufferRef lights;  ///< array of LightSample in shaders/common/lights.glsl
  gpu::BufferRef views;   ///< mat4 per layer: world to light clip space
  gpu::TextureRef depth;  ///< d2Array depth32f; null when the scene has no lights
  int lightCount = 0;
  int layerCount = 0;
};

/// Where a cubic voxel grid lies. Voxel (i,j,k) covers low + [i,i+1] x [j,j+1] x [k,k+1] times voxelSize; its
/// centre is the half-way point.
struct GridPlacement {
  glm::vec3 low{0.0f};       ///< corner of voxel (0,0,0), metres relative to the snapshot's origin
  float voxelSize = 1.0f;    ///< m
  glm::ivec3 resolution{0};  ///< voxels per axis
};

/// An unordered list of surface samples, one per triangle and voxel that it touches (Crassin & Green 2012).
struct VoxelFragments {
  static constexpr const char* kPortKind = "VoxelFragments";
  GridPlacement grid;
  gpu::BufferRef fragments;  ///< array of VoxelFragment in shaders/common/voxel.glsl
  gpu::BufferRef count;      ///< words: fragments written; then x, y, z of an indirect dispatch over them
  std::uint64_t capacity = 0;
  int workGroupSize = 64;  ///< that the indirect dispatch assumes
};

/// One bit or one opacity per voxel.
struct OccupancyGrid {
  static constexpr const char* kPortKind = "OccupancyGrid";
  GridPlacement grid;
  gpu::TextureRef opacity;  ///< d3 r8, 0..1
};

/// Pre-filtered outgoing radiance, pre-multiplied by opacity, one mip per halving (Crassin et al. 2011).
struct RadianceGrid {
  static constexpr const char* kPortKind = "RadianceGrid";
  GridPlacement grid;
  gpu::TextureRef radiance;  ///< d3 rgba16f or rgba32f with mips: rgb radiance * opacity, a opacity
};

/// Spherical-harmonic coefficients per voxel, one volume per colour channel.
struct ShGrid {
  static constexpr const char* kPortKind = "ShGrid";
  GridPlacement grid;
  std::array<gpu::TextureRef, 3> coefficients;
};

/// Scattering medium per voxel.
struct ScatteringGrid {
  static constexpr const char* kPortKind = "ScatteringGrid";
  GridPlacement grid;
  gpu::TextureRef extinction;  ///< d3 r16f or r32f, 1/m
};

}  // namespace lumivox
