// The paper's own claim: how little the holes of a volume harm the light. Error of light and of occlusion
// against the share of the voxels that were found.
#include <fmt/format.h>

#include <array>
#include <map>
#include <optional>

#include "support/against_reference.h"
#include "support/imperfect_volumes_scene.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::volumes;

namespace {

struct Found {
  double recall = 0.0;
  Against light, occlusion;
};

/// A scene with what is true of it.
class Claim {
 public:
  Claim(const Scene& scene, const Picture& picture)
      : scene_(scene),
        snapshot_(snapshotOf(scene, 0.0)),
        picture_(picture),
        reference_(referenceOf(scene, picture)) {}

  Found found(const Made& made, const std::vector<std::string>& settings) {
    const Pipeline text = volumePipeline(made);
    RenderOptions options;
    options.width = picture_.width;
    options.height = picture_.height;
    options.parameters = text.settings(settings);
    PipelineExecutor executor(device(), techniques(), scene_, text, options);
    executor.keepOutput("average", "bits");
    const FrameResult frame = executor.render(0.0);
    const auto* bits = dynamic_cast<const Out<BinaryGrid>*>(executor.output("average", "bits"));
    REQUIRE(bits != nullptr);
    return {recallOf(bits->value()), lightAgainst(reference_, frame.outputs.at("indirect_diffuse")),
            occlusionAgainst(reference_, frame.outputs.at("ambient_occlusion"))};
  }

 private:
  const Scene& scene_;
  SceneSnapshot snapshot_;
  Picture picture_;
  LayeredImage reference_;
  std::map<int, VoxelReference> right_;  // by the voxels along the longest side

  double recallOf(const BinaryGrid& bits) {
    const auto [right, isNew] = right_.try_emplace(bits.grid.longest());
    if (isNew) right->second = trueVoxels(scene_, snapshot_, bits.grid);
    VoxelSet occupied(bits.grid.resolution);
    for (const Cell& cell : cellsOf(bits)) occupied.insert({cell[0], cell[1], cell[2]});
    return compareVoxels(occupied, right->second).recall();
  }
};

/// Recall, error of light and error of occlusion by the density of points, as the card has them: `cornell`,
/// `arcade`, `bunny` and `sponza_dabrovic`, with 32 voxels and with 64.
struct AsInCard {
  double density;
  std::array<std::array<double, 3>, 8> found;
};
constexpr AsInCard kCard[] = {
    {0.1,
     {{{0.10, 0.84, 0.75},
       {0.09, 0.84, 0.70},
       {0.37, 0.56, 0.64},
       {0.23, 0.71, 0.58},
       {0.21, 0.50, 0.78},
       {0.22, 0.46, 0.72},
       {0.54, 1.53, 0.55},
       {0.32, 1.60, 0.45}}}},
    {0.25,
     {{{0.22, 0.70, 0.56},
       {0.22, 0.69, 0.55},
       {0.50, 0.46, 0.60},
       {0.34, 0.52, 0.54},
       {0.33, 0.40, 0.68},
       {0.33, 0.38, 0.66},
       {0.62, 1.11, 0.55},
       {0.41, 1.07, 0.45}}}},
    {0.5,
     {{{0.39, 0.52, 0.55},
       {0.38, 0.52, 0.56},
       {0.66, 0.40, 0.61},
       {0.48, 0.41, 0.57},
       {0.48, 0.29, 0.52},
       {0.47, 0.30, 0.64},
       {0.72, 0.70, 0.61},
       {0.54, 0.68, 0.49}}}},
    {1,
     {{{0.62, 0.35, 0.60},
       {0.62, 0.34, 0.56},
       {0.83, 0.37, 0.62},
       {0.69, 0.37, 0.62},
       {0.68, 0.20, 0.39},
       {0.68, 0.21, 0.54},
       {0.85, 0.56, 0.70},
       {0.72, 0.47, 0.55}}}},
    {2,
     {{{0.86, 0.19, 0.52},
       {0.84, 0.20, 0.40},
       {0.94, 0.37, 0.60},
       {0.88, 0.35, 0.62},
       {0.88, 0.18, 0.31},
       {0.88, 0.17, 0.39},
       {0.95, 0.54, 0.76},
       {0.89, 0.46, 0.58}}}},
    {4,
     {{{0.96, 0.15, 0.42},
       {0.96, 0.14, 0.22},
       {0.98, 0.39, 0.59},
       {0.97, 0.36, 0.63},
       {0.98, 0.19, 0.28},
       {0.98, 0.17, 0.29},
       {0.99, 0.53, 0.78},
       {0.98, 0.47, 0.59}}}},
    {8,
     {{{0.99, 0.15, 0.41},
       {0.99, 0.13, 0.17},
       {0.99, 0.39, 0.59},
       {0.99, 0.37, 0.63},
       {1.00, 0.19, 0.27},
       {1.00, 0.17, 0.27},
       {0.99, 0.54, 0.78},
       {0.99, 0.47, 0.59}}}},
    {16,
     {{{0.99, 0.15, 0.41},
       {1.00, 0.14, 0.17},
       {1.00, 0.39, 0.60},
       {0.99, 0.37, 0.64},
       {1.00, 0.19, 0.27},
       {1.00, 0.17, 0.27},
       {0.99, 0.59, 0.78},
       {1.00, 0.47, 0.59}}}},
};

}  // namespace

TEST_CASE(
    "where a seventh of the voxels is missing light errs by a third more, and by far more where most are") {
  const Scene scene = committed("cornell");
  Claim claim(scene, {40, 40, 256});
  const auto at = [&](const char* density) {
    return claim.found({.reprojected = false}, {"resolution=32", density});
  };
  const Found full = at("density=16"), most = at("density=2"), half = at("density=0.5");
  CAPTURE(full.recall, full.light.rmse, most.recall, most.light.rmse, half.recall, half.light.rmse);
  CHECK(full.recall > most.recall);
  CHECK(most.recall > half.recall);
  CHECK(most.light.rmse < 1.5 * full.light.rmse);
  CHECK(half.light.rmse > 2.0 * full.light.rmse);
}

// The numbers of the card; minutes.
TEST_CASE("error against recall by points and density, with and without reprojection", "[.]") {
  std::size_t column = 0;  // of the card, at 32 voxels
  for (const auto& [name, picture] : {std::pair<const char*, Picture>("cornell", {64, 64, 1024}),
                                      {"arcade", {80, 45, 1024}},
                                      {"bunny", {60, 48, 1024}},
                                      {"sponza_dabrovic", {64, 36, 256}}}) {
    const std::size_t ofScene = column;
    column += 2;
    DYNAMIC_SECTION(name) {
      std::optional<Scene> scene;
      try {
        scene.emplace(committed(name));
      } catch (const AbsentError&) {
        WARN(name << " is not on the asset path");
        return;
      }
      Claim claim(*scene, picture);
      for (const int resolution : {32, 64})
        for (const bool reprojected : {false, true}) {
          std::vector<std::vector<std::string>> settings;
          for (const int points : {1, 3, 9, 12, 19, 64})
            settings.push_back({"adaptive=off", fmt::format("points={}", points)});
          for (const AsInCard& row : kCard) settings.push_back({fmt::format("density={}", row.density)});
          for (std::vector<std::string>& one : settings) {
            one.push_back(fmt::format("resolution={}", resolution));
            const Found found = claim.found({.reprojected = reprojected}, one);
            WARN(fmt::format(
                "{} {} {} {}: recall {:.3f} light {:.3f} ratio {:.2f} occlusion {:.3f} ratio {:.2f}", name,
                resolution, reprojected ? "reprojected" : "points", one[one.size() - 2], found.recall,
                found.light.rmse, found.light.ratio, found.occlusion.rmse, found.occlusion.ratio));
            CHECK(found.recall > 0.0);
            CHECK(found.recall <= 1.0);
            for (const AsInCard& row : kCard) {
              if (reprojected || one.front() != fmt::format("density={}", row.density)) continue;
              const auto& expected = row.found[ofScene + (resolution == 64 ? 1 : 0)];
              CHECK(found.recall == Approx(expected[0]).margin(0.02));
              CHECK(found.light.rmse == Approx(expected[1]).margin(0.03));
              CHECK(found.occlusion.rmse == Approx(expected[2]).margin(0.03));
            }
          }
          if (!reprojected) continue;
          const Found alone = claim.found({.points = false}, {fmt::format("resolution={}", resolution)});
          WARN(fmt::format("{} {} reprojection alone: recall {:.3f} light {:.3f} occlusion {:.3f}", name,
                           resolution, alone.recall, alone.light.rmse, alone.occlusion.rmse));
        }
    }
  }
}
