// Light at surface elements in the pipelines of implicit visibility.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../../techniques/implicit_visibility/links/direction_bins.h"
#include "../../techniques/implicit_visibility/links/element_light.h"
#include "../../techniques/implicit_visibility/links/element_links.h"
#include "support/passes.h"

namespace lumivox::test {

using implicit_visibility::BinMapping, implicit_visibility::DirectionBins, implicit_visibility::BinTable,
    implicit_visibility::ElementLight, implicit_visibility::ElementLink, implicit_visibility::ElementLinks,
    implicit_visibility::ElementTree, implicit_visibility::SurfaceElements;

/// One frame of the committed pipeline `text`, with the outputs of its passes.
class LitElements {
 public:
  LitElements(const Scene& scene, const std::vector<std::string>& settings,
              const std::string& text = "implicit_visibility_lights", bool keepEverything = false) {
    const Pipeline loaded = withAllBounces(text);
    RenderOptions options;
    options.parameters = loaded.settings(settings);
    options.keepEverything = keepEverything;
    executor_ = std::make_unique<PipelineExecutor>(device(), techniques(), scene, loaded, options);
    executor_->keepOutput("elements", "elements");
    executor_->keepOutput("links", "links");
    executor_->keepOutput("illuminate", "light");
    frame = executor_->render(0.0);
  }
  const SurfaceElements& elements() const {
    return kept<SurfaceElements>(*executor_, "elements", "elements");
  }
  const ElementLinks& links() const { return kept<ElementLinks>(*executor_, "links", "links"); }
  const ElementLight& light() const { return kept<ElementLight>(*executor_, "illuminate", "light"); }

  /// The red channel of one side of a leaf, in a texture with two texels per leaf.
  static double leafValue(const std::vector<float>& floats, std::size_t leaf, int side) {
    return floats[4 * (2 * leaf + static_cast<std::size_t>(side))];
  }
  /// Irradiance of the fronts of all leaves, W/m^2.
  std::vector<double> irradiance() const { return fronts(*light().irradiance); }
  std::vector<double> directIrradiance() const { return fronts(*light().directIrradiance); }
  std::vector<double> fronts(const gpu::Texture& texture) const {
    const std::vector<float> floats = texture.downloadFloats(0);
    std::vector<double> result;
    for (int leaf = 0; leaf < elements().leafCount; ++leaf)
      result.push_back(leafValue(floats, static_cast<std::size_t>(leaf), 0));
    return result;
  }
  /// The area-weighted mean over the leaves of all objects or of one.
  double mean(const std::vector<double>& ofLeaves, std::optional<std::uint32_t> object = {}) const {
    double sum = 0.0, area = 0.0;
    for (std::size_t leaf = 0; leaf < ofLeaves.size(); ++leaf) {
      if (object && elements().tree->objectOfNode[leaf] != *object) continue;
      sum += ofLeaves[leaf] * elements().state->area[leaf];
      area += elements().state->area[leaf];
    }
    return sum / area;
  }

  FrameResult frame;

 private:
  /// The committed pipeline with a wider range of bounces, up to the pass's limit.
  static Pipeline withAllBounces(const std::string& name) {
    const Pipeline committed = pipeline(name);
    std::string text = committed.document->source;
    const std::string range = "param bounces 1 in 1..64";
    const std::size_t at = text.find(range);
    REQUIRE(at != std::string::npos);
    text.replace(at, range.size(), "param bounces 1 in 1..4096");
    return Pipeline::parse(text, committed.file);
  }
  std::unique_ptr<PipelineExecutor> executor_;
};

}  // namespace lumivox::test
