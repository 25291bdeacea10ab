// Elements and links of a scene, pass by pass, for tests of implicit visibility.
#pragma once

#include <span>
#include <vector>

#include "../../techniques/implicit_visibility/elements/surface_elements.h"
#include "../../techniques/implicit_visibility/links/element_light.h"
#include "../../techniques/implicit_visibility/links/element_links.h"
#include "support/passes.h"

namespace lumivox::test {

using implicit_visibility::ElementLight, implicit_visibility::ElementLink, implicit_visibility::ElementLinks,
    implicit_visibility::ElementLists, implicit_visibility::ElementState, implicit_visibility::ElementTree,
    implicit_visibility::kNoElement, implicit_visibility::QuadtreeNumbers,
    implicit_visibility::SurfaceElements, implicit_visibility::BinMapping, implicit_visibility::DirectionBins,
    implicit_visibility::BinTable;

/// The results of the three passes `elements`, `create_links` and `push_links`.
struct LinkedScene {
  SurfaceElements elements;
  ElementLinks pairs, links;

  const ElementTree& tree() const { return *elements.tree; }
  const ElementState& state() const { return *elements.state; }
  std::span<const ElementLink> seenBy(std::uint32_t leaf) const { return (*links.seen)[leaf]; }
};

struct LinkSettings {
  Settings elements, create, push;
};

inline LinkedScene linked(const Scene& scene, const LinkSettings& settings = {}, double time = 0.0) {
  LinkedScene made;
  made.elements = LonePass("implicit_visibility.elements", scene, settings.elements, time)
                      .out<SurfaceElements>("elements");
  made.pairs = LonePass("implicit_visibility.create_links", scene, settings.create, time)
                   .in("elements", made.elements)
                   .out<ElementLinks>("links");
  made.links = LonePass("implicit_visibility.push_links", scene, settings.push, time)
                   .in("elements", made.elements)
                   .in("links", made.pairs)
                   .out<ElementLinks>("links");
  return made;
}

/// The weight of a direction bin's light at a leaf: its projected solid angle, positive above the leaf's
/// plane and negative below.
class BinWeights {
 public:
  explicit BinWeights(const ElementLinks& links) : table_(DirectionBins(links.bins, links.mapping)) {}
  double operator()(const glm::vec3& normal, std::uint32_t bin) const {
    return static_cast<double>(glm::dot(normal, glm::vec3(table_.bins[bin])) * table_.bins[bin].w);
  }
  double scale(const glm::vec3& normal) const { return static_cast<double>(table_.projectionScale(normal)); }
  std::size_t count() const { return table_.bins.size(); }

 private:
  BinTable table_;
};

}  // namespace lumivox::test
