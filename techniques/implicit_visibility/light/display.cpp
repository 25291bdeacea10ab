// Shows the light of elements to the camera (Dong et al. 2007, Sec. 4.3.1).
#include <fmt/format.h>

#include <algorithm>

#include "../elements/element_cells.h"
#include "../passes.h"
#include "display_vertices.h"
#include "light.h"
#include "lumivox/toolkit/environment.h"
#include "lumivox/toolkit/loop_limit.h"
#include "outgoing.h"

namespace lumivox::implicit_visibility {

using namespace shaders::implicit_visibility;

namespace {

struct CellBuffers {
  std::vector<float> sizes;
  std::uint32_t buckets;
  gpu::BufferRef starts, leaves;
};

class DisplayPass : public Pass {
  enum class Interpolate { neighbours, vertices };
  enum class Lobe { pixel, element };

  In<GBuffer> gbuffer{this, "gbuffer", "visible surfaces"};
  In<SurfaceElements> elements{this, "elements", "what is lit"};
  In<ElementLinks> links{
      this, "links", Presence::optional,
      "visible elements of each leaf, from push_links: for 'glossy', 'occlusion' and the glossy part of 'direct'"};
  In<ElementLight> light{this, "light", Presence::optional,
                         "light at elements, from illuminate: for 'diffuse', 'glossy' and 'direct'"};
  In<Image> directImage{this,
                        "direct",
                        Presence::optional,
                        "direct light other than over links, for 'direct'",
                        Needs::nothing,
                        Contributes::direct};
  Param<Interpolate> interpolate{
      this, "interpolate", Interpolate::neighbours,
      "elements that a pixel interpolates; neighbours: those around the visible point; vertices: those at the corners of its triangle, only with 'source vertices'. A Phong lobe at pixels always uses neighbours",
      published(Interpolate::vertices)};
  Param<Lobe> lobe{
      this, "lobe", Lobe::pixel,
      "where the Phong lobe is integrated over the bins; pixel: with the normal and material of the visible surface; element: with those of elements",
      published(Lobe::element)};
  Param<float> distance{
      this,
      "distance",
      0.0f,
      within(0.0f, 1e9f),
      "m",
      "distance within which elements occlude, for 'occlusion'; 0: a tenth of the diagonal of the scene's bounds, as in the reference"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::anyLight,
                     "indirect light reflected by the diffuse lobe, W/(sr m^2)"};
  Out<Image> glossy{this, "glossy", Contributes::indirectGlossy, Needs::anyLight | Needs::glossyMaterial,
                    "indirect light reflected by the Phong lobe, W/(sr m^2)"};
  Out<Image> direct{this, "direct", Contributes::direct, Needs::nothing,
                    "the input 'direct' plus light of emissive surfaces over links, W/(sr m^2)"};
  Out<Image> occlusion{
      this, "occlusion", Contributes::ambientOcclusion, Needs::triangles,
      "share of the projected solid angle whose bins hold no element nearer than 'distance'"};
  Out<Image> segments{this, "segments", Contributes::nothing, Needs::triangles,
                      "a colour for each segment (Fig. 3a)"};

  Reads readsFrom() const override { return Reads::camera | Reads::environment | Reads::geometry; }
  bool uses(const InBase& input) const override {
    if (&input == &directImage) return direct.wanted();
    if (&input == &light) return diffuse.wanted() || glossy.wanted() || direct.wanted();
    if (&input == &links) return glossy.wanted() || occlusion.wanted() || direct.wanted();
    return true;
  }

  void run(PassContext& frame) override {
    const shader::BindingSet common{NodeBinding(*elements, links.present() ? links->bins : 0),
                                    GBufferBinding(*gbuffer)};
    using Variant = display::Variant;
    if (diffuse.wanted())
      diffuse =
          light.present() ? show(frame, common, Variant::ofIrradiance, light->irradiance, {}) : black(frame);
    if (glossy.wanted())
      glossy = light.present() && links.present()
                   ? showLobe(frame, common, light->radiance, light->outgoing, frame.traits().environment, {})
                   : black(frame);
    if (glossy.wanted() && links.present() && frame.inspects())
      frame.note(fmt::format(
          "Phong lobes of exponents up to {:.0f} are as wide as bins; narrower ones fall between their middles",
          resolvedExponent(links->bins)));
    if (direct.wanted()) direct = showDirect(frame, common);
    if (occlusion.wanted()) occlusion = showOpenness(frame, common);
    if (segments.wanted()) {
      const gpu::BufferRef ofLeaves = frame.uploaded(elements->tree->segmentOfLeaf, "segments of elements");
      Image colours =
          show(frame, {common, display::segments(ofLeaves)}, Variant::ofSegments, elements->position, {});
      colours.radiance = false;
      segments = colours;
    }
  }

  static Image black(PassContext& frame) {
    Image result{frame.image("nothing")};
    result.texture->clear(glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));
    return result;
  }

  const CellBuffers& cellsOf(PassContext& frame) const {
    return frame.kept("cells of elements", elements->state, [&] {
      const ElementCells cells(*elements->state, static_cast<std::uint32_t>(elements->leafCount));
      return CellBuffers{cells.cellSizes, cells.buckets, frame.uploaded(cells.starts, "cells of elements"),
                         frame.uploaded(cells.leaves, "elements by cells")};
    });
  }
  /// Leaves by their positions, for neighbours.glsl.
  shader::BindingSet cellBinding(PassContext& frame) const {
    const CellBuffers& cells = cellsOf(frame);
    return {sizesOf(cells), display::cellStarts(cells.starts), display::cellLeaves(cells.leaves)};
  }
  static gpu::ResourceBinding sizesOf(const CellBuffers& cells) {
    display::Cells block{};
    for (std::size_t i = 0; i < cells.sizes.size(); ++i)
      block.cellSizes[i] = {cells.sizes[i], 1.0f / cells.sizes[i], 0.0f, 0.0f};
    block.sizes = static_cast<int>(cells.sizes.size());
    block.buckets = cells.buckets;
    block.reach = kReach;
    return shader::UniformSlot<display::Cells>{"Cells"}(block);
  }

  /// Values of leaves where the camera sees them, plus `added` unless it is null.
  Image show(PassContext& frame, const shader::BindingSet& common, int of, const gpu::TextureRef& values,
             const Image& added, float empty = 0.0f) const {
    using display::Variant;
    Image result{frame.image("values of elements")};
    const bool overTriangles = of != Variant::ofSegments && interpolate == Interpolate::vertices;
    shader::BindingSet bound{common, display::added(added.texture, gpu::Sampling::nearest),
                             display::shownImage(result.texture)};
    Image interpolated;
    if (overTriangles) {
      interpolated = interpolatedOverTriangles(frame, *elements, *gbuffer, values);
      bound.add(display::interpolated(interpolated.texture, gpu::Sampling::nearest));
    } else {
      bound = {bound, cellBinding(frame), display::leafValues(values, gpu::Sampling::nearest)};
    }
    frame.dispatch(
        frame.program(Variant{.of = of,
                              .from = overTriangles ? Variant::fromVertices : Variant::fromNeighbours,
                              .added = added.texture != nullptr},
                      display::Constants{.empty = empty}),
        bound, pixels(frame));
    return result;
  }

  /// The Phong lobe over the `radiance` of nodes and `outgoing`, which may be null, and, with `sky`, over the
  /// environment where a bin has no link.
  Image showLobe(PassContext& frame, const shader::BindingSet& common, const gpu::TextureRef& radiance,
                 const gpu::TextureRef& outgoing, bool sky, const Image& added) const {
    using namespace display_glossy;
    const shader::BindingSet bound{
        common,
        LinkBinding(*links),
        EnvironmentBinding(frame),
        display_glossy::lobe({frame.sceneDescription().environment, frame.snapshot().camera.eye}),
        sentRadiance(radiance, gpu::Sampling::nearest),
        OutgoingBinding(outgoing, light->outgoingRows, light->directions)};
    const bool passedOn = outgoing != nullptr;
    if (lobe == Lobe::pixel) {
      const int most = std::clamp(kLoopLimit / (12 * links->bins * links->bins), 1, 4);
      Image result{frame.image("glossy radiance")};
      frame.dispatch(frame.program(Variant{.at = Variant::atPixel,
                                           .environment = sky,
                                           .added = added.texture != nullptr,
                                           .outgoing = passedOn},
                                   Constants{.mostLeaves = most, .environmentMap = environmentMapOf(frame)}),
                     {bound, cellBinding(frame), display_glossy::added(added.texture, gpu::Sampling::nearest),
                      shownImage(result.texture)},
                     pixels(frame));
      return result;
    }
    const gpu::TextureRef atLeaves =
        emptyTexels(frame, 2 * elements->leafCount, "glossy radiance of elements");
    if (elements->specular != nullptr && elements->leafCount > 0)
      frame.dispatchList(
          frame.program(Variant{.at = Variant::atElement, .environment = sky, .outgoing = passedOn},
                        Constants{.environmentMap = environmentMapOf(frame)}),
          {bound, speculars(elements->specular, gpu::Sampling::nearest), shownImage(atLeaves)},
          static_cast<std::uint64_t>(elements->leafCount));
    return show(frame, common, display::Variant::ofValue, atLeaves, added);
  }

  Image showDirect(PassContext& frame, const shader::BindingSet& common) const {
    const Image base = directImage.present() ? *directImage : black(frame);
    if (!light.present() || light->directIrradiance == nullptr) return base;
    const Image sum = show(frame, common, display::Variant::ofIrradiance, light->directIrradiance, base);
    if (gbuffer->specular == nullptr || !links.present()) return sum;
    return showLobe(frame, common, light->emission, nullptr, false, sum);
  }

  Image showOpenness(PassContext& frame, const shader::BindingSet& common) const {
    const float reach = distance > 0.0f
                            ? float(distance)
                            : static_cast<float>(ambientOcclusionDistance(frame.snapshot().bounds));
    const gpu::TextureRef open = emptyTexels(frame, 2 * elements->leafCount, "openness of elements");
    if (links.present() && elements->leafCount > 0)
      frame.dispatchList(
          frame.program(open_leaves::kProgram),
          {common, LinkBinding(*links), open_leaves::openness({reach}), open_leaves::openImage(open)},
          static_cast<std::uint64_t>(elements->leafCount));
    return show(frame, common, display::Variant::ofValue, open, {}, 1.0f);
  }
};

}  // namespace

void addDisplay(TechniqueRegistry& registry) {
  registry.add<DisplayPass>(
      "display",
      "Light of elements at the visible surfaces, and ambient occlusion by links (Dong et al. 2007, Sec. 4.3.1)");
}

}  // namespace lumivox::implicit_visibility
