#include "vdbexport/fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/ports.h"
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

glm::ivec3 unpackedVoxel(std::uint32_t packed) {
  return {static_cast<int>(packed & 1023u), static_cast<int>(packed >> 10 & 1023u),
          static_cast<int>(packed >> 20 & 1023u)};
}

constexpr int kWordBits = 32;  // of a component of a stack

/// A grid from bits that are stacked along z; mip levels halve x and y alone.
openvdb::GridBase::Ptr gridOfBits(const gpu::Texture& texture, int level, const glm::ivec3& resolution) {
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

glm::ivec3 voxelOf(std::uint32_t packed) {
  return unpackedVoxel(packed);
}
const glm::ivec3& voxelOf(const VoxelsRead::Voxel& read) {
  return read.voxel;
}

/// Sorts items, which lie in voxels in any order, by leaf.
template <class Item>
class SortedVoxels {
 public:
  explicit SortedVoxels(const glm::ivec3& resolution) : layout_(resolution) {}

  /// Item `i` of `count` is `itemOf(i)`. Error if it lies outside the grid.
  template <class ItemOf>
  void sort(std::uint64_t count, const ItemOf& itemOf) {
    first_.assign(layout_.count() + 1, 0);
    for (std::uint64_t i = 0; i < count; ++i) {
      const glm::ivec3 voxel = voxelOf(itemOf(i)), size = layout_.resolution;
      if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(voxel, size)))
        throw Error(fmt::format("fragment {} lies in voxel ({}, {}, {}), outside its grid of {} x {} x {}", i,
                                voxel.x, voxel.y, voxel.z, size.x, size.y, size.z));
      ++first_[leafOf(voxel) + 1];
    }
    for (std::size_t leaf = 0; leaf < layout_.count(); ++leaf) first_[leaf + 1] += first_[leaf];
    items_.resize(count);
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::uint64_t i = 0; i < count; ++i) items_[next[leafOf(voxelOf(itemOf(i)))]++] = itemOf(i);
  }
  bool sorted() const { return !first_.empty(); }
  const LeafLayout& layout() const { return layout_; }

  /// Calls `set(node, offset, item)` for every item.
  template <class GridType, class Set>
  openvdb::GridBase::Ptr grid(std::string_view what, const Set& set) const {
    using Node = typename GridType::TreeType::LeafNodeType;
    const auto occupied = [&](std::size_t leaf) { return first_[leaf] != first_[leaf + 1]; };
    const auto fill = [&](std::size_t leaf, Node& node) {
      for (std::size_t i = first_[leaf]; i < first_[leaf + 1]; ++i) {
        const glm::ivec3 voxel = voxelOf(items_[i]);
        set(node, Node::coordToOffset({voxel.x, voxel.y, voxel.z}), items_[i]);
      }
    };
    return sparseGrid<GridType>(layout_, what, occupied, fill);
  }

 private:
  std::size_t leafOf(const glm::ivec3& voxel) const {
    const glm::u64vec3 leaf(voxel / kLeaf), leaves(layout_.leaves);
    return leaf.x + leaves.x * (leaf.y + leaves.y * leaf.z);
  }
  LeafLayout layout_;
  std::vector<std::size_t> first_;  ///< index in items_ of each leaf's first item, and at last their count
  std::vector<Item> items_;
};

/// The voxels of a list on the device, downloaded when they are first needed.
class ListedVoxels {
 public:
  ListedVoxels(VoxelList list, const glm::ivec3& resolution) : list_(std::move(list)), voxels_(resolution) {}

  /// The value of a voxel is true or, in a grid of numbers, its number of items.
  template <class GridType>
  openvdb::GridBase::Ptr grid(std::string_view what) {
    if (!voxels_.sorted()) load();
    using Value = typename GridType::ValueType;
    return voxels_.grid<GridType>(what, [](auto& node, openvdb::Index offset, std::uint32_t) {
      node.setValueOn(offset, static_cast<Value>(node.getValue(offset) + 1));
    });
  }

 private:
  void load() {
    const std::vector<std::byte> head = list_.count->download(0, sizeof(std::uint32_t));
    const std::uint64_t count =
        std::min<std::uint64_t>(detail::readAs<std::uint32_t>(head.data()), list_.capacity);
    const std::uint64_t listBytes = count * list_.itemBytes;
    requireMemory(listBytes + count * sizeof(std::uint32_t) + voxels_.layout().count() * sizeof(std::size_t),
                  "sorting voxel fragments");
    std::vector<std::byte> items;
    if (count > 0) items = list_.items->download(0, listBytes);
    voxels_.sort(count, [&](std::uint64_t i) {
      return detail::readAs<std::uint32_t>(items.data() + i * list_.itemBytes);
    });
  }

  VoxelList list_;
  SortedVoxels<std::uint32_t> voxels_;
};

openvdb::GridBase::Ptr gridOfRead(const VoxelsRead& source, const glm::ivec3& resolution,
                                  const std::string& what) {
  const std::vector<VoxelsRead::Voxel> read = source.read();
  SortedVoxels<VoxelsRead::Voxel> voxels(resolution);
  voxels.sort(read.size(), [&](std::uint64_t i) { return read[i]; });
  if (source.components == 1)
    return voxels.grid<FloatGrid>(what, [](auto& node, openvdb::Index offset, const VoxelsRead::Voxel& one) {
      node.setValueOn(offset, one.value.x);
    });
  return voxels.grid<Vec3fGrid>(what, [](auto& node, openvdb::Index offset, const VoxelsRead::Voxel& one) {
    node.setValueOn(offset, vdbVector(one.value));
  });
}

/// A grid with the value 1 in every voxel; full leaves become tiles.
openvdb::GridBase::Ptr filledGrid(const glm::ivec3& resolution, const std::string& what) {
  using Node = FloatGrid::TreeType::LeafNodeType;
  const LeafLayout layout(resolution);
  const auto everywhere = [](std::size_t) { return true; };
  const auto fill = [&](std::size_t leaf, Node& node) {
    forEachVoxel<Node>(layout, leaf,
                       [&](const glm::ivec3&, openvdb::Index offset) { node.setValueOn(offset, 1.0f); });
  };
  return sparseGrid<FloatGrid>(layout, what, everywhere, fill);
}

/// Makes fields from textures, lists and boxes: type, size on the device and values. Fields of the same
/// textures or lists share one download.
class FieldMaker {
 public:
  Field make(const PortContents::Field& from) {
    Field field;
    field.onDevice = from;
    field.name = from.name;
    field.level = from.level;
    field.quantity = from.what->quantity;
    field.unit = from.unit;
    field.low = from.box.low;
    field.voxelSize = from.box.voxelSize;
    field.resolution = from.box.resolution;
    const PortField::Role role = from.what->role;
    field.mediumDensity = role == PortField::Role::density;
    if (role == PortField::Role::fog || role == PortField::Role::density)
      field.gridClass = openvdb::GRID_FOG_VOLUME;
    if (role == PortField::Role::direction) field.vectorType = openvdb::VEC_COVARIANT;
    for (const auto& [name, value] : from.constants) addConstant(field, "lumivox." + name, value);
    std::visit([&](const auto& source) { values(field, source); }, from.source);
    return field;
  }

 private:
  template <class GridType>
  static void setType(Field& field) {
    field.type = openvdb::typeNameAsString<typename GridType::ValueType>();
  }

  static void addConstant(Field& field, const std::string& name,
                          const std::variant<std::string, float, glm::vec3>& value) {
    if (const auto* text = std::get_if<std::string>(&value))
      field.constants.insertMeta(name, openvdb::StringMetadata(*text));
    else if (const auto* vector = std::get_if<glm::vec3>(&value))
      field.constants.insertMeta(name, openvdb::Vec3SMetadata(vdbVector(*vector)));
    else
      field.constants.insertMeta(name, openvdb::FloatMetadata(std::get<float>(value)));
  }

  void values(Field& field, const VoxelTexels& source) {
    if (source.textures.size() == 1) return texels<1>(field, source);
    if (source.textures.size() == 3) return texels<3>(field, source);
    throw Error(fmt::format("field '{}' is made of {} textures; expected 1 or 3", field.name,
                            source.textures.size()));
  }

  template <std::size_t kCount>
  void texels(Field& field, const VoxelTexels& source) {
    std::array<TexelsRef, kCount> sources;
    for (std::size_t i = 0; i < kCount; ++i) {
      TexelsRef& known = texels_[{source.textures[i].get(), source.level}];
      if (known == nullptr) known = std::make_shared<Texels>(source.textures[i], source.level);
      sources[i] = known;
      field.deviceBytes += known->sizeBytes();
      if (known->layout().resolution != field.resolution)
        throw Error(fmt::format("field '{}' is of {} x {} x {} voxels, but its texture of {} x {} x {}",
                                field.name, field.resolution.x, field.resolution.y, field.resolution.z,
                                known->layout().resolution.x, known->layout().resolution.y,
                                known->layout().resolution.z));
    }
    const auto component = [channels = source.channels, unit = source.unit](
                               const std::array<glm::vec4, kCount>& texel, std::size_t i) {
      return texel[static_cast<std::size_t>(channels[i].texture)][channels[i].component] * unit;
    };
    if (source.channels.size() == 1) {
      setType<FloatGrid>(field);
      field.values = [sources, component, name = field.name]() -> openvdb::GridBase::Ptr {
        return gridOf<FloatGrid>(sources, name, [&](const auto& texel) { return component(texel, 0); });
      };
    } else if (source.channels.size() == 3) {
      setType<Vec3fGrid>(field);
      field.values = [sources, component, name = field.name]() -> openvdb::GridBase::Ptr {
        return gridOf<Vec3fGrid>(sources, name, [&](const auto& texel) {
          return openvdb::Vec3f(component(texel, 0), component(texel, 1), component(texel, 2));
        });
      };
    } else {
      throw Error(
          fmt::format("field '{}' has {} components; expected 1 or 3", field.name, source.channels.size()));
    }
  }

  void values(Field& field, const VoxelBits& source) {
    setType<BoolGrid>(field);
    const gpu::TextureDescription& description = source.stacks->description();
    const glm::u64vec3 size(levelResolution({description.width, description.height, 1}, source.level));
    field.deviceBytes = size.x * size.y * static_cast<std::uint64_t>(description.depth) *
                        gpu::bytesPerTexel(description.format);
    field.values = [source, resolution = field.resolution] {
      return gridOfBits(*source.stacks, source.level, resolution);
    };
  }

  void values(Field& field, const VoxelList& source) {
    std::shared_ptr<ListedVoxels>& known = lists_[source.items.get()];
    if (known == nullptr) known = std::make_shared<ListedVoxels>(source, field.resolution);
    field.deviceBytes = source.items->sizeBytes() + source.count->sizeBytes();
    if (source.counts) {
      setType<Int32Grid>(field);
      field.values = [known, name = field.name] { return known->grid<Int32Grid>(name); };
    } else {
      setType<BoolGrid>(field);
      field.values = [known, name = field.name] { return known->grid<BoolGrid>(name); };
    }
  }

  void values(Field& field, const VoxelsFilled&) {
    setType<FloatGrid>(field);
    field.values = [resolution = field.resolution, name = field.name] {
      return filledGrid(resolution, name);
    };
  }

  void values(Field& field, const VoxelsRead& source) {
    if (source.components == 1)
      setType<FloatGrid>(field);
    else
      setType<Vec3fGrid>(field);
    field.deviceBytes = source.deviceBytes;
    field.values = [source, resolution = field.resolution, name = field.name] {
      return gridOfRead(source, resolution, name);
    };
  }

  std::map<std::pair<const gpu::Texture*, int>, TexelsRef> texels_;
  std::map<const gpu::Buffer*, std::shared_ptr<ListedVoxels>> lists_;
};

}  // namespace

std::vector<Field> fieldsOf(const OutBase& output) {
  const PortContents contents = output.contents();
  std::vector<Field> fields;
  FieldMaker maker;
  for (const PortContents::Field& field : contents.fields()) fields.push_back(maker.make(field));
  return fields;
}

}  // namespace lumivox::vdb
