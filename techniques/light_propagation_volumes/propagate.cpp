// Propagation from cell to cell: Kaplanyan & Dachsbacher 2010, Sec. 4.3; thesis Gomes 2015, Sec. 4.3.3.
#include <algorithm>
#include <cmath>

#include "light_propagation_volumes_shaders.h"
#include "nested_grids.h"

namespace lumivox::light_propagation_volumes {
namespace {

namespace startShader = shaders::light_propagation_volumes::start;
namespace foldedShader = shaders::light_propagation_volumes::propagate;
namespace plainShader = shaders::light_propagation_volumes::propagate_plain;

using Channels = std::array<gpu::TextureRef, 3>;

/// Mean projected area of a cube of side 1, a quarter of its surface (Cauchy): light of the same radiance L
/// everywhere passes a cell of size h with the intensity L 3/2 h^2.
constexpr float kMeanProjection = 1.5f;

/// Light on its way: two sets of textures that take turns, and which bricks of them hold light.
struct Travelling {
  std::array<Channels, 2> light;
  std::array<gpu::TextureRef, 2> stamps;
};

class PropagatePass : public Pass {
  In<ShGrid> injected{this, "light", "virtual point lights and closed faces"};
  Param<int> iterations{
      this, "iterations", 64, {1, 4096}, "steps from cell to cell; light that has not arrived then is lost"};
  Param<std::string> lobe{
      this,
      "lobe",
      "straight",
      {"straight", "cosine"},
      "flux goes on in the direction in which it came, or, as published, leaves as a clamped cosine around the face"};
  Param<float> fluxAmplifier{
      this, "flux_amplifier", 1.0f, {0.0f, 100.0f}, "", "factor of every step; 1 conserves energy"};
  Param<float> occlusionAmplifier{this, "occlusion_amplifier",
                                  1.0f, {0.0f, 100.0f},
                                  "",   "factor of the closed share of a face; 0: nothing occludes"};
  Param<std::string> border{this,
                            "border",
                            "open",
                            {"open", "mirror"},
                            "of the coarsest grid; a mirror loses no light, for checks of energy"};
  Param<std::string> method{
      this,
      "method",
      "folded",
      {"folded", "plain"},
      "of computing the same; plain: face by face as in Listing 4.32, slow, and the only one of the published transfer and occlusion"};
  Param<std::string> transfer{
      this,
      "transfer",
      "conserving",
      {"conserving", "published"},
      "what leaves a cell arrives; or Listing 4.32: a quarter of it, as clamped cosines, none that is negative, and the cell keeps its light: the sum grows to 5/4 and more in every iteration"};
  Param<std::string> occlusion{
      this,
      "occlusion",
      "faces",
      {"faces", "normals"},
      "by the closed share of faces; or, as published (Listing 4.33), by a lobe around the normal in the sending voxel that is closest to the way: needs an injection with voxels packed"};
  Param<std::string> grids{
      this,
      "grids",
      "nested",
      {"nested", "apart"},
      "light comes in from the next coarser grid and from the environment; or, as published, every grid is alone"};
  Param<bool> asPublished{this, "as_published", false,
                          "Listings 4.32 and 4.33: the printed settings of transfer, occlusion and grids"};
  Out<ShGrid> light{this, "light", "all light that passed each cell, summed over the iterations, W/sr"};
  Out<ShGrid> travelling{this, "travelling", "light that is still on its way after the last iteration, W/sr"};

  Reads readsFrom() const override { return Reads::environment; }

  void run(PassContext& frame) override {
    if (occludesByNormals())
      requirePackedVoxels(*injected);
    else
      requireFaces(*injected);
    // Light that comes in from outside passes the faces of the border.
    if (!gridsApart()) requireFaces(*injected);
    ShGrid total = *injected, left = *injected;
    // From the coarsest to the finest: what comes into a grid from outside is in the coarser one.
    for (std::size_t i = injected->levels.size(); i-- > 0;) {
      const ShGrid::Level& level = injected->levels[i];
      const ShGrid::Level* outside = i + 1 < injected->levels.size() ? &total.levels[i + 1] : nullptr;
      Channels sum = coefficientTextures(frame, level.grid.resolution, "sum of light");
      const Travelling state = start(frame, level, outside, sum);
      const int last = iterate(frame, level, state, sum);
      left.levels[i].coefficients = state.light[static_cast<std::size_t>(last)];
      // Where light stays in its cell, the last state is the sum already.
      total.levels[i].coefficients = publishedTransfer() ? left.levels[i].coefficients : sum;
    }
    light = total;
    travelling = left;
  }

  bool publishedTransfer() const { return asPublished || transfer == "published"; }
  bool occludesByNormals() const { return asPublished || occlusion == "normals"; }
  bool gridsApart() const { return asPublished || grids == "apart"; }

  Travelling start(PassContext& frame, const ShGrid::Level& level, const ShGrid::Level* outside,
                   const Channels& sum) {
    const glm::ivec3 resolution = level.grid.resolution;
    Travelling result;
    for (std::size_t i = 0; i < 2; ++i) {
      result.light[i] = coefficientTextures(frame, resolution, "travelling light");
      result.stamps[i] = cellTexture(frame, (resolution + kBrick - 1) / kBrick, gpu::Format::r32ui, "stamps");
      result.stamps[i]->clear(glm::vec4(0.0f));
    }
    for (const gpu::TextureRef& texture : result.light[1]) texture->clear(glm::vec4(0.0f));

    startShader::Variant variant;
    startShader::Parameters parameters{};
    parameters.resolution = resolution;
    parameters.occlusion = occlusionAmplifier;
    using gpu::Sampling;
    std::vector<gpu::ResourceBinding> bindings{
        startShader::red(*level.coefficients[0], Sampling::nearest),
        startShader::green(*level.coefficients[1], Sampling::nearest),
        startShader::blue(*level.coefficients[2], Sampling::nearest),
        startShader::closed(facesOrUnread(level.closed, level), Sampling::nearest),
        startShader::redNext(*result.light[0][0]),
        startShader::greenNext(*result.light[0][1]),
        startShader::blueNext(*result.light[0][2]),
        startShader::redTotal(*sum[0]),
        startShader::greenTotal(*sum[1]),
        startShader::blueTotal(*sum[2]),
        startShader::stampsNext(*result.stamps[0])};
    const float cell = level.grid.voxelSize;
    if (outside != nullptr && !gridsApart()) {
      variant.outside = startShader::Variant::outsideGrid;
      const glm::vec3 size = glm::vec3(outside->grid.resolution) * outside->grid.voxelSize;
      // The same radiance passes cells in proportion to their faces.
      parameters.outsideShare = std::pow(cell / outside->grid.voxelSize, 2.0f);
      parameters.cellInOutside = glm::vec3(cell) / size;
      parameters.lowInOutside = (level.grid.low - outside->grid.low) / size;
      bindings.push_back(startShader::redOutside(*outside->coefficients[0], Sampling::linear));
      bindings.push_back(startShader::greenOutside(*outside->coefficients[1], Sampling::linear));
      bindings.push_back(startShader::blueOutside(*outside->coefficients[2], Sampling::linear));
    } else if (outside == nullptr && frame.traits().environment && border == "open" && !gridsApart()) {
      variant.outside = startShader::Variant::outsideEnvironment;
      parameters.environment =
          glm::vec4(frame.sceneDescription().environment * (kMeanProjection * cell * cell), 0.0f);
    }
    bindings.push_back(startShader::parameters(parameters));
    startShader::Constants constants;
    constants.cosineLobe = lobe == "cosine" ? 1 : 0;
    frame.dispatch(frame.program(startShader::kProgram, variant.key(), constants.values()), bindings,
                   resolution, kCellGroup);
    return result;
  }

  /// Which of the two sets holds the light after the last iteration.
  int iterate(PassContext& frame, const ShGrid::Level& level, const Travelling& state, const Channels& sum) {
    const bool plain = publishedTransfer() || occludesByNormals() || method == "plain";
    plainShader::Variant variant;
    if (occludesByNormals()) variant.occlusion = plainShader::Variant::occlusionNormals;
    foldedShader::Constants foldedConstants;
    plainShader::Constants plainConstants;
    foldedConstants.cosineLobe = plainConstants.cosineLobe = lobe == "cosine" ? 1 : 0;
    plainConstants.publishedTransfer = publishedTransfer() ? 1 : 0;
    const shader::BoundProgram& program =
        plain ? frame.program(plainShader::kProgram, variant.key(), plainConstants.values())
              : frame.program(foldedShader::kProgram, {}, foldedConstants.values());
    foldedShader::Parameters parameters{};
    parameters.resolution = level.grid.resolution;
    parameters.amplifier = fluxAmplifier;
    parameters.occlusion = occlusionAmplifier;
    parameters.mirrors = border == "mirror" ? 1 : 0;
    using gpu::Sampling;
    for (int i = 0; i < iterations; ++i) {
      const auto now = static_cast<std::size_t>(i % 2), next = 1 - now;
      parameters.stamp = i + 1;
      // What the last iteration brings has not passed its cell yet: it is still travelling.
      parameters.addToTotal = i + 1 < iterations && !publishedTransfer() ? 1 : 0;
      const Channels &from = state.light[now], &to = state.light[next];
      std::vector<gpu::ResourceBinding> bindings{
          foldedShader::parameters(parameters),
          foldedShader::red(*from[0], Sampling::nearest),
          foldedShader::green(*from[1], Sampling::nearest),
          foldedShader::blue(*from[2], Sampling::nearest),
          foldedShader::closed(facesOrUnread(level.closed, level), Sampling::nearest),
          foldedShader::stamps(*state.stamps[now], Sampling::nearest),
          foldedShader::redNext(*to[0]),
          foldedShader::greenNext(*to[1]),
          foldedShader::blueNext(*to[2]),
          foldedShader::redTotal(*sum[0]),
          foldedShader::greenTotal(*sum[1]),
          foldedShader::blueTotal(*sum[2]),
          foldedShader::stampsNext(*state.stamps[next])};
      if (occludesByNormals()) bindings.push_back(plainShader::words(*level.packed));
      const glm::ivec3 bricks = (level.grid.resolution + kBrick - 1) / kBrick;
      frame.shaders().dispatch(program, bindings, glm::uvec3(bricks));
      frame.device().barrier();
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
