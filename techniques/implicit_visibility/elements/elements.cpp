// The surface as elements (Dong et al. 2007, Sec. 4.1 and 4.2.1; steps 1, 2 and 4 of Algorithm 1).
#include "../passes.h"
#include "element_hierarchy.h"

namespace lumivox::implicit_visibility {
namespace {

class ElementsPass : public Pass {
  In<ElementHierarchy> hierarchy{
      this, "hierarchy", Presence::optional,
      "trees that the pass `hierarchy` made; 'source', 'segments', 'elements' and 'share' are then ignored"};
  ElementWords words{this};
  Param<Areas> areas{
      this, "areas", Areas::now,
      "areas of elements on deforming meshes; now: as stretched; rest: as in the scene at rest",
      published(Areas::rest)};
  Out<SurfaceElements> result{this, "elements", "the surface as discs, and trees of them"};

  Reads readsFrom() const override { return Reads::geometry | Reads::materials; }
  bool worksOnHost() const override { return true; }

  void run(PassContext& frame) override {
    const ElementHierarchy made = hierarchy ? *hierarchy : words.made(frame);
    SurfaceElements elementsNow = made.fixed;
    elementsNow.state = std::make_shared<const ElementState>(
        stateOf(*made.forest, frame.sceneDescription(), frame.snapshot(), areas));
    const ElementState& state = *elementsNow.state;
    std::vector<glm::vec4> positions, normals;
    for (std::size_t node = 0; node < state.position.size(); ++node) {
      positions.emplace_back(state.position[node], state.area[node]);
      normals.emplace_back(state.normal[node], state.radius[node]);
    }
    elementsNow.position = elementTexture(frame, positions, "positions of elements");
    elementsNow.normal = elementTexture(frame, normals, "normals of elements");
    result = elementsNow;
  }
};

}  // namespace

void addElements(TechniqueRegistry& registry) {
  registry.add<ElementsPass>("elements", "The surface as discs in quadtrees (Dong et al. 2007, Sec. 4.1)");
}

}  // namespace lumivox::implicit_visibility
