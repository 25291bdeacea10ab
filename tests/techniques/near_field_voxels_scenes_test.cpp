// Near-field voxels on committed scenes: errors against the path-traced reference, texels that rays read, and
// what the printed walk finds otherwise.
#include <random>

#include "lumivox/measure/metrics.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/reference/path_tracer.h"
#include "support/near_field_scene.h"
#include "support/scene_builder.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::near_field;

namespace {

/// RMSE, without the reference's own noise, over that of nothing; and the mean over the reference's.
struct Against {
  double rmse, ratio;
};
Against against(const Scene& scene, const std::string& name, const std::string& output,
                const std::string& layer, float nothing, const std::vector<std::string>& settings,
                int height) {
  ReferenceOptions referenceOptions = quietly(64, 1);
  referenceOptions.width = 64;
  referenceOptions.height = height;
  referenceOptions.useCache = true;
  const LayeredImage reference = cachedReference(scene, referenceOptions);
  const ImageBuffer &right = reference.layers.at(layer), &variance = reference.layers.at(layer + ".variance");
  const Pipeline text = pipeline(name);
  RenderOptions options;
  options.width = 64;
  options.height = height;
  options.parameters = text.settings(settings);
  const ImageBuffer image = renderOnce(scene, text, options).outputs.at(output);
  ImageBuffer none(64, height, right.channels());
  for (float& value : none.values()) value = nothing;
  const ImageError error = compare(image, right, variance), ofNone = compare(none, right, variance);
  const double squared = error.rmse.value * error.rmse.value - error.noiseFloor * error.noiseFloor;
  return {std::sqrt(std::max(0.0, squared)) / ofNone.rmse.value, error.meanRatio.value};
}

/// Texels that all rays of the image read.
double fetchesOf(const Seen& seen, const char* method) {
  PassHarness gather(device(), techniques(), "near_field_voxels", "gather", seen.scene, seen.snapshot);
  gather.setInput("gbuffer", seen.gbuffer);
  gather.setInput("bits", seen.bits);
  gather.setParameter("method", std::string(method));
  gather.setParameter("rays", 16);
  gather.setParameter("radius", 1e6);
  gather.run();
  const std::vector<float> read = gather.output<Image>("fetches").texture->downloadFloats(0);
  double sum = 0.0;
  for (std::size_t i = 0; i < read.size(); i += 4) sum += read[i];
  return sum;
}

}  // namespace

TEST_CASE("near-field voxels err on the Cornell box and the arcade by less than what is asked of them") {
  const Scene cornell = committed("cornell");
  const auto light = [](const Scene& scene, const std::vector<std::string>& settings, int height) {
    return against(scene, "near_field_voxels", "indirect_diffuse", "one_bounce_diffuse", 0.0f, settings,
                   height);
  };
  const Against fine = light(cornell, {"rays=64"}, 64),
                coarse = light(cornell, {"rays=64", "resolution=32"}, 64);
  CHECK(fine.rmse < 0.25);
  CHECK(fine.ratio == Approx(1.0).epsilon(0.1));
  CHECK(coarse.ratio == Approx(1.0).epsilon(0.1));
  CHECK(coarse.rmse > fine.rmse);
  CHECK(light(committed("arcade"), {"rays=64"}, 36).rmse < 0.5);
  const Against open = against(cornell, "near_field_voxels_occlusion", "ambient_occlusion",
                               "ambient_occlusion", 1.0f, {"rays=64", "resolution=128"}, 64);
  CHECK(open.rmse < 0.45);
}

TEST_CASE("the hierarchy reads fewer texels than the plain walk, the more the finer the voxels are") {
  struct Asked {
    int resolution;
    double share;
  };
  for (const Asked& asked : {Asked{64, 0.5}, {128, 0.3}, {256, 0.16}}) {
    const Seen seen("cornell", asked.resolution, 16);
    const double hierarchy = fetchesOf(seen, "hierarchy"), plain = fetchesOf(seen, "plain");
    CAPTURE(asked.resolution, hierarchy / plain, fetchesOf(seen, "stacks") / plain);
    CHECK(hierarchy < asked.share * plain);
  }
}

TEST_CASE("the printed walk misses voxels and finds others, as its card says") {
  const Seen seen("cornell", 128, 64);
  const auto texels = [](const gpu::TextureRef& texture) { return texture->downloadFloats(0); };
  const std::vector<float> positions = texels(seen.gbuffer.position),
                           normals = texels(seen.gbuffer.geometricNormal);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  constexpr int kWidth = 512;
  std::vector<float> origins, directions;
  for (int ray = 0; ray < 16; ++ray)
    for (std::size_t i = 0; i < positions.size(); i += 4) {
      const glm::vec3 position(positions[i], positions[i + 1], positions[i + 2]),
          normal(normals[i], normals[i + 1], normals[i + 2]);
      const float height = 1.0f - 2.0f * unit(random), turn = 6.2831853f * unit(random),
                  across = std::sqrt(1.0f - height * height);
      const glm::vec3 direction = glm::normalize(
          normal * 1.0001f + glm::vec3(across * std::cos(turn), height, across * std::sin(turn)));
      const glm::vec3 start =
          position + normal * (seen.bits.grid.voxelSize *
                               (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z) + 0.0625f));
      for (int c = 0; c < 3; ++c) {
        origins.push_back(start[c]);
        directions.push_back(direction[c]);
      }
      origins.push_back(positions[i + 3] > 0.0f ? 1e6f : -1.0f);
      directions.push_back(0.0f);
    }
  const auto image = [&](const std::vector<float>& values) {
    auto texture = std::make_shared<gpu::Texture>(
        device(),
        gpu::TextureDescription{.format = gpu::Format::rgba32f,
                                .width = kWidth,
                                .height = static_cast<int>(values.size()) / 4 / kWidth},
        "rays");
    texture->uploadFloats(0, values);
    return Image{texture};
  };
  const auto hits = [&](const char* method) {
    PassHarness probe(device(), techniques(), "near_field_voxels", "probe", seen.scene, seen.snapshot);
    probe.setInput("bits", seen.bits);
    probe.setInput("origins", image(origins));
    probe.setInput("directions", image(directions));
    probe.setParameter("method", std::string(method));
    probe.run();
    return texels(probe.output<Image>("hits").texture);
  };
  const std::vector<float> right = hits("hierarchy"), printed = hits("printed");
  int all = 0, missed = 0, other = 0, invented = 0;
  for (std::size_t i = 0; i < right.size(); i += 4) {
    if (right[i + 3] < 0.0f) {
      invented += printed[i + 3] >= 0.0f;
      continue;
    }
    ++all;
    if (printed[i + 3] < 0.0f)
      ++missed;
    else
      other += right[i] != printed[i] || right[i + 1] != printed[i + 1] || right[i + 2] != printed[i + 2];
  }
  REQUIRE(all > 20000);
  CAPTURE(all, 1.0 * missed / all, 1.0 * other / all, invented);
  CHECK(missed > 0);
  CHECK(missed < 0.02 * all);
  CHECK(other < 0.1 * all);
}

namespace {

/// The floor beside the hidden sender: mean light in red, its standard error over the pixels' noise, and
/// pixels.
struct Patch {
  double mean = 0.0, error = 0.0;
  int pixels = 0;
};
Patch litFloor(const Seen& seen, const ImageBuffer& image) {
  const std::vector<float> places = seen.gbuffer.position->downloadFloats(0),
                           normals = seen.gbuffer.normal->downloadFloats(0);
  const glm::vec3 low = glm::vec3(glm::dvec3(0.2, -0.01, -1.1) - seen.snapshot.origin),
                  high = glm::vec3(glm::dvec3(0.8, 0.01, -0.5) - seen.snapshot.origin);
  Patch patch;
  double squares = 0.0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const auto i = static_cast<std::size_t>(4 * (y * image.width() + x));
      const glm::vec3 place(places[i], places[i + 1], places[i + 2]);
      const bool inside = places[i + 3] > 0.0f && normals[i + 1] > 0.9f &&
                          glm::all(glm::greaterThan(place, low)) && glm::all(glm::lessThan(place, high));
      if (!inside) continue;
      ++patch.pixels;
      patch.mean += image.at(x, y, 0);
      squares += image.at(x, y, 0) * image.at(x, y, 0);
    }
  patch.mean /= patch.pixels;
  // From the differences between the pixels, light's own among them: an upper bound of the noise.
  patch.error = std::sqrt((squares / patch.pixels - patch.mean * patch.mean) / patch.pixels);
  return patch;
}

}  // namespace

TEST_CASE("a sender that the camera does not see lights the floor, as from any other view") {
  const auto ofView = [](double degrees, ImageBuffer* reference) {
    Seen seen("hidden_sender", 8, 64);
    Camera& camera = seen.scene.cameras.front();
    const glm::dvec3 way = camera.target - camera.eye;
    const double turn = degrees * kPi / 180.0;
    camera.target = camera.eye + glm::dvec3(std::cos(turn) * way.x + std::sin(turn) * way.z, way.y,
                                            std::cos(turn) * way.z - std::sin(turn) * way.x);
    seen.snapshot = snapshotOf(seen.scene, 0.0);
    PassHarness view(device(), techniques(), "direct_lighting", "gbuffer", seen.scene, seen.snapshot);
    view.run();
    seen.gbuffer = view.output<GBuffer>("gbuffer");
    // Nothing red is in the picture.
    const std::vector<float> albedo = seen.gbuffer.diffuse->downloadFloats(0);
    for (std::size_t i = 0; i < albedo.size(); i += 4) REQUIRE(albedo[i] == albedo[i + 1]);
    const Pipeline text = pipeline("near_field_voxels");
    RenderOptions options;
    options.parameters = text.settings({"rays=256", "resolution=128"});
    const ImageBuffer image = renderOnce(seen.scene, text, options).outputs.at("indirect_diffuse");
    if (reference != nullptr)
      *reference = renderReference(seen.scene, quietly(256, 1)).layers.at("one_bounce_diffuse");
    return std::pair(litFloor(seen, image), reference != nullptr ? litFloor(seen, *reference) : Patch{});
  };
  ImageBuffer reference;
  const auto [ahead, truth] = ofView(0.0, &reference);
  const Patch turned = ofView(10.0, nullptr).first;
  REQUIRE(ahead.pixels > 30);
  REQUIRE(turned.pixels > 30);
  REQUIRE(truth.mean > 0.01);
  CAPTURE(ahead.mean, truth.mean, turned.mean, ahead.error, turned.error);
  CHECK(ahead.mean == Approx(truth.mean).epsilon(0.15));
  CHECK(std::abs(turned.mean - ahead.mean) < std::hypot(ahead.error, turned.error));
}

TEST_CASE("samples of some pixels are those of the same pixels among all, for any number of rays") {
  constexpr int kSide = 64;
  const Scene scene = committed("cornell");
  const auto arriving = [&](const char* pixels, int rays) {
    Pipeline text = pipeline("near_field_voxels");
    std::string source = text.document->source;
    const std::string head = "near_field_voxels.gather {\n";
    source.insert(source.find(head) + head.size(),
                  std::string("    rotation none\n    pixels ") + pixels + "\n");
    RenderOptions options;
    options.width = options.height = kSide;
    const Pipeline changed = Pipeline::parse(source, text.file);
    options.parameters = changed.settings({"rays=" + std::to_string(rays)});
    PipelineExecutor executor(device(), techniques(), scene, changed, options);
    executor.keepOutput("gather", "arriving");
    executor.render(0.0);
    const auto* output = dynamic_cast<const Out<Image>*>(executor.output("gather", "arriving"));
    REQUIRE(output != nullptr);
    return imageOf(*(*output)->texture);
  };
  for (const int rays : {16, 24, 64, 200}) {
    const ImageBuffer all = arriving("full", rays);
    for (const auto& [word, every] : {std::pair("half", 2), std::pair("quarter", 4)}) {
      const ImageBuffer some = arriving(word, rays);
      int other = 0;
      for (int y = 0; y < kSide / every; ++y)
        for (int x = 0; x < kSide / every; ++x)
          other += some.at(x, y, 0) != all.at(every * x + every / 2, every * y + every / 2, 0);
      CAPTURE(rays, word);
      CHECK(other == 0);
    }
  }
}
