// Grids of radiance made by hand, and cones through them, for the tests of voxel cone tracing.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/ports/directional_radiance_grid.h"
#include "support/scene_builder.h"
#include "support/techniques.h"

namespace lumivox::test::cones {

inline constexpr int kPixels = 8;  ///< along both sides of the images here

/// A g-buffer with the same surface point in every pixel. It has a specular albedo if the exponent in
/// `specular`.w is above 0.
inline GBuffer surfacePoint(const glm::vec3& position, const glm::vec3& normal, const glm::vec3& albedo,
                            const glm::vec4& specular = glm::vec4(0.0f)) {
  gpu::TextureDescription description;
  description.format = gpu::Format::rgba32f;
  description.width = description.height = kPixels;
  const auto filled = [&](const glm::vec4& value) {
    auto texture = std::make_shared<gpu::Texture>(device(), description, "test g-buffer");
    texture->clear(value);
    return texture;
  };
  GBuffer result;
  result.position = filled(glm::vec4(position, 1.0f));
  result.normal = filled(glm::vec4(normal, 1.0f));
  result.geometricNormal = filled(glm::vec4(normal, 0.0f));
  result.diffuse = filled(glm::vec4(albedo, 1.0f));
  if (specular.w > 0.0f) result.specular = filled(specular);
  return result;
}

/// A grid over [-1,1]^3 with all levels allocated; `fill` gives the finest.
inline RadianceGrid makeGrid(int resolution, const std::function<glm::vec4(int, int, int)>& fill) {
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d3;
  description.format = gpu::Format::rgba32f;
  description.width = description.height = description.depth = resolution;
  description.levels = gpu::fullLevelCount(resolution, resolution, resolution);
  RadianceGrid grid;
  grid.grid = {glm::vec3(-1.0f), 2.0f / static_cast<float>(resolution), glm::ivec3(resolution)};
  grid.radiance = std::make_shared<gpu::Texture>(device(), description, "test grid");
  grid.radiance->clear(glm::vec4(0.0f));
  std::vector<float> values;
  for (int z = 0; z < resolution; ++z)
    for (int y = 0; y < resolution; ++y)
      for (int x = 0; x < resolution; ++x) {
        const glm::vec4 value = fill(x, y, z);
        values.insert(values.end(), {value.r, value.g, value.b, value.a});
      }
  grid.radiance->uploadFloats(0, values);
  return grid;
}

/// A committed pipeline with a line added to the first pass of each of these kinds.
inline Pipeline pipelineWith(const std::string& name,
                             const std::vector<std::pair<std::string, std::string>>& added) {
  const Pipeline text = pipeline(name);
  std::string source = text.document->source;
  for (const auto& [pass, line] : added) {
    const std::size_t place = source.find('{', source.find(pass + " "));
    REQUIRE(place != std::string::npos);
    source.insert(place + 1, "\n" + line + "\n");
  }
  return Pipeline::parse(source, text.file);
}

/// Six grids over [-1,1]^3 with all levels allocated. `fill` gives the finest level by face and voxel; the
/// faces' outward normals are +x, -x, +y, -y, +z and -z, in this order.
inline DirectionalRadianceGrid makeDirections(int resolution,
                                              const std::function<glm::vec4(int, int, int, int)>& fill) {
  DirectionalRadianceGrid result;
  for (int face = 0; face < 6; ++face) {
    const RadianceGrid one = makeGrid(resolution, [&](int x, int y, int z) { return fill(face, x, y, z); });
    result.grid = one.grid;
    result.faces[static_cast<std::size_t>(face)] = one.radiance;
  }
  return result;
}

/// A grid whose voxels are all the same.
inline RadianceGrid uniformGrid(int resolution, const glm::vec4& value) {
  return makeGrid(resolution, [&](int, int, int) { return value; });
}

inline Scene emptyScene(const glm::vec3& environment = glm::vec3(0.0f)) {
  SceneBuilder builder;
  builder.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, kPixels, kPixels);
  builder.scene.environment = environment;
  return builder.scene;
}

inline RadianceGrid filtered(RadianceGrid grid, const char* opacity = "facing") {
  const Scene scene = emptyScene();
  PassHarness harness(device(), techniques(), "voxel_cone_tracing", "filter", scene, snapshotOf(scene, 0.0));
  harness.setParameter("opacity", std::string(opacity));
  harness.setInput("radiance", grid);
  harness.run();
  return harness.output<RadianceGrid>("mips");
}

/// Filters to six directional grids, from a finest level of six grids or of one.
template <class Finest>
DirectionalRadianceGrid filteredDirections(const Finest& finest) {
  const Scene scene = emptyScene();
  PassHarness harness(device(), techniques(), "voxel_cone_tracing", "filter_directional", scene,
                      snapshotOf(scene, 0.0));
  harness.setInput(std::is_same_v<Finest, RadianceGrid> ? "finest" : "radiance", finest);
  harness.run();
  return harness.template output<DirectionalRadianceGrid>("mips");
}

/// One value of a face at a level of the grid.
inline glm::vec4 faceAt(const DirectionalRadianceGrid& grid, int face, int level, const glm::ivec3& voxel) {
  const glm::ivec3 size = levelResolution(grid.grid.resolution, level);
  const std::vector<float> texels =
      grid.faces[static_cast<std::size_t>(face)]->downloadFloats(level - grid.firstLevelOfFaces());
  const std::size_t at = 4 * static_cast<std::size_t>((voxel.z * size.y + voxel.y) * size.x + voxel.x);
  return {texels[at], texels[at + 1], texels[at + 2], texels[at + 3]};
}

struct GatherSettings {
  int cones = 6;
  const char* distribution = "cosine";
  double offset = 0, start = 0, reach = 0, step = 0.25;
  double clearance = 0.5, footprint = 0.5;  // the defaults of the pass
  double coneRatio = 1.1547005383792515;
  double jitter = 0;
  std::uint64_t seed = 1;
  const char* reading = "layers";
  double refinement = 1;
  int pattern = 1, glossyCones = 1;
  const char* resolution = "full";
};

/// The name of gather's input for each store.
inline const char* inputOf(const RadianceGrid&) {
  return "grid";
}
inline const char* inputOf(const DirectionalRadianceGrid&) {
  return "directions";
}

/// Runs `gather` over a g-buffer; `read` gets the pass with its outputs.
template <class Store, class Read>
auto gatherWith(const Scene& scene, const Store& grid, const GBuffer& gbuffer, const GatherSettings& settings,
                const Read& read) {
  PassHarness harness(device(), techniques(), "voxel_cone_tracing", "gather", scene, snapshotOf(scene, 0.0));
  harness.setParameter("cones", settings.cones);
  harness.setParameter("distribution", std::string(settings.distribution));
  harness.setParameter("offset", settings.offset);
  harness.setParameter("start", settings.start);
  harness.setParameter("reach", settings.reach);
  harness.setParameter("step", settings.step);
  harness.setParameter("clearance", settings.clearance);
  harness.setParameter("footprint", settings.footprint);
  harness.setParameter("cone_ratio", settings.coneRatio);
  harness.setParameter("jitter", settings.jitter);
  harness.setParameter("reading", std::string(settings.reading));
  harness.setParameter("refinement", settings.refinement);
  harness.setParameter("pattern", settings.pattern);
  harness.setParameter("glossy_cones", settings.glossyCones);
  harness.setParameter("resolution", std::string(settings.resolution));
  harness.setInput("gbuffer", gbuffer);
  harness.setInput(inputOf(grid), grid);
  harness.run(settings.seed);
  return read(harness);
}

/// Indirect diffuse radiance at one surface point of albedo 1, in every pixel.
template <class Store>
ImageBuffer gatherImage(const Scene& scene, const Store& grid, const glm::vec3& position,
                        const glm::vec3& normal, const GatherSettings& settings) {
  return gatherWith(scene, grid, surfacePoint(position, normal, glm::vec3(1.0f)), settings,
                    [](PassHarness& harness) { return imageOf(*harness.output<Image>("diffuse").texture); });
}
inline glm::vec3 pixelOf(const ImageBuffer& image) {
  return {image.at(3, 3, 0), image.at(3, 3, 1), image.at(3, 3, 2)};
}
template <class Store>
glm::vec3 gather(const Scene& scene, const Store& grid, const glm::vec3& position, const glm::vec3& normal,
                 const GatherSettings& settings) {
  return pixelOf(gatherImage(scene, grid, position, normal, settings));
}

/// Indirect glossy radiance at one surface point.
template <class Store>
glm::vec3 gatherGlossy(const Scene& scene, const Store& grid, const glm::vec3& position,
                       const glm::vec3& normal, const glm::vec4& specular, const GatherSettings& settings) {
  return gatherWith(
      scene, grid, surfacePoint(position, normal, glm::vec3(0.0f), specular), settings,
      [](PassHarness& harness) { return pixelOf(imageOf(*harness.output<Image>("glossy").texture)); });
}

/// The radiance that one cone of a mirroring lobe gathers along a direction.
template <class Store>
glm::vec3 alongNormal(const Store& grid, const glm::vec3& position, const glm::vec3& direction,
                      float exponent, const GatherSettings& settings,
                      const glm::vec3& environment = glm::vec3(0.0f)) {
  const glm::vec3 d = glm::normalize(direction);
  Scene scene = emptyScene(environment);
  scene.cameras.front().eye =
      glm::dvec3(position) + 2.0 * glm::dvec3(d);  // so that the mirror direction is the normal
  return gatherGlossy(scene, grid, position, d, glm::vec4(1, 1, 1, exponent), settings);
}

struct InjectSettings {
  const char* precision = "float";
  double ambient = 0;
  bool lights = true, storeMedia = false, twoSided = true, emission = false;
  int bounces = 1;
  const ScatteringGrid* media = nullptr;
  int lightSamples = 1;
  double backWeight = 1.0 / 256.0;  // of directional grids, like the next member
  const char* opaqueAlong = "facing";
};

/// The grid, RadianceGrid or DirectionalRadianceGrid, after injection of a scene's fragments under its
/// lights.
template <class Grid>
Grid injectedAs(const char* pass, const Scene& scene, int resolution, const InjectSettings& settings = {},
                VoxelFragments* fragments = nullptr) {
  const SceneSnapshot snapshot = snapshotOf(scene, 0.0);
  PassHarness voxels(device(), techniques(), "voxelization", "conservative", scene, snapshot);
  voxels.setParameter("resolution", resolution);
  voxels.run();
  PassHarness shadow(device(), techniques(), "direct_lighting", "shadow_map", scene, snapshot);
  PassHarness inject(device(), techniques(), "voxel_cone_tracing", pass, scene, snapshot);
  inject.setParameter("precision", std::string(settings.precision));
  inject.setParameter("ambient", settings.ambient);
  inject.setParameter("store_media", std::string(settings.storeMedia ? "on" : "off"));
  inject.setInput("fragments", voxels.output<VoxelFragments>("fragments"));
  if (settings.lights) {
    shadow.run();
    inject.setInput("shadow", shadow.output<ShadowMap>("depth"));
  }
  if (settings.media != nullptr) inject.setInput("media", *settings.media);
  if (fragments != nullptr) *fragments = voxels.output<VoxelFragments>("fragments");
  inject.setParameter("light_samples", settings.lightSamples);
  if constexpr (std::is_same_v<Grid, DirectionalRadianceGrid>) {
    inject.setParameter("back_weight", settings.backWeight);
    inject.setParameter("opaque_along", std::string(settings.opaqueAlong));
  }
  inject.setParameter("bounces", settings.bounces);
  inject.setParameter("two_sided", std::string(settings.twoSided ? "on" : "off"));
  inject.setParameter("emission", std::string(settings.emission ? "on" : "off"));
  inject.run();
  return inject.template output<Grid>("radiance");
}
inline RadianceGrid injectedGrid(const Scene& scene, int resolution, const InjectSettings& settings = {},
                                 VoxelFragments* fragments = nullptr) {
  return injectedAs<RadianceGrid>("inject", scene, resolution, settings, fragments);
}
inline DirectionalRadianceGrid injectedDirections(const Scene& scene, int resolution,
                                                  const InjectSettings& settings = {}) {
  return injectedAs<DirectionalRadianceGrid>("inject_directional", scene, resolution, settings);
}

}  // namespace lumivox::test::cones
