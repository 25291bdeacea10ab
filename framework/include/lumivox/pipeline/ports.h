// What flows between passes. A port carries a meaning, not just a format, so that stages of different papers
// fit together. All are cheap to copy: they share their resources. Picture-sized textures have row 0 at the
// TOP of the picture.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/scene/grid.h"
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

/// What each light sees, as a source of one-bounce light (Dachsbacher & Stamminger 2005): every texel is a
/// small light. Lights and layers are those of a ShadowMap with the same settings; all layers have one size.
struct ReflectiveShadowMap {
  static constexpr const char* kPortKind = "ReflectiveShadowMap";
  gpu::BufferRef lights;     ///< array of LightSample in shaders/common/lights.glsl
  gpu::BufferRef views;      ///< mat4 per layer: world to light clip space
  gpu::TextureRef position;  ///< d2Array rgba32f: posWorld; w = 1 where something was hit, else 0
  gpu::TextureRef normal;    ///< d2Array rgba32f: unit normal towards the light; w = the area of surface that
                             ///< the texel stands for, m^2
  gpu::TextureRef flux;      ///< d2Array rgba32f: diffusely reflected flux of the texel, W; w = the layer's
                             ///< light as a number
  int lightCount = 0;
  int layerCount = 0;
};

/// An unordered list of surface samples, one per triangle and voxel that it touches (Crassin & Green 2012).
struct VoxelFragments {
  static constexpr const char* kPortKind = "VoxelFragments";
  static constexpr std::uint64_t kFragmentBytes = 6 * sizeof(std::uint32_t);
  GridPlacement grid;
  gpu::BufferRef fragments;  ///< array of VoxelFragment in shaders/common/voxel.glsl
  gpu::BufferRef count;      ///< words: fragments written; then x, y, z of an indirect dispatch over them
  /// Direct light that fragments are known to reflect, since a renderer computed it where the camera sees
  /// them (Mavridis & Papaioannou 2011, Sec. 3.2). Null: of none. Else a word for each of the first
  /// fragments: their reflected radiance in W/(sr m^2), packed as `packShared` does, or kNotKnown; those
  /// behind the end of the buffer are not known either.
  gpu::BufferRef reflected;
  static constexpr std::uint32_t kNotKnown = 0xffffffffu;
  std::uint64_t capacity = 0;
  int workGroupSize = 64;  ///< that the indirect dispatch assumes
  /// How the coverages of the fragments in one voxel make its opacity: their mean (each triangle is judged by
  /// itself, less than 1 only where a mask has holes), or their sum up to 1 (each covers a part of the
  /// voxel).
  enum class Coverage { mean, sum } coverage = Coverage::mean;
};

/// One opacity per voxel.
struct OccupancyGrid {
  static constexpr const char* kPortKind = "OccupancyGrid";
  GridPlacement grid;
  gpu::TextureRef opacity;  ///< d3 r8, 0..1
};

/// One bit per voxel in stacks along z (Thiedemann et al. 2011): bit b of component c of texel (i, j) of
/// layer l is voxel (i, j, 128 l + 32 c + b). Mip levels halve x and y alone; a texel is the union of those
/// below.
struct BinaryGrid {
  static constexpr const char* kPortKind = "BinaryGrid";
  static constexpr int kStack = 128;  ///< voxels in one texel
  GridPlacement grid;
  gpu::TextureRef stacks;  ///< d2Array rgba32ui
};

/// Averages over the surface in each voxel.
struct AttributeGrid {
  static constexpr const char* kPortKind = "AttributeGrid";
  GridPlacement grid;
  gpu::TextureRef albedo;    ///< d3 rgba16f: rgb mean diffuse albedo, a covered fraction (0: no surface)
  gpu::TextureRef normal;    ///< d3 rgba16f: xyz mean of the unit normals, not normalised: short where they
                             ///< disagree
  gpu::TextureRef emission;  ///< d3 rgba32f: rgb mean emitted radiance; null when nothing emits
};

/// Where in a volume anything is: a list of its occupied bricks, in no order.
struct OccupiedBricks {
  static constexpr int kSide = 4;  ///< finest voxels along a side of a brick
  gpu::BufferRef bricks;           ///< words: i, j, k of each brick, in 10 bits each
  gpu::BufferRef count;  ///< words: bricks; then x, y, z of the indirect dispatches of one thread for each
                         ///< voxel in them at level 0, at level 1 and at level 2, in groups of kGroupSize
  static constexpr int kGroupSize = 64;
  /// Where the arguments of a level's dispatch lie in `count`.
  static constexpr std::uint64_t argumentsBytes(int level) {
    return (1 + 3 * static_cast<std::uint64_t>(level)) * sizeof(std::uint32_t);
  }
};

/// Pre-filtered outgoing radiance, pre-multiplied by opacity, one mip per halving (Crassin et al. 2011).
struct RadianceGrid {
  static constexpr const char* kPortKind = "RadianceGrid";
  GridPlacement grid;
  gpu::TextureRef radiance;  ///< d3 rgba16f or rgba32f with mips: rgb radiance * opacity / unit, a opacity
  float unit = 1.0f;         ///< W/(sr m^2): keeps very bright and very dark light within half floats
  int filledLevels = 0;      ///< mip levels that hold values, finest first; 0: all that the texture has
  /// What the opacity of a coarser voxel is that of: the whole of it, as seen through; or a path of one
  /// finest voxel's length in it, which is what the plain mean of the children gives for a uniform medium.
  enum class Opacity { ofVoxel, ofFinestVoxel } opacity = Opacity::ofVoxel;
  bool holdsMedia = false;  ///< participating media are in the voxels beside the surfaces
  /// Outside of these bricks the finest level is 0; null members: not known.
  OccupiedBricks occupied;
};

/// Spherical-harmonic coefficients per voxel, one volume per colour channel, in one or more nested grids.
struct ShGrid {
  static constexpr const char* kPortKind = "ShGrid";
  struct Level {
    GridPlacement grid;
    std::array<gpu::TextureRef, 3> coefficients;  ///< d3 rgba16f or rgba32f: Y00, Y1-1, Y10, Y11
    gpu::TextureRef closed;  ///< d3 rgba8, one voxel larger: xyz the shares of the faces to the voxels at
                             ///< lower x, y and z that surfaces close; null: all open
    gpu::TextureRef moved;   ///< d3 rgba8, of the same faces, as bytes: how far surfaces were moved to lie on
                             ///< them, fourteenths of a voxel: the low four bits of those that look down the
                             ///< axis and truly lie above, the high ones the other way; null: not at all
    gpu::BufferRef packed{};  ///< five words a voxel, x first (thesis Gomes 2015, Listings 4.26 to 4.29):
                              ///< albedo over pi behind its contrast, and for each face of a tetrahedron a
                              ///< normal behind its closeness to it; 0: no surface. null: not kept
  };
  std::vector<Level> levels;  ///< finest and smallest first
};

/// The particles of all media of the scene that have some, in the order of the scene (scene/medium.h).
struct Particles {
  static constexpr const char* kPortKind = "Particles";
  struct Group {
    int medium = 0;          ///< index into Scene::media
    int count = 0;           ///< of particles
    gpu::BufferRef offsets;  ///< vec4 each: xyz position relative to the medium's source, m; w age, s
  };
  std::vector<Group> groups;
};

/// Scattering media. Extinction and scattering of one medium are its density times its constants; they end at
/// its bounds.
struct ScatteringGrid {
  static constexpr const char* kPortKind = "ScatteringGrid";
  struct Medium {
    std::string name;
    Bounds bounds;               ///< of all of it, metres relative to the snapshot's origin
    GridPlacement grid;          ///< where the density is stored; zero resolution when homogeneous
    gpu::TextureRef density;     ///< d3 r32f, zero outside the grid; null: the density is 1 in the bounds
    glm::vec3 extinction{0.0f};  ///< sigma_t at density 1, 1/m
    glm::vec3 albedo{0.0f};      ///< sigma_s / sigma_t
    float anisotropy = 0.0f;     ///< Henyey-Greenstein mean cosine g
  };
  std::vector<Medium> media;
};

}  // namespace lumivox
