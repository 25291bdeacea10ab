// Light gathered along rays through bits: closed forms of visibility and of the light where rays end.
#include "support/form_factors.h"
#include "support/near_field.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::near_field;

TEST_CASE("an empty grid lets all of the environment arrive, and nothing is in the way") {
  const BinaryGrid grid = gridOf(VoxelSet({16, 20, 140}));
  for (const char* method : {"hierarchy", "stacks", "plain"}) {
    Gatherer gatherer(grid, underSky(3.0f));
    gatherer.at({5.3f, 4.1f, 77.7f}, glm::normalize(glm::vec3(1, 2, -3)))
        .with({{"rays", 100}, {"method", method}, {"occlusion_distance", 1000}});
    const std::vector<float> arriving = gatherer.arriving(), open = gatherer.floats("occlusion");
    for (std::size_t i = 0; i < arriving.size(); ++i)
      CHECK(arriving[i] == Approx(i % 4 == 3 ? 1 : 3).epsilon(1e-6));
    for (std::size_t i = 0; i < open.size(); i += 4) CHECK(open[i] == 1.0f);
  }
}

TEST_CASE("a slab of voxels overhead takes the form factor of its lower face") {
  VoxelSet set({16, 16, 16});
  for (int x = 3; x < 12; ++x)
    for (int z = 5; z < 14; ++z) set.insert({x, 9, z});
  const glm::dvec3 point(7.3, 5.6, 8.2);
  const double expected = polygonFormFactor(point, kUp, {{3, 9, 5}, {12, 9, 5}, {12, 9, 14}, {3, 9, 14}});
  REQUIRE(expected > 0.4);
  Gatherer gatherer(gridOf(set), underSky(2.0f));
  gatherer.at(point, kUp).with({{"rays", 4096}, {"offset", 0}, {"occlusion_distance", 1000}});
  CHECK(1.0 - gatherer.mean("occlusion") == Approx(expected).epsilon(0.005));
  CHECK(gatherer.mean("arriving") == Approx(2.0 * (1.0 - expected)).epsilon(0.005));
}

TEST_CASE("one voxel takes its own form factor, overhead and of three faces") {
  struct Place {
    glm::ivec3 voxel;
    std::vector<std::vector<glm::dvec3>> faces;
  };
  const glm::dvec3 point(8.4, 5.7, 8.3);
  const auto lower = [](double x, double y, double z) {
    return std::vector<glm::dvec3>{{x, y, z}, {x + 1, y, z}, {x + 1, y, z + 1}, {x, y, z + 1}};
  };
  const Place overhead{{8, 7, 8}, {lower(8, 7, 8)}};
  // Of this one the lower face and those towards lower x and z are seen.
  const Place aside{{9, 7, 9},
                    {lower(9, 7, 9),
                     {{9, 7, 9}, {9, 8, 9}, {9, 8, 10}, {9, 7, 10}},
                     {{9, 7, 9}, {10, 7, 9}, {10, 8, 9}, {9, 8, 9}}}};
  for (const Place& place : {overhead, aside}) {
    VoxelSet set({16, 16, 16});
    set.insert(place.voxel);
    double expected = 0.0;
    for (const auto& face : place.faces) expected += polygonFormFactor(point, kUp, face);
    Gatherer gatherer(gridOf(set));
    gatherer.at(point, kUp).with({{"rays", 4096}, {"offset", 0}, {"occlusion_distance", 1000}});
    CAPTURE(expected);
    CHECK(1.0 - gatherer.mean("occlusion") == Approx(expected).epsilon(0.02));
  }
}

TEST_CASE("hits count up to the occlusion distance, and light up to the radius") {
  VoxelSet set({16, 16, 16});
  for (int x = 0; x < 16; ++x)
    for (int z = 0; z < 16; ++z) set.insert({x, 10, z});
  // Straight up the ceiling is 5 m away from y = 5; rays begin at the offset of (1 + 1/16) m.
  const ReflectiveShadowMap map =
      mapOf(lightOf("directional"), 4, {8, 10, 8, 1}, {0, -1, 0, 1}, fluxOf(7.0f));
  const auto gathered = [&](double occlusion, double radius, double start, const char* beyond) {
    Gatherer gatherer(gridOf(set), underSky(3.0f));
    gatherer.at({8.5f, 5.0f, 8.5f}, kUp)
        .map(map)
        .with({{"rays", 1},
               {"spread", 0},
               {"occlusion_distance", occlusion},
               {"radius", radius},
               {"start", start},
               {"beyond", beyond},
               {"tolerance", 1000}});
    const float light = gatherer.arriving()[0];
    return std::pair(light, gatherer.floats("occlusion")[0]);
  };
  const double way = 5.0 - 17.0 / 16.0;
  for (const double start : {0.0, 2.0}) {
    CHECK(gathered(way - 0.01, 0, start, "grid").second == 1.0f);
    CHECK(gathered(way + 0.01, 0, start, "grid").second == 0.0f);
    CHECK(gathered(1, 0, start, "grid").first == Approx(7.0f));
    CHECK(gathered(1, way + 0.01, start, "grid").first == Approx(7.0f));
    CHECK(gathered(1, way - 0.01, start, "grid").first == 0.0f);
    // Occlusion may look further than light: the ray still brings none from there.
    CHECK(gathered(100, way - 0.01, start, "grid").first == 0.0f);
    CHECK(gathered(1, way - 0.01, start, "radius").first == 3.0f);
    CHECK(gathered(100, way - 0.01, start, "radius").first == 3.0f);
    CHECK(gathered(100, way + 0.01, start, "radius").first == Approx(7.0f));
  }
  // A start behind the ceiling passes it.
  CHECK(gathered(100, 0, 6, "grid") == std::pair(3.0f, 1.0f));
}

TEST_CASE("no plane shadows itself, at a hundred tilts") {
  SceneBuilder builder;
  for (int i = 0; i < 100; ++i) {
    builder = SceneBuilder();
    // The axes, where the plane lies in the faces of voxels, diagonals, and directions all around.
    const double height = 1.0 - 2.0 * (i + 0.5) / 100.0, turn = 2.399963 * i;
    glm::vec3 normal(std::sqrt(1 - height * height) * std::cos(turn), height,
                     std::sqrt(1 - height * height) * std::sin(turn));
    if (i < 6) normal = glm::vec3(i % 3 == 0, i % 3 == 1, i % 3 == 2) * (i < 3 ? 1.0f : -1.0f);
    if (i >= 6 && i < 10) normal = {i % 2 ? 1.0f : -1.0f, i / 8 ? 1.0f : -1.0f, i < 8};
    normal = glm::normalize(normal);
    const glm::vec3 tangent = glm::normalize(glm::cross(
                        normal, std::abs(normal.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0))),
                    other = glm::cross(normal, tangent);
    builder.quad(-tangent - other, 2.0f * tangent, 2.0f * other, builder.lambert(0.5f));
    builder.look(glm::dvec3(3.0f * normal + 0.3f * tangent), {0, 0, 0}, glm::dvec3(tangent), 0.6, 16, 16);
    const std::vector<float> open =
        LonePass("near_field_voxels.gather", builder.scene, {{"occlusion_distance", 100}})
            .in("gbuffer", gbufferOf(builder.scene))
            .in("bits", bitsIn(builder.scene, 17 + i % 5))
            .floats("occlusion");
    int shadowed = 0;
    for (std::size_t p = 0; p < open.size(); p += 4) shadowed += open[p] != 1.0f;
    CAPTURE(i, normal.x, normal.y, normal.z);
    CHECK(shadowed == 0);
  }
}

TEST_CASE("in a closed box whose map shines L everywhere, L arrives") {
  SceneBuilder builder;
  builder.box({0, 0, 0}, {8, 8, 8}, builder.lambert(0.5f), true);
  builder.light(LightKind::point, glm::vec3(1.0f), {4.1, 3.9, 4.2});
  builder.look({4, 4, 7}, {3, 3, 0}, {0, 1, 0}, 1.4, 16, 16);
  ReflectiveShadowMap map =
      LonePass("reflective_shadow_maps.render", builder.scene).out<ReflectiveShadowMap>("map");
  std::vector<float> flux = map.normal->downloadFloats(0);
  const float radiance = 2.5f;
  for (std::size_t i = 0; i < flux.size(); ++i)
    flux[i] = static_cast<float>(kPi) * radiance * flux[i / 4 * 4 + 3];
  map.flux = textureOf(map.flux->description(), flux);
  LonePass gather("near_field_voxels.gather", builder.scene, {{"rays", 64}});
  gather.in("gbuffer", gbufferOf(builder.scene)).in("bits", bitsIn(builder.scene, 64)).in("map", map);
  const auto arriving = [&](double tolerance, const char* front) {
    return gather.with({{"tolerance", tolerance}, {"front", front}}).image("arriving");
  };
  const ImageBuffer untested = arriving(1000, "off");
  for (const float value : untested.values()) CHECK(value == Approx(radiance).epsilon(1e-5));
  const ImageBuffer tested = arriving(1, "on");
  for (const float value : tested.values()) CHECK(value <= radiance * 1.00001f);
  CHECK(meanOf(tested) >= 0.95 * radiance);
}

TEST_CASE("a texel shines just within epsilon, and not beyond, for each kind of light at five slants") {
  const OneVoxel voxel;
  const double diagonal = std::sqrt(3.0);
  constexpr int kSide = 32;
  int ruledByVoxel = 0, ruledByTexel = 0, ruledByCap = 0;
  for (const char* kind : {"directional", "point", "spot", "area"}) {
    const Scene scene = lightOf(kind);
    const LightSet set = sampleLights(scene, snapshotOf(scene, 0.0), 1, kSide);
    const LightSampleData& light = set.samples.front();
    const bool parallel = light.kind == LightSampleKind::directional;
    // Depth along the view that sees the voxel: w of clip space.
    double depth = 0.0;
    for (const LightView& view : set.views) {
      const glm::vec4 clip = view.worldToClip * glm::vec4(voxel.centre, 1.0f);
      if (clip.w > 0.0f && std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w) depth = clip.w;
    }
    REQUIRE(depth > 0.0);
    const double width = light.texelWidth * (parallel ? 1.0 : depth);
    for (const double cosine : {1.0, 0.7, 0.4, 0.2, 0.05}) {
      const glm::dvec3 centre(voxel.centre);
      const auto toLight = [&](const glm::dvec3& place) {
        return glm::normalize(parallel ? -glm::dvec3(light.direction) : glm::dvec3(light.position) - place);
      };
      const glm::dvec3 way = toLight(centre), side = glm::normalize(glm::cross(way, glm::dvec3(0.3, 0.2, 1))),
                       normal = cosine * way + std::sqrt(1 - cosine * cosine) * side;
      const auto epsilon = [&](const glm::dvec3& place) {
        return std::min(4.0 * diagonal,
                        std::max(diagonal, width / std::max(glm::dot(normal, toLight(place)), 0.02)));
      };
      // Along the way from the light, so that the slant stays what it is.
      double distance = diagonal;
      for (int i = 0; i < 60; ++i) distance = epsilon(centre - distance * way);
      ruledByVoxel += distance == diagonal;
      ruledByCap += distance == 4.0 * diagonal;
      ruledByTexel += distance > diagonal && distance < 4.0 * diagonal;
      for (const double share : {0.999, 1.001, 1.999, 2.001}) {
        const bool doubled = share > 1.5, shines = share == 0.999 || share == 1.999;
        const glm::dvec3 place = centre - share * distance * way;
        const ReflectiveShadowMap map = mapOf(scene, kSide, glm::vec4(glm::vec3(place), 1.0f),
                                              glm::vec4(glm::vec3(normal), 1.0f), fluxOf(5.0f));
        Gatherer gatherer = voxel.gatherer(map);
        if (doubled) gatherer.with({{"tolerance", 2}});
        CAPTURE(kind, cosine, share, distance, width);
        CHECK(gatherer.arriving()[0] == Approx(shines ? 5.0f : 0.0f));
      }
    }
  }
  CHECK(ruledByVoxel > 0);
  CHECK(ruledByTexel > 0);
  CHECK(ruledByCap > 0);
}

TEST_CASE("without a cap a slanted texel reaches further, and with the largest tolerance any does") {
  const OneVoxel voxel;
  const Scene scene = lightOf("directional");
  const glm::vec3 way = -glm::vec3(glm::normalize(glm::dvec3(0.1, -1, 0.2)));
  const glm::vec3 side = glm::normalize(glm::cross(way, glm::vec3(0, 0, 1)));
  const glm::vec3 normal = 0.05f * way + std::sqrt(1 - 0.05f * 0.05f) * side;
  const double width = sampleLights(scene, snapshotOf(scene, 0.0), 1, 32).samples.front().texelWidth;
  for (const double distance : {0.99 * width / 0.05, 1.01 * width / 0.05}) {
    const ReflectiveShadowMap map =
        mapOf(scene, 32, glm::vec4(voxel.centre - static_cast<float>(distance) * way, 1),
              glm::vec4(normal, 1), fluxOf(5.0f));
    CHECK(voxel.gatherer(map).arriving()[0] == 0.0f);
    CHECK(voxel.gatherer(map).with({{"cap", 0}}).arriving()[0] ==
          Approx(distance < width / 0.05 ? 5.0 : 0.0));
    CHECK(voxel.gatherer(map).with({{"tolerance", 1000}}).arriving()[0] == Approx(5.0));
  }
}

TEST_CASE(
    "as printed the tolerance enlarges the texel's side alone: neither the voxel's diagonal nor the cap") {
  constexpr int kSide = 128;
  const OneVoxel voxel;
  const Scene scene = lightOf("directional");
  const glm::dvec3 way = -glm::normalize(glm::dvec3(0.1, -1, 0.2)),
                   side = glm::normalize(glm::cross(way, glm::dvec3(0, 0, 1)));
  const double diagonal = std::sqrt(3.0),
               width = sampleLights(scene, snapshotOf(scene, 0.0), 1, kSide).samples.front().texelWidth;
  // The receiver looks down, so that what faces the sun faces it too.
  const glm::dvec3 centre(voxel.centre);
  const double toFace = (centre.y + 0.5 - 12.0) / voxel.down.y;
  struct Case {
    double cosine, tolerance;
    const char* front;
    double ours, printed;  ///< epsilon, m
  };
  const double slanted = 2.5 * diagonal;
  REQUIRE(1.5 * width < diagonal);
  const double cosine = width / slanted;
  for (const Case& one :
       {Case{1.0, 1.5, "on", 1.5 * diagonal, diagonal}, Case{cosine, 1.5, "on", 1.5 * slanted, 1.5 * slanted},
        Case{cosine, 3.0, "on", 3.0 * slanted, 4.0 * diagonal},
        Case{cosine, 0.6, "on", 0.6 * slanted, 0.6 * slanted}, Case{cosine, 1.0, "off", slanted, diagonal}}) {
    const glm::dvec3 normal = one.cosine * way + std::sqrt(1.0 - one.cosine * one.cosine) * side;
    for (const bool printed : {false, true})
      for (const double share : {0.9, 1.1}) {
        // Printed hits have x and y of the entry, off by up to a tenth, and z of the middle.
        const glm::dvec3 entry = voxel.above + toFace * voxel.down,
                         hit = printed ? glm::dvec3(entry.x, entry.y, centre.z) : centre;
        const glm::dvec3 place = hit - share * (printed ? one.printed : one.ours) * way;
        CAPTURE(one.cosine, one.tolerance, one.front, printed, share, width);
        CHECK(voxel.isLitFromAbove(printed,
                                   mapOf(scene, kSide, glm::vec4(glm::vec3(place), 1.0f),
                                         glm::vec4(glm::vec3(normal), 1.0f), fluxOf(5.0f)),
                                   {{"tolerance", one.tolerance}, {"front", one.front}}) == (share < 1.0));
      }
  }
}

TEST_CASE("as printed a spot slants its texels by its one direction, and here by the way to it") {
  constexpr int kSide = 8;
  const OneVoxel voxel;
  Scene scene = lightOf("spot");
  Light& spot = scene.lights.front();
  spot.direction = glm::normalize(glm::dvec3(-0.25, -1, -0.3));
  const glm::dvec3 centre(voxel.centre), light(7, 14, 6.5), toLight = glm::normalize(light - centre),
                                                            axis = -glm::dvec3(spot.direction);
  // Beyond the way to the light, away from the axis: 30 degrees from the one and 70 from the other.
  const glm::dvec3 aside = glm::normalize(toLight - glm::dot(toLight, axis) * axis);
  const double between = std::acos(glm::dot(toLight, axis)), turned = between + kPi / 6.0;
  const glm::dvec3 normal = std::cos(turned) * axis + std::sin(turned) * aside;
  const double width = sampleLights(scene, snapshotOf(scene, 0.0), 1, kSide).samples.front().texelWidth *
                       glm::dot(centre - light, -axis),
               ours = width / std::cos(kPi / 6.0), printed = width / std::cos(turned);
  REQUIRE(ours > std::sqrt(3.0));
  REQUIRE(printed > 2.0 * ours);
  REQUIRE(printed < 4.0 * std::sqrt(3.0));
  for (const bool asPrinted : {false, true})
    for (const double distance : {0.5 * ours, std::sqrt(ours * printed), 1.3 * printed}) {
      CAPTURE(asPrinted, distance, ours, printed);
      CHECK(voxel.isLitFromAbove(asPrinted,
                                 mapOf(scene, kSide, glm::vec4(glm::vec3(centre - distance * toLight), 1.0f),
                                       glm::vec4(glm::vec3(normal), 1.0f), fluxOf(5.0f))) ==
            (distance < (asPrinted ? printed : ours)));
    }
}

TEST_CASE("as printed a surface must look to the receiver's place, and here to where the ray came from") {
  const OneVoxel voxel;
  // The printed hit has z of the voxel's middle, 0.0065 beyond the ray's entry: a surface along z that leans
  // to the ray by a ninth of that over the five metres of the way looks to the ray, and not to the receiver.
  for (const auto& [leaning, ours, printed] :
       {std::tuple(0.0136, true, false), {0.02, true, true}, {0.012, false, false}}) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(0, leaning, 1));
    for (const bool asPrinted : {false, true}) {
      CAPTURE(leaning, asPrinted);
      CHECK(voxel.isLitFromAbove(asPrinted,
                                 mapOf(lightOf("directional"), 8, glm::vec4(voxel.centre, 1.0f),
                                       glm::vec4(glm::vec3(normal), 1.0f), fluxOf(5.0f)),
                                 {{"cap", 0}}) == (asPrinted ? printed : ours));
    }
  }
}

TEST_CASE("surfaces that look away from the receiver bring nothing, unless they may") {
  const OneVoxel voxel;
  const Scene scene = lightOf("point");
  for (const float up : {-1.0f, 1.0f}) {
    const ReflectiveShadowMap map = mapOf(scene, 8, glm::vec4(voxel.centre, 1), {0, up, 0, 1}, fluxOf(5.0f));
    CHECK(voxel.gatherer(map).arriving()[0] == Approx(5.0));
    CHECK(voxel.gatherer(map).with({{"front", "on"}}).arriving()[0] == Approx(up < 0.0f ? 5.0 : 0.0));
  }
}

TEST_CASE("where a light sees nothing, behind a spot and beside its view there is no light") {
  const OneVoxel voxel;
  const glm::vec4 place(voxel.centre, 1), normal(0, -1, 0, 1);
  CHECK(voxel.gatherer(mapOf(lightOf("point"), 8, glm::vec4(voxel.centre, 0), normal, fluxOf(5.0f)))
            .arriving()[0] == 0.0f);
  for (const glm::dvec3& direction : {glm::dvec3(0, 1, 0), glm::dvec3(1, 0.1, 0)}) {
    Scene scene = lightOf("spot");
    scene.lights.front().direction = glm::normalize(direction);
    CHECK(voxel.gatherer(mapOf(scene, 8, place, normal, fluxOf(5.0f))).arriving()[0] == 0.0f);
  }
  CHECK(voxel.gatherer(mapOf(lightOf("spot"), 8, place, normal, fluxOf(5.0f))).arriving()[0] == Approx(5.0));
}

TEST_CASE("a light that has no view brings nothing") {
  const OneVoxel voxel;
  ReflectiveShadowMap map =
      mapOf(lightOf("directional"), 4, glm::vec4(voxel.centre, 1), {0, -1, 0, 1}, fluxOf(5.0f));
  CHECK(voxel.gatherer(map).arriving()[0] == Approx(5.0));
  std::vector<LightSampleData> lights = map.lights->downloadValues<LightSampleData>();
  for (LightSampleData& light : lights) light.firstView = -1;
  map.lights = bufferOf(lights);
  CHECK(voxel.gatherer(map).arriving()[0] == 0.0f);
}

TEST_CASE("the texels that rays read are counted for each of them") {
  // From the offset of 17/16 above y = 2 straight up: the voxels 3, 4 and 5, and 6, which is set.
  VoxelSet set({16, 16, 16});
  set.insert({8, 6, 8});
  for (const int rays : {1, 3}) {
    Gatherer gatherer(gridOf(set));
    gatherer.at({8.5f, 2.0f, 8.5f}, kUp)
        .with({{"rays", double(rays)}, {"spread", 0}, {"occlusion_distance", 100}, {"method", "plain"}});
    CHECK(gatherer.floats("fetches")[0] == 4.0f * static_cast<float>(rays));
  }
}

TEST_CASE("lights of several kinds add up") {
  const OneVoxel voxel;
  Scene scene = lightOf("point");
  for (const char* kind : {"directional", "spot"}) scene.lights.push_back(lightOf(kind).lights.front());
  const ReflectiveShadowMap map = mapOf(scene, 8, glm::vec4(voxel.centre, 1), {0, -1, 0, 1}, fluxOf(5.0f));
  REQUIRE(map.lightCount == 3);
  CHECK(voxel.gatherer(map).arriving()[0] == Approx(15.0));
}

TEST_CASE("the point that is projected back lies where its word says") {
  // One ray through the voxel (8, 6, 8), from below and at a slant: only a texel at that very point shines.
  VoxelSet set({16, 16, 16});
  set.insert({8, 6, 8});
  const glm::vec3 direction = glm::normalize(glm::vec3(0.2f, 1.0f, 0.1f)), origin(8.0f, 4.0f, 8.15f);
  const auto along = [&](float height) { return origin + direction * ((height - origin.y) / direction.y); };
  const glm::vec3 entry = along(6), middle = along(6.5f), centre(8.5f, 6.5f, 8.5f),
                  printed(entry.x, entry.y, 8.5f);
  const std::vector<std::pair<const char*, glm::vec3>> points{
      {"middle", middle}, {"entry", entry}, {"centre", centre}, {"printed", printed}};
  for (const auto& [word, place] : points)
    for (const auto& [other, at] : points) {
      Gatherer gatherer(gridOf(set));
      gatherer.at(origin, direction)
          .map(mapOf(lightOf("point"), 8, glm::vec4(at, 1), {0, -1, 0, 1}, fluxOf(5.0f)))
          .with({{"rays", 1}, {"spread", 0}, {"offset", 0}, {"hit", word}, {"tolerance", 0.001}});
      CAPTURE(word, other);
      CHECK(gatherer.arriving()[0] == Approx(std::string(word) == other ? 5.0 : 0.0));
    }
}

TEST_CASE("four texels are weighed bilinearly, each by its own test") {
  const OneVoxel voxel;
  const Scene scene = lightOf("directional");
  ReflectiveShadowMap map = mapOf(scene, 4, glm::vec4(voxel.centre, 1), {0, -1, 0, 1}, fluxOf(0.0f));
  const LightSet set = sampleLights(scene, snapshotOf(scene, 0.0), 1, 4);
  const glm::vec4 clip = set.views.front().worldToClip * glm::vec4(voxel.centre, 1);
  const glm::vec2 place = glm::vec2(0.5f + 0.5f * clip.x, 0.5f - 0.5f * clip.y) * 4.0f - 0.5f;
  const glm::ivec2 low(glm::floor(place));
  const glm::vec2 share = place - glm::vec2(low);
  REQUIRE((low.x >= 0 && low.y >= 0 && low.x < 3 && low.y < 3));
  for (int i = 0; i < 4; ++i) {
    const glm::ivec2 step(i & 1, i >> 1);
    std::vector<float> flux(4 * 16, 0.0f);
    for (int c = 0; c < 3; ++c)
      flux[static_cast<std::size_t>(4 * ((low.y + step.y) * 4 + low.x + step.x) + c)] = fluxOf(5.0f)[c];
    map.flux = textureOf(layers(4, 4, 1), flux);
    const double weight = (step.x ? share.x : 1 - share.x) * (step.y ? share.y : 1 - share.y);
    CAPTURE(i, weight);
    CHECK(voxel.gatherer(map).with({{"taps", 4}}).arriving()[0] == Approx(5.0 * weight).epsilon(1e-4));
  }
}
