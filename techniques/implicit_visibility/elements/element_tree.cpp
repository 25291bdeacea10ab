#include "element_tree.h"

#include <algorithm>

namespace lumivox::implicit_visibility {

QuadtreeNumbers::QuadtreeNumbers(std::uint32_t leaves) : first_{0} {
  for (std::uint32_t size = leaves; size > 0; size = size == 1 ? 0 : (size + 3) / 4)
    first_.push_back(first_.back() + size);
}

std::uint32_t QuadtreeNumbers::levelOf(std::uint32_t node) const {
  return static_cast<std::uint32_t>(std::upper_bound(first_.begin(), first_.end(), node) - first_.begin()) -
         1;
}

std::uint32_t QuadtreeNumbers::parent(std::uint32_t node) const {
  const std::uint32_t level = levelOf(node);
  if (level + 1 == levelCount()) return kNoElement;
  return first_[level + 1] + (node - first_[level]) / 4;
}

std::uint32_t QuadtreeNumbers::firstChild(std::uint32_t node) const {
  const std::uint32_t level = levelOf(node);
  return level == 0 ? kNoElement : first_[level - 1] + 4 * (node - first_[level]);
}

std::uint32_t QuadtreeNumbers::childCount(std::uint32_t node) const {
  const std::uint32_t level = levelOf(node);
  return level == 0 ? 0 : std::min(levelSize(level - 1) - 4 * (node - first_[level]), 4u);
}

}  // namespace lumivox::implicit_visibility
