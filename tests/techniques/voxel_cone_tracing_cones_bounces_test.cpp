// Further bounces by light that cones gather for every fragment.
#include <cmath>
#include <optional>

#include "support/cones.h"
#include "support/kept_table.h"
#include "support/marching.h"
#include "support/phong_lobes.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;

namespace {

/// What surfaces inside a closed box of this albedo see of it, on average over some places, when every
/// surface reflects 1 W/(sr m^2) x albedo of light that is there from the beginning, after so many bounces.
enum class Faces { one, coarse, six };

double seenInBox(const Material& material, int resolution, int bounces, Faces faces = Faces::six) {
  SceneBuilder builder;
  builder.box({-1, -1, -1}, {1, 1, 1}, builder.material(material), true);
  InjectSettings settings;
  settings.lights = false;
  settings.ambient = kPi;
  settings.bounces = bounces;
  const auto seenIn = [](const auto& grid) {
    GatherSettings gathering{64, "cosine", 1, 0, 0, 0.5};
    gathering.refinement = 0;
    double sum = 0.0;
    constexpr int kPlaces = 5;
    for (int place = 0; place < kPlaces; ++place) {
      const float along = -0.8f + 0.4f * static_cast<float>(place);
      sum +=
          gather(cones::emptyScene(), grid, {along, -1.0f, 0.3f * along}, {0, 1, 0}, gathering).r / kPlaces;
    }
    return sum;
  };
  if (faces == Faces::six)
    return seenIn(filteredDirections(injectedDirections(builder.scene, resolution, settings)));
  const RadianceGrid grid = injectedGrid(builder.scene, resolution, settings);
  return faces == Faces::one ? seenIn(filtered(grid)) : seenIn(filteredDirections(grid));
}

double seenInBox(float albedo, int resolution, int bounces, Faces faces = Faces::six) {
  Material material;
  material.diffuse = glm::vec3(albedo);
  return seenInBox(material, resolution, bounces, faces);
}

/// albedo + albedo^2 + ... of so many terms.
double series(double albedo, int terms) {
  return albedo * (1.0 - std::pow(albedo, terms)) / (1.0 - albedo);
}

}  // namespace

TEST_CASE("in a closed box of albedo a the bounces add up to 1 + a + a^2 + ..., towards 1 / (1 - a)") {
  for (const float albedo : {0.5f, 0.9f})
    for (const int bounces : {1, 2, 4, 12}) {
      const double seen = seenInBox(albedo, 32, bounces), expected = series(albedo, bounces);
      INFO("albedo " << albedo << ", bounces " << bounces << ": " << seen << " of " << expected);
      // A bounce loses up to 1 % in the edges of 32 voxels, half of it in those of 64.
      CHECK(seen == Approx(expected).epsilon(bounces > 4 ? 0.06 : 0.03));
      if (albedo == 0.5f && bounces == 12) CHECK(seen == Approx(albedo / (1.0 - albedo)).epsilon(0.05));
    }
}

TEST_CASE("in a closed box whose walls also have lobes, bounces add up by the mean share of both") {
  // Light arrives evenly from all sides: a lobe reflects the mean of its share over them, weighed by cosines.
  Material glossy;
  glossy.diffuse = glm::vec3(0.3f);
  glossy.specular = glm::vec3(0.4f);
  for (const float exponent : {2.0f, 30.0f}) {
    glossy.exponent = exponent;
    double share = 0.0;
    constexpr int kSteps = 40;
    for (int i = 0; i < kSteps; ++i)
      share += reflectedShare(static_cast<double>(exponent), std::sqrt((i + 0.5) / kSteps)) / kSteps;
    for (const int bounces : {1, 4}) {
      CAPTURE(exponent, share, bounces);
      CHECK(seenInBox(glossy, 32, bounces) == Approx(series(0.3 + 0.4 * share, bounces)).epsilon(0.03));
    }
  }
}

// Minutes on a software rasteriser.
TEST_CASE("in a closed box of albedo 0.9 at 64 voxels 48 bounces come within 5 % of 1 / (1 - a)", "[.]") {
  const double seen = seenInBox(0.9f, 64, 48);
  CHECK(seen == Approx(9.0).epsilon(0.05));
  KeptTable table("voxel_cone_tracing.bounces", {{"of a / (1 - a)", 3, 0.003}});
  table.row("48 bounces, 64 voxels, albedo 0.9", {seen / 9.0});
}

TEST_CASE("further bounces in one grid lose what comes through walls of sheets each time") {
  // Trilinear reading lets exp(-2 / cos) through a sheet, 0.06 of the hemisphere: with every bounce anew.
  // With faces on the coarser levels the last way is whole, and the bounces go through one grid all the same.
  struct Row {
    float albedo;
    int bounces;
    double one, coarse;  // as the card says
  };
  for (const Row& row : {Row{0.5f, 1, 0.465, 0.500}, Row{0.5f, 2, 0.679, 0.730}, Row{0.5f, 12, 0.862, 0.926},
                         Row{0.9f, 12, 4.37, 4.69}}) {
    CAPTURE(row.albedo, row.bounces);
    CHECK(seenInBox(row.albedo, 32, row.bounces, Faces::one) == Approx(row.one).epsilon(0.02));
    CHECK(seenInBox(row.albedo, 32, row.bounces, Faces::coarse) == Approx(row.coarse).epsilon(0.02));
  }
}

TEST_CASE(
    "further bounces reflect an environment that is brighter than all that the scene reflects otherwise") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, builder.lambert(0.5f));
  builder.look({0, 2, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, 8, 8);
  builder.scene.environment = glm::vec3(10.0f, 10.0f, 10.0f);
  InjectSettings settings;
  settings.lights = false;
  settings.bounces = 2;
  for (const char* precision : {"float", "half"}) {
    settings.precision = precision;
    const RadianceGrid grid = injectedGrid(builder.scene, 16, settings);
    float brightest = 0.0f;
    for (const float value : grid.radiance->downloadFloats(0))
      brightest = std::max(brightest, value * grid.unit);
    INFO(precision);
    CHECK(brightest == Approx(0.5 * 10.0).epsilon(0.02));
  }
}

TEST_CASE("further bounces see the smoke in the voxels as they see it beside them") {
  // An absorbing medium over a floor below a bright sky: cones of a second bounce go through it, in coarse
  // voxels too.
  SceneBuilder builder;
  builder.quad({-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.5f));
  builder.quad({-1, 1, -1}, {0, 0, 0.01f}, {0.01f, 0, 0}, builder.lambert(0.0f));  // the grid is as high
  builder.look({0, 2, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, 8, 8);
  builder.scene.environment = glm::vec3(1.0f);
  const ScatteringGrid media = evenMedium(glm::vec3(1.5f), glm::vec3(0.0f), 0.0f, {-1, -1, -1}, {1, 1, 1});
  const auto reflected = [&](bool stored, bool foggy) {
    InjectSettings settings;
    settings.lights = false;
    settings.bounces = 2;
    settings.storeMedia = stored;
    settings.twoSided = false;  // from below the sky is clear
    settings.media = foggy ? &media : nullptr;
    const RadianceGrid grid = injectedGrid(builder.scene, 32, settings);
    const std::vector<float> texels = grid.radiance->downloadFloats(0);
    const glm::ivec3 size = grid.grid.resolution;
    double sum = 0.0;
    const int y = static_cast<int>((-1.0f - grid.grid.low.y) / grid.grid.voxelSize);
    for (int z = 8; z < 24; ++z)
      for (int x = 8; x < 24; ++x)
        sum += texels[static_cast<std::size_t>(4 * ((z * size.y + y) * size.x + x))] / 256.0;
    return sum * grid.unit;
  };
  const double clear = reflected(false, false), beside = reflected(false, true),
               inside = reflected(true, true);
  CAPTURE(clear, beside, inside);
  CHECK(clear == Approx(0.5).epsilon(0.04));
  CHECK(beside < 0.4 * clear);
  CHECK(inside == Approx(beside).epsilon(0.12));
}

namespace {

/// The filtered light of frames in a row in a closed box: six grids that find those of the frame before.
class Frames {
 public:
  explicit Frames(float albedo) { builder_.box({-1, -1, -1}, {1, 1, 1}, builder_.lambert(albedo), true); }
  /// One more frame, with this ambient light.
  void render(double ambient = kPi) {
    const SceneSnapshot snapshot = snapshotOf(builder_.scene, 0.0);
    PassHarness voxels(device(), techniques(), "voxelization", "conservative", builder_.scene, snapshot);
    voxels.setParameter("resolution", 16);
    voxels.run();
    PassHarness inject(device(), techniques(), "voxel_cone_tracing", "inject_directional", builder_.scene,
                       snapshot);
    inject.setParameter("ambient", ambient);
    inject.setInput("fragments", voxels.output<VoxelFragments>("fragments"));
    if (light_) inject.setInput("before", *light_);
    inject.run();
    light_ = filteredDirections(inject.output<DirectionalRadianceGrid>("radiance"));
  }
  const Scene& scene() const { return builder_.scene; }
  const DirectionalRadianceGrid& light() const { return *light_; }
  std::vector<float> texels() const { return light_->faces[2]->downloadFloats(0); }
  /// Radiance of all upper faces.
  double total() const {
    const std::vector<float> all = texels();
    double sum = 0.0;
    for (std::size_t i = 0; i < all.size(); i += 4) sum += all[i];
    return sum;
  }

 private:
  SceneBuilder builder_;
  std::optional<DirectionalRadianceGrid> light_;
};

}  // namespace

TEST_CASE(
    "frame n of a still scene holds the n + 1 reflections of as many bounces in one frame, to the bit") {
  Frames frames(0.9f);
  InjectSettings settings;
  settings.lights = false;
  settings.ambient = kPi;
  for (int frame = 0; frame < 4; ++frame) {
    frames.render();
    settings.bounces = frame + 1;
    const auto once = filteredDirections(injectedDirections(frames.scene(), 16, settings));
    CAPTURE(frame);
    CHECK(frames.texels() == once.faces[2]->downloadFloats(0));
  }
}

TEST_CASE("light that is switched off is gone to 1 % within log 0.01 / log albedo frames") {
  for (const float albedo : {0.5f, 0.9f}) {
    Frames frames(albedo);
    for (int frame = 0; frame < 12; ++frame) frames.render();
    const double lit = frames.total();
    const int most = static_cast<int>(std::ceil(std::log(0.01) / std::log(albedo)));
    frames.render(0.0);
    CAPTURE(albedo);
    CHECK(frames.total() > 0.3 * lit);  // a frame later the last frame's light is there still
    for (int frame = 1; frame < most; ++frame) frames.render(0.0);
    CHECK(frames.total() < 0.01 * lit);
    CHECK(frames.total() > 0.0);
  }
}
