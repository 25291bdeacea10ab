// Makes trees of surface elements, once (Dong et al. 2007, Sec. 4.1; step 2 of Algorithm 1).
#include "element_hierarchy.h"

#include <fmt/format.h>

#include "../passes.h"
#include "lumivox/base/log.h"

namespace lumivox::implicit_visibility {

ElementWords::ElementWords(Pass* pass)
    : source_(pass, "source", Source::atlas,
              "atlas: elements of one size on each object, whatever its triangles; vertices: one for each "
              "loaded vertex",
              published(Source::vertices)),
      segments_(
          pass, "segments", Segments::charts,
          "pieces of surface that have a tree each; charts: connected pieces whose normals lie within 45 degrees; uv: islands of the texture coordinates",
          published(Segments::uv)),
      elements_(pass, "elements", 4096, within(16, 1048576),
                "approximate number of leaves, with 'source atlas'"),
      share_(pass, "share", 0.5f, within(0.0f, 1.0f),
             "exponent of an object's area in its share of the elements") {}

gpu::TextureRef elementTexture(PassContext& frame, std::vector<glm::vec4> values, const std::string& label) {
  const glm::ivec2 size = SurfaceElements::sizeFor(static_cast<int>(values.size()));
  values.resize(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), glm::vec4(0.0f));
  const gpu::TextureDescription description{
      .format = gpu::Format::rgba32f, .width = size.x, .height = size.y};
  gpu::TextureRef result = frame.texture(description, label);
  result->upload(0, std::as_bytes(std::span(values)));
  return result;
}

namespace {

std::shared_ptr<const Forest> plant(PassContext& frame, const OriginSettings& settings) {
  const Scene& scene = frame.sceneDescription();
  Origins origins = findOrigins(scene, settings);
  if (!origins.withoutTexcoords.empty())
    frame.warn(fmt::format("segments uv: {} has no texture coordinates; its charts are used",
                           origins.withoutTexcoords));
  auto forest = std::make_shared<const Forest>(plantForest(scene, std::move(origins)));
  logDetails("elements: {} leaves in {} segments, {} nodes", forest->tree->leafCount,
             forest->tree->segments.size(), forest->tree->nodeCount);
  return forest;
}

SurfaceElements upload(PassContext& frame, const Forest& forest) {
  SurfaceElements made;
  made.tree = forest.tree;
  made.leafCount = static_cast<int>(forest.tree->leafCount);
  made.firstGroup = static_cast<int>(forest.tree->firstGroup);
  made.nodeCount = static_cast<int>(forest.tree->nodeCount);
  made.albedo = elementTexture(frame, forest.albedo, "albedo of elements");
  if (forest.glossy || frame.keepsEverything())
    made.specular = elementTexture(frame, forest.specular, "specular albedo of elements");
  if (forest.emissive || frame.keepsEverything())
    made.emission = elementTexture(frame, forest.emission, "emission of elements");
  made.children = frame.uploaded(forest.tree->children, "children of elements");
  return made;
}

class HierarchyPass : public Pass {
  ElementWords words{this};
  Out<ElementHierarchy> result{this, "hierarchy", "trees of elements, for `elements`"};

  Reads readsFrom() const override { return Reads::materials; }
  bool worksOnHost() const override { return true; }

  void run(PassContext& frame) override { result = words.made(frame); }
};

}  // namespace

ElementHierarchy ElementWords::made(PassContext& frame) const {
  const auto forest = frame.kept("hierarchy of elements", 0, [&] {
    return plant(frame, {.source = source_,
                         .segments = segments_,
                         .elements = static_cast<double>(static_cast<int>(elements_)),
                         .share = static_cast<double>(static_cast<float>(share_))});
  });
  const SurfaceElements fixed =
      frame.kept("reflectance of elements", forest, [&] { return upload(frame, *forest); });
  return {forest, fixed};
}

void addHierarchy(TechniqueRegistry& registry) {
  registry.add<HierarchyPass>(
      "hierarchy",
      "Quadtrees of surface elements, made once, as a pass of its own that is timed apart (Dong et al. 2007, Sec. 4.1)");
}

}  // namespace lumivox::implicit_visibility
