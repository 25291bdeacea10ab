#include "vdbexport/fields.h"

#include <fmt/format.h>

#include <array>
#include <cassert>

#include "lumivox/base/error.h"
#include "vdbexport/texels.h"

namespace lumivox::vdb {
namespace {

using openvdb::BoolGrid;
using openvdb::FloatGrid;
using openvdb::Int32Grid;
using openvdb::Vec3fGrid;

openvdb::Vec3f vdbVector(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}

/// The place of a level: all levels cover the same box.
Field fieldAt(const GridPlacement& grid, const glm::ivec3& resolution, int level) {
  Field field;
  field.level = level;
  field.low = glm::dvec3(grid.low);
  field.voxelSize = static_cast<double>(grid.voxelSize) *
                    (glm::dvec3(grid.resolution) / glm::dvec3(glm::max(resolution, glm::ivec3(1))));
  field.resolution = resolution;
  return field;
}

/// Fields that come from texels of the same volumes.
template <std::size_t kCount>
class FieldsOfTexels {
 public:
  FieldsOfTexels(const GridPlacement& grid, const std::array<gpu::TextureRef, kCount>& textures, int level)
      : place_(fieldAt(grid, levelResolution(grid.resolution, level), level)) {
    for (std::size_t i = 0; i < kCount; ++i) {
      texels_[i] = std::make_shared<Texels>(textures[i], level);
      place_.deviceBytes += texels_[i]->sizeBytes();
    }
    assert(texels_[0]->layout().resolution == place_.resolution);
  }

  template <class GridType, class Select>
  Field make(const std::string& name, const std::string& quantity, const std::string& unit,
             const Select& select) const {
    Field field = place_;
    field.name = name;
    field.type = openvdb::typeNameAsString<typename GridType::ValueType>();
    field.quantity = quantity;
    field.unit = unit;
    field.values = [texels = texels_, name, select]() -> openvdb::GridBase::Ptr {
      return gridOf<GridType>(texels, name, select);
    };
    return field;
  }

 private:
  Field place_;
  std::array<TexelsRef, kCount> texels_;
};

using OneTexel = std::array<glm::vec4, 1>;
float red(const OneTexel& texel) {
  return texel[0].r;
}
float alpha(const OneTexel& texel) {
  return texel[0].a;
}
openvdb::Vec3f rgb(const OneTexel& texel) {
  return vdbVector(glm::vec3(texel[0]));
}

Field asFog(Field field) {
  field.gridClass = openvdb::GRID_FOG_VOLUME;
  return field;
}

// ---- one function for each kind of port ----------------------------------------------------------------

std::vector<Field> fields(const OccupancyGrid& port) {
  const FieldsOfTexels<1> texels(port.grid, {port.opacity}, 0);
  return {asFog(texels.make<FloatGrid>("opacity", "opacity", "1", red))};
}

std::vector<Field> fields(const AttributeGrid& port) {
  const FieldsOfTexels<1> albedo(port.grid, {port.albedo}, 0), normal(port.grid, {port.normal}, 0);
  std::vector<Field> result{
      albedo.make<Vec3fGrid>("albedo", "mean diffuse albedo of the surface in the voxel", "1", rgb),
      asFog(albedo.make<FloatGrid>("coverage", "covered fraction", "1", alpha)),
      normal.make<Vec3fGrid>("normal", "mean of the unit normals, not normalised", "1", rgb)};
  result.back().vectorType = openvdb::VEC_COVARIANT;
  if (port.emission) {
    const FieldsOfTexels<1> emission(port.grid, {port.emission}, 0);
    result.push_back(emission.make<Vec3fGrid>("emission", "mean emitted radiance", "W/(sr m^2)", rgb));
  }
  return result;
}

std::vector<Field> fields(const RadianceGrid& port) {
  const int all = port.radiance->description().levels;
  const int filled = port.filledLevels == 0 ? all : port.filledLevels;
  std::vector<Field> result;
  const auto radiance = [unit = port.unit](const OneTexel& texel) { return rgb(texel) * unit; };
  for (int level = 0; level < filled; ++level) {
    const FieldsOfTexels<1> texels(port.grid, {port.radiance}, level);
    result.push_back(texels.make<Vec3fGrid>("radiance", "outgoing radiance, multiplied by the opacity",
                                            "W/(sr m^2)", radiance));
    result.push_back(asFog(texels.make<FloatGrid>("opacity", "opacity", "1", alpha)));
  }
  return result;
}

/// Of each real spherical harmonic up to band 1 the coefficients of red, green and blue.
std::vector<Field> fields(const ShGrid& port) {
  constexpr std::array<const char*, 4> kCoefficients = {"Y00", "Y1-1", "Y10", "Y11"};
  std::vector<Field> result;
  for (std::size_t level = 0; level < port.levels.size(); ++level) {
    const ShGrid::Level& one = port.levels[level];
    const FieldsOfTexels<3> texels(one.grid, one.coefficients, 0);
    for (int i = 0; i < static_cast<int>(kCoefficients.size()); ++i) {
      const auto coefficient = [i](const std::array<glm::vec4, 3>& channels) {
        return openvdb::Vec3f(channels[0][i], channels[1][i], channels[2][i]);
      };
      const char* harmonic = kCoefficients[static_cast<std::size_t>(i)];
      Field field = texels.make<Vec3fGrid>(
          harmonic,
          fmt::format("coefficients of the spherical harmonic {} for red, green and blue", harmonic),
          "of the port's quantity", coefficient);
      field.level = static_cast<int>(level);  // each level is a grid of its own
      result.push_back(std::move(field));
    }
    if (!one.closed) continue;
    GridPlacement faces = one.grid;
    faces.resolution += 1;
    Field closed = FieldsOfTexels<1>(faces, {one.closed}, 0)
                       .make<Vec3fGrid>("closed",
                                        "shares of the faces to the voxels at lower x, y and z that surfaces "
                                        "close",
                                        "1", rgb);
    closed.level = static_cast<int>(level);
    result.push_back(std::move(closed));
  }
  return result;
}

/// Density 1 in a box: one leaf, which becomes one tile, with voxels shaped like the box.
Field homogeneousDensity(const Bounds& bounds) {
  Field field;
  field.low = glm::dvec3(bounds.low);
  field.resolution = glm::ivec3(kLeaf);
  field.voxelSize = (glm::dvec3(bounds.high) - field.low) / static_cast<double>(kLeaf);
  field.type = openvdb::typeNameAsString<float>();
  field.unit = "1";
  field.gridClass = openvdb::GRID_FOG_VOLUME;
  field.values = [resolution = field.resolution]() -> openvdb::GridBase::Ptr {
    using Node = FloatGrid::TreeType::LeafNodeType;
    const auto everywhere = [](std::size_t) { return true; };
    const auto fill = [](std::size_t, Node& node) { node.fill(1.0f, true); };
    return sparseGrid<FloatGrid>(LeafLayout(resolution), "density", everywhere, fill);
  };
  return field;
}

std::vector<Field> fields(const ScatteringGrid& port) {
  std::vector<Field> result;
  for (const ScatteringGrid::Medium& medium : port.media) {
    if (!medium.density && medium.bounds.empty) continue;
    Field field;
    if (medium.density) {
      const FieldsOfTexels<1> texels(medium.grid, {medium.density}, 0);
      field = asFog(texels.make<FloatGrid>({}, {}, "1", red));
    } else {
      field = homogeneousDensity(medium.bounds);
    }
    field.name = port.media.size() == 1 ? "density" : "density_" + medium.name;
    field.quantity = "density, a factor of the medium's extinction";
    field.constants.insertMeta("lumivox.medium", openvdb::StringMetadata(medium.name));
    field.constants.insertMeta("lumivox.extinction", openvdb::Vec3SMetadata(vdbVector(medium.extinction)));
    field.constants.insertMeta("lumivox.extinction_unit", openvdb::StringMetadata("/m at density 1"));
    field.constants.insertMeta("lumivox.albedo", openvdb::Vec3SMetadata(vdbVector(medium.albedo)));
    field.constants.insertMeta("lumivox.anisotropy", openvdb::FloatMetadata(medium.anisotropy));
    field.mediumDensity = true;
    result.push_back(std::move(field));
  }
  return result;
}

constexpr int kWordBits = 32;  // of a component of a stack

/// Bits of stacks along z; mip levels halve x and y alone.
openvdb::GridBase::Ptr binaryGrid(const gpu::Texture& texture, int level, const glm::ivec3& resolution) {
  const gpu::TextureDescription& description = texture.description();
  const glm::ivec3 texels = levelResolution({description.width, description.height, 1}, level);
  const std::uint64_t sizeBytes =
      static_cast<std::uint64_t>(texels.x) * static_cast<std::uint64_t>(texels.y) *
      static_cast<std::uint64_t>(description.depth) * gpu::bytesPerTexel(description.format);
  requireMemory(sizeBytes, fmt::format("downloading {}", texture.label()));
  const std::vector<std::byte> bytes = texture.download(level);
  const auto word = [&](const glm::ivec3& voxel) {
    const auto x = static_cast<std::size_t>(voxel.x), y = static_cast<std::size_t>(voxel.y),
               stack = static_cast<std::size_t>(voxel.z / BinaryGrid::kStack),
               width = static_cast<std::size_t>(texels.x), height = static_cast<std::size_t>(texels.y);
    const auto component = static_cast<std::size_t>(voxel.z % BinaryGrid::kStack / kWordBits);
    return detail::readAs<std::uint32_t>(bytes.data() + 16 * (x + width * (y + height * stack)) +
                                         4 * component);
  };
  using Node = BoolGrid::TreeType::LeafNodeType;
  const LeafLayout layout(resolution);
  const auto occupied = [&](std::size_t leaf) {
    const glm::ivec3 low = layout.low(leaf), high = layout.high(leaf);
    std::uint32_t bits = 0;
    for (int y = low.y; y < high.y; ++y)
      for (int x = low.x; x < high.x; ++x) bits |= word({x, y, low.z});  // a leaf lies within one word
    return bits != 0;
  };
  const auto fill = [&](std::size_t leaf, Node& node) {
    forEachVoxel<Node>(layout, leaf, [&](const glm::ivec3& voxel, openvdb::Index offset) {
      if ((word(voxel) >> (voxel.z % kWordBits) & 1u) != 0) node.setValueOn(offset, true);
    });
  };
  return sparseGrid<BoolGrid>(layout, "occupancy", occupied, fill);
}

std::vector<Field> fields(const BinaryGrid& port) {
  std::vector<Field> result;
  for (int level = 0; level < port.stacks->description().levels; ++level) {
    glm::ivec3 resolution = levelResolution(port.grid.resolution, level);
    resolution.z = port.grid.resolution.z;
    Field field = fieldAt(port.grid, resolution, level);
    field.name = "occupancy";
    field.type = openvdb::typeNameAsString<bool>();
    field.quantity = "whether a surface touches the voxel";
    field.unit = "1";
    const glm::u64vec3 texels(resolution.x, resolution.y, port.stacks->description().depth);
    field.deviceBytes =
        texels.x * texels.y * texels.z * gpu::bytesPerTexel(port.stacks->description().format);
    field.values = [texture = port.stacks, level, resolution] {
      return binaryGrid(*texture, level, resolution);
    };
    result.push_back(std::move(field));
  }
  return result;
}

/// The voxels of a list of fragments, sorted by leaf.
class FragmentCounts {
 public:
  explicit FragmentCounts(const VoxelFragments& port) : port_(port), layout_(port.grid.resolution) {}

  template <class GridType>
  openvdb::GridBase::Ptr grid(std::string_view what) {
    if (first_.empty()) load();
    using Node = typename GridType::TreeType::LeafNodeType;
    using Value = typename GridType::ValueType;
    const auto occupied = [&](std::size_t leaf) { return first_[leaf] != first_[leaf + 1]; };
    const auto fill = [&](std::size_t leaf, Node& node) {
      for (std::size_t i = first_[leaf]; i < first_[leaf + 1]; ++i) {
        const glm::ivec3 voxel = unpacked(voxels_[i]);
        const openvdb::Index offset = Node::coordToOffset({voxel.x, voxel.y, voxel.z});
        node.setValueOn(offset, static_cast<Value>(node.getValue(offset) + 1));
      }
    };
    return sparseGrid<GridType>(layout_, what, occupied, fill);
  }

 private:
  /// VoxelFragment::voxel: i, j, k in 10 bits each.
  static glm::ivec3 unpacked(std::uint32_t packed) {
    return {static_cast<int>(packed & 1023u), static_cast<int>(packed >> 10 & 1023u),
            static_cast<int>(packed >> 20 & 1023u)};
  }
  std::size_t leafOf(const glm::ivec3& voxel) const {
    const glm::u64vec3 leaf(voxel / kLeaf), leaves(layout_.leaves);
    return leaf.x + leaves.x * (leaf.y + leaves.y * leaf.z);
  }
  void load();

  VoxelFragments port_;
  LeafLayout layout_;
  std::vector<std::size_t> first_;     ///< of each leaf in voxels_, and the end
  std::vector<std::uint32_t> voxels_;  ///< one word a fragment
};

void FragmentCounts::load() {
  const std::vector<std::byte> head = port_.count->download(0, sizeof(std::uint32_t));
  const std::uint64_t count =
      std::min<std::uint64_t>(detail::readAs<std::uint32_t>(head.data()), port_.capacity);
  const std::uint64_t listBytes = count * VoxelFragments::kFragmentBytes;
  requireMemory(listBytes + count * sizeof(std::uint32_t) + layout_.count() * sizeof(std::size_t),
                "sorting voxel fragments");
  std::vector<std::byte> list;
  if (count > 0) list = port_.fragments->download(0, listBytes);
  const auto voxelOf = [&](std::uint64_t i) {
    return detail::readAs<std::uint32_t>(list.data() + i * VoxelFragments::kFragmentBytes);
  };
  first_.assign(layout_.count() + 1, 0);
  for (std::uint64_t i = 0; i < count; ++i) {
    const glm::ivec3 voxel = unpacked(voxelOf(i)), size = layout_.resolution;
    if (glm::any(glm::greaterThanEqual(voxel, size)))
      throw Error(fmt::format("fragment {} lies in voxel ({}, {}, {}), outside its grid of {} x {} x {}", i,
                              voxel.x, voxel.y, voxel.z, size.x, size.y, size.z));
    ++first_[leafOf(voxel) + 1];
  }
  for (std::size_t leaf = 0; leaf < layout_.count(); ++leaf) first_[leaf + 1] += first_[leaf];
  voxels_.resize(count);
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint32_t voxel = voxelOf(i);
    voxels_[next[leafOf(unpacked(voxel))]++] = voxel;
  }
}

std::vector<Field> fields(const VoxelFragments& port) {
  const auto counts = std::make_shared<FragmentCounts>(port);
  Field occupancy = fieldAt(port.grid, port.grid.resolution, 0);
  occupancy.deviceBytes = port.fragments->sizeBytes() + port.count->sizeBytes();
  occupancy.unit = "1";
  Field number = occupancy;
  occupancy.name = "occupancy";
  occupancy.type = openvdb::typeNameAsString<bool>();
  occupancy.quantity = "whether a surface touches the voxel";
  occupancy.values = [counts] { return counts->grid<BoolGrid>("occupancy"); };
  number.name = "fragments";
  number.type = openvdb::typeNameAsString<std::int32_t>();
  number.quantity = "surface samples in the voxel";
  number.values = [counts] { return counts->grid<Int32Grid>("fragments"); };
  return {occupancy, number};
}

// ---- finding the function for a port -------------------------------------------------------------------

struct PortKind {
  const char* name;
  std::vector<Field> (*fieldsOf)(const OutBase&);
};

template <class Port>
PortKind kindOf() {
  return {Port::kPortKind,
          [](const OutBase& output) { return fields(static_cast<const Out<Port>&>(output).value()); }};
}

const std::array<PortKind, 7>& kinds() {
  static const std::array<PortKind, 7> table = {
      kindOf<VoxelFragments>(), kindOf<OccupancyGrid>(), kindOf<BinaryGrid>(),    kindOf<AttributeGrid>(),
      kindOf<RadianceGrid>(),   kindOf<ShGrid>(),        kindOf<ScatteringGrid>()};
  return table;
}

const PortKind* findKind(const std::string& name) {
  for (const PortKind& kind : kinds())
    if (name == kind.name) return &kind;
  return nullptr;
}

}  // namespace

std::vector<std::string> exportableKinds() {
  std::vector<std::string> names;
  for (const PortKind& kind : kinds()) names.emplace_back(kind.name);
  return names;
}

bool isExportable(const std::string& portKind) {
  return findKind(portKind) != nullptr;
}

std::vector<Field> fieldsOf(const OutBase& output) {
  const PortKind* kind = findKind(output.portKind());
  assert(kind != nullptr && output.hasValue());
  return kind->fieldsOf(output);
}

}  // namespace lumivox::vdb
