// Light at its extremes: none, too much, where distances and cosines vanish, many lights, spots of nearly no
// and of nearly all directions.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stress/cases.h"
#include "stress/measures.h"
#include "stress/scene_pieces.h"

namespace lumivox::stress {
namespace {

constexpr const char* kLightFamily = "light";
/// Bias of a one-bounce technique at its best against the one-bounce reference.
constexpr double kFairBias = 0.1;

std::optional<Finding> exactlyBlack(Bench& bench, const Scene& scene) {
  if (!makesImages(bench)) return std::nullopt;
  const Frame frame = bench.render(scene);
  if (frame.whole.empty()) return withoutLight();
  return judged("largest radiance", {largestOf(frame.whole), 0.0}, 0.0);
}

/// A room with a light of every kind without extent; in the full battery the Cornell box with its area light
/// as well.
Scene allLights(const Bench& bench) {
  Scene scene = bench.quick() ? closedRoom(0.7f).scene : bench.committedScene("cornell");
  scene.hash = {};
  for (const LightKind kind : {LightKind::directional, LightKind::point, LightKind::spot}) {
    Light light;
    light.name = "light " + std::to_string(scene.lights.size());
    light.kind = kind;
    light.position = {0.2, 0.4, 0.15};
    light.direction = glm::normalize(glm::dvec3(0.1, -0.3, 1.0));
    light.power = glm::vec3(kind == LightKind::directional ? 2.0f : 0.2f);
    light.innerAngle = glm::radians(20.0f);
    light.outerAngle = glm::radians(30.0f);
    scene.lights.push_back(light);
  }
  return scene;
}

std::optional<Finding> powersOfLight(Bench& bench) {
  if (!makesImages(bench)) return std::nullopt;
  const Scene scene = allLights(bench);
  const Frame wanted = bench.render(scene);
  if (wanted.whole.empty()) return withoutLight();
  double largest = 0.0;
  std::string detail;
  for (const float factor : {1e-8f, 1e8f}) {
    ImageBuffer image = bench.render(brighter(scene, factor)).whole;
    for (float& value : image.values()) value /= factor;
    const double difference = relativeDifference(image, wanted.whole);
    detail += fmt::format("{}at {:.0e} times {:.3g}", detail.empty() ? "" : ", ", factor, difference);
    largest = std::max(largest, difference);
  }
  return judged("RMS difference from the image at power 1 after division by the power, of its mean",
                {largest, 0.0}, 0.001, detail);
}

Scene floorWithPointLight(const glm::dvec3& position) {
  SceneBuilder builder = openFloor();
  builder.light(LightKind::point, glm::vec3(2.0f), position);
  return builder.scene;
}

std::optional<Finding> lightInGeometry(Bench& bench) {
  // The middle of the box on the floor, and above it.
  return leak(bench, floorWithPointLight({0.0, 0.25, 0.0}), {}, floorWithPointLight({0.0, 0.9, 0.0}), {},
              "of a light in a closed box, of that above it", 0.01);
}

std::optional<Finding> lightAtCamera(Bench& bench) {
  SceneBuilder builder = closedRoom(0.7f);
  builder.scene.lights[0].position = builder.scene.camera().eye;
  return againstReference(bench, builder.scene, kFairBias);
}

std::optional<Finding> lightOnSurface(Bench& bench) {
  SceneBuilder builder = closedRoom(0.7f);
  builder.scene.lights[0].position.y = 0.0;
  return againstReference(bench, builder.scene, kFairBias);
}

std::optional<Finding> grazing(Bench& bench) {
  SceneBuilder builder = openFloor();
  const double elevation = glm::radians(1.0);
  builder.light(LightKind::directional, glm::vec3(30.0f), {},
                {-std::cos(elevation), -std::sin(elevation), -0.3 * std::cos(elevation)});
  return againstReference(bench, builder.scene, kFairBias);
}

std::optional<Finding> manyLights(Bench& bench) {
  const auto litBy = [](int count) {
    SceneBuilder builder = closedRoom(0.7f);
    builder.scene.lights.clear();
    for (int i = 0; i < count; ++i) {
      Light& light = builder.light(LightKind::spot, glm::vec3(4.0f / static_cast<float>(count)),
                                   {0.6, 0.9, 0.6}, {-0.4, -0.8, -0.3});
      light.innerAngle = glm::radians(30.0f);
      light.outerAngle = glm::radians(40.0f);
    }
    return builder.scene;
  };
  if (!makesImages(bench)) return std::nullopt;
  return sameAs(bench, litBy(1), litBy(64), 0.005, "one light of the power of all");
}

/// The lit room, with a spot of these half angles in place of its point light.
Scene spotRoom(double inner, double outer) {
  SceneBuilder builder = closedRoom(0.7f);
  Light& light = builder.scene.lights[0];
  light.kind = LightKind::spot;
  // Away from everything that the camera sees.
  light.direction = glm::normalize(glm::dvec3(1.0, 1.0, 1.0));
  light.innerAngle = glm::radians(static_cast<float>(inner));
  light.outerAngle = glm::radians(static_cast<float>(outer));
  return builder.scene;
}

std::optional<Finding> spotOfNoAngle(Bench& bench) {
  Scene narrow = spotRoom(0.0, 0.0);
  narrow.lights[0].direction = glm::normalize(glm::dvec3(-1.0, -1.0, -1.0));  // towards what is seen
  return leak(bench, narrow, {}, closedRoom(0.7f).scene, {},
              "of a spot of 0 degrees, of that of a point light of its intensity", 1e-3);
}

std::optional<Finding> spotOfAllAngles(Bench& bench) {
  if (!makesImages(bench)) return std::nullopt;
  return sameAs(bench, closedRoom(0.7f).scene, spotRoom(179.8, 179.9), 0.001,
                "a point light of its intensity");
}

std::optional<Finding> environmentOnly(Bench& bench) {
  SceneBuilder builder = openFloor();
  builder.scene.environment = glm::vec3(0.5f, 0.7f, 1.0f);
  return againstReference(bench, builder.scene, kFairBias);
}

/// Light from a wall outside the view, with the camera looking ahead and turned.
std::optional<Finding> hiddenSender(Bench& bench) {
  if (!makesImages(bench)) return std::nullopt;
  constexpr double kTurn = 10.0;  // degrees
  // Few paths hit such a small wall.
  constexpr int kSamples = 1024;
  Finding worst;
  std::string detail;
  for (const double turn : {0.0, kTurn}) {
    Scene scene = bench.committedScene("hidden_sender");
    scene.hash = {};
    Camera& camera = scene.cameras.front();
    camera.target = camera.eye + turnAboutY(glm::radians(turn)) * (camera.target - camera.eye);
    Shot shot;
    shot.subpixels = bench.quick() ? 1 : 4;
    const Frame frame = bench.render(scene, shot);
    if (frame.whole.empty()) return withoutLight();
    if (!makesIndirect(frame)) return notApplicable("it makes no indirect light");
    const ReferenceLayer reference = indirectLayer(bench, scene, frame, shot, kSamples);
    const Measured ratio = compare(indirectOf(frame), reference.mean, reference.variance).meanRatio;
    detail += turn == 0.0 ? fmt::format("{:.3g} of the reference's", ratio.value)
                          : fmt::format(", {:.3g} with the camera turned by {} degrees", ratio.value, turn);
    const Measured distance{std::abs(ratio.value - 1.0), ratio.uncertainty};
    if (turn == 0.0 || distance.value > worst.value.value)
      worst =
          judged("distance of the indirect light's mean from the reference's, of it, the worse of two views",
                 distance, 0.25);
  }
  worst.detail = detail;
  return worst;
}

}  // namespace

std::vector<Case> lightCases() {
  const auto info = [](const char* name, const char* meaning, bool quick) {
    return StressCaseInfo{kLightFamily, name, meaning, quick};
  };
  return {
      {info("no_light", "a room without any light is black, exactly", true),
       [](Bench& bench) { return exactlyBlack(bench, bench.committedScene("stress/no_light")); }},
      {info("zero_light", "a light of every kind with a power of zero: black, exactly", true),
       [](Bench& bench) { return exactlyBlack(bench, brighter(allLights(bench), 0.0f)); }},
      {info("light_1e8", "10^8 and 10^-8 times the light: the image times 10^8 and 10^-8", true),
       powersOfLight},
      {info("light_in_geometry", "a point light within a closed box: no light outside", false),
       lightInGeometry},
      {info("light_on_surface", "a point light in the plane of a room's floor: the reference", true),
       lightOnSurface},
      {info("light_at_camera", "a point light exactly at the camera in a closed room: the reference", true),
       lightAtCamera},
      {info("grazing", "the sun one degree above a floor with a box: the reference", false), grazing},
      {info("lights_64", "64 lights of a 64th of the power in the same place: the image of one", false),
       manyLights},
      {info("spot_0", "a spot of 0 degrees lights nothing", false), spotOfNoAngle},
      {info("spot_179.9", "a spot of 179.9 degrees to every side is a point light but for a needle behind it",
            false),
       spotOfAllAngles},
      {info("hidden_sender",
            "a lit wall behind a column, which no view from there shows, shines on the floor: the reference, "
            "ahead and with the camera turned by 10 degrees",
            true),
       hiddenSender},
      {info("environment_only", "a box on a floor under the sky alone: the reference", true),
       environmentOnly},
  };
}

}  // namespace lumivox::stress
