// The description of a kind of port: its textures and buffers, the members that a reader must heed, its
// exported fields, and the voxels that it occupies. The exporter, the health scan, the stress battery, the
// measures of voxels and the documentation read only this description, so a technique may bring a kind of its
// own:
//
//   struct Octree {
//     GridPlacement grid;
//     gpu::BufferRef nodes;
//   };
//   namespace lumivox {
//   template <>
//   struct PortTraits<Octree> {
//     static PortKind kind() {
//       return {"Octree", "radiance in the leaves of a tree", {{"nodes", "buffer", "16 bytes a node"}}};
//     }
//     static void contents(const Octree& port, PortContents& contents) { contents.buffer("nodes",
//     port.nodes); }
//   };
//   }
//
// The headers in pipeline/ports/ are those of the framework's own kinds.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <typeinfo>
#include <utility>
#include <variant>
#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/scene/grid.h"

namespace lumivox {

// ---- what all values of a kind have in common ----------------------------------------------------------

/// A texture or a buffer of a kind of port.
struct PortResource {
  enum class Sign { positive, any };
  std::string name;   ///< of the member
  std::string shape;  ///< "d3 rgba16f", "buffer"
  std::string meaning;
  Sign sign = Sign::positive;  ///< any: numbers below 0 are no finding of the health scan
};

/// A quantity of each voxel: what the exporter writes.
struct PortField {
  /// fog: a share of what fills the voxel. density: a fog, which viewers expect under that name. direction: a
  /// vector that turns with the surface.
  enum class Role { value, fog, density, direction };
  std::string name;      ///< unique in its kind
  std::string quantity;  ///< what a value is
  std::string unit;      ///< "1" for a pure number
  Role role = Role::value;
};

/// A member that says how to read the textures and buffers of a value. A reader that ignores it gets wrong
/// light and no message. tests/tools/house_test.cpp finds such readers among the techniques.
struct PortCondition {
  std::string member;
  std::string meaning;    ///< what it says
  std::string otherwise;  ///< what a reader that ignores it gets
  std::string readers{};  ///< whom it concerns, "of coarser levels"; empty: every reader
};

struct PortKind {
  std::string name;
  std::string meaning;
  std::vector<PortResource> resources{};
  std::vector<PortField> fields{};  ///< none: there is nothing to export
  std::string occupancy{};          ///< which voxels count as occupied; empty: it is no set of voxels
  std::vector<PortCondition> conditions{};
  // Filled in by portKind(): two types that call themselves alike are told apart by these.
  std::string type{};
  std::size_t bytes = 0;

  bool isSameType(const PortKind& other) const {
    return name == other.name && type == other.type && bytes == other.bytes;
  }
};

// ---- what one value holds -------------------------------------------------------------------------------

/// A box of voxels: voxel (i,j,k) covers low + [i,i+1] x [j,j+1] x [k,k+1] voxel sizes.
struct VoxelBox {
  glm::dvec3 low{0.0};        ///< m, relative to the snapshot's origin
  glm::dvec3 voxelSize{1.0};  ///< m; differs between the axes where a coarser level does not divide evenly
  glm::ivec3 resolution{0};

  /// The box of a grid, in another number of voxels.
  static VoxelBox of(const GridPlacement& grid, const glm::ivec3& resolution) {
    const glm::dvec3 parts = glm::dvec3(grid.resolution) / glm::dvec3(glm::max(resolution, glm::ivec3(1)));
    return {glm::dvec3(grid.low), static_cast<double>(grid.voxelSize) * parts, resolution};
  }
  static VoxelBox of(const GridPlacement& grid) { return of(grid, grid.resolution); }
};

/// Voxels along each axis of a mip level.
inline glm::ivec3 levelResolution(const glm::ivec3& finest, int level) {
  return glm::max(glm::ivec3(finest.x >> level, finest.y >> level, finest.z >> level), glm::ivec3(1));
}

/// Numbers in the texels of volumes of one format and size. A value is made of one or three of their
/// components.
struct VoxelTexels {
  struct Channel {
    int texture = 0, component = 0;
  };
  std::vector<gpu::TextureRef> textures;
  std::vector<Channel> channels;
  int level = 0;
  float unit = 1.0f;  ///< that the number 1 stands for
};
/// Bits in stacks of 128 along z, as in BinaryGrid; a value is whether the bit is set.
struct VoxelBits {
  gpu::TextureRef stacks;
  int level = 0;
};
/// Unordered items. The first word of each is its voxel: i, j, k in 10 bits each. A value is whether a voxel
/// has items, or their number.
struct VoxelList {
  gpu::BufferRef items, count;  ///< count: its first word
  std::uint64_t itemBytes = sizeof(std::uint32_t), capacity = 0;
  bool counts = false;  ///< the value is their number
  /// Whether an item fills anything of its voxel; null: all do.
  bool (*fills)(const std::uint32_t* words) = nullptr;
};
/// The value 1 everywhere in the box.
struct VoxelsFilled {};
/// Any other source: voxels and their values, read on request.
struct VoxelsRead {
  struct Voxel {
    glm::ivec3 voxel{0};
    glm::vec3 value{0.0f};
  };
  int components = 1;  ///< of a value: 1 or 3
  std::uint64_t deviceBytes = 0;
  std::function<std::vector<Voxel>()> read;
};
using VoxelSource = std::variant<VoxelTexels, VoxelBits, VoxelList, VoxelsFilled, VoxelsRead>;

/// The unit of radiance, as fields of ports name it.
inline constexpr const char* kRadianceUnit = "W/(sr m^2)";
/// The condition of kinds whose radiance is divided by their member `unit`.
inline PortCondition radianceUnitCondition() {
  return {"unit", "the radiance that the number 1 stands for, W/(sr m^2)",
          "light is too bright or too dark by this factor"};
}

/// The written part of a texture; the rest is undefined.
struct FilledTexels {
  std::optional<int> levels{};  ///< finest first; none: all that there are
  /// For a pool with spare room: for each texel of the finest level, whether it is in use; empty: all are.
  std::function<std::vector<bool>()> texels{};
};

/// The contents of a value of a kind of port: filled by PortTraits<Port>::contents().
class PortContents {
 public:
  struct Resource {
    const PortResource* what;
    gpu::TextureRef texture;
    gpu::BufferRef buffer;
    FilledTexels filled{};
  };
  struct Field {
    std::string name, unit;  ///< as the kind says, unless the value says otherwise
    const PortField* what;
    int level = 0;  ///< 0 is the finest
    VoxelBox box;
    VoxelSource source;
    /// Constants needed to read the values: a medium's extinction.
    std::vector<std::pair<std::string, std::variant<std::string, float, glm::vec3>>> constants{};
  };
  struct Occupancy {
    GridPlacement grid;
    VoxelSource source;  ///< occupied: a value above 0
  };

  explicit PortContents(const PortKind& kind) : kind_(&kind) {}

  /// Names are those of the kind; Error for another one. Null resources are left out.
  void texture(const std::string& name, const gpu::TextureRef& texture, FilledTexels filled = {});
  void buffer(const std::string& name, const gpu::BufferRef& buffer);
  Field& field(const std::string& name, const VoxelBox& box, VoxelSource source, int level = 0);
  void occupies(const GridPlacement& grid, VoxelSource source) { occupancy_ = {{grid, std::move(source)}}; }

  const PortKind& kind() const { return *kind_; }
  const std::vector<Resource>& resources() const { return resources_; }
  const std::vector<Field>& fields() const { return fields_; }
  const Occupancy* occupancy() const { return occupancy_.empty() ? nullptr : &occupancy_.front(); }

 private:
  const PortResource& resourceNamed(const std::string& name) const;

  const PortKind* kind_;
  std::vector<Resource> resources_;
  std::vector<Field> fields_;
  std::vector<Occupancy> occupancy_;  ///< none or one
};

/// Traits of a kind of port; see above.
template <class Port>
struct PortTraits;

/// The kind of a port, the same object at every call.
template <class Port>
const PortKind& portKind() {
  static const PortKind kind = [] {
    PortKind made = PortTraits<Port>::kind();
    made.type = typeid(Port).name();
    made.bytes = sizeof(Port);
    return made;
  }();
  return kind;
}

}  // namespace lumivox
