#pragma once

#include <bit>
#include <memory>
#include <span>

#include "../elements/element_tree.h"
#include "direction_bins.h"
#include "lumivox/pipeline/port.h"

namespace lumivox::implicit_visibility {

/// What an element sees in a bin: another element, its side and its distance. Two words on the device.
struct ElementLink {
  static constexpr std::uint32_t kBack = 0x8000u;
  /// Bin in the lower 15 bits, then whether a disc's back is seen; upper half of the bits of the distance as
  /// a float.
  std::uint32_t binAndDistance = 0;
  std::uint32_t node = 0;  ///< of ElementTree

  ElementLink() = default;
  ElementLink(std::uint32_t bin, float distance, std::uint32_t seen, bool back)
      : binAndDistance(bin | (back ? kBack : 0u) | (std::bit_cast<std::uint32_t>(distance) & 0xffff0000u)),
        node(seen) {}
  std::uint32_t bin() const { return binAndDistance & (kBack - 1u); }
  bool back() const { return (binAndDistance & kBack) != 0u; }
  /// m, too small by at most 2^-7 of it.
  float distance() const { return std::bit_cast<float>(binAndDistance & 0xffff0000u); }
  bool operator==(const ElementLink&) const = default;
};

/// Lists of different lengths, one behind the other: list i is values[first[i]] .. values[first[i + 1] - 1].
template <class Value>
struct ElementLists {
  std::vector<std::uint64_t> first{0};
  std::vector<Value> values;
  std::size_t size() const { return first.size() - 1; }
  std::span<const Value> operator[](std::size_t i) const {
    return std::span(values).subspan(first[i], first[i + 1] - first[i]);
  }
  bool operator==(const ElementLists&) const = default;
};

/// Which elements see which (Dong, Kautz, Theobalt and Seidel 2007, Sec. 4.2). create_links makes the pairs
/// of nodes that may exchange light, listed at both ends. push_links adds `seen`, what leaves see, and its
/// buffers.
struct ElementLinks {
  int bins = 0;  ///< along a side of a face of the cube of directions
  BinMapping mapping = BinMapping::even;
  /// Partners of each node where one end moves, and partners where both stand still. Null where every leaf is
  /// a partner of every other one.
  std::shared_ptr<const ElementLists<std::uint32_t>> movingPartners, stillPartners;
  std::shared_ptr<const ElementLists<ElementLink>>
      seen;  ///< for each leaf, by increasing bins, each bin at most once
  gpu::BufferRef directions, first, links;
  gpu::BufferRef lights;  ///< null where nothing emits
};

}  // namespace lumivox::implicit_visibility

namespace lumivox {

template <>
struct PortTraits<implicit_visibility::ElementLinks> {
  static PortKind kind() {
    return {
        "ElementLinks",
        "visibility between surface elements, by bins of directions",
        {{"directions", "buffer", "vec4 a bin: xyz direction of its centre; w solid angle, sr",
          PortResource::Sign::any},
         {"first", "buffer",
          "uvec4 a leaf: where its links begin, and how many there are, by growing bins; bits of the float "
          "projectionScale() of its normal; 0"},
         {"links", "buffer",
          "uvec2 a link: bin (lower 15 bits), 1 where the back of a disc is seen, and upper half of the distance as "
          "a float, m; node that is seen"},
         {"lights", "buffer",
          "uvec2 a leaf: where its list begins, counted in words of this buffer, and its length; then the lists: "
          "numbers of links to nodes that emit, growing"}}};
  }
  static void contents(const implicit_visibility::ElementLinks& port, PortContents& contents) {
    contents.buffer("first", port.first);
    contents.buffer("links", port.links);
    contents.buffer("lights", port.lights);
  }
};

}  // namespace lumivox
