#include "vdbexport/difference.h"

#include <fmt/format.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox::vdb {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;

// In voxels: two lattices count as equal, and two borders as one, if they differ by less.
constexpr double kSnap = 1e-5;

/// Where cubic voxels lie: the centre of voxel (0,0,0) and their size, m.
struct Lattice {
  Vec3d origin;
  double size = 1.0;
};

Lattice latticeOf(const openvdb::GridBase& grid, const std::string& what) {
  const auto refuse = [&](const std::string& found) {
    throw Error(fmt::format("{}: grid '{}' has {}; expected a linear transform with cubic voxels", what,
                            grid.getName(), found));
  };
  const openvdb::math::Transform& transform = grid.transform();
  if (!transform.isLinear()) refuse("a perspective transform");
  const openvdb::Mat4d matrix = transform.baseMap()->getAffineMap()->getMat4();
  const Vec3d size(matrix[0][0], matrix[1][1], matrix[2][2]);
  const double largest = std::max({std::abs(size.x()), std::abs(size.y()), std::abs(size.z())});
  if (!(largest > 0.0) || !std::isfinite(largest)) refuse("voxels without a size");
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (i != j && std::abs(matrix[i][j]) > kSnap * largest) refuse("a rotation or a shear");
  if (size.x() <= 0.0 || size.y() <= 0.0 || size.z() <= 0.0) refuse("a mirrored axis");
  if (std::abs(size.x() - size.y()) > kSnap * largest || std::abs(size.x() - size.z()) > kSnap * largest)
    refuse(fmt::format("voxels of {:.6g} x {:.6g} x {:.6g} m", size.x(), size.y(), size.z()));
  return {{matrix[3][0], matrix[3][1], matrix[3][2]}, size.x()};
}

template <class Value>
struct Numbers {  // a scalar
  using Mean = double;
  static constexpr int kComponents = 1;
  static Mean of(const Value& value) { return static_cast<double>(value); }
  static double component(const Value& value, int) { return static_cast<double>(value); }
};
template <class T>
struct Numbers<openvdb::math::Vec3<T>> {
  using Mean = Vec3d;
  static constexpr int kComponents = 3;
  static Mean of(const openvdb::math::Vec3<T>& value) { return Vec3d(value); }
  static double component(const openvdb::math::Vec3<T>& value, int i) {
    return static_cast<double>(value[i]);
  }
};

// ---- onto a coarser lattice ----------------------------------------------------------------------------

/// The coarse voxels that a fine one overlaps along one axis, and the share of each that it fills.
struct Overlap {
  int first = 0, count = 1;
  std::array<double, 2> share{1.0, 0.0};
};

Overlap overlapOf(int index, double fineSize, double fineOrigin, const Lattice& coarse, int axis) {
  const auto snapped = [](double x) { return std::abs(x - std::round(x)) < kSnap ? std::round(x) : x; };
  // Borders in coarse voxels, counted from the lower border of coarse voxel 0.
  const double start = (fineOrigin - coarse.origin[axis]) / coarse.size + 0.5;
  const double low = snapped(start + (index - 0.5) * fineSize / coarse.size),
               high = snapped(start + (index + 0.5) * fineSize / coarse.size);
  Overlap overlap;
  overlap.first = static_cast<int>(std::floor(low));
  overlap.count = std::clamp(static_cast<int>(std::ceil(high)) - overlap.first, 1, 2);
  const double border = overlap.first + 1.0;
  overlap.share = {std::min(high, border) - low, std::max(0.0, high - border)};
  return overlap;
}

/// The means of a fine grid over the voxels of a coarser lattice.
template <class TreeType>
auto averagedOnto(const TreeType& fine, const Lattice& from, const Lattice& onto, const std::string& what) {
  using Value = typename TreeType::ValueType;
  using Mean = typename Numbers<Value>::Mean;
  using MeanTree = typename TreeType::template ValueConverter<Mean>::Type;
  constexpr std::uint64_t kLeafVoxels = 512;
  // At worst every active fine voxel lies in a leaf of its own.
  const double ratio = onto.size / from.size;
  const auto leaves = static_cast<double>(fine.leafCount()) +
                      static_cast<double>(fine.activeTileCount() == 0 ? 0 : fine.activeVoxelCount()) /
                          static_cast<double>(kLeafVoxels) / (ratio * ratio * ratio);
  requireMemory(static_cast<std::uint64_t>(std::min(8.0 * leaves * kLeafVoxels * sizeof(Mean), 1e18)), what);

  const Mean background = Numbers<Value>::of(fine.background());
  MeanTree coarse(background);
  openvdb::tree::ValueAccessor<MeanTree> accessor(coarse);
  const auto add = [&](const Coord& voxel, const Mean& value) {
    const Overlap x = overlapOf(voxel.x(), from.size, from.origin.x(), onto, 0),
                  y = overlapOf(voxel.y(), from.size, from.origin.y(), onto, 1),
                  z = overlapOf(voxel.z(), from.size, from.origin.z(), onto, 2);
    for (int i = 0; i < x.count; ++i)
      for (int j = 0; j < y.count; ++j)
        for (int k = 0; k < z.count; ++k) {
          const Coord target(x.first + i, y.first + j, z.first + k);
          const double share = x.share[static_cast<std::size_t>(i)] * y.share[static_cast<std::size_t>(j)] *
                               z.share[static_cast<std::size_t>(k)];
          accessor.setValue(target, accessor.getValue(target) + (value - background) * share);
        }
  };
  for (auto value = fine.cbeginValueOn(); value; ++value) {
    openvdb::CoordBBox box;
    value.getBoundingBox(box);
    const Mean mean = Numbers<Value>::of(*value);
    for (const Coord& voxel : box) add(voxel, mean);
  }
  return coarse;
}

// ---- on one lattice ------------------------------------------------------------------------------------

template <class FirstTree, class SecondTree>
class Comparison {
 public:
  Comparison(const FirstTree& first, const SecondTree& second, double tolerance)
      : first_(&first), second_(&second), tolerance_(tolerance) {}

  GridDifference run(const std::string& what) const {
    openvdb::MaskTree either(*first_, false, openvdb::TopologyCopy());
    either.topologyUnion(openvdb::MaskTree(*second_, false, openvdb::TopologyCopy()));
    constexpr std::uint64_t kVoxelsPerByte = 4;  // of a bit tree, including its nodes
    requireMemory(either.activeVoxelCount() / kVoxelsPerByte, what);
    either.voxelizeActiveTiles();
    const openvdb::tree::LeafManager<openvdb::MaskTree> leaves(either);
    // Deterministic, so that the sum does not depend on the threads.
    const Sum sum = tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, leaves.leafCount(), 64), Sum{},
        [&](const auto& range, Sum partial) {
          openvdb::tree::ValueAccessor<const FirstTree> first(*first_);
          openvdb::tree::ValueAccessor<const SecondTree> second(*second_);
          for (std::size_t i = range.begin(); i < range.end(); ++i)
            for (auto voxel = leaves.leaf(i).cbeginValueOn(); voxel; ++voxel)
              compare(first, second, voxel.getCoord(), partial);
          return partial;
        },
        [](const Sum& a, const Sum& b) { return joined(a, b); });
    GridDifference result = sum.found;
    if (result.voxels > 0)
      result.rms = std::sqrt(sum.squares / (static_cast<double>(result.voxels) * kComponents));
    return result;
  }

 private:
  using First = Numbers<typename FirstTree::ValueType>;
  using Second = Numbers<typename SecondTree::ValueType>;
  static constexpr int kComponents = First::kComponents;
  static_assert(kComponents == Second::kComponents);
  struct Sum {
    GridDifference found;
    double squares = 0.0;
  };

  static Sum joined(Sum a, const Sum& b) {
    a.squares += b.squares;
    a.found.voxels += b.found.voxels;
    a.found.differing += b.found.differing;
    a.found.onlyFirst += b.found.onlyFirst;
    a.found.onlySecond += b.found.onlySecond;
    if (b.found.largest > a.found.largest) {
      a.found.largest = b.found.largest;
      a.found.where = b.found.where;
    }
    return a;
  }

  template <class FirstAccessor, class SecondAccessor>
  void compare(FirstAccessor& first, SecondAccessor& second, const Coord& voxel, Sum& sum) const {
    typename FirstTree::ValueType firstValue;
    typename SecondTree::ValueType secondValue;
    const bool inFirst = first.probeValue(voxel, firstValue),
               inSecond = second.probeValue(voxel, secondValue);
    ++sum.found.voxels;
    if (inFirst && !inSecond) ++sum.found.onlyFirst;
    if (inSecond && !inFirst) ++sum.found.onlySecond;
    double largest = 0.0;
    for (int i = 0; i < kComponents; ++i) {
      const double a = First::component(firstValue, i), b = Second::component(secondValue, i);
      double apart = a == b || (std::isnan(a) && std::isnan(b)) ? 0.0 : std::abs(a - b);
      if (std::isnan(apart)) apart = std::numeric_limits<double>::infinity();
      sum.squares += apart * apart;
      largest = std::max(largest, apart);
    }
    if (largest > tolerance_) ++sum.found.differing;
    if (largest > sum.found.largest) {
      sum.found.largest = largest;
      sum.found.where = voxel;
    }
  }

  const FirstTree* first_;
  const SecondTree* second_;
  double tolerance_;
};

template <class FirstTree, class SecondTree>
GridDifference compare(const FirstTree& first, const SecondTree& second, double tolerance,
                       const std::string& what) {
  return Comparison<FirstTree, SecondTree>(first, second, tolerance).run(what);
}

template <class GridType>
GridDifference differenceOf(const GridType& first, const GridType& second, double tolerance,
                            const std::string& what) {
  // Voxels of one transform are the same boxes, whatever their shape.
  if (first.transform().isLinear() && first.transform() == second.transform())
    return compare(first.tree(), second.tree(), tolerance, what);
  const Lattice a = latticeOf(first, what), b = latticeOf(second, what);
  const bool sameSize = std::abs(a.size - b.size) <= kSnap * std::min(a.size, b.size);
  const Vec3d offset = (b.origin - a.origin) / a.size;
  if (sameSize && std::max({std::abs(offset.x()), std::abs(offset.y()), std::abs(offset.z())}) < kSnap)
    return compare(first.tree(), second.tree(), tolerance, what);
  if (sameSize || a.size > b.size) {
    GridDifference result = compare(first.tree(), averagedOnto(second.tree(), b, a, what), tolerance, what);
    result.lattice = "first";
    return result;
  }
  GridDifference result = compare(averagedOnto(first.tree(), a, b, what), second.tree(), tolerance, what);
  result.lattice = "second";
  return result;
}

/// Calls differenceOf for the type that both grids have.
template <class... GridTypes>
bool compareAs(const openvdb::GridBase& first, const openvdb::GridBase& second, double tolerance,
               const std::string& what, GridDifference& result) {
  const auto tried = [&]<class GridType>() {
    if (!first.isType<GridType>() || !second.isType<GridType>()) return false;
    result = differenceOf(static_cast<const GridType&>(first), static_cast<const GridType&>(second),
                          tolerance, what);
    return true;
  };
  return (tried.template operator()<GridTypes>() || ...);
}

}  // namespace

GridDifference difference(const openvdb::GridBase& first, const openvdb::GridBase& second, double tolerance,
                          const std::string& what) {
  GridDifference result;
  if (compareAs<openvdb::FloatGrid, openvdb::Vec3fGrid, openvdb::BoolGrid, openvdb::Int32Grid,
                openvdb::DoubleGrid, openvdb::Vec3dGrid, openvdb::Int64Grid, openvdb::Vec3IGrid>(
          first, second, tolerance, what, result))
    return result;
  if (first.valueType() != second.valueType())
    throw Error(fmt::format("{}: grid '{}' contains {} and grid '{}' contains {}; expected the same type",
                            what, first.getName(), first.valueType(), second.getName(), second.valueType()));
  throw Error(fmt::format("{}: grid '{}' contains {}; expected numbers, vectors or bools", what,
                          first.getName(), first.valueType()));
}

}  // namespace lumivox::vdb
