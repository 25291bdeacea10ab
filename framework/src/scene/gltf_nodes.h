// The node hierarchy of a glTF file with what moves it, its cameras and its lights.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/scene/model_animation.h"
#include "scene/gltf_document.h"
#include "scene/model.h"

namespace lumivox {

struct GltfNodes {
  std::shared_ptr<AnimatedModel> animated;
  std::vector<std::size_t> visible;  ///< nodes of the scene, parents first
  std::vector<std::string> names;    ///< of all nodes, each once, fit for scene texts
  std::vector<ModelMotionName> motions;
};

/// Reads nodes, skins and the animation that plays. Refuses cycles and nodes with two parents.
GltfNodes readGltfNodes(GltfDocument& document, const ModelOptions& options);

std::vector<ModelCamera> readGltfCameras(GltfDocument& document, const GltfNodes& nodes, GltfLosses& losses);

/// KHR_lights_punctual. Candela and lux become W/sr and W/m^2 by the luminous efficacy of green light.
std::vector<Light> readGltfLights(GltfDocument& document, const GltfNodes& nodes, GltfLosses& losses);

/// lm/W at 555 nm: what exporters multiply radiant units with.
inline constexpr double kLuminousEfficacy = 683.0;

/// Names that are taken, and the number that the next equal one gets.
using NextNumbers = std::map<std::string, int>;
/// A name without blanks, slashes and the letters of patterns; numbered where `taken` has it.
std::string sceneNameOf(const std::string& name, const std::string& fallback, NextNumbers& taken);

}  // namespace lumivox
