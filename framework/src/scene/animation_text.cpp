#include "scene/animation_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "scene/motion.h"

namespace lumivox {
namespace {

using dsl::Block;
using dsl::BlockSpecification;
using dsl::CheckedBlock;
using dsl::Property;

constexpr double kNearestTarget = 1e-9;  // m

constexpr const char* kKeyValues[] = {"position", "direction", "irradiance", "intensity", "inner",
                                      "outer",    "eye",       "target",     "fov"};

void reportBlock(BlockReader& reader, const Block& block, std::string what, std::string expected) {
  reader.report(block.place, static_cast<int>(block.word.size()), std::move(what), std::move(expected));
}

Interpolation interpolationOf(BlockReader& reader, const CheckedBlock& block, bool hasKeys) {
  const Property* property = block.find("interpolation");
  if (property == nullptr) return Interpolation::linear;
  if (!hasKeys) reader.report(*property, "'interpolation' without keys", "key { time TIME ... } beside it");
  return block.text("interpolation", "linear") == "step" ? Interpolation::step : Interpolation::linear;
}

/// What keys of `what` may set. The names of its values are in the order in which a text writes them.
struct KeyReader {
  BlockReader& reader;
  const BlockSpecification& grammar;
  std::string what;  ///< "a point light"
  std::vector<std::string> values;

  bool mayHold(const std::string& word) const {
    return std::find(values.begin(), values.end(), word) != values.end();
  }

  /// The keys of a block, checked for the order of their times and for what they set.
  std::vector<CheckedBlock> read(const CheckedBlock& block) const {
    std::vector<CheckedBlock> keys;
    for (const Block* inner : block.blocks("key")) {
      const CheckedBlock key(*inner, grammar);
      if (!keys.empty() && key.number("time", 0) <= keys.back().number("time", 0))
        reader.report(*key.find("time"), "keys run backwards in time",
                      fmt::format("a time after {} s", keys.back().number("time", 0)));
      bool setsAny = false;
      for (const char* word : kKeyValues) {
        const Property* property = key.find(word);
        if (property == nullptr) continue;
        setsAny = true;
        if (!mayHold(word))
          reader.report(*property, fmt::format("'{}' in a key of {}", word, what), expected());
      }
      if (!setsAny) reportBlock(reader, *inner, "the key sets nothing", expected());
      keys.push_back(key);
    }
    return keys;
  }

  std::string expected() const {
    return values.size() == 1 ? values.front() : fmt::format("one of {}", fmt::join(values, ", "));
  }

  /// Refuses a value in one key alone, joined linearly: it would be the same at all times.
  void requireChanges(const std::vector<CheckedBlock>& keys, Interpolation interpolation) const {
    if (interpolation == Interpolation::step) return;
    for (const std::string& word : values) {
      const auto sets = [&](const CheckedBlock& key) { return key.has(word); };
      if (std::count_if(keys.begin(), keys.end(), sets) != 1) continue;
      reader.report(
          *std::find_if(keys.begin(), keys.end(), sets)->find(word),
          fmt::format("'{}' is in one key alone, so that it never changes", word),
          fmt::format("another key with '{}', or interpolation step: its own value holds before the key",
                      word));
    }
  }
};

std::optional<RigidMotion> rigidMotionOf(BlockReader& reader, const CheckedBlock& block,
                                         const glm::dvec3& pivot) {
  if (!block.has("rotate") && !block.has("translate")) {
    if (const Property* about = block.find("about"))
      reader.report(*about, "'about' without a turn", "rotate AXIS SPEED beside it");
    return std::nullopt;
  }
  RigidMotion motion;
  if (block.has("rotate")) {
    motion.axis = reader.direction(block, "rotate", {0, 1, 0});
    motion.angularSpeed = block.numbers("rotate", {}).at(3);
  }
  motion.velocity = BlockReader::vector(block, "translate", glm::dvec3(0));
  motion.pivot = BlockReader::vector(block, "about", pivot);
  return motion;
}

void animateMesh(BlockReader& reader, const CheckedBlock& block, const PlacedText& target,
                 SceneDescription& description) {
  const std::vector<const Block*> keys = block.blocks("key");
  interpolationOf(reader, block, !keys.empty());
  for (const Block* key : keys)
    reportBlock(reader, *key, fmt::format("a key of the mesh '{}'", target.text),
                "rotate AXIS SPEED, translate VELOCITY or both; lights and cameras have keys");
  const auto motion = rigidMotionOf(reader, block, glm::dvec3(0));
  if (!motion && keys.empty() && !block.has("about"))
    reportBlock(reader, block.block(), "the animation moves nothing",
                "rotate AXIS SPEED, translate VELOCITY or both");
  description.animations.push_back({target, motion.value_or(RigidMotion{}), block.has("about")});
}

const char* kindOf(LightKind kind) {
  return kind == LightKind::directional ? "a directional light"
         : kind == LightKind::point     ? "a point light"
                                        : "a spot light";
}

std::vector<std::string> valuesOf(LightKind kind) {
  switch (kind) {
    case LightKind::directional:
      return {"direction", "irradiance"};
    case LightKind::point:
      return {"position", "intensity"};
    case LightKind::spot:
      return {"position", "direction", "intensity", "inner", "outer"};
  }
  return {};
}

LightKey lightKey(BlockReader& reader, const CheckedBlock& key) {
  LightKey result;
  result.time = key.number("time", 0);
  if (key.has("position")) result.position = BlockReader::vector(key, "position", glm::dvec3(0));
  if (key.has("direction")) result.direction = reader.direction(key, "direction", glm::dvec3(0, -1, 0));
  for (const char* power : {"irradiance", "intensity"})
    if (key.has(power)) result.power = BlockReader::vector(key, power, glm::dvec3(0));
  if (key.has("inner")) result.innerAngle = static_cast<float>(key.number("inner", 0));
  if (key.has("outer")) result.outerAngle = static_cast<float>(key.number("outer", 0));
  return result;
}

/// Refuses rates that change nothing of the light.
void checkRates(BlockReader& reader, const CheckedBlock& block, LightKind kind) {
  const auto refuse = [&](const char* word, const char* expected) {
    if (const Property* property = block.find(word))
      reader.report(*property, fmt::format("'{}' of {}, which it does not change", word, kindOf(kind)),
                    expected);
  };
  if (kind == LightKind::directional) {
    refuse("translate", "rotate AXIS SPEED, or keys of its direction");
    refuse("about", "rotate AXIS SPEED alone");
  } else if (kind == LightKind::point && !block.has("about")) {
    refuse("rotate", "about X Y Z beside it: a point away from the light");
  }
}

/// Refuses keys between which the light has no direction, or the spot's cone is empty. Between keys the
/// angles are linear, so that their difference has its extremes at keys.
void checkLightKeys(BlockReader& reader, const Light& light, const std::vector<CheckedBlock>& keys) {
  const LightMotion& motion = *light.motion;
  const LightKey* before = nullptr;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const LightKey& key = motion.keys[i];
    if (key.direction) {
      if (before != nullptr && motion.interpolation == Interpolation::linear &&
          glm::length(0.5 * (*before->direction + *key.direction)) < kShortestMean)
        reader.report(
            *keys[i].find("direction"),
            "the direction is opposite to that of the key before, and nothing tells the way between them",
            "a key between them, rotate AXIS SPEED, or interpolation step");
      before = &key;
    }
    if (light.kind != LightKind::spot) continue;
    const auto angle = [&](float own, auto which) {
      return valueAt(motion.keys, motion.interpolation, key.time, own, [which](const LightKey& one) {
        return one.*which ? &*(one.*which) : static_cast<const float*>(nullptr);
      });
    };
    const float inner = angle(light.innerAngle, &LightKey::innerAngle),
                outer = angle(light.outerAngle, &LightKey::outerAngle);
    if (inner >= outer)
      reportBlock(reader, keys[i].block(),
                  fmt::format("at {} s the inner angle of the spot is not below the outer one", key.time),
                  "inner < outer at all times");
  }
}

void animateLight(BlockReader& reader, const CheckedBlock& block, const BlockSpecification& keyGrammar,
                  Light& light) {
  const KeyReader keyReader{reader, keyGrammar, kindOf(light.kind), valuesOf(light.kind)};
  const std::vector<CheckedBlock> keys = keyReader.read(block);
  LightMotion motion;
  motion.interpolation = interpolationOf(reader, block, !keys.empty());
  keyReader.requireChanges(keys, motion.interpolation);
  for (const CheckedBlock& key : keys) motion.keys.push_back(lightKey(reader, key));
  checkRates(reader, block, light.kind);
  motion.rigid = rigidMotionOf(reader, block, light.position);
  if (keys.empty() && !motion.rigid && !block.has("about"))
    reportBlock(reader, block.block(), "the animation changes nothing",
                "key { time TIME ... }, rotate AXIS SPEED or translate VELOCITY");
  light.motion = std::move(motion);
  checkLightKeys(reader, light, keys);
}

void animateCamera(BlockReader& reader, const CheckedBlock& block, const BlockSpecification& keyGrammar,
                   Camera& camera) {
  const std::vector<const Block*> keys = block.blocks("key");
  if (camera.capture >= 0) {
    reportBlock(reader, block.block(),
                fmt::format("camera '{}' stands where a capture's stood and moves with it", camera.name),
                "a camera of its own, with eye and target");
    return;
  }
  const glm::dvec3 eye = camera.eye;
  if (!camera.keys.empty() && !keys.empty()) {
    reportBlock(reader, *keys.front(), fmt::format("camera '{}' has keys in its own block too", camera.name),
                "all keys in one of the two blocks");
  } else if (!keys.empty()) {
    readCameraKeys(reader, block, keyGrammar, camera);
    const KeyReader keyReader{reader, keyGrammar, "a camera", {"eye", "target", "fov"}};
    std::vector<CheckedBlock> checked;
    for (const Block* key : keys) checked.emplace_back(*key, keyGrammar);
    keyReader.requireChanges(checked, camera.interpolation);
  } else {
    interpolationOf(reader, block, false);
  }
  camera.motion = rigidMotionOf(reader, block, eye);
  if (keys.empty() && !camera.motion && !block.has("about"))
    reportBlock(reader, block.block(), "the animation changes nothing",
                "key { time TIME ... }, rotate AXIS SPEED or translate VELOCITY");
}

}  // namespace

void checkView(BlockReader& reader, const Block& block, const glm::dvec3& eye, const glm::dvec3& target,
               const glm::dvec3& up) {
  const glm::dvec3 forward = target - eye;
  if (glm::length(forward) < kNearestTarget) {
    reportBlock(reader, block, "eye and target are the same point",
                fmt::format("two points, at least {:.6g} m apart", kNearestTarget));
  } else if (glm::length(glm::cross(glm::normalize(forward), up)) <
             1e-6) {  // half a thousandth of a pixel of roll
    reportBlock(reader, block, "the camera looks along 'up'", "another up direction, such as 0 0 1");
  }
}

void readCameraKeys(BlockReader& reader, const CheckedBlock& block, const BlockSpecification& keyGrammar,
                    Camera& camera) {
  struct Key {
    double time;
    std::optional<glm::dvec3> eye, target;
    std::optional<double> fov;
  };
  const std::vector<CheckedBlock> blocks =
      KeyReader{reader, keyGrammar, "a camera", {"eye", "target", "fov"}}.read(block);
  camera.interpolation = interpolationOf(reader, block, !blocks.empty());
  std::vector<Key> keys;
  for (const CheckedBlock& one : blocks) {
    Key& key = keys.emplace_back();
    key.time = one.number("time", 0);
    if (one.has("eye")) key.eye = BlockReader::vector(one, "eye", camera.eye);
    if (one.has("target")) key.target = BlockReader::vector(one, "target", camera.target);
    if (one.has("fov")) key.fov = one.number("fov", camera.fov);
  }
  const bool setsFov = std::any_of(keys.begin(), keys.end(), [](const Key& key) { return key.fov; });
  // A key that passes a value over has the value of its time: the path stays the same.
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto at = [&](const auto& own, auto which) {
      return valueAt(keys, camera.interpolation, keys[i].time, own,
                     [which](const Key& key) { return key.*which ? &*(key.*which) : nullptr; });
    };
    camera.keys.push_back({keys[i].time, at(camera.eye, &Key::eye), at(camera.target, &Key::target)});
    if (setsFov) camera.keys.back().fov = at(camera.fov, &Key::fov);
    checkView(reader, blocks[i].block(), camera.keys.back().eye, camera.keys.back().target, camera.up);
  }
}

void describeAnimation(BlockReader& reader, const CheckedBlock& block, const BlockSpecification& keyGrammar,
                       AnimationTarget target, SceneDescription& description) {
  const dsl::Value& header = block.block().header.front();
  const PlacedText name{header.text, header.place, header.length};
  const auto called = [&](auto& all) {
    return std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == name.text; });
  };
  const auto twice = [&](const char* what) {
    reader.report(name.place, name.length, fmt::format("{} '{}' is animated twice", what, name.text),
                  fmt::format("one animation for each {}", what));
  };
  if (target == AnimationTarget::mesh) {
    animateMesh(reader, block, name, description);
  } else if (target == AnimationTarget::light) {
    const auto light = called(description.lights);
    if (light == description.lights.end()) return;
    if (light->motion) return twice("light");
    animateLight(reader, block, keyGrammar, *light);
  } else if (target == AnimationTarget::camera) {
    const auto camera = called(description.cameras);
    if (camera == description.cameras.end()) return;
    if (!description.animatedCameras.insert(name.text).second) return twice("camera");
    animateCamera(reader, block, keyGrammar, *camera);
  }
}

}  // namespace lumivox
