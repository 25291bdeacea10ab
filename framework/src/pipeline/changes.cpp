#include "pipeline/changes.h"

#include <algorithm>
#include <cassert>

namespace lumivox {

namespace {

bool emits(const Scene& scene, const Object& object) {
  return std::any_of(object.parts.begin(), object.parts.end(), [&](const Part& part) {
    return scene.materials[static_cast<std::size_t>(part.material)].emissive();
  });
}

bool sameLens(const CameraView& a, const CameraView& b) {
  return a.aperture == b.aperture && a.focus == b.focus;
}

bool sameButForLens(const CameraView& a, CameraView b) {
  b.aperture = a.aperture, b.focus = a.focus;
  return a == b;
}

}  // namespace

Reads whatChanged(const Scene& scene, const SceneSnapshot& before, const SceneSnapshot& after) {
  assert(before.objects.size() == after.objects.size());
  Reads changed = Reads::nothing;
  const bool otherOrigin = before.origin != after.origin;
  for (std::size_t i = 0; i < after.objects.size(); ++i) {
    const ObjectState &a = before.objects[i], &b = after.objects[i];
    if (!otherOrigin && a.toWorld == b.toWorld && a.positions == b.positions && a.normals == b.normals)
      continue;
    changed = changed | Reads::geometry;
    // Emissive objects are lights too.
    if (emits(scene, scene.objects[i])) changed = changed | Reads::lights;
  }
  if (otherOrigin || before.lights != after.lights) changed = changed | Reads::lights;
  if (otherOrigin || !sameButForLens(before.camera, after.camera)) changed = changed | Reads::camera;
  if (!sameLens(before.camera, after.camera)) changed = changed | Reads::lens;
  if (otherOrigin || before.captures != after.captures) changed = changed | Reads::capture;
  if (before.time != after.time) changed = changed | Reads::time;
  return changed;
}

Reads whatChanged(const Scene& before, const Scene& after) {
  Reads changed = Reads::nothing;
  const bool geometry = before.positions != after.positions || before.normals != after.normals ||
                        before.texcoords != after.texcoords || before.indices != after.indices ||
                        before.objects != after.objects;
  const bool materials = before.materials != after.materials || before.textures != after.textures;
  if (geometry) changed = changed | Reads::geometry;
  // Objects assign materials to parts.
  if (materials || before.objects != after.objects) changed = changed | Reads::materials;
  const auto emits = [](const Scene& scene) {
    return std::any_of(scene.materials.begin(), scene.materials.end(),
                       [](const Material& material) { return material.emissive(); });
  };
  if ((geometry || materials) && (emits(before) || emits(after))) changed = changed | Reads::lights;
  const auto hashOf = [](const Scene& scene) {
    return scene.environmentMap ? scene.environmentMap->hash : ContentHash{};
  };
  if (before.environment != after.environment || hashOf(before) != hashOf(after))
    changed = changed | Reads::environment;
  if (before.media != after.media) changed = changed | Reads::media;
  const auto same = [](const std::shared_ptr<const Capture>& a, const std::shared_ptr<const Capture>& b) {
    return a->hash == b->hash;
  };
  if (!std::equal(before.captures.begin(), before.captures.end(), after.captures.begin(),
                  after.captures.end(), same))
    changed = changed | Reads::capture;
  return changed;
}

}  // namespace lumivox
