// Propagates light from cell to cell: Kaplanyan & Dachsbacher 2010, Sec. 4.3; thesis Gomes 2015, Sec. 4.3.3.
#include <cmath>

#include "lumivox/toolkit/environment.h"
#include "nested_grids.h"

namespace lumivox::light_propagation_volumes {

using namespace shaders::light_propagation_volumes;

namespace {

/// Mean projected area of a cube of side 1, a quarter of its surface (Cauchy): light of the same radiance L
/// everywhere passes a cell of size h with the intensity L 3/2 h^2.
constexpr float kMeanProjection = 1.5f;

/// Travelling light: two sets of textures that take turns, and the bricks in them that hold light.
struct Travelling {
  std::array<Channels, 2> light;
  std::array<gpu::TextureRef, 2> stamps;
};

class PropagatePass : public Pass {
  enum class Lobe { straight, cosine };
  enum class Border { open, mirror };
  enum class Method { folded, plain };
  enum class Transfer { conserving, published };
  enum class Occlusion { faces, normals };
  enum class Grids { nested, apart };

  In<ShGrid> injected{this, "light", "virtual point lights"};
  In<OccludedFaces> faces{this, "faces", Presence::optional,
                          "occluded faces, from the same injection; always needed"};
  Param<int> iterations{this, "iterations", 64, within(1, 4096),
                        "steps from cell to cell; light that has not arrived then is lost"};
  Param<Lobe> lobe{
      this, "lobe", Lobe::straight,
      "direction of flux that leaves a cell; straight: that in which it came; cosine: a clamped cosine around the face",
      published(Lobe::cosine)};
  Param<float> fluxAmplifier{this, "flux_amplifier", 1.0f, within(0.0f, 100.0f),
                             "factor of every step; 1 conserves energy"};
  Param<float> occlusionAmplifier{this, "occlusion_amplifier", 1.0f, within(0.0f, 100.0f),
                                  "factor of the occluded share of a face; 0: nothing occludes"};
  Param<Border> border{this, "border", Border::open,
                       "border of the coarsest grid; mirror: no light is lost, for checks of energy"};
  Param<Method> method{
      this, "method", Method::folded,
      "implementation of a step, with the same result; folded: five numbers for each neighbour, fast; plain: face by face as in Listing 4.32, slow, and the only one for 'transfer published' and 'occlusion normals'"};
  Param<Transfer> transfer{
      this, "transfer", Transfer::conserving,
      "flux between cells; conserving: all that leaves a cell arrives; published: a quarter of it arrives, as clamped cosines without negative values, and the cell keeps its light, so that the sum grows to 5/4 and more in every iteration (Listing 4.32)",
      published(Transfer::published)};
  Param<Occlusion> occlusion{
      this, "occlusion", Occlusion::faces,
      "faces: by the occluded share of a face; normals: by a lobe around that normal of the sending voxel that is closest to the direction (Listing 4.33), which needs an injection with 'voxels packed'",
      published(Occlusion::normals)};
  Param<Grids> grids{
      this, "grids", Grids::nested,
      "nested: light enters from the next coarser grid and from the environment; apart: no light enters a grid from outside",
      published(Grids::apart)};
  Out<ShGrid> light{this, "light", "all light that passed each cell, summed over the iterations, W/sr"};
  Out<ShGrid> travelling{this, "travelling", "light that is still on its way after the last iteration, W/sr"};

  Reads readsFrom() const override { return Reads::environment; }

  void run(PassContext& frame) override {
    const NestedGrids levels = fluxIn(injected);
    if (occludesByNormals()) requirePackedVoxels(levels, faces);
    // Light from outside passes the faces of the border.
    if (!occludesByNormals() || !gridsApart()) requireFaces(levels, faces);
    ShGrid total = *injected, left = *injected;
    forEachLevel(levels, [&](std::size_t i) {
      const ShGrid::Level& level = levels[i];
      const ShGrid::Level* outside = i + 1 < levels.size() ? &total.levels[i + 1] : nullptr;
      const Channels sum = coefficientTextures(frame, level.grid.resolution, "sum of light");
      const Travelling state = start(frame, level, faces->levels[i], outside, sum);
      const int last = iterate(frame, level, faces->levels[i], state, sum);
      left.levels[i].coefficients = state.light[static_cast<std::size_t>(last)];
      // Where light stays in its cell, the last state already is the sum.
      total.levels[i].coefficients = publishedTransfer() ? left.levels[i].coefficients : sum;
    });
    light = total;
    travelling = left;
  }

  bool publishedTransfer() const { return transfer == Transfer::published; }
  bool occludesByNormals() const { return occlusion == Occlusion::normals; }
  bool gridsApart() const { return grids == Grids::apart; }

  Travelling start(PassContext& frame, const ShGrid::Level& level, const OccludedFaces::Level& surfaces,
                   const ShGrid::Level* outside, const Channels& sum) {
    const glm::ivec3 resolution = level.grid.resolution;
    Travelling result;
    for (std::size_t i = 0; i < 2; ++i) {
      result.light[i] = coefficientTextures(frame, resolution, "travelling light");
      result.stamps[i] = frame.emptyVolume((resolution + kBrick - 1) / kBrick, gpu::Format::r32ui, "stamps");
    }
    for (const gpu::TextureRef& texture : result.light[1]) texture->clear(glm::vec4(0.0f));

    start::Variant variant;
    start::Parameters parameters{.occlusion = occlusionAmplifier};
    shader::BindingSet fromOutside;
    const float cell = level.grid.voxelSize;
    if (outside != nullptr && !gridsApart()) {
      variant.outside = start::Variant::outsideGrid;
      const glm::vec3 size = glm::vec3(outside->grid.resolution) * outside->grid.voxelSize;
      // Equal radiance passes cells in proportion to the areas of their faces.
      parameters.outsideShare = std::pow(cell / outside->grid.voxelSize, 2.0f);
      parameters.cellInOutside = glm::vec3(cell) / size;
      parameters.lowInOutside = (level.grid.low - outside->grid.low) / size;
      fromOutside = sampled(outside->coefficients, gpu::Sampling::linear, kOutside);
    } else if (outside == nullptr && frame.traits().environment && border == Border::open && !gridsApart()) {
      variant.outside = start::Variant::outsideEnvironment;
      parameters.environment =
          glm::vec4(frame.sceneDescription().environment * (kMeanProjection * cell * cell), 0.0f);
      if (frame.traits().environmentMap) {
        // Light from a direction travels the opposite way: the odd band changes its sign.
        const auto bands = environmentBands(frame.sceneDescription());
        for (std::size_t c = 0; c < bands.size(); ++c) {
          // Two bands are negative somewhere beyond |c1| = c0 / sqrt 3: a small sun is taken as wide as that.
          const glm::vec3 odd(bands[c].y, bands[c].z, bands[c].w);
          const float share =
              std::min(1.0f, bands[c].x / (std::sqrt(3.0f) * std::max(glm::length(odd), 1e-30f)));
          parameters.environmentSlope[c] = glm::vec4(-kMeanProjection * cell * cell * share * odd, 0.0f);
        }
      }
    }
    frame.dispatch(frame.program(variant, start::Constants{.cosineLobe = lobe == Lobe::cosine}),
                   {start::parameters(parameters), sampled(level, gpu::Sampling::nearest), fromOutside,
                    facesOf(surfaces, level), images(result.light[0], kNext), images(sum, kTotal),
                    start::stampsNext(result.stamps[0])},
                   resolution);
    return result;
  }

  /// Returns which of the two sets holds the light after the last iteration.
  int iterate(PassContext& frame, const ShGrid::Level& level, const OccludedFaces::Level& surfaces,
              const Travelling& state, const Channels& sum) {
    const bool plain = publishedTransfer() || occludesByNormals() || method == Method::plain;
    propagate_plain::Variant variant;
    if (occludesByNormals()) variant.occlusion = propagate_plain::Variant::occlusionNormals;
    const propagate::Constants folded{.cosineLobe = lobe == Lobe::cosine};
    const propagate_plain::Constants faceByFace{.cosineLobe = folded.cosineLobe,
                                                .publishedTransfer = publishedTransfer()};
    const shader::BoundProgram& program =
        plain ? frame.program(variant, faceByFace) : frame.program(propagate::Variant{}, folded);
    const glm::ivec3 wholeBricks = (level.grid.resolution + kBrick - 1) / kBrick * kBrick;
    for (int i = 0; i < iterations; ++i) {
      const auto now = static_cast<std::size_t>(i % 2), next = 1 - now;
      // The flux of the last iteration is still travelling: it has not passed its cell yet.
      const bool passes = i + 1 < iterations && !publishedTransfer();
      frame.dispatch(program,
                     {propagate::parameters({.resolution = level.grid.resolution,
                                             .stamp = i + 1,
                                             .amplifier = fluxAmplifier,
                                             .occlusion = occlusionAmplifier,
                                             .mirrors = border == Border::mirror,
                                             .addToTotal = passes}),
                      sampled(state.light[now], gpu::Sampling::nearest), facesOf(surfaces, level),
                      propagate::stamps(state.stamps[now], gpu::Sampling::nearest),
                      images(state.light[next], kNext), images(sum, kTotal),
                      propagate::stampsNext(state.stamps[next]), propagate_plain::words(surfaces.packed)},
                     wholeBricks);
    }
    return iterations % 2;
  }
};

}  // namespace

void addPropagate(TechniqueRegistry& registry) {
  registry.add<PropagatePass>(
      "propagate", "Light from cell to cell through open faces (Kaplanyan & Dachsbacher 2010, Sec. 4.3)");
}

}  // namespace lumivox::light_propagation_volumes
