#include <cmath>
#include <cstring>

#include "lumivox/pipeline/gpu_scene.h"
#include "support/against_reference.h"
#include "support/facts.h"
#include "support/marching.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

Medium smokeMedium() {
  return smokeFrom({0.1, -0.6, 0.2});
}

Scene smokeScene(const Medium& medium) {
  Scene scene = emptyScene();
  scene.media.push_back(medium);
  return scene;
}

/// The grid after inserting the particles of a scene's media.
ScatteringGrid inserted(const Scene& scene, double time, int resolution,
                        const OccupancyGrid* space = nullptr) {
  LonePass particles("volumetric_smoke.particles", scene, {}, time),
      insert("volumetric_smoke.insert", scene, {{"resolution", resolution}}, time);
  insert.in("particles", particles.out<Particles>("particles"));
  if (space != nullptr) insert.in("space", *space);
  return insert.out<ScatteringGrid>("media");
}

double massOf(const ScatteringGrid::Medium& medium) {
  return sumOf(medium.density->downloadFloats(0)) * std::pow(double(medium.grid.voxelSize), 3.0);
}

RenderOptions sized(int size) {
  return test::sized(size, size);
}

FrameResult frameAt(const Scene& scene, const Pipeline& text, const RenderOptions& options, double time) {
  return PipelineExecutor(device(), techniques(), scene, text, options).render(time);
}

}  // namespace

TEST_CASE(
    "the phase function integrates to 1 within 1e-4 for g from -0.99 to 0.99; as published to (1-g)/(1+g)") {
  // Thin medium, one step: L = sigma_s p(cos) E d. Pixel i looks at an angle to the light of cosine
  // mu = +-(1 - 2 t^3), which puts many of the angles into the narrow lobe; int p dmu by the midpoint rule in
  // t.
  constexpr float kThin = 1e-6f;
  constexpr int kCount = kPixels * kPixels;
  for (const double g : {-0.99, -0.9, -0.4, 0.0, 0.4, 0.9, 0.99}) {
    SceneBuilder builder;
    builder.scene = emptyScene();
    builder.light(LightKind::directional, glm::vec3(1.0f), {}, {0, 0, 1});
    const double side = g < 0.0 ? -1.0 : 1.0;
    const GBuffer gbuffer = surfacesAt([&](int i) {
      const double t = (i + 0.5) / kCount, rest = 2.0 * t * t * t;  // 1 - |mu|, kept exact
      const double mu = side * (1.0 - rest), sine = std::sqrt(rest * (2.0 - rest));
      // The light travels to +z, so the way to it is -z: cosine of the view direction with -z.
      return glm::vec3(glm::dvec3(sine, 0.0, -mu));
    });
    for (const char* form : {"normalised", "as_published"}) {
      const ScatteringGrid fog =
          evenMedium(glm::vec3(kThin), glm::vec3(1.0f), static_cast<float>(g), glm::vec3(-2), glm::vec3(2));
      const Marched result = march(builder.scene, fog, gbuffer, 1, {{"phase", form}});
      double sum = 0.0;
      for (int i = 0; i < kCount; ++i) {
        const double t = (i + 0.5) / kCount;
        sum += 2.0 * kPi * valueOf(result.scattered, i) / kThin * 6.0 * t * t / kCount;
      }
      CAPTURE(g, form);
      const double factor = std::strcmp(form, "normalised") == 0 ? 1.0 : (1.0 - g) / (1.0 + g);
      CHECK(sum == Approx(factor).epsilon(1e-4));
    }
  }
}

TEST_CASE("particles on the device are those of the scene, bit for bit, at any time") {
  const Scene scene = smokeScene(smokeMedium());
  for (const double time : {0.0, 0.4, 2.9999, 3.0, 100000.25, -1.0}) {
    const auto offsets = LonePass("volumetric_smoke.particles", scene, {}, time)
                             .out<Particles>("particles")
                             .groups.front()
                             .offsets->downloadValues<glm::vec3>();
    const ParticleClock clock = particleClock(scene.media.front(), time);
    for (std::uint32_t i = 0; i < 3000; ++i) {
      const glm::vec3 expected(particleAt(scene.media.front(), clock, i));
      REQUIRE(offsets[i] == expected);
    }
  }
}

TEST_CASE("more particles than a row of work groups holds are all made and inserted, to the last one") {
  Medium many = smokeMedium();
  many.particles = 65535 * 64 + 1000;  // in groups of 64; OpenGL promises 65535 groups along an axis
  const Scene scene = smokeScene(many);
  const Particles made = LonePass("volumetric_smoke.particles", scene, {}, 1.3).out<Particles>("particles");
  const auto offsets = made.groups.front().offsets->downloadValues<glm::vec3>();
  const ParticleClock clock = particleClock(many, 1.3);
  for (std::uint32_t i = 65535 * 64 - 100; i < static_cast<std::uint32_t>(many.particles); ++i)
    REQUIRE(offsets[i] == glm::vec3(particleAt(many, clock, i)));
  LonePass insert("volumetric_smoke.insert", scene, {{"resolution", 8}, {"deposit", "counts"}}, 1.3);
  CHECK(massOf(insert.in("particles", made).out<ScatteringGrid>("media").media.front()) ==
        Approx(many.particles * particleMass(many)).epsilon(1e-6));
}

TEST_CASE("inserting particles keeps their mass, in coarse and fine grids, and gives the same bits again") {
  const Scene scene = smokeScene(smokeMedium());
  const double expected = 3000 * particleMass(scene.media.front());
  for (const int resolution : {8, 16, 48}) {
    const ScatteringGrid first = inserted(scene, 1.3, resolution), second = inserted(scene, 1.3, resolution);
    CHECK(massOf(first.media.front()) == Approx(expected).epsilon(1e-6));
    CHECK(first.media.front().density->downloadFloats(0) == second.media.front().density->downloadFloats(0));
  }
}

TEST_CASE("a particle shares out its mass in proportion to its cloud at the centres of voxels") {
  Medium single = smokeMedium();
  single.particles = 1;
  const Scene scene = smokeScene(single);
  const double time = 1.3, mass = particleMass(single);
  for (const int resolution : {8, 12}) {  // clouds are at least a voxel wide: a few voxels, then some more
    const ScatteringGrid::Medium medium = inserted(scene, time, resolution).media.front();
    const std::vector<float> density = medium.density->downloadFloats(0);
    const double voxel = medium.grid.voxelSize, radius = std::max(single.radius, voxel);
    const glm::dvec3 centre = single.source - snapshotOf(scene, time).origin +
                              glm::dvec3(particleAt(single, particleClock(single, time), 0));
    std::vector<double> weights;
    double sum = 0.0;
    const glm::ivec3 size = medium.grid.resolution;
    for (int i = 0; i < size.x * size.y * size.z; ++i) {
      const glm::dvec3 place(i % size.x, i / size.x % size.y, i / (size.x * size.y)),
          path = (glm::dvec3(medium.grid.low) + voxel * (place + 0.5) - centre) / radius;
      weights.push_back(std::pow(std::max(0.0, 1.0 - glm::dot(path, path)), 3.0));
      sum += weights.back();
    }
    REQUIRE(weights.size() == density.size());
    REQUIRE(sum > 0.0);
    for (std::size_t i = 0; i < weights.size(); ++i)
      CHECK(density[i] * voxel * voxel * voxel / mass == Approx(weights[i] / sum).margin(1e-4));
  }
}

TEST_CASE("a fine grid holds the density of the clouds") {
  const Scene scene = smokeScene(smokeMedium());
  const ScatteringGrid grid = inserted(scene, 2.0, 96);
  const ScatteringGrid::Medium& medium = grid.media.front();
  const std::vector<float> density = medium.density->downloadFloats(0);
  const Medium& source = scene.media.front();
  const ParticleClock clock = particleClock(source, 2.0);
  const glm::dvec3 origin = snapshotOf(scene, 2.0).origin;
  double squared = 0.0, reference = 0.0;
  for (int z = 5; z < medium.grid.resolution.z; z += 7)
    for (int y = 5; y < medium.grid.resolution.y; y += 7)
      for (int x = 5; x < medium.grid.resolution.x; x += 7) {
        const glm::dvec3 centre = origin + glm::dvec3(medium.grid.low) +
                                  double(medium.grid.voxelSize) * (glm::dvec3(x, y, z) + 0.5);
        double expected = 0.0;
        for (std::uint32_t i = 0; i < 3000; ++i) {
          const glm::dvec3 path =
              (centre - source.source - glm::dvec3(particleAt(source, clock, i))) / source.radius;
          expected += std::pow(std::max(0.0, 1.0 - glm::dot(path, path)), 3.0);
        }
        const auto index =
            static_cast<std::size_t>((z * medium.grid.resolution.y + y) * medium.grid.resolution.x + x);
        squared += std::pow(density[index] - expected, 2.0);
        reference += expected * expected;
      }
  CHECK(std::sqrt(squared / reference) < 0.01);
}

TEST_CASE("nothing is inserted into solid voxels, and what they would have held stays in the free ones") {
  Medium large = smokeMedium();
  large.radius = 0.25;  // every cloud reaches out of a slab of 0.25 m
  const Scene scene = smokeScene(large);
  OccupancyGrid space;
  space.grid = {glm::vec3(-2.0f), 0.25f, glm::ivec3(16)};
  std::vector<float> solid(16 * 16 * 16, 0.0f);
  for (std::size_t i = 0; i < solid.size(); ++i) solid[i] = i / 16 % 16 == 8 ? 1.0f : 0.0f;  // 0 < y < 0.25
  space.opacity = textureOf(volumeOf(glm::ivec3(16), gpu::Format::r8), solid);
  const ScatteringGrid grid = inserted(scene, 1.3, 64, &space);
  const ScatteringGrid::Medium& medium = grid.media.front();
  const std::vector<float> density = medium.density->downloadFloats(0);
  int blocked = 0;
  std::size_t i = 0;
  for (int z = 0; z < medium.grid.resolution.z; ++z)
    for (int y = 0; y < medium.grid.resolution.y; ++y)
      for (int x = 0; x < medium.grid.resolution.x; ++x, ++i) {
        const float height = medium.grid.low.y + (static_cast<float>(y) + 0.5f) * medium.grid.voxelSize;
        if (height <= 0.001f || height >= 0.249f) continue;
        CHECK(density[i] == 0.0f);
        ++blocked;
      }
  CHECK(blocked > 100);
  CHECK(massOf(medium) == Approx(3000 * particleMass(scene.media.front())).epsilon(1e-6));
}

TEST_CASE("light depths in a volume give the image of marching to the light from every step") {
  SceneBuilder builder;
  builder.scene = smokeScene(smokeMedium());
  builder.light(LightKind::point, glm::vec3(4.0f), {1.0, 1.0, 1.0});
  builder.light(LightKind::directional, glm::vec3(2.0f), {}, {0.4, -1, 0.1});
  builder.scene.cameras.front().eye = {0, 0, 3};
  const ScatteringGrid grid = inserted(builder.scene, 0.0, 48);
  const GBuffer gbuffer = surfacesAt([](int i) {
    return glm::vec3(2.0f * static_cast<float>(i % kPixels) / kPixels - 1.0f,
                     1.0f - 2.0f * static_cast<float>(i / kPixels) / kPixels, -1.0f);
  });
  const ImageBuffer marched = march(builder.scene, grid, gbuffer, 32, {{"light_depth", "march"}}).scattered;
  // Near media are integrated; trilinear interpolation of the rest: a finer grid errs less.
  double errors[2];
  for (const int level : {0, 1}) {
    const ImageBuffer volume =
        march(builder.scene, grid, gbuffer, 32, {{"light_resolution", 32 << level}}).scattered;
    double squared = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < volume.values().size(); ++i) {
      squared += std::pow(volume.values()[i] - marched.values()[i], 2.0);
      sum += std::pow(marched.values()[i], 2.0);
    }
    CHECK(sum > 0.0);
    errors[level] = std::sqrt(squared / sum);
  }
  CAPTURE(errors[0], errors[1]);

  CHECK(errors[0] < 0.01);
  CHECK(errors[1] < 0.006);
}

TEST_CASE("at half resolution of an image of odd size every ray is one of the image's") {
  // Where the pattern would look beside the image it takes the last pixel: all rays end at the surface.
  constexpr int kWidth = 9, kHeight = 7;
  SceneBuilder builder;
  builder.look({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.7, kWidth, kHeight);
  GBuffer gbuffer;
  gbuffer.position = filled(pixels(kWidth, kHeight), {0, 0, -1, 1});
  const ScatteringGrid fog = evenMedium(glm::vec3(1.0f), glm::vec3(0.5f), 0, glm::vec3(-3), glm::vec3(3));
  const ImageBuffer through = march(builder.scene, fog, gbuffer, 4, {{"resolution", "half"}}).transmittance;
  REQUIRE(through.width() == 5);
  REQUIRE(through.height() == 4);
  for (const float value : through.values()) CHECK(value == Approx(std::exp(-1.0)).epsilon(1e-3));
}

TEST_CASE("surfaces are lit through the medium: E exp(-sigma_t d)") {
  SceneBuilder builder;
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.lambert(0.6f));
  builder.light(LightKind::directional, glm::vec3(3.0f), {}, {0, -1, 0});
  builder.look({0, 3, 0.01}, {0, 0, 0}, {0, 1, 0}, 0.3, 16, 16);
  Medium fog;
  fog.extinction = {0.3f, 1.0f, 2.0f};
  fog.box.emplace(glm::dvec3(-2, 0, -2), glm::dvec3(2, 0.7, 2));
  builder.scene.media.push_back(fog);
  const ImageBuffer direct = renderOnce(builder.scene, pipeline("volumetric_smoke")).outputs.at("direct");
  for (int channel = 0; channel < 3; ++channel)
    CHECK(direct.at(8, 8, channel) ==
          Approx(0.6 / kPi * 3.0 * std::exp(-0.7 * fog.extinction[channel])).epsilon(0.001));
}

TEST_CASE("cones see the medium: an environment seen through d metres of it is dimmed by exp(-sigma_t d)") {
  Scene scene = emptyScene();
  scene.environment = glm::vec3(1.0f);
  RadianceGrid grid;
  grid.grid = {glm::vec3(-2.0f), 0.25f, glm::ivec3(16)};
  grid.radiance = filled(volumeOf(glm::ivec3(16), gpu::Format::rgba32f, 5), glm::vec4(0.0f));
  // A slab above the surface: along the slanted cone of one direction the way through it is 0.5 m / cos 45
  // deg.
  const glm::vec3 extinction(0.3f, 1.0f, 3.0f);
  const ImageBuffer diffuse =
      LonePass("voxel_cone_tracing.gather", scene, {{"cones", 1}, {"pattern", 1}})
          .in("gbuffer", gbufferAt({}, {kPixels, kPixels}))
          .in("grid", grid)
          .in("media", evenMedium(extinction, glm::vec3(0.5f), 0, {-50, 1, -50}, {50, 1.5f, 50}))
          .image("diffuse");
  for (int channel = 0; channel < 3; ++channel)
    CHECK(diffuse.at(5, 5, channel) ==
          Approx(std::exp(-0.5 / std::sqrt(0.5) * extinction[channel])).epsilon(0.001));
}

TEST_CASE("smoke at half resolution differs from that at full by no more FLIP than the card claims") {
  const Scene scene = committed("smoke");
  const Pipeline text = pipeline("volumetric_smoke");
  RenderOptions half = sized(256), full = sized(256);
  half.wanted = full.wanted = {"scattered", "final"};
  full.parameters = text.settings({"pixels=full"});
  const FrameResult a = frameAt(scene, text, half, 3.0), b = frameAt(scene, text, full, 3.0);
  // A tenth more is allowed.
  const struct {
    const char* output;
    double flip;
  } claims[] = {{"scattered", 0.015}, {"final", 0.007}};
  for (const auto& claim : claims) {
    const double flip = compare(a.outputs.at(claim.output), b.outputs.at(claim.output)).flip;
    CAPTURE(claim.output, flip);
    CHECK(flip < 1.1 * claim.flip);
    CHECK(flip > 0.5 * claim.flip);  // half the rays are not the same
  }
}

TEST_CASE("a scene without media pays nothing: the passes are left out and the image keeps its bits") {
  const Scene scene = committed("cornell_glossy");
  PipelineExecutor executor(device(), techniques(), scene, pipeline("volumetric_smoke"), sized(48));
  const FrameResult pruned = executor.render(0.0),
                    without = renderOnce(scene, pipeline("voxel_cone_tracing_directional"), sized(48));
  for (const PassRecord& pass : pruned.passes) CHECK(pass.technique != "volumetric_smoke");
  const std::vector<LeftOut> leftOut = executor.explain().leftOut;
  CHECK(std::count_if(leftOut.begin(), leftOut.end(), [](const LeftOut& one) {
          return one.level == LeftOut::Level::pass && Tells("scene", "not", "have").match(one.why);
        }) == 4);
  CHECK(pruned.outputs.at("indirect_diffuse").values() == without.outputs.at("indirect_diffuse").values());
}

TEST_CASE("scattering in smoke and fog is that of the path tracer", "[slow]") {
  for (const char* name : {"smoke", "fog"}) {
    CAPTURE(name);
    const Scene scene = committed(name);
    ReferenceOptions referenceOptions = quietly(384);
    referenceOptions.width = referenceOptions.height = 64;
    referenceOptions.time = 3.0;
    referenceOptions.useCache = true;
    const LayeredImage reference = cachedReference(scene, referenceOptions);
    const Pipeline text = pipeline("volumetric_smoke");
    // Grid and image resolution bring the energy to the reference's; the default is near.
    for (const bool fine : {false, true}) {
      RenderOptions options = sized(64);
      if (fine) options.parameters = text.settings({"pixels=full", "smoke_resolution=128", "steps=64"});
      const Against found = against(reference, frameAt(scene, text, options, 3.0).outputs.at("scattered"),
                                    "scattered_single", 0.0f);
      CAPTURE(fine, found.rmse, found.ratio);
      CHECK(found.ratio == Approx(1.0).margin(fine ? 0.02 : 0.05));
      CHECK(found.rmse < (fine ? 0.15 : 0.25));
    }
  }
}
