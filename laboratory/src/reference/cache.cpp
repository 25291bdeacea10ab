#include "reference/cache.h"

#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/reference/reference_cache.h"
#include "lumivox/scene/model_animation.h"
#include "reference/kept.h"
#include "reference/real_scene.h"

namespace lumivox {
namespace reference {
namespace {

void add(Hasher& hasher, const glm::vec3& value) {
  hasher.add(value.x).add(value.y).add(value.z);
}
void add(Hasher& hasher, const glm::dvec3& value) {
  hasher.add(value.x).add(value.y).add(value.z);
}

void add(Hasher& hasher, const RigidMotion& motion) {
  add(hasher, motion.axis);
  hasher.add(motion.angularSpeed);
  add(hasher, motion.pivot);
  add(hasher, motion.velocity);
}

template <class Value>
void add(Hasher& hasher, const std::optional<Value>& value) {
  hasher.add(value.has_value());
  if (!value) return;
  if constexpr (std::is_arithmetic_v<Value>)
    hasher.add(*value);
  else
    add(hasher, *value);
}

void add(Hasher& hasher, const Object& object) {
  hasher.add(object.firstVertex).add(object.vertexCount).add(std::uint64_t{object.parts.size()});
  for (const Part& part : object.parts) hasher.add(part.material).add(part.firstIndex).add(part.indexCount);
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) hasher.add(object.placement[column][row]);
  }
  add(hasher, object.motion);
  hasher.add(object.sequence.has_value());
  if (object.sequence) {
    hasher.add(object.sequence->framesPerSecond).add(object.sequence->loop);
    hasher.add(std::uint64_t{object.sequence->positions.size()})
        .add(std::uint64_t{object.sequence->normals.size()});
    for (const auto& frame : object.sequence->positions) hasher.add(frame);
    for (const auto& frame : object.sequence->normals) hasher.add(frame);
  }
  if (object.animation) object.animation->addTo(hasher.add("animation"));
}

void add(Hasher& hasher, const Material& material) {
  add(hasher, material.diffuse);
  add(hasher, material.specular);
  add(hasher, material.emission);
  hasher.add(material.exponent).add(material.diffuseTexture).add(material.maskTexture);
}

void add(Hasher& hasher, const Light& light) {
  hasher.add(light.kind);
  add(hasher, light.position);
  add(hasher, light.direction);
  add(hasher, light.power);
  hasher.add(light.innerAngle).add(light.outerAngle);
  if (!light.motion) return;
  hasher.add("motion").add(light.motion->interpolation).add(std::uint64_t{light.motion->keys.size()});
  add(hasher, light.motion->rigid);
  for (const LightKey& key : light.motion->keys) {
    hasher.add(key.time);
    add(hasher, key.position);
    add(hasher, key.direction);
    add(hasher, key.power);
    add(hasher, key.innerAngle);
    add(hasher, key.outerAngle);
  }
}

void add(Hasher& hasher, const Camera& camera) {
  hasher.add(camera.name);
  add(hasher, camera.eye);
  add(hasher, camera.target);
  add(hasher, camera.up);
  hasher.add(camera.fov).add(camera.width).add(camera.height).add(std::uint64_t{camera.keys.size()});
  if (camera.aperture > 0.0) hasher.add("lens").add(camera.aperture).add(camera.focus);
  for (const CameraKey& key : camera.keys) {
    hasher.add(key.time);
    add(hasher, key.eye);
    add(hasher, key.target);
    if (key.fov) hasher.add("fov").add(*key.fov);
  }
  if (camera.interpolation != Interpolation::linear) hasher.add("step");
  if (!camera.motion) return;
  hasher.add("motion");
  add(hasher, *camera.motion);
}

void add(Hasher& hasher, const Medium& medium) {
  add(hasher, medium.extinction);
  add(hasher, medium.albedo);
  hasher.add(medium.anisotropy).add(medium.box.has_value());
  if (medium.box) {
    add(hasher, medium.box->first);
    add(hasher, medium.box->second);
  }
  hasher.add(medium.particles).add(medium.spread).add(medium.radius).add(medium.rise).add(medium.drift);
  hasher.add(medium.life).add(medium.seed).add(medium.volume != nullptr);
  add(hasher, medium.source);
  if (medium.volume) {
    add(hasher, medium.volume->low);
    hasher.add(medium.volume->voxelSize).add(medium.volume->resolution.x).add(medium.volume->resolution.y);
    hasher.add(medium.volume->resolution.z).add(medium.volume->values);
  }
}

/// The hash of all pixels and attributes. It reveals damage in an entry that still reads as an image.
ContentHash contentOf(const LayeredImage& image) {
  Hasher hasher;
  for (const auto& [name, layer] : image.layers) {
    hasher.add(name).add(layer.width()).add(layer.height()).add(layer.channels()).add(layer.values());
  }
  for (const auto& [name, value] : image.attributes) hasher.add(name).add(value);
  return hasher.finish();
}

constexpr const char* kContentHash = "content";

/// Why an entry is not the wanted reference; empty if it is. Its attributes are compared with the expected
/// ones.
std::string defectOf(LayeredImage& entry, const Scene& scene, const ResolvedOptions& resolved) {
  const auto stated = entry.attributes.find(kContentHash);
  const std::string hash = stated == entry.attributes.end() ? std::string() : stated->second;
  entry.attributes.erase(kContentHash);
  if (hash != contentOf(entry).text()) return "its content is not what was written";
  for (const auto& [name, value] : provenance(scene, resolved)) {
    const auto found = entry.attributes.find(name);
    if (found == entry.attributes.end() || found->second != value)
      return fmt::format("its attribute '{}' is not '{}'", name, value);
  }
  if (!cutOffIn(entry.attributes)) return "its attribute 'cut_off' is not two numbers";
  std::map<std::string, int> channels{{"ambient_occlusion", 1}};
  if (scene.media.empty()) {
    for (const char* layer : kSurfaceLayers) channels[layer] = 3;
  } else {
    for (const char* layer : kMediaLayers) channels[layer] = 3;
  }
  for (const int bounces : resolved.options.bounceLayers)
    for (const std::string& layer : bounceLayerNames(bounces)) channels[layer] = 3;
  if (hasEnvironment(scene))
    for (const char* layer : kEnvironmentLayers) channels[layer] = 3;
  if (entry.layers.size() != 2 * channels.size()) return "it has other layers";
  for (const auto& [name, count] : channels) {
    for (const std::string& layer : {name, name + ".variance"}) {
      const auto found = entry.layers.find(layer);
      if (found == entry.layers.end() || found->second.channels() != count ||
          found->second.width() != resolved.options.width ||
          found->second.height() != resolved.options.height)
        return fmt::format("it has no layer '{}' of the right size", layer);
    }
  }
  return {};
}

/// The entry, or nothing if there is none or it has a defect, which is logged.
std::optional<LayeredImage> readEntry(const std::filesystem::path& file, const Scene& scene,
                                      const ResolvedOptions& resolved) {
  std::error_code failure;
  if (!std::filesystem::exists(std::filesystem::symlink_status(file, failure))) return std::nullopt;
  try {
    LayeredImage image = readExr(file);
    const std::string defect = defectOf(image, scene, resolved);
    if (defect.empty()) return image;
    logWarning("{}: this cached reference is damaged ({}); it is rendered again", file.string(), defect);
  } catch (const Error& error) {
    logWarning("this cached reference is damaged and is rendered again: {}", error.what());
  }
  return std::nullopt;
}

/// Stores an entry. A link under this name is replaced, not followed.
void keep(const std::filesystem::path& file, const LayeredImage& image) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(file, failure)))
    std::filesystem::remove(file, failure);
  writeExr(file, image);
  const PrunedReferences pruned = pruneReferences(referenceCacheLimit());
  if (pruned.removed > 0) {
    logInformation("the cache of references is full: removed the {} least recently used ({})", pruned.removed,
                   formatBytes(pruned.removedBytes));
  }
}

/// Keeps a reference, or says why not.
void keepForLater(const std::filesystem::path& file, LayeredImage& image) {
  image.attributes[kContentHash] = contentOf(image).text();
  try {
    keep(file, image);
  } catch (const Error& error) {
    // The image is good; only the next call pays.
    logWarning("the reference could not be kept for later: {}", error.what());
  }
  image.attributes.erase(kContentHash);
}

}  // namespace

void keepInCache(const Scene& scene, const ResolvedOptions& resolved, LayeredImage& image) {
  keepForLater(cacheDirectory() / entryName(cacheKey(scene, resolved)), image);
}

ContentHash contentOf(const Scene& scene) {
  if (scene.hash != ContentHash{}) return scene.hash;
  Hasher hasher;
  hasher.add(scene.positions).add(scene.normals).add(scene.texcoords).add(scene.indices);
  hasher.add(std::uint64_t{scene.objects.size()});
  for (const Object& object : scene.objects) add(hasher, object);
  hasher.add(std::uint64_t{scene.materials.size()});
  for (const Material& material : scene.materials) add(hasher, material);
  hasher.add(std::uint64_t{scene.textures.size()});
  for (const SurfaceTexture& texture : scene.textures) {
    hasher.add(texture.width).add(texture.height).add(texture.mask).add(texture.values);
  }
  hasher.add(std::uint64_t{scene.lights.size()});
  for (const Light& light : scene.lights) add(hasher, light);
  hasher.add(std::uint64_t{scene.cameras.size()});
  for (const Camera& camera : scene.cameras) add(hasher, camera);
  add(hasher, scene.environment);
  if (scene.environmentMap) hasher.add(scene.environmentMap->hash.high).add(scene.environmentMap->hash.low);
  for (const Medium& medium : scene.media) add(hasher, medium);
  return hasher.finish();
}

ContentHash cacheKey(const Scene& scene, const ResolvedOptions& resolved) {
  const ReferenceOptions& options = resolved.options;
  Hasher hasher;
  hasher.add("lumivox reference").add(kTracerVersion);
  if (!scene.media.empty()) hasher.add(kMediaVersion);
  if (hasEnvironment(scene)) hasher.add("environment").add(kEnvironmentVersion);
  const ContentHash content = contentOf(scene);
  hasher.add(content.high).add(content.low);
  for (const auto& capture : scene.captures)
    if (capture->realScene)
      hasher.add("stands for").add(capture->realScene->hash.high).add(capture->realScene->hash.low);
  // Sums of several blocks are rounded otherwise than one.
  if (options.samplesPerPixel > kBlockSamples) hasher.add("blocks").add(kBlockSamples);
  hasher.add(options.samplesPerPixel)
      .add(options.bounces)
      .add(options.roulette)
      .add(options.seed)
      .add(options.time);
  hasher.add(options.camera).add(options.width).add(options.height).add(options.occlusionDistance);
  if (!options.bounceLayers.empty()) hasher.add("bounce layers").add(options.bounceLayers);
  return hasher.finish();
}

std::map<std::string, std::string> provenance(const Scene& scene, const ResolvedOptions& resolved) {
  const ReferenceOptions& options = resolved.options;
  std::map<std::string, std::string> attributes{
      {"scene", scene.name},
      {"hash", contentOf(scene).text()},
      {"samples", std::to_string(options.samplesPerPixel)},
      {"bounces", std::to_string(options.bounces)},
      {"roulette", options.roulette ? "on" : "off"},
      {"seed", std::to_string(options.seed)},
      {"time", fmt::format("{}", options.time)},
      {"camera", options.camera},
      {"resolution", fmt::format("{} {}", options.width, options.height)},
      {"occlusion_distance", fmt::format("{}", options.occlusionDistance)},
      {"tracer_version", std::to_string(kTracerVersion)}};
  for (const auto& capture : scene.captures)
    if (capture->realScene) attributes["stands_for"] = capture->realScene->hash.text();
  if (!options.bounceLayers.empty())
    attributes["bounce_layers"] = fmt::format("{}", fmt::join(options.bounceLayers, " "));
  return attributes;
}

bool isKept(const Scene& scene, const ReferenceOptions& options) {
  std::error_code failure;
  return options.useCache &&
         std::filesystem::exists(cacheDirectory() / entryName(cacheKey(scene, resolve(scene, options))),
                                 failure);
}

}  // namespace reference

LayeredImage cachedReference(const Scene& scene, const ReferenceOptions& options) {
  using namespace reference;
  if (!options.useCache) return renderReference(scene, options);
  const ResolvedOptions resolved = resolve(scene, options);
  const std::filesystem::path file = cacheDirectory() / entryName(cacheKey(scene, resolved));
  if (std::optional<LayeredImage> entry = readEntry(file, scene, resolved)) {
    markAsUsed(file);
    if (options.progress) warnOfCutOff(entry->attributes);
    return *std::move(entry);
  }
  LayeredImage image = renderReference(scene, options);
  keepForLater(file, image);
  return image;
}

}  // namespace lumivox
