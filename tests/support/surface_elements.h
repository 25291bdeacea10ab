// Elements and links of a scene, pass by pass, as tests of implicit visibility want them.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "../../techniques/implicit_visibility/elements/surface_elements.h"
#include "../../techniques/implicit_visibility/links/element_light.h"
#include "../../techniques/implicit_visibility/links/element_links.h"
#include "lumivox/gpu/device.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/pipeline.h"
#include "support/techniques.h"

namespace lumivox::test {

using implicit_visibility::ElementLight, implicit_visibility::ElementLink, implicit_visibility::ElementLinks,
    implicit_visibility::ElementLists, implicit_visibility::ElementState, implicit_visibility::ElementTree,
    implicit_visibility::kNoElement, implicit_visibility::QuadtreeNumbers,
    implicit_visibility::SurfaceElements, implicit_visibility::BinMapping, implicit_visibility::DirectionBins,
    implicit_visibility::BinTable;

/// Parameters of one of the passes.
using Settings = std::vector<std::pair<std::string, std::variant<double, std::string>>>;

inline void apply(PassHarness& harness, const Settings& settings) {
  for (const auto& [name, value] : settings)
    std::visit([&, &key = name](const auto& set) { harness.setParameter(key, set); }, value);
}

/// The three passes, one behind the other.
struct LinkedScene {
  std::vector<std::unique_ptr<PassHarness>> harnesses;
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
  const SceneSnapshot snapshot = snapshotOf(scene, time);
  const auto pass = [&](const std::string& name, const Settings& own) -> PassHarness& {
    made.harnesses.push_back(
        std::make_unique<PassHarness>(device(), techniques(), "implicit_visibility", name, scene, snapshot));
    apply(*made.harnesses.back(), own);
    return *made.harnesses.back();
  };
  PassHarness& elements = pass("elements", settings.elements);
  elements.run();
  made.elements = elements.output<SurfaceElements>("elements");
  PassHarness& create = pass("create_links", settings.create);
  create.setInput("elements", made.elements);
  create.run();
  made.pairs = create.output<ElementLinks>("links");
  PassHarness& push = pass("push_links", settings.push);
  push.setInput("elements", made.elements);
  push.setInput("links", made.pairs);
  push.run();
  made.links = push.output<ElementLinks>("links");
  return made;
}

/// Projected solid angle of a bin of a leaf, by which its light counts; positive above the plane, negative
/// below it.
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
