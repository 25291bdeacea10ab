// Values that flow between passes. A port carries a meaning, not just a format, so that stages of different
// papers fit together. All are cheap to copy: they share their resources. Image-sized textures have row 0 at
// the TOP of the image. Each kind has a header of its own, with all that is known of it (pipeline/port.h);
// docs/reference.md has the table.
#pragma once

#include "lumivox/pipeline/ports/attribute_grid.h"
#include "lumivox/pipeline/ports/binary_grid.h"
#include "lumivox/pipeline/ports/g_buffer.h"
#include "lumivox/pipeline/ports/image.h"
#include "lumivox/pipeline/ports/occupancy_grid.h"
#include "lumivox/pipeline/ports/particles.h"
#include "lumivox/pipeline/ports/radiance_grid.h"
#include "lumivox/pipeline/ports/reflective_shadow_map.h"
#include "lumivox/pipeline/ports/scattering_grid.h"
#include "lumivox/pipeline/ports/sh_grid.h"
#include "lumivox/pipeline/ports/shadow_map.h"
#include "lumivox/pipeline/ports/surface_lights.h"
#include "lumivox/pipeline/ports/voxel_fragments.h"

namespace lumivox {

/// The kinds of the framework itself: techniques add theirs by using them.
template <class... Ports>
struct PortList {
  static constexpr std::size_t bytes() { return (sizeof(Ports) + ...); }
  static std::vector<const PortKind*> kinds() { return {&portKind<Ports>()...}; }
};
using FrameworkPorts =
    PortList<Image, GBuffer, ShadowMap, ReflectiveShadowMap, VoxelFragments, OccupancyGrid, BinaryGrid,
             AttributeGrid, RadianceGrid, ShGrid, Particles, ScatteringGrid, SurfaceLights>;

}  // namespace lumivox
