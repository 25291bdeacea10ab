// Paths through bits on committed scenes: against the reference of the boxes, which knows the same bits, map
// and averages and nothing else of them; and against the path-traced reference of the triangles.
#include <set>

#include "lumivox/base/low_discrepancy.h"
#include "lumivox/reference/voxel_transport.h"
#include "support/against_reference.h"
#include "support/kept_table.h"
#include "support/near_field_scene.h"
#include "support/planes_on_host.h"
#include "support/voxel_paths.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::near_field;

namespace {

/// What both transports know of a scene.
struct Known {
  Seen seen;
  ReflectiveShadowMap map;
  VoxelFragments fragments;
  AttributeGrid attributes;
  Known(const std::string& name, int resolution, int side)
      : seen(name, resolution, side),
        map(LonePass("reflective_shadow_maps.render", seen.scene).out<ReflectiveShadowMap>("surfaces")),
        fragments(fragmentsIn(seen.scene, {{"resolution", resolution}})),
        attributes(LonePass("voxelization.average", seen.scene)
                       .in("fragments", fragments)
                       .out<AttributeGrid>("attributes")) {}
};

/// Where rays end.
enum class Stop { box, plane };

std::vector<float> traced(const Known& known, int bounces, int samples, Stop stop = Stop::box) {
  GBuffer gbuffer = known.seen.gbuffer;
  return LonePass("voxel_path_tracing.trace", known.seen.scene,
                  {{"samples", samples},
                   {"bounces", bounces},
                   {"stop", stop == Stop::plane ? "plane" : "box"},
                   {"offset", stop == Stop::plane ? 0.5 : 1.0}})
      .in("gbuffer", gbuffer)
      .in("bits", known.seen.bits)
      .in("fragments", known.fragments)
      .in("map", known.map)
      .in("attributes", known.attributes)
      .floats("arriving");
}

double reachOfPlane(const glm::dvec3& normal) {
  const glm::dvec3 sides = glm::abs(normal);
  return sides.x + sides.y + sides.z + 1.0 / 16.0;
}

/// The same by the host.
class Boxes {
 public:
  explicit Boxes(const Known& known, Stop stop = Stop::box)
      : known_(known),
        grid_(known.seen.bits.grid),
        onHost_(known.map),
        albedos_(known.attributes.albedo->downloadFloats(0)),
        normals_(known.attributes.normal->downloadFloats(0)) {
    for (const Cell& cell : cellsOf(known.seen.bits)) {
      voxels_.push_back({cell[0], cell[1], cell[2]});
      set_.insert(cell);
    }
    if (stop == Stop::plane) planes_.emplace(known.fragments);
  }
  std::vector<BoxLight> light(int bounces, int samples) const {
    BoxTransport transport;
    transport.environment = known_.seen.scene.environment;
    transport.samples = samples;
    transport.bounces = bounces;
    transport.radiance = [&](const BoxHit& hit) {
      return onHost_.radianceAt(endOf(hit), -hit.direction, voxelOfMap());
    };
    transport.surface = [&](const BoxHit& hit) { return surfaceAt(hit); };
    StopWithin within;
    if (planes_) within = [&](const BoxHit& hit) { return planes_->stop(hit); };
    return transportThroughBoxes(VoxelBoxes(voxels_, grid_, within), starts(), transport);
  }

 private:
  const Known& known_;
  GridPlacement grid_;
  MapOnHost onHost_;
  std::vector<float> albedos_, normals_;
  std::vector<glm::ivec3> voxels_;
  std::set<Cell> set_;
  std::optional<PlanesOnHost> planes_;

  glm::dvec3 endOf(const BoxHit& hit) const { return planes_ ? hit.place() : hit.middle(); }
  /// By which the map tells whether a light sees the end of a ray.
  double voxelOfMap() const { return (planes_ ? 0.5 : 1.0) * grid_.voxelSize; }
  double offset() const { return planes_ ? 0.5 : 1.0; }

  /// Whether a ray from there ends at once.
  bool isStuck(const glm::dvec3& place) const {
    const glm::ivec3 voxel(
        glm::floor((place - glm::dvec3(grid_.low)) / static_cast<double>(grid_.voxelSize)));
    return set_.count({voxel.x, voxel.y, voxel.z}) > 0 && !(planes_ && planes_->has(voxel));
  }
  BoxSurface surfaceAt(const BoxHit& hit) const {
    const glm::dvec3 toViewer = -glm::normalize(hit.direction);
    BoxSurface result;
    glm::dvec3 normal = toViewer;
    if (const auto lit = onHost_.surfaceAt(endOf(hit), toViewer, voxelOfMap())) {
      normal = lit->normal, result.albedo = lit->albedo;
    } else {
      const auto texel = static_cast<std::size_t>(
          (hit.voxel.z * grid_.resolution.y + hit.voxel.y) * grid_.resolution.x + hit.voxel.x);
      const auto rgb = [&](const std::vector<float>& texels) {
        return glm::dvec3(texels[4 * texel], texels[4 * texel + 1], texels[4 * texel + 2]);
      };
      result.albedo = rgb(albedos_);
      if (rgb(normals_) != glm::dvec3(0.0)) normal = glm::normalize(rgb(normals_));
      if (hit.normal != glm::dvec3(0.0)) normal = hit.normal;
    }
    if (glm::dot(normal, toViewer) < 0.0) normal = -normal;
    const double voxel = grid_.voxelSize;
    result.start = {endOf(hit) + offset() * voxel * reachOfPlane(normal) * normal, normal};
    if (!isStuck(result.start.place)) return result;
    for (int i = 1; i <= 8; ++i) {
      const glm::dvec3 further = result.start.place + 0.25 * i * voxel * normal;
      if (isStuck(further)) continue;
      result.start.place = further;
      break;
    }
    return result;
  }
  std::vector<BoxStart> starts() const {
    const std::vector<float> positions = known_.seen.gbuffer.position->downloadFloats(0),
                             normals = known_.seen.gbuffer.normal->downloadFloats(0),
                             geometric = known_.seen.gbuffer.geometricNormal->downloadFloats(0);
    std::vector<BoxStart> result(positions.size() / 4);
    for (std::size_t i = 0; i < result.size(); ++i) {
      if (positions[4 * i + 3] == 0.0f) continue;
      const auto at = [&](const std::vector<float>& values) {
        return glm::dvec3(values[4 * i], values[4 * i + 1], values[4 * i + 2]);
      };
      const glm::dvec3 outwards = at(geometric);
      result[i] = {at(positions) + offset() * grid_.voxelSize * reachOfPlane(outwards) * outwards,
                   glm::normalize(at(normals))};
    }
    return result;
  }
};

}  // namespace

namespace {

/// `inMean`: how far the means of all pixels may differ.
void checkNoiseAlone(int samples, double inMean, Stop stop = Stop::box, const char* scene = "cornell") {
  const Known known(scene, 64, 16);
  const Boxes boxes(known, stop);
  for (const int bounces : {2, 8}) {
    const std::vector<float> arriving = traced(known, bounces, samples, stop);
    const std::vector<BoxLight> light = boxes.light(bounces, samples);
    int compared = 0, within = 0;
    double sum = 0.0, right = 0.0;
    for (std::size_t i = 0; i < light.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const double value = arriving[4 * i + static_cast<std::size_t>(c)];
        sum += value, right += light[i].arriving[c];
        ++compared;
        within += std::abs(value - light[i].arriving[c]) <=
                  3.0 * std::sqrt(2.0 * light[i].variance[c]) + 1e-5 * light[i].arriving[c] + 1e-9;
      }
    CAPTURE(bounces, 1.0 * within / compared, sum / right);
    CHECK(within >= 0.99 * compared);
    CHECK(sum / right == Approx(1.0).epsilon(inMean));
  }
}

}  // namespace

TEST_CASE("two and eight bounces of paths differ from the reference of the boxes by noise alone") {
  checkNoiseAlone(512, 0.01);
}

TEST_CASE("paths that end at planes differ from the reference of the same planes by noise alone") {
  // The sun through a skylight is more noise than the lamp of a box.
  const auto [scene, inMean] = GENERATE(std::pair("cornell", 0.01), std::pair("spinning_box", 0.03));
  checkNoiseAlone(512, inMean, Stop::plane, scene);
}

TEST_CASE("the noise of paths falls as the root of their number, or faster") {
  const Known known("cornell", 64, 16);
  const int bounces = GENERATE(1, 2, 8);
  const std::vector<float> settled = traced(known, bounces, 2048);
  const auto noiseOf = [&](int samples) {
    const std::vector<float> found = traced(known, bounces, samples);
    double sum = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i)
      if (i % 4 != 3) sum += std::pow(static_cast<double>(found[i]) - settled[i], 2.0);
    return std::sqrt(sum);
  };
  const double few = noiseOf(4), some = noiseOf(16), many = noiseOf(64);
  CAPTURE(bounces, few / some, some / many);
  CHECK(few / many >= 4.0);
}

// A minute.
TEST_CASE("with 4096 paths a pixel all light of the boxes is met within 0.3 %", "[.]") {
  checkNoiseAlone(4096, 0.003);
}

namespace {

/// What is left of the pipeline's error when there are paths enough: means over positions in the pixel, as
/// the reference has them, each with paths of its own.
Against errorOf(const Scene& scene, const Picture& picture, int paths, int bounces, const std::string& layer,
                const std::string& output = "indirect_diffuse",
                const std::vector<std::string>& more = {"resolution=128"}) {
  ReferenceOptions options = quietly(picture.referenceSamples, 32);
  options.width = picture.width;
  options.height = picture.height;
  options.useCache = true;
  options.bounceLayers = {2, 8};
  const LayeredImage reference = cachedReference(scene, options);
  constexpr int kPositions = 16;
  const Pipeline text = pipeline("voxel_path_tracing");
  RenderOptions render;
  render.width = picture.width;
  render.height = picture.height;
  std::vector<std::string> settings{"samples=" + std::to_string(paths / kPositions),
                                    "bounces=" + std::to_string(bounces)};
  settings.insert(settings.end(), more.begin(), more.end());
  render.parameters = text.settings(settings);
  PipelineExecutor executor(device(), techniques(), scene, text, render);
  const SceneSnapshot centre = snapshotOf(scene, 0.0, {}, picture.width, picture.height);
  ImageBuffer sum;
  std::uint64_t seed = 0;
  for (const auto& [u, v] : latticePoints(kPositions)) {
    SceneSnapshot shifted = centre;
    shifted.camera.shift = glm::vec2(u - 0.5, v - 0.5);
    executor.setSeed(++seed);
    const ImageBuffer image = executor.render(shifted, 0).outputs.at(output);
    if (sum.empty()) sum = ImageBuffer(image.width(), image.height(), image.channels());
    for (std::size_t i = 0; i < image.values().size(); ++i) sum.values()[i] += image.values()[i] / kPositions;
  }
  return against(reference, sum, layer, 0.0f);
}

}  // namespace

TEST_CASE("paths of eight bounces show all of the Cornell box's indirect light") {
  const Against found = errorOf(committed("cornell"), {32, 32, 256}, 512, 8, "indirect_diffuse");
  CAPTURE(found.rmse, found.ratio);
  CHECK(found.rmse < 0.12);
  CHECK(found.ratio == Approx(1.0).epsilon(0.05));
}

// The numbers of the card; minutes.
TEST_CASE("errors of paths by bounces", "[.]") {
  KeptTable table("voxel_path_tracing.errors", {{"error", 3, 0.01}, {"ratio", 2, 0.01}});
  const Picture picture{48, 48, 1024};
  constexpr int kPaths = 2048;
  const auto row = [&](const char* name, const Scene& scene, int bounces, const char* layer,
                       const char* output) {
    const Against found = errorOf(scene, picture, kPaths, bounces, layer, output);
    table.row(name, {found.rmse, found.ratio});
    CAPTURE(name, found.rmse, found.ratio);
    // Without lobes what is left is noise and the thickness of voxels; the other scenes have lobes in shadow.
    const bool diffuse = scene.name == "Cornell box";
    CHECK(found.rmse < (diffuse ? 0.06 : 0.18));
    CHECK(found.ratio == Approx(1.0).margin(diffuse ? 0.03 : 0.09));
  };
  const Scene cornell = committed("cornell"), glossy = committed("cornell_glossy"),
              arcade = committed("arcade");
  row("cornell, 1 bounce", cornell, 1, "one_bounce_diffuse", "indirect_diffuse");
  row("cornell, 2 bounces", cornell, 2, "bounces_2_diffuse", "indirect_diffuse");
  row("cornell, 8 bounces, of as many", cornell, 8, "bounces_8_diffuse", "indirect_diffuse");
  row("cornell, 8 bounces, of all light", cornell, 8, "indirect_diffuse", "indirect_diffuse");
  row("cornell_glossy, 8 bounces, diffuse, of all light", glossy, 8, "indirect_diffuse", "indirect_diffuse");
  row("cornell_glossy, 8 bounces, glossy, of all light", glossy, 8, "indirect_glossy", "indirect_glossy");
  row("arcade, 8 bounces, of all light", arcade, 8, "indirect_diffuse", "indirect_diffuse");
}

// The table of the card; minutes.
TEST_CASE("errors of paths that end at boxes and at planes within voxels", "[.]") {
  KeptTable table(
      "voxel_path_tracing.planes",
      {{"box", 3, 0.02}, {"plane", 3, 0.02}, {"ratio, box", 2, 0.015}, {"ratio, plane", 2, 0.015}});
  for (const char* name : {"cornell", "cornell_glossy", "corridor", "arcade", "spinning_box", "sibenik",
                           "untuned/court", "untuned/room"}) {
    const Scene scene = committed(name);
    const Picture picture = name == std::string("arcade") ? Picture{80, 45, 1024} : Picture{48, 48, 1024};
    const auto error = [&](const std::vector<std::string>& settings) {
      return errorOf(scene, picture, 512, 2, "bounces_2_diffuse", "indirect_diffuse", settings);
    };
    const Against box = error({}), plane = error({"stop=plane", "offset=0.5"});
    table.row(name, {box.rmse, plane.rmse, box.ratio, plane.ratio});
    CAPTURE(name, box.rmse, plane.rmse);
    CHECK(plane.rmse < box.rmse);
    CHECK(plane.ratio == Approx(1.0).margin(0.1));
  }
}
