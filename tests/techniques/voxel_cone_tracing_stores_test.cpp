// What holds for every store that cones read alike: closed forms, refusals, and the same light as through
// another store that holds the same.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "../../techniques/voxel_cone_tracing/cones/light_discs.h"
#include "lumivox/base/error.h"
#include "lumivox/measure/metrics.h"
#include "support/stores.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;
using Catch::Matchers::Contains;

namespace {

const char* const kPipelines[] = {"voxel_cone_tracing",
                                  "voxel_cone_tracing_lobes",
                                  "voxel_cone_tracing_coarse_directional",
                                  "voxel_cone_tracing_directional",
                                  "voxel_cone_tracing_octree",
                                  "voxel_cone_tracing_octree_directional",
                                  "voxel_cone_tracing_clipmap"};

ImageBuffer indirectLight(const Scene& scene, const char* name) {
  RenderOptions options;
  options.width = options.height = 16;
  const Pipeline text = pipeline(name);
  options.parameters = text.settings({"resolution=32"});
  return renderOnce(scene, text, options).outputs.at("indirect_diffuse");
}

/// A pipeline through one grid, through another store.
struct Store {
  const char *name, *finest, *filled, *input;
};
const Store kStores[] = {
    {"six grids", "voxel_cone_tracing.inject_directional { fragments voxels.fragments $ }",
     "voxel_cone_tracing.filter_directional { radiance finest.radiance }", "directions"},
    {"coarse directional", "voxel_cone_tracing.inject { fragments voxels.fragments $ }",
     "voxel_cone_tracing.filter_directional { finest finest.radiance }", "directions"},
    {"octree", "voxel_cone_tracing.octree_inject { fragments voxels.fragments tree tree.tree $ }",
     "voxel_cone_tracing.octree_filter { radiance finest.radiance }", "octree"},
    {"octree of six faces",
     "voxel_cone_tracing.octree_inject { fragments voxels.fragments tree tree.tree faces six $ }",
     "voxel_cone_tracing.octree_filter { radiance finest.radiance }", "octree"},
    {"clipmap", "voxel_cone_tracing.clipmap { resolution 64 levels 1 $ }",
     "voxel_cone_tracing.clipmap_filter { radiance finest.radiance }", "clipmap"}};

ImageBuffer directLight(const Scene& scene, const std::string& tracing, const std::string& injecting,
                        const Store* store, const glm::ivec2& size) {
  const Store one{"one grid", "voxel_cone_tracing.inject { fragments voxels.fragments $ }",
                  "voxel_cone_tracing.filter { radiance finest.radiance }", "grid"};
  if (store == nullptr) store = &one;
  std::string finest = store->finest;
  finest.replace(finest.find('$'), 1, injecting);
  const std::string source =
      "pipeline \"p\" {\n  pass gbuffer direct_lighting.gbuffer { }\n"
      "  pass shadow direct_lighting.shadow_map { }\n  pass lights voxel_cone_tracing.lights { }\n"
      "  pass voxels voxelization.conservative { resolution 64 }\n"
      "  pass tree voxel_cone_tracing.octree { fragments voxels.fragments }\n"
      "  pass finest " +
      finest + "\n  pass grid " + store->filled + "\n  pass direct " + tracing + " " + store->input +
      " grid.mips }\n  output direct direct.radiance\n}\n";
  RenderOptions options;
  options.width = size.x;
  options.height = size.y;
  return renderOnce(scene, Pipeline::parse(source, "p.pipeline"), options).outputs.at("direct");
}

/// What mirrors at the origin see in directions all around the one to `middle`, up to `reach` m from it: each
/// stands for the solid angle of its part of a plane.
double seenAround(const AnyStore& store, const glm::dvec3& middle, double reach, float exponent) {
  constexpr int kSide = 48;
  SceneBuilder builder;
  builder.look({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, kSide, kSide);
  const glm::dvec3 forward = glm::normalize(middle), right = glm::normalize(glm::cross(forward, {0, 1, 0})),
                   top = glm::cross(right, forward), view(0, 0, -1);  // from the eye
  const double step = 2.0 * reach / glm::length(middle) / kSide;      // in the plane at distance 1
  const auto directionAt = [&](int i) {
    const glm::dvec2 at = (glm::dvec2(i % kSide, i / kSide) + 0.5 - 0.5 * kSide) * step;
    return glm::normalize(forward + at.x * right + at.y * top);
  };
  GBuffer gbuffer = surfacePoint(glm::vec3(0.0f), {1, 0, 0}, glm::vec3(0.0f));
  gpu::TextureDescription description = gbuffer.position->description();
  description.width = description.height = kSide;
  const auto image = [&](const auto& valueAt) {
    std::vector<float> values;
    for (int i = 0; i < kSide * kSide; ++i) {
      const glm::vec4 value = valueAt(i);
      values.insert(values.end(), {value.x, value.y, value.z, value.w});
    }
    auto texture = std::make_shared<gpu::Texture>(device(), description, "test g-buffer");
    texture->uploadFloats(0, values);
    return texture;
  };
  const auto normalAt = [&](int i) { return glm::normalize(directionAt(i) - view); };
  const auto constant = [](const glm::vec4& value) { return [value](int) { return value; }; };
  gbuffer.position = image(constant({0, 0, 0, 1}));
  gbuffer.normal = gbuffer.geometricNormal =
      image([&](int i) { return glm::vec4(glm::vec3(normalAt(i)), 1.0f); });
  gbuffer.diffuse = image(constant(glm::vec4(0.0f)));
  gbuffer.specular = image(constant({1, 1, 1, exponent}));
  const ImageBuffer seen =
      gatherWith(builder.scene, store, gbuffer, {6, "cosine", 0, 0, 0, 0.25},
                 [](PassHarness& harness) { return imageOf(*harness.output<Image>("glossy").texture); });
  double sum = 0.0;
  for (int i = 0; i < kSide * kSide; ++i)
    sum += seen.at(i % kSide, i / kSide, 0) / glm::dot(directionAt(i), normalAt(i)) *
           std::pow(glm::dot(directionAt(i), forward), 3) * step * step;
  return sum;
}

/// All light of the finest level, by faces.
template <class Grid>
double lightOf(const Grid& grid, int faces) {
  double sum = 0.0;
  for (int face = 0; face < faces; ++face)
    for (const auto& [voxel, value] : voxelsOf(grid, face, 0)) sum += value.x + value.y + value.z;
  return sum * grid.unit;
}

Scene cornell() {
  return loadScene(sourceDirectory() / "scenes/cornell.scene");
}

}  // namespace

TEST_CASE("a constant environment passes through every empty store unchanged, by the weights of the cones") {
  const StoreKind kind = GENERATE(from_range(kStoreKinds));
  const glm::vec3 environment(0.5f, 1.0f, 2.0f);
  const AnyStore empty = storeOf(kind, [](const glm::vec3&, float, int) { return glm::vec4(0.0f); });
  for (const glm::vec3 place : {glm::vec3(0.1f), glm::vec3(0.6f, 0.1f, -0.7f)})
    for (const int cones : {1, 2, 5, 6, 9, 16, 32}) {
      const glm::vec3 radiance =
          gather(emptyScene(environment), empty, place, glm::normalize(glm::vec3(1, 2, 3)), {cones});
      CAPTURE(kind.name, place.x, cones);
      for (int c = 0; c < 3; ++c) CHECK(radiance[c] == Approx(environment[c]).epsilon(1e-5));
    }
  const glm::vec3 published =
      gather(emptyScene(environment), empty, glm::vec3(0.1f), {0, 1, 0}, {5, "published"});
  for (int c = 0; c < 3; ++c) CHECK(published[c] == Approx(environment[c]).epsilon(1e-5));
}

TEST_CASE("a uniform medium gives L (1 - (1-a)^(d / voxel)) in every store, whatever the width of the cone") {
  // In a medium of opacity a per finest voxel the transmittance over a distance d is (1-a)^(d / voxel), and
  // the radiance that a ray collects is L times what is absorbed. Coarse voxels have the opacity of their own
  // size, but in stores of plain means, which keep that of a finest voxel; either way wide cones see the
  // same.
  const StoreKind kind = GENERATE(from_range(kStoreKinds));
  const double voxel = kind.finest();
  for (const float opacity : {0.02f, 0.1f, 0.3f}) {
    const AnyStore uniform = storeOf(kind, [&](const glm::vec3&, float width, int) {
      const auto a = static_cast<float>(1.0 - std::pow(1.0 - opacity, width / voxel));
      return glm::vec4(a * 1.0f, a * 2.0f, a * 0.5f, a);
    });
    for (const char* reading : kind.readings())
      for (const int cones : {1, 6, 64})                 // the widest and narrow ones
        for (const double distance : {0.1, 0.5, 0.9}) {  // cones of a wide set leave the store behind that
          GatherSettings settings{cones, "cosine", 0, 0, distance, 0.25};
          settings.reading = reading;
          const glm::vec3 gathered = gather(emptyScene(), uniform, glm::vec3(0.0f), {0, 1, 0}, settings);
          const double expected = 1.0 - std::pow(1.0 - opacity, distance / voxel);
          CAPTURE(kind.name, reading, opacity, cones, distance);
          for (int c = 0; c < 3; ++c)
            CHECK(gathered[c] == Approx(expected * (c == 0 ? 1.0 : c == 1 ? 2.0 : 0.5)).epsilon(0.01));
        }
  }
}

TEST_CASE("narrow cones all around a single lit voxel see its radiance times its solid angle within 10 %") {
  // A face of s^2 at a distance d from the apex subtends s^2 / d^2; what filtered reading shows of a voxel
  // lies around its middle. Of a clipmap the voxel lies in one of the levels beyond the finer ones.
  const StoreKind kind = GENERATE(from_range(kStoreKinds));
  const bool nested = kind.of == StoreKind::Of::clipmap;
  for (const int level : nested ? std::vector<int>{0, 1, 2} : std::vector<int>{0}) {
    const double size = kind.finest() * (1 << level);
    const glm::dvec3 middle = size * glm::dvec3(nested                  ? 13.5
                                                : kind.resolution == 64 ? 20.5
                                                                        : 10.5,
                                                0.5, 0.5);
    const AnyStore lit = storeOf(kind,
                                 [&](const glm::vec3& at, float width, int) {
                                   const glm::dvec3 away = glm::abs(glm::dvec3(at) - middle);
                                   return glm::vec4(width == static_cast<float>(size) &&
                                                            std::max({away.x, away.y, away.z}) < 0.25 * size
                                                        ? 1.0f
                                                        : 0.0f);
                                 },
                                 {.levels = 3, .extent = 0.5, .ramp = 0.0, .border = 0.0});
    for (const float exponent : {4000.0f, 800.0f}) {
      CAPTURE(kind.name, level, exponent);
      CHECK(seenAround(lit, middle, 6.4 * size, exponent) ==
            Approx(size * size / (middle.x * middle.x)).epsilon(0.10));
    }
  }
}

TEST_CASE("a closed box of thick walls of uniform radiance gives it back within 3 %, in every store") {
  // Walls of an eighth of the grid: as thick as the voxels that 64 cones read across it. Sheets of one voxel
  // let exp(-2 / cos) through one grid. Six wider cones lose a little more.
  StoreKind kind = GENERATE(from_range(kStoreKinds));
  if (kind.of == StoreKind::Of::clipmap || kind.opacity == std::string("average")) return;
  for (const int resolution : {32, 64}) {
    kind.resolution = resolution;
    const int thick = resolution / 8;
    const AnyStore box = storeOf(kind, [&](const glm::vec3& middle, float width, int) {
      const glm::ivec3 inner((1.0f - glm::abs(middle)) / width);
      const int depth = std::min({inner.x, inner.y, inner.z});
      return depth >= 1 && depth <= thick ? glm::vec4(0.5f, 0.5f, 0.5f, 1.0f) : glm::vec4(0.0f);
    });
    for (const double refinement : {0.0, 0.5, 1.0})
      for (const int cones : {6, 64})
        for (const float along : {-0.5f, 0.0f, 0.4f}) {
          const glm::vec3 position(along, -0.75f + 2.5f / static_cast<float>(resolution), 0.5f * along);
          GatherSettings settings{cones, "cosine", 1, 1, 0, 0.5};
          settings.refinement = refinement;
          CAPTURE(kind.name, resolution, refinement, cones, along);
          CHECK(gather(emptyScene(), box, position, {0, 1, 0}, settings).x ==
                Approx(0.5).epsilon(cones == 64 ? 0.03 : 0.05));
        }
  }
}

TEST_CASE("cones see in octrees what they see in grids of the same voxels, in and beyond the grid") {
  // Random voxels up to the very ends of the grid, each face its own.
  const bool six = GENERATE(false, true);
  const auto fill = [&](const glm::vec3& middle, float width, int face) {
    const glm::ivec3 at((middle + 1.0f) / width);
    const auto hash = static_cast<std::uint32_t>(at.x * 73856093 ^ at.y * 19349663 ^ at.z * 83492791);
    if (hash % 3 != 0) return glm::vec4(0.0f);
    const float opacity =
        0.125f + 0.125f * static_cast<float>((hash >> 3 ^ static_cast<unsigned>(face / 2)) % 5);
    return glm::vec4(opacity * glm::vec3(0.1f + 0.2f * static_cast<float>(face), 0.5f, 0.25f), opacity);
  };
  const StoreKind grid{six ? StoreKind::Of::faces : StoreKind::Of::grid, "grid", "facing", 16},
      tree{six ? StoreKind::Of::octreeFaces : StoreKind::Of::octree, "octree", "facing", 16};
  const AnyStore dense = storeOf(grid, fill), sparse = storeOf(tree, fill);
  for (const char* reading : grid.readings())
    for (int i = 0; i < 24; ++i) {
      const glm::vec3 apex(-1.2f + 0.1f * static_cast<float>(i), 0.9f - 0.08f * static_cast<float>(i),
                           0.05f * static_cast<float>(i % 5) - 1.0f);
      const glm::vec3 normal = glm::normalize(glm::vec3(i % 3 - 1, i % 2 == 0 ? 1 : -1, i % 5 - 2));
      GatherSettings settings{4};
      settings.reading = reading;
      settings.clearance = i % 2 == 0 ? 0.5 : 0.25;
      const glm::vec3 a = gather(emptyScene(), dense, apex, normal, settings),
                      b = gather(emptyScene(), sparse, apex, normal, settings);
      CAPTURE(six, reading, i);
      // A sampler filters with weights of 8 bits.
      for (int c = 0; c < 3; ++c) CHECK(b[c] == Approx(a[c]).epsilon(0.005).margin(1e-4));
    }
}

TEST_CASE("a voxel shows its three faces by the shares of the direction, in every store with faces") {
  // Listing 4.15: weights |d| / sum |d|. Every voxel lets nothing through; its faces shine 1, 10, 2, 20,
  // 4, 40.
  const StoreKind kind = GENERATE(StoreKind{StoreKind::Of::faces, "six grids", "facing", 16},
                                  StoreKind{StoreKind::Of::octreeFaces, "octree of six faces", "facing", 16});
  const std::array<float, 6> shine{1, 10, 2, 20, 4, 40};
  const AnyStore store = storeOf(kind, [&](const glm::vec3&, float, int face) {
    return glm::vec4(glm::vec3(shine[static_cast<std::size_t>(face)]), 1.0f);
  });
  for (const char* reading : kind.readings())
    for (const glm::vec3 direction : {glm::vec3(-1, -2, -3), glm::vec3(3, -1, 1), glm::vec3(0, 0, 1)}) {
      GatherSettings settings;
      settings.reading = reading;
      const glm::vec3 d = glm::normalize(direction),
                      weights = glm::abs(d) / (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
      double expected = 0.0;
      for (int axis = 0; axis < 3; ++axis)
        expected += weights[axis] * shine[static_cast<std::size_t>(2 * axis + (d[axis] < 0.0f ? 0 : 1))];
      CAPTURE(kind.name, reading, d.x, d.y, d.z);
      CHECK(alongNormal(store, glm::vec3(0.0f), d, 1e5f, settings).r == Approx(expected).epsilon(1e-3));
    }
}

TEST_CASE("further bounces in octrees are those of grids with as many faces") {
  const bool six = GENERATE(false, true);
  InjectSettings settings;
  settings.bounces = 3;
  const char* faces = six ? "six" : "one";
  const int count = six ? 6 : 1;
  const double once = lightOf(octree::injectedOctree(cornell(), 32, {}, faces), count),
               sparse = lightOf(octree::injectedOctree(cornell(), 32, settings, faces), count),
               dense = six ? lightOf(injectedDirections(cornell(), 32, settings), 6)
                           : lightOf(injectedGrid(cornell(), 32, settings), 1);
  CAPTURE(six, once, sparse);
  CHECK(sparse == Approx(dense).epsilon(0.005));
  CHECK(sparse > 1.2 * once);
}

TEST_CASE(
    "what is exported of an octree is what grids with as many faces hold, each voxel once, in its place") {
  const bool six = GENERATE(false, true);
  const int resolution = six ? 16 : 32;
  const octree::RadianceOctree sparse =
      octree::filteredOctree(octree::injectedOctree(cornell(), resolution, {}, six ? "six" : "one"));
  const auto check = [&](const auto& dense, int faces) {
    PortContents contents(portKind<octree::RadianceOctree>());
    PortTraits<octree::RadianceOctree>::contents(sparse, contents);
    REQUIRE(contents.fields().size() == (six ? 7u : 2u) * static_cast<std::size_t>(sparse.tree.depth + 1));
    for (const PortContents::Field& field : contents.fields()) {
      std::map<Cell, glm::vec3> found, expected;
      for (const auto& [voxel, value] : std::get<VoxelsRead>(field.source).read()) {
        CHECK(found.emplace(octree::cellOf(voxel), value).second);
        CHECK(glm::all(glm::lessThan(voxel, field.box.resolution)));
      }
      for (int face = 0; face < faces; ++face)
        for (const auto& [voxel, value] : voxelsOf(dense, face, field.level))
          if (field.name == "opacity")
            expected[voxel] = glm::vec3(value.w);
          else if (field.name == "opacity_along" && face % 2 == 0)
            expected[voxel][face / 2] = value.w;
          else if (field.name == "radiance" ||
                   field.name ==
                       std::string("radiance_") +
                           PortTraits<DirectionalRadianceGrid>::kFaces[static_cast<std::size_t>(face)])
            expected[voxel] = dense.unit * glm::vec3(value);
      CAPTURE(field.name, field.level);
      CHECK_FALSE(expected.empty());
      CHECK((found == expected));
      CHECK(glm::distance(field.box.low, glm::dvec3(dense.grid.low)) < 1e-6);
      CHECK(field.box.voxelSize.x == Approx(dense.grid.voxelSize * (1 << field.level)));
    }
  };
  if (six)
    check(filteredDirections(injectedDirections(cornell(), resolution)), 6);
  else
    check(filtered(injectedGrid(cornell(), resolution)), 1);
}

TEST_CASE("stores that hold the same voxels show images within a FLIP of 0.03, in grids of any shape") {
  // The room fills no cube: its dense grid has empty voxels at the high ends, behind the walls.
  struct Pair {
    const char *dense, *other, *setting;
    double ratio;
  };
  const auto [dense, other, setting, ratio] =
      GENERATE(Pair{"voxel_cone_tracing", "voxel_cone_tracing_octree", "", 0.001},
               Pair{"voxel_cone_tracing_directional", "voxel_cone_tracing_octree_directional", "", 0.002},
               Pair{"voxel_cone_tracing_directional", "voxel_cone_tracing_clipmap", "levels=1", 0.01});
  const std::string scene = GENERATE(as<std::string>{}, "cornell", "untuned/room");
  if (*setting != '\0' && scene != "cornell") return;
  RenderOptions options;
  options.width = options.height = 64;
  const Scene loaded = loadScene(sourceDirectory() / "scenes" / (scene + ".scene"));
  const FrameResult expected = renderOnce(loaded, pipeline(dense), options);
  if (*setting != '\0') options.parameters = pipeline(other).settings({setting});
  const FrameResult frame = renderOnce(loaded, pipeline(other), options);
  for (const char* output : {"indirect_diffuse", "final"}) {
    const ImageError error = compare(frame.outputs.at(output), expected.outputs.at(output));
    CAPTURE(other, scene, output, error.flip);
    CHECK(error.flip < 0.03);
    CHECK(error.meanRatio.value == Approx(1.0).epsilon(ratio));
  }
}

TEST_CASE("a store that does not fit is refused with the bytes that it needs and the largest that fits") {
  // 128^3 voxels of 16 bytes and a seventh for the coarser levels: 36.6 MiB, and six times that. Of a clipmap
  // six faces of 16 bytes: 3 levels of 34^3 texels and about one of 36^3 for what finer ones make.
  struct Limit {
    const char* pipeline;
    std::uint64_t megabytes;
    int fits;  ///< 0: even the smallest that is tried does not
    std::vector<const char*> facts;
  };
  const Limit limit = GENERATE(
      Limit{"voxel_cone_tracing", 32, 64, {"a grid of 128 voxels", "36.6 MiB"}},
      Limit{"voxel_cone_tracing_directional", 32, 0, {"six directional grids of 128 voxels", "219"}},
      Limit{"voxel_cone_tracing_octree", 20, 64, {"an octree of 128 voxels", "tags ", "nodes ", "bricks "}},
      Limit{"voxel_cone_tracing_octree_directional", 40, 64, {"an octree of 128 voxels"}},
      Limit{"voxel_cone_tracing_octree", 40, 128, {}},
      Limit{"voxel_cone_tracing_clipmap", 48, 32, {"3 levels of 128 voxels", "873.8 MiB"}});
  const Scene scene = cornell();
  const auto render = [&](int resolution) {
    gpu::Device small({.memoryBytes = limit.megabytes << 20});
    const Pipeline text = pipeline(limit.pipeline);
    RenderOptions options;
    options.width = options.height = 16;
    options.parameters = text.settings({"resolution=" + std::to_string(resolution)});
    PipelineExecutor(small, techniques(), scene, text, options).render(0.0);
  };
  CAPTURE(limit.pipeline, limit.megabytes);
  if (!limit.facts.empty()) {
    const std::string message = messageOf<Error>([&] { render(128); });
    CHECK_THAT(message, Contains("that fit"));
    if (limit.fits > 0) CHECK_THAT(message, Contains(fmt::format("fits is {}", limit.fits)));
    for (const char* fact : limit.facts) CHECK_THAT(message, Contains(fact));
  }
  if (limit.fits > 0) CHECK_NOTHROW(render(limit.fits));
}

TEST_CASE("passes that look along cones refuse media beside voxels that hold them, which would dim twice") {
  const std::string pass = GENERATE(as<std::string>{}, "gather", "soft_shadows", "lens");
  const Scene scene = emptyScene();
  RadianceGrid grid = uniformGrid(8, glm::vec4(0.0f));
  grid.holdsMedia = true;
  PassHarness lights(device(), techniques(), "voxel_cone_tracing", "lights", scene, snapshotOf(scene, 0.0));
  lights.run();
  PassHarness harness(device(), techniques(), "voxel_cone_tracing", pass.c_str(), scene,
                      snapshotOf(scene, 0.0));
  if (pass != "lens") harness.setInput("gbuffer", surfacePoint({0, 0, 0}, {0, 1, 0}, glm::vec3(1.0f)));
  if (pass == "soft_shadows") harness.setInput("lights", lights.output<LightDiscs>("lights"));
  harness.setInput("grid", grid);
  harness.setInput("media", ScatteringGrid{});
  CHECK_THAT(messageOf<Error>([&] { harness.run(); }),
             Contains("already contain the media") && Contains("store_media off"));
}

TEST_CASE(
    "light is finite and smooth with the camera outside of a store, in a surface's voxels and far away") {
  const auto look = [](const glm::dvec3& eye) {
    SceneBuilder builder;
    builder.scene = litRoom(16, 16);
    const glm::dvec3 target(0.5, 0.6, 0.2);
    builder.look(eye, target, {0, 1, 0}, std::min(0.7, 1.2 / glm::length(eye - target)), 16, 16);
    return builder.scene;
  };
  const auto meanOf = [](const ImageBuffer& image) {
    double sum = 0.0;
    for (const float value : image.values()) {
      REQUIRE(std::isfinite(value));
      REQUIRE(value >= 0.0f);
      sum += value;
    }
    return sum / static_cast<double>(image.values().size());
  };
  for (const char* name : kPipelines)
    for (const glm::dvec3& eye :
         {glm::dvec3(0.7, 3, 50), glm::dvec3(0.5, 0.005, 0.5), glm::dvec3(300, 200, 400)}) {
      CAPTURE(name, eye.x, eye.y);
      const ImageBuffer here = indirectLight(look(eye), name),
                        moved = indirectLight(look(eye * (1.0 + 1e-6)), name);
      const double mean = meanOf(here);
      meanOf(moved);
      double difference = 0.0;
      for (std::size_t i = 0; i < here.values().size(); ++i)
        difference += std::abs(here.values()[i] - moved.values()[i]);
      difference /= static_cast<double>(here.values().size());
      // A step whose middle lies on the border of two layers of voxels falls to either side.
      CHECK(difference < 0.005 * mean);
    }
}

TEST_CASE("light far from the world's origin is that of the same scene at the origin, in every store") {
  const Scene here = loadScene(sourceDirectory() / "scenes/cornell.scene"),
              there = loadScene(sourceDirectory() / "scenes/stress/far_away.scene");
  for (const char* name : kPipelines) {
    CAPTURE(name);
    CHECK(compare(indirectLight(there, name), indirectLight(here, name)).flip < 0.003);
  }
}

TEST_CASE("soft shadows, and what a lens sees, are through every store what they are through one grid") {
  const Scene scene = loadScene(sourceDirectory() / "scenes/cornell.scene");
  const auto mean = [](const ImageBuffer& image) {
    double sum = 0.0;
    for (const float value : image.values()) sum += value;
    return sum / static_cast<double>(image.values().size());
  };
  struct Way {
    const char *tracing, *injecting;
    glm::ivec2 size;  // of a square image the diagonal lies in the room's edges, and a pixel in either wall
    double energy,
        error;  // of the mean, for other stores than the octree, whose voxels are those of the grid
  };
  // A lamp in six grids shines to the side that it faces alone, and voxels have edges: of its light, which is
  // nearly all that the lens sees, a tenth lies elsewhere (of the octree's of six faces 0.107).
  for (const Way& way :
       {Way{"voxel_cone_tracing.soft_shadows { gbuffer gbuffer  lights lights.lights ",
            "",
            {30, 29},
            0.003,
            0.02},
        Way{"voxel_cone_tracing.lens { ", "shadow shadow.depth  emission on", {32, 32}, 0.12, 1.0}}) {
    const ImageBuffer one = directLight(scene, way.tracing, way.injecting, nullptr, way.size);
    for (const Store& store : kStores) {
      CAPTURE(way.tracing, store.name);
      const ImageBuffer other = directLight(scene, way.tracing, way.injecting, &store, way.size);
      const bool same = store.name == std::string("octree");
      CHECK(mean(other) == Approx(mean(one)).epsilon(same ? 1e-5 : way.energy));
      CHECK(compare(other, one).rmse.value <= (same ? 1e-5 : way.error) * mean(one));
    }
  }
}
