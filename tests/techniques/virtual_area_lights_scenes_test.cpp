// Committed scenes against the path tracer, and against every light at every pixel.
#include <cstdio>
#include <random>

#include "support/against_reference.h"
#include "support/kept_table.h"
#include "support/virtual_area_lights.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

const char* const kBruteForce = "virtual_area_lights/virtual_area_lights_brute_force";

/// Without the cache, which knows a scene by its text.
LayeredImage tracedOf(const Scene& scene, const Picture& picture) {
  ReferenceOptions options = quietly(picture.referenceSamples, 1);
  options.width = picture.width;
  options.height = picture.height;
  return renderReference(scene, options);
}

struct Errors {
  Against diffuse, glossy;
};

Errors errorsOn(const Scene& scene, const std::vector<std::string>& settings,
                const Picture& picture = {64, 64, 128}) {
  const LayeredImage reference = tracedOf(scene, picture);
  const FrameResult frame = pictured(scene, picture, pipeline("virtual_area_lights"), settings);
  return {lightAgainst(reference, frame.outputs.at("indirect_diffuse")),
          against(reference, frame.outputs.at("indirect_glossy"), "one_bounce_glossy", 0.0f)};
}
Errors errorsOn(const std::string& name, const std::vector<std::string>& settings = {}) {
  return errorsOn(committed(name), settings);
}

/// RMS of what two pictures differ by over that of the second, and the ratio of their means.
Against beside(const ImageBuffer& image, const ImageBuffer& right) {
  double squared = 0.0, all = 0.0, sum = 0.0, rightSum = 0.0;
  for (std::size_t i = 0; i < image.values().size(); ++i) {
    const auto a = static_cast<double>(image.values()[i]), b = static_cast<double>(right.values()[i]);
    squared += (a - b) * (a - b);
    all += b * b;
    sum += a;
    rightSum += b;
  }
  return {std::sqrt(squared / all), sum / rightSum};
}

Pipeline withoutLimit() {
  const Pipeline text = pipeline("virtual_area_lights");
  std::string source = text.document->source;
  const std::string pass = "pass gather virtual_area_lights.gather {";
  source.insert(source.find(pass) + pass.size(), "\n exponent_limit none\n");
  return Pipeline::parse(source, text.file);
}

/// The glossy light of the panels of `exponents`, all of one exponent, beside that of all lights.
Against ofExponent(float exponent, const std::vector<std::string>& settings, bool limited = true) {
  Scene scene = committed("exponents");
  for (Material& material : scene.materials)
    if (material.glossy()) material.exponent = exponent;
  const Picture picture{64, 64};
  std::vector<std::string> all{"occlusion=off"};
  all.insert(all.end(), settings.begin(), settings.end());
  return beside(pictured(scene, picture, limited ? pipeline("virtual_area_lights") : withoutLimit(), all)
                    .outputs.at("indirect_glossy"),
                pictured(scene, picture, pipeline(kBruteForce), {}).outputs.at("indirect_glossy"));
}

/// The diffuse light of `cornell` at points of growing number, beside that of all lights.
std::vector<Against> ofPoints(const std::vector<int>& points, const std::string& lights) {
  const Scene scene = committed("cornell");
  const Picture picture{64, 64};
  const ImageBuffer right =
      pictured(scene, picture, pipeline(kBruteForce), {lights}).outputs.at("indirect_diffuse");
  std::vector<Against> found;
  for (const int count : points)
    found.push_back(beside(pictured(scene, picture, pipeline("virtual_area_lights"),
                                    {"occlusion=off", "points=" + std::to_string(count), lights})
                               .outputs.at("indirect_diffuse"),
                           right));
  return found;
}

/// RMS of changes from frame to frame which the reference does not make, over the mean light.
double flickerOn(const Scene& scene, const Pipeline& text, const std::vector<std::string>& settings,
                 int frames = 4) {
  const Picture picture{32, 32, 512};
  RenderOptions options;
  options.width = picture.width;
  options.height = picture.height;
  options.parameters = text.settings(settings);
  PipelineExecutor executor(device(), techniques(), scene, text, options);
  std::vector<ImageBuffer> images, references, variances;
  for (int i = 0; i < frames; ++i) {
    images.push_back(executor.render(i / 24.0, i).outputs.at("indirect_diffuse"));
    ReferenceOptions path = quietly(picture.referenceSamples, 1);
    path.width = picture.width;
    path.height = picture.height;
    path.time = i / 24.0;
    path.seed = static_cast<std::uint64_t>(i + 1);
    path.useCache = true;
    const LayeredImage reference = cachedReference(scene, path);
    references.push_back(reference.layers.at("one_bounce_diffuse"));
    variances.push_back(reference.layers.at("one_bounce_diffuse.variance"));
  }
  double mean = 0.0;
  for (const float value : references.front().values())
    mean += static_cast<double>(value) / static_cast<double>(references.front().values().size());
  return flicker(images, references, variances).value / mean;
}

/// Errors of `interpolate averaged` and `plain` over a plane of bumps as wide as the points are apart, beside
/// every light at every place.
struct Kept {
  double averaged, plain;
};
Kept bumps(const std::vector<DiscLight>& discs) {
  constexpr int kSide = 16, kPoints = 24;
  std::mt19937 random(9);
  std::uniform_real_distribution<float> jitter(0.2f, 0.8f);
  constexpr float kSlope = 0.2f;  // of two waves, 8 and 9 cm long
  const auto bump = [](float x, float z) {
    return SparsePoint{{x, 0, z},
                       glm::normalize(glm::vec3(-kSlope * std::cos(78.5f * x + 20.0f * z), 1.0f,
                                                -kSlope * std::cos(70.0f * z - 15.0f * x)))};
  };
  std::vector<SparsePoint> points, seen;
  for (int i = 0; i < kPoints * kPoints; ++i)
    points.push_back(bump((static_cast<float>(i % kPoints) + jitter(random)) * 2.0f / kPoints - 1.0f,
                          (static_cast<float>(i / kPoints) + jitter(random)) * 2.0f / kPoints - 1.0f));
  for (int i = 0; i < kSide * kSide; ++i)
    seen.push_back(bump(1.6f * (jitter(random) - 0.5f), 1.6f * (jitter(random) - 0.5f)));
  SparsePasses passes({0, 1, 0}, kSide);
  const SurfacePoints made = pointsOf(points, 2.0f / kPoints);
  const SurfaceLights lights = lightsOf(discs);
  const SparseLight light = passes.normalise(made, passes.gather(made, lights));
  const ImageBuffer right = passes.bruteForce(lights, seen).first;
  return {beside(passes.apply(made, light, seen).first, right).rmse,
          beside(passes.apply(made, light, seen, {{"interpolate", "plain"}}).first, right).rmse};
}

/// A patch beside the plane, and a dome over it which is brighter on one side by `tilt` of its mean.
std::vector<DiscLight> patch() {
  std::vector<DiscLight> lights;
  for (int i = 0; i < 16; ++i)
    lights.push_back(
        {{1.4f, 0.5f + 0.1f * static_cast<float>(i / 4), -0.15f + 0.1f * static_cast<float>(i % 4)},
         {-1, 0, 0},
         0.01f});
  return lights;
}
std::vector<DiscLight> dome(float tilt) {
  std::vector<DiscLight> lights;
  constexpr int kRings = 8, kSpokes = 32;
  for (int i = 0; i < kRings * kSpokes; ++i) {
    const float height = (static_cast<float>(i / kSpokes) + 0.5f) / kRings,
                wide = std::sqrt(1.0f - height * height),
                turn = 2.0f * static_cast<float>(kPi) * static_cast<float>(i % kSpokes) / kSpokes;
    const glm::vec3 way(wide * std::cos(turn), height, wide * std::sin(turn));
    lights.push_back({4.0f * way, -way, static_cast<float>(2.0 * kPi) * 16.0f / (kRings * kSpokes),
                      glm::vec3(1.0f + tilt * way.x)});
  }
  return lights;
}

}  // namespace

TEST_CASE("virtual area lights err on the Cornell box by at most 0.85 of what all texels unoccluded do",
          "[slow]") {
  const Scene scene = committed("cornell");
  const Picture picture{32, 32, 256};
  const LayeredImage reference = tracedOf(scene, picture);
  const auto errorOf = [&](const Pipeline& text) {
    return lightAgainst(reference, pictured(scene, picture, text, {}).outputs.at("indirect_diffuse"));
  };
  const Pipeline published = pipeline("reflective_shadow_maps");
  std::string source = published.document->source;
  const std::string pass = "pass gather reflective_shadow_maps.gather {";
  source.insert(source.find(pass) + pass.size(), "\n method all\n map lights.map\n");
  const Against ours = errorOf(pipeline("virtual_area_lights")),
                all = errorOf(Pipeline::parse(source, published.file));
  CAPTURE(ours.rmse, ours.ratio, all.rmse, all.ratio);
  CHECK(ours.rmse <= 0.85 * all.rmse);
  CHECK(ours.ratio >= 0.9);
  CHECK(ours.ratio <= 1.15);
}

TEST_CASE("virtual area lights err on corridor, spinning box and arcade by what their card claims") {
  const Against corridor = errorsOn("corridor").diffuse;
  CAPTURE(corridor.rmse, corridor.ratio);
  CHECK(corridor.rmse <= 0.4);
  CHECK(corridor.ratio >= 0.7);
  CHECK(corridor.ratio <= 1.4);
  const Against spinning = errorsOn("spinning_box").diffuse;
  CAPTURE(spinning.rmse);
  CHECK(spinning.rmse < 0.53);
  Scene arcade = committed("arcade");
  const Against under = errorsOn(arcade, {}).diffuse;
  CAPTURE(under.rmse, under.ratio);
  CHECK(under.rmse <= 0.55);
  CHECK(under.ratio >= 0.8);
  arcade.environment = glm::vec3(0.0f);
  const Against without = errorsOn(arcade, {}).diffuse;
  CAPTURE(without.rmse, without.ratio);
  CHECK(without.ratio >= 0.7);
  CHECK(without.ratio <= 1.3);
}

TEST_CASE("glossy light of the Cornell box with a box of gold errs by at most half, energy within a fifth") {
  const Against glossy = errorsOn("cornell_glossy").glossy;
  CAPTURE(glossy.rmse, glossy.ratio);
  CHECK(glossy.rmse <= 0.5);
  CHECK(glossy.ratio >= 0.8);
  CHECK(glossy.ratio <= 1.2);
}

TEST_CASE("lobes up to exponent 100 are those of all lights within half, narrower ones keep their energy") {
  for (const auto& [exponent, most] :
       {std::pair(10.0f, 0.32), {40.0f, 0.45}, {100.0f, 0.55}, {1e3f, 0.9}, {1e4f, 0.9}, {1e5f, 0.9}}) {
    const Against found = ofExponent(exponent, {});
    CAPTURE(exponent);
    CHECK(found.rmse <= most);
    CHECK(found.ratio >= 0.7);
    CHECK(found.ratio <= 1.3);
  }
}

TEST_CASE("more points come nearer to every light at every pixel: 0.07 with 1024, 0.045 with 4096",
          "[slow]") {
  // Of so many lights that their discs are small where walls meet.
  const std::vector<Against> found = ofPoints({256, 512, 1024, 2048, 4096}, "lights=16384");
  for (std::size_t i = 1; i < found.size(); ++i) CHECK(found[i].rmse < found[i - 1].rmse);
  CHECK(found[2].rmse <= 0.07);
  CHECK(found[4].rmse <= 0.045);
}

TEST_CASE("averaged lights keep the bumps of a surface lit from one side, and lose little under a dome") {
  const Kept one = bumps(patch()), all = bumps(dome(1.0f));
  CAPTURE(one.averaged, one.plain, all.averaged, all.plain);
  CHECK(one.averaged <= 0.5 * one.plain);
  CHECK(all.averaged <= 1.3 * all.plain);
}

TEST_CASE("a turning box flickers no more than with reflective shadow maps of as many lights", "[slow]") {
  const Scene scene = committed("spinning_box");
  const double ours = flickerOn(scene, pipeline("virtual_area_lights"), {}),
               theirs = flickerOn(scene, pipeline("reflective_shadow_maps"), {"samples=1024"});
  CAPTURE(ours, theirs);
  CHECK(ours <= theirs);
}

TEST_CASE("table: errors by occlusion and its variants", "[.]") {
  KeptTable table("virtual_area_lights.occlusion", {{"diffuse", 3, 0.01, 0.02},
                                                    {"ratio of diffuse", 3, 0.01},
                                                    {"glossy", 3, 0.01, 0.02},
                                                    {"ratio of glossy", 3, 0.01}});
  for (const char* name :
       {"cornell", "corridor", "stress/stacked_plates", "cornell_glossy", "spinning_box", "arcade"}) {
    std::map<std::string, Against> found;
    for (const char* occlusion : {"visibility=directions", "occlusion=off", "combine=product", "combine=sum",
                                  "combine=nearest", "combine=mask"}) {
      std::vector<std::string> settings{occlusion};
      if (settings.front() != "visibility=directions") settings.emplace_back("visibility=sphere");
      const Errors errors = errorsOn(name, settings);
      table.row(std::string(name) + ", " + occlusion,
                {errors.diffuse.rmse, errors.diffuse.ratio, errors.glossy.rmse, errors.glossy.ratio});
      found[occlusion] = errors.diffuse;
    }
    // Every further disc that counts takes light away; the sum counts those in one line fully, a product
    // less.
    CAPTURE(name);
    CHECK(found["occlusion=off"].ratio > found["combine=nearest"].ratio);
    CHECK(found["combine=nearest"].ratio > found["combine=mask"].ratio);
    CHECK(found["combine=nearest"].ratio > found["combine=product"].ratio);
    CHECK(found["combine=mask"].ratio > found["combine=sum"].ratio);
    CHECK(found["combine=product"].ratio > found["combine=sum"].ratio);
    CHECK(found["visibility=directions"].rmse < found["occlusion=off"].rmse);
  }
}

TEST_CASE("table: the double occlusion of the bunny", "[.]") {
  // Fig. 6: discs in one line hide the light behind them twice, which `mask` does not; `nearest` counts one
  // disc alone.
  KeptTable table("virtual_area_lights.double_occlusion", {{"diffuse", 3, 0.01, 0.02}, {"ratio", 3, 0.01}});
  double light[4];
  int i = 0;
  for (const char* occlusion : {"occlusion=off", "combine=nearest", "combine=product", "combine=mask"}) {
    const Errors errors = errorsOn("bunny", {occlusion, "visibility=sphere"});
    table.row(occlusion, {errors.diffuse.rmse, errors.diffuse.ratio});
    light[i++] = errors.diffuse.ratio;
  }
  // The card's figures.
  CHECK(light[0] / light[3] == Approx(1.057).margin(0.005));
  CHECK(light[1] / light[3] == Approx(1.044).margin(0.005));
  CHECK(light[2] / light[3] == Approx(1.0).margin(0.005));
}

TEST_CASE("table: lobes beside all lights, by exponent and points", "[.]") {
  KeptTable table("virtual_area_lights.lobes", {{"error", 3, 0.01, 0.02},
                                                {"ratio", 2, 0.01},
                                                {"error with exponent_limit none", 3, 0.01, 0.02},
                                                {"ratio with it", 2, 0.01, 0.02}});
  std::map<float, double> before;  // error with fewer points, by exponent
  for (const char* points : {"points=512", "points=2048", "points=8192"})
    for (const float exponent : {1.0f, 10.0f, 40.0f, 100.0f, 1e3f, 1e4f, 1e5f}) {
      const Against limited = ofExponent(exponent, {points}), free = ofExponent(exponent, {points}, false);
      table.row(std::string(points) + ", exponent " + std::to_string(static_cast<int>(exponent)),
                {limited.rmse, limited.ratio, free.rmse, free.ratio});
      CAPTURE(points, exponent);
      // The bound widens what points cannot resolve: it keeps the energy, and more points err less.
      CHECK(limited.ratio == Approx(1.0).margin(0.1));
      CHECK(std::abs(limited.ratio - 1.0) <= std::abs(free.ratio - 1.0) + 0.03);
      if (before.contains(exponent)) CHECK(limited.rmse < before[exponent]);
      before[exponent] = limited.rmse;
    }
}

TEST_CASE("table: interpolation by points and lights", "[.]") {
  const std::vector<int> points{256, 512, 1024, 2048, 4096, 8192, 16384};
  KeptTable table("virtual_area_lights.interpolation", {{"error", 3, 0.005, 0.02}, {"ratio", 3, 0.005}});
  for (const char* lights : {"lights=1024", "lights=4096", "lights=16384"}) {
    const std::vector<Against> found = ofPoints(points, lights);
    for (std::size_t i = 0; i < points.size(); ++i) {
      table.row(std::string(lights) + ", " + std::to_string(points[i]) + " points",
                {found[i].rmse, found[i].ratio});
      CAPTURE(lights, points[i]);
      CHECK(found[i].ratio == Approx(1.0).margin(0.025));
      if (i > 0) CHECK(found[i].rmse < found[i - 1].rmse + 0.002);
    }
    CHECK(found.back().rmse < 0.3 * found.front().rmse);
  }
}

TEST_CASE("table: bumps and flicker", "[.]") {
  const Kept one = bumps(patch());
  KeptTable table("virtual_area_lights.bumps",
                  {{"error, averaged", 3, 0.005, 0.02}, {"plain", 3, 0.005, 0.02}});
  table.row("lit by a patch", {one.averaged, one.plain});
  CHECK(one.averaged <= 0.5 * one.plain);
  for (const char* tilt : {"0.0", "0.3", "0.6", "1.0"}) {
    const Kept all = bumps(dome(std::stof(tilt)));
    table.row(std::string("lit by a dome of tilt ") + tilt, {all.averaged, all.plain});
    CAPTURE(tilt);
    // Under an even dome `plain` interpolates what hardly changes.
    CHECK(all.averaged <= (std::stof(tilt) > 0.0f ? 1.3 * all.plain : 0.05));
  }
  KeptTable flicker("virtual_area_lights.flicker",
                    {{"flicker", 4, 0.001, 0.05}, {"reflective shadow maps", 4, 0.001, 0.05}});
  for (const char* name : {"spinning_box", "horse_gallop"}) {
    const Scene scene = committed(name);
    const double ours = flickerOn(scene, pipeline("virtual_area_lights"), {}, 6),
                 theirs = flickerOn(scene, pipeline("reflective_shadow_maps"), {"samples=1024"}, 6);
    flicker.row(name, {ours, theirs});
    CHECK(ours <= theirs);
  }
}

TEST_CASE("table: shares of the light that no virtual area light holds", "[.]") {
  KeptTable table("virtual_area_lights.unheld",
                  {{"from the environment", 3, 0.01}, {"sent on by glossy surfaces", 3, 0.01}});
  for (const char* name : {"cornell_glossy", "arcade", "exponents"}) {
    const Scene scene = committed(name);
    Scene without = scene;
    without.environment = glm::vec3(0.0f);
    const auto meanOf = [](const Scene& of, const char* layer) {
      return estimateOf(tracedOf(of, {64, 64, 128}), layer).mean;
    };
    // What glossy surfaces send on: light that is left where they reflect nothing but diffusely.
    Scene dull = without;
    for (Material& material : dull.materials) material.specular = glm::vec3(0.0f);
    const double all = meanOf(scene, "one_bounce_diffuse"), noSky = meanOf(without, "one_bounce_diffuse"),
                 diffuse = meanOf(dull, "one_bounce_diffuse");
    table.row(name, {1.0 - noSky / all, (noSky - diffuse) / all});
    CAPTURE(name);
    // The same paths without a sky bring the same light, to the bit, where there was none.
    if (scene.environment == glm::vec3(0.0f))
      CHECK(noSky == all);
    else
      CHECK(noSky < all);
    CHECK(diffuse > 0.0);
  }
}

TEST_CASE("table: discs in line on the bunny", "[.]") {
  KeptTable table("virtual_area_lights.bunny", {{"error", 3, 0.01, 0.02}, {"ratio", 3, 0.01}});
  std::map<std::string, double> light;
  for (const char* combine : {"occlusion=off", "combine=product", "combine=nearest", "combine=mask"})
    for (const char* points : {"points=1024", "points=4096"}) {
      const Against found = errorsOn(committed("bunny"), {combine, points, "visibility=sphere"}).diffuse;
      table.row(std::string(combine) + ", " + points, {found.rmse, found.ratio});
      light[std::string(combine) + points] = found.ratio;
    }
  // Discs in line take more than the nearest alone; counted once or twice, they are not what is lost.
  for (const std::string points : {"points=1024", "points=4096"}) {
    CAPTURE(points);
    CHECK(light["occlusion=off" + points] > light["combine=nearest" + points]);
    CHECK(light["combine=nearest" + points] > light["combine=mask" + points]);
    CHECK(light["combine=product" + points] == Approx(light["combine=mask" + points]).epsilon(0.01));
  }
}
