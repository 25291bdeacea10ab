// The surface as elements (Dong et al. 2007, Sec. 4.1 and 4.2.1; steps 1, 2 and 4 of Algorithm 1).
#include <fmt/format.h>

#include "forest.h"
#include "lumivox/base/log.h"
#include "lumivox/plugin/technique.h"
#include "passes.h"

namespace lumivox::implicit_visibility {
namespace {

class ElementsPass : public Pass {
  Param<Source> source{
      this, "source", Source::atlas,
      "atlas: elements of one size on each object, whatever its triangles; vertices: one for each "
      "loaded vertex (published)"};
  Param<Segments> segments{
      this, "segments", Segments::charts,
      "what a tree stands on; charts: connected pieces within 45 degrees; uv: islands of the "
      "texture coordinates (published)"};
  Param<int> elements{this, "elements", 4096, within(16, 1048576),
                      "about how many leaves, with source atlas"};
  Param<float> share{this, "share", 0.5f, within(0.0f, 1.0f),
                     "an object's part of the elements goes by this power of its area"};
  Param<Areas> areas{this, "areas", Areas::now,
                     "now: areas follow stretching; rest: they stay those of the scene at rest (published)"};
  Param<bool> asPublished{this, "as_published", false, "'source vertices', 'segments uv' and 'areas rest'"};
  Out<SurfaceElements> result{this, "elements", "the surface as discs, and trees of them"};

  Reads readsFrom() const override { return Reads::geometry | Reads::materials; }
  bool worksOnHost() const override { return true; }

  void run(PassContext& frame) override {
    const auto forest = frame.kept("hierarchy of elements", 0, [&] { return plant(frame); });
    const SurfaceElements fixed =
        frame.kept("reflectance of elements", forest, [&] { return upload(frame, *forest); });
    SurfaceElements elementsNow = fixed;
    elementsNow.state = std::make_shared<const ElementState>(stateOf(
        *forest, frame.sceneDescription(), frame.snapshot(), asPublished ? Areas::rest : Areas(areas)));
    const ElementState& state = *elementsNow.state;
    std::vector<glm::vec4> positions, normals;
    for (std::size_t node = 0; node < state.position.size(); ++node) {
      positions.emplace_back(state.position[node], state.area[node]);
      normals.emplace_back(state.normal[node], state.radius[node]);
    }
    elementsNow.position = texture(frame, positions, "positions of elements");
    elementsNow.normal = texture(frame, normals, "normals of elements");
    result = elementsNow;
  }

  std::shared_ptr<const Forest> plant(PassContext& frame) const {
    const Scene& scene = frame.sceneDescription();
    OriginSettings settings;
    settings.source = asPublished ? Source::vertices : Source(source);
    settings.segments = asPublished ? Segments::uv : Segments(segments);
    settings.elements = static_cast<double>(static_cast<int>(elements));
    settings.share = static_cast<double>(static_cast<float>(share));
    Origins origins = findOrigins(scene, settings);
    if (!origins.withoutTexcoords.empty())
      frame.warn(fmt::format("segments uv: {} has no texture coordinates; its charts are used",
                             origins.withoutTexcoords));
    auto forest = std::make_shared<const Forest>(plantForest(scene, std::move(origins)));
    logDetails("elements: {} leaves in {} segments, {} nodes", forest->tree->leafCount,
               forest->tree->segments.size(), forest->tree->nodeCount);
    return forest;
  }

  static SurfaceElements upload(PassContext& frame, const Forest& forest) {
    SurfaceElements made;
    made.tree = forest.tree;
    made.leafCount = static_cast<int>(forest.tree->leafCount);
    made.firstGroup = static_cast<int>(forest.tree->firstGroup);
    made.nodeCount = static_cast<int>(forest.tree->nodeCount);
    made.albedo = texture(frame, forest.albedo, "albedo of elements");
    if (forest.glossy || frame.keepsEverything())
      made.specular = texture(frame, forest.specular, "specular albedo of elements");
    if (forest.emissive || frame.keepsEverything())
      made.emission = texture(frame, forest.emission, "emission of elements");
    made.children = frame.uploaded(forest.tree->children, "children of elements");
    return made;
  }

  static gpu::TextureRef texture(PassContext& frame, std::vector<glm::vec4> values,
                                 const std::string& label) {
    const glm::ivec2 size = SurfaceElements::sizeFor(static_cast<int>(values.size()));
    values.resize(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), glm::vec4(0.0f));
    const gpu::TextureDescription description{
        .format = gpu::Format::rgba32f, .width = size.x, .height = size.y};
    gpu::TextureRef result = frame.texture(description, label);
    result->upload(0, std::as_bytes(std::span(values)));
    return result;
  }
};

}  // namespace

void addElements(TechniqueRegistry& registry) {
  registry.add<ElementsPass>("elements", "The surface as discs in quadtrees (Dong et al. 2007, Sec. 4.1)");
}

}  // namespace lumivox::implicit_visibility
