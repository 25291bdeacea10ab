#include "scene/gltf_nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "lumivox/base/error.h"
#include "scene/limits.h"

namespace lumivox {
namespace {

// A hierarchy of more is refused: looking up a node's place walks up to its root.
constexpr std::size_t kMostNodes = 1'000'000, kDeepestNode = 1024;
constexpr double kFarthest = 1e9;  // m

AnimatedNode nodeOf(const GltfValue& source) {
  AnimatedNode node;
  if (const auto matrix = source.numbers("matrix", 16, -kFarthest, kFarthest)) {
    glm::dmat4& result = node.matrix.emplace();
    for (int i = 0; i < 16; ++i) result[i / 4][i % 4] = (*matrix)[static_cast<std::size_t>(i)];
    if (result[0][3] != 0.0 || result[1][3] != 0.0 || result[2][3] != 0.0 || result[3][3] != 1.0)
      source.member("matrix").refuse("is no affine transform", "0 0 0 1 in the last row");
    return node;
  }
  if (const auto t = source.numbers("translation", 3, -kFarthest, kFarthest))
    node.translation = {(*t)[0], (*t)[1], (*t)[2]};
  if (const auto s = source.numbers("scale", 3, -kFarthest, kFarthest))
    node.scale = {(*s)[0], (*s)[1], (*s)[2]};
  if (const auto r = source.numbers("rotation", 4, -kFarthest, kFarthest)) {
    const glm::dquat rotation((*r)[3], (*r)[0], (*r)[1], (*r)[2]);
    if (!(glm::length(rotation) > 0.0)) source.member("rotation").refuse("is zero", "a unit quaternion");
    // A unit quaternion in single precision is one: normalising it would only add rounding.
    node.rotation = std::abs(glm::length(rotation) - 1.0) < 1e-12 ? rotation : glm::normalize(rotation);
  }
  return node;
}

class NodeReader {
 public:
  NodeReader(GltfDocument& document, const ModelOptions& options)
      : document_(document), options_(options), root_(document.root()) {}

  GltfNodes run() {
    nodes_.animated = std::make_shared<AnimatedModel>();
    nodes_.animated->loop = options_.loop;
    readHierarchy();
    findVisible();
    readNames();
    readAnimation();
    readSkins();
    return std::move(nodes_);
  }

 private:
  void readHierarchy() {
    const std::size_t count = root_.count("nodes");
    if (count > kMostNodes)
      root_.member("nodes").refuse(fmt::format("{} nodes", count), fmt::format("at most {}", kMostNodes));
    for (std::size_t i = 0; i < count; ++i) nodes_.animated->nodes.push_back(nodeOf(root_.item("nodes", i)));
    children_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto children = root_.item("nodes", i).find("children");
      for (std::size_t c = 0; children && c < children->size(); ++c) {
        const std::size_t child = children->at(c).asIndex(count, "nodes");
        std::size_t& parent = nodes_.animated->nodes[child].parent;
        if (parent != AnimatedNode::kNone)
          children->at(c).refuse(fmt::format("node {} is a child of node {} too", child, parent),
                                 "one parent for each node");
        parent = i;
        children_[i].push_back(child);
      }
    }
    // Every node has one parent at most: what is not reached from a root lies on a cycle or behind one.
    std::vector<std::size_t> open;
    std::vector<std::size_t> depth(count, 0);
    for (std::size_t i = 0; i < count; ++i)
      if (nodes_.animated->nodes[i].parent == AnimatedNode::kNone) open.push_back(i);
    for (std::size_t at = 0; at < open.size(); ++at) {
      if (depth[open[at]] > kDeepestNode)
        root_.item("nodes", open[at])
            .refuse("the hierarchy is too deep", fmt::format("at most {}", kDeepestNode));
      for (const std::size_t child : children_[open[at]]) {
        depth[child] = depth[open[at]] + 1;
        open.push_back(child);
      }
    }
    if (open.size() == count) return;
    std::vector<bool> reached(count, false);
    for (const std::size_t node : open) reached[node] = true;
    const auto first =
        static_cast<std::size_t>(std::find(reached.begin(), reached.end(), false) - reached.begin());
    root_.item("nodes", first).refuse("the node is its own ancestor or below one that is", "a tree of nodes");
  }

  void findVisible() {
    const std::size_t scenes = root_.count("scenes"), count = nodes_.animated->nodes.size();
    std::vector<std::size_t> open;
    if (scenes > 0) {
      const std::size_t scene = root_.index("scene", scenes, "scenes").value_or(0);
      const auto roots = root_.item("scenes", scene).find("nodes");
      for (std::size_t i = 0; roots && i < roots->size(); ++i)
        open.push_back(roots->at(i).asIndex(count, "nodes"));
    } else {
      for (std::size_t i = 0; i < count; ++i)
        if (nodes_.animated->nodes[i].parent == AnimatedNode::kNone) open.push_back(i);
    }
    std::vector<bool> seen(count, false);
    std::reverse(open.begin(), open.end());
    while (!open.empty()) {
      const std::size_t node = open.back();
      open.pop_back();
      if (seen[node]) continue;
      seen[node] = true;
      nodes_.visible.push_back(node);
      open.insert(open.end(), children_[node].rbegin(), children_[node].rend());
    }
  }

  void readNames() {
    NextNumbers taken;
    const std::size_t meshes = root_.count("meshes");
    for (std::size_t i = 0; i < nodes_.animated->nodes.size(); ++i) {
      const GltfValue node = root_.item("nodes", i);
      std::string name = node.text("name");
      const auto mesh = node.index("mesh", meshes, "meshes");
      if (name.empty() && mesh) name = root_.item("meshes", *mesh).text("name");
      nodes_.names.push_back(sceneNameOf(name, fmt::format("node_{}", i), taken));
    }
  }

  void readAnimation() {
    const std::size_t count = root_.count("animations");
    std::vector<std::string> names;
    std::optional<std::size_t> chosen;
    for (std::size_t i = 0; i < count; ++i) {
      const GltfValue animation = root_.item("animations", i);
      names.push_back(animation.text("name", fmt::format("animation_{}", i)));
      nodes_.motions.push_back({names.back(), durationOf(animation)});
      if (options_.animation == names.back() && !chosen) chosen = i;
    }
    if (options_.animation && !chosen) {
      const std::string nearest = nearestWord(*options_.animation, names);
      throw Error(fmt::format("{}: has no animation '{}'; expected {}{}", document_.file().string(),
                              *options_.animation,
                              names.empty() ? "a file with animations" : "one of " + listed(names),
                              nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
    }
    if (count == 0) return;
    const GltfValue animation = root_.item("animations", chosen.value_or(0));
    for (std::size_t i = 0; i < animation.count("channels"); ++i)
      readChannel(animation, animation.item("channels", i));
  }

  double durationOf(const GltfValue& animation) {
    double duration = 0.0;
    const std::size_t accessors = root_.count("accessors");
    for (std::size_t i = 0; i < animation.count("samplers"); ++i) {
      const auto input = animation.item("samplers", i).index("input", accessors, "accessors");
      if (!input) continue;
      const auto most = root_.item("accessors", *input).numbers("max", 1, 0, kFarthest);
      if (most) duration = std::max(duration, most->front());
    }
    return duration;
  }

  void readChannel(const GltfValue& animation, const GltfValue& channel) {
    AnimatedModel& model = *nodes_.animated;
    const GltfValue target = channel.member("target");
    const auto node = target.index("node", model.nodes.size(), "nodes");
    if (!node) return;
    const std::string path = target.member("path").asText();
    AnimatedNode& moved = model.nodes[*node];
    std::size_t* track = path == "translation" ? &moved.translationTrack
                         : path == "rotation"  ? &moved.rotationTrack
                         : path == "scale"     ? &moved.scaleTrack
                         : path == "weights"   ? &moved.weightsTrack
                                               : nullptr;
    if (track == nullptr)
      target.member("path").refuse(fmt::format("is '{}'", path.substr(0, 20)),
                                   "translation, rotation, scale or weights");
    if (*track != AnimatedNode::kNone)
      target.refuse("the node has this motion already", "one channel for each path");
    if (moved.matrix && path != "weights")
      target.refuse("a node with a matrix moves", "a node of translation, rotation and scale");
    const std::size_t sampler = channel.member("sampler").asIndex(animation.count("samplers"), "samplers");
    model.tracks.push_back(trackOf(animation.item("samplers", sampler), path));
    *track = model.tracks.size() - 1;
    model.duration = std::max(model.duration, static_cast<double>(model.tracks.back().times.back()));
  }

  AnimationTrack trackOf(const GltfValue& sampler, const std::string& path) {
    const std::size_t accessors = root_.count("accessors");
    const GltfAccessor input(document_, sampler.member("input").asIndex(accessors, "accessors"));
    const GltfAccessor output(document_, sampler.member("output").asIndex(accessors, "accessors"));
    AnimationTrack track;
    const std::string joining = sampler.text("interpolation", "LINEAR");
    if (joining == "STEP")
      track.joining = AnimationTrack::Joining::step;
    else if (joining == "CUBICSPLINE")
      track.joining = AnimationTrack::Joining::cubic;
    else if (joining != "LINEAR")
      sampler.member("interpolation")
          .refuse(fmt::format("is '{}'", joining.substr(0, 20)), "LINEAR, STEP or CUBICSPLINE");
    track.isRotation = path == "rotation";
    track.times = input.require({1}, "times").floats();
    if (track.times.empty()) input.place().refuse("no times", "at least one");
    for (std::size_t i = 0; i < track.times.size(); ++i) {
      const float time = track.times[i];
      if (!(time >= 0.0f && static_cast<double>(time) <= kFarthest) || (i > 0 && time <= track.times[i - 1]))
        input.place().refuse(fmt::format("time {} is {}", i, time),
                             "finite times that rise from at least 0 s");
    }
    track.values = output.floats();
    for (const float value : track.values)
      if (!std::isfinite(value)) output.place().refuse("a value is not finite", "finite values");
    const std::size_t keys = track.times.size() * (track.joining == AnimationTrack::Joining::cubic ? 3 : 1);
    track.components = path == "weights" ? track.values.size() / keys : path == "rotation" ? 4 : 3;
    if (path == "weights")
      output.require({1}, "weights");
    else
      output.require({track.components}, "values");
    if (track.values.size() != keys * track.components || track.components == 0)
      output.place().refuse(fmt::format("{} numbers for {} keys", track.values.size(), track.times.size()),
                            "values for each key, three times as many of CUBICSPLINE");
    return track;
  }

  void readSkins() {
    AnimatedModel& model = *nodes_.animated;
    const std::size_t accessors = root_.count("accessors");
    for (std::size_t i = 0; i < root_.count("skins"); ++i) {
      const GltfValue source = root_.item("skins", i);
      AnimatedSkin skin;
      const GltfValue joints = source.member("joints");
      for (std::size_t j = 0; j < joints.size(); ++j)
        skin.joints.push_back(joints.at(j).asIndex(model.nodes.size(), "nodes"));
      skin.inverseBind.assign(skin.joints.size(), glm::dmat4(1.0));
      if (const auto index = source.index("inverseBindMatrices", accessors, "accessors")) {
        const GltfAccessor matrices(document_, *index);
        const std::vector<float> values = matrices.require({16}, "matrices").floats();
        if (matrices.count() < skin.joints.size())
          source.member("inverseBindMatrices")
              .refuse(fmt::format("{} matrices for {} joints", matrices.count(), skin.joints.size()),
                      "one for each joint");
        for (std::size_t v = 0; v < 16 * skin.joints.size(); ++v)
          if (!std::isfinite(values[v]))
            source.member("inverseBindMatrices").refuse("a matrix that is not finite", "finite matrices");
          else
            skin.inverseBind[v / 16][static_cast<int>(v % 16 / 4)][static_cast<int>(v % 4)] =
                static_cast<double>(values[v]);
      }
      model.skins.push_back(std::move(skin));
    }
  }

  GltfDocument& document_;
  const ModelOptions& options_;
  GltfValue root_;
  GltfNodes nodes_;
  std::vector<std::vector<std::size_t>> children_;
};

}  // namespace

GltfNodes readGltfNodes(GltfDocument& document, const ModelOptions& options) {
  return NodeReader(document, options).run();
}

std::vector<ModelCamera> readGltfCameras(GltfDocument& document, const GltfNodes& nodes, GltfLosses& losses) {
  const GltfValue root = document.root();
  const AnimatedModel& model = *nodes.animated;
  constexpr std::size_t kMostViews = 1024;
  std::vector<ModelCamera> result;
  for (const std::size_t node : nodes.visible) {
    const auto index = root.item("nodes", node).index("camera", root.count("cameras"), "cameras");
    if (!index) continue;
    const auto perspective = root.item("cameras", *index).find("perspective");
    if (!perspective) {
      losses.dropped.insert("orthographic cameras");  // they have no eye
      continue;
    }
    ModelCamera camera;
    camera.name = nodes.names[node];
    // The range of a scene text.
    constexpr double kDegree = std::numbers::pi / 180.0;
    camera.fov = perspective->member("yfov").asNumber(0.1 * kDegree, 179.0 * kDegree);
    const std::vector<double> times =
        model.moves(node) ? model.sampleTimes(kMostViews) : std::vector<double>{0.0};
    for (const double time : times) {
      const glm::dmat4 toFile = model.globalOf(node, time);
      ModelCamera::View view{time, glm::dvec3(toFile[3]), -glm::dvec3(toFile[2]), glm::dvec3(toFile[1])};
      if (glm::length(view.forward) > 0.0 && glm::length(view.up) > 0.0) {
        view.forward = glm::normalize(view.forward);
        view.up = glm::normalize(view.up);
        camera.views.push_back(view);
      }
    }
    if (!camera.views.empty()) result.push_back(std::move(camera));
  }
  return result;
}

std::vector<Light> readGltfLights(GltfDocument& document, const GltfNodes& nodes, GltfLosses& losses) {
  std::vector<Light> result;
  const GltfValue root = document.root();
  const auto lightsOf = [](const GltfValue& value) {
    const auto extensions = value.find("extensions");
    return extensions ? extensions->find("KHR_lights_punctual") : std::nullopt;
  };
  const auto lights = lightsOf(root);
  if (!lights) return result;
  for (const std::size_t node : nodes.visible) {
    const auto use = lightsOf(root.item("nodes", node));
    if (!use) continue;
    const GltfValue source =
        lights->item("lights", use->member("light").asIndex(lights->count("lights"), "lights"));
    if (source.has("range")) losses.reduced.insert("lights reach beyond their range");
    Light light;
    light.name = nodes.names[node];
    const std::string type = source.member("type").asText();
    const auto colour = source.numbers("color", 3, 0, 1e6);
    const double power = source.number("intensity", 1.0, 0, kMostLight) / kLuminousEfficacy;
    for (int i = 0; i < 3; ++i)
      light.power[i] = static_cast<float>(power * (colour ? (*colour)[static_cast<std::size_t>(i)] : 1.0));
    const glm::dmat4 toFile = nodes.animated->globalOf(node, 0.0);
    light.position = glm::dvec3(toFile[3]);
    const glm::dvec3 forward = -glm::dvec3(toFile[2]);
    if (glm::length(forward) > 0.0) light.direction = glm::normalize(forward);
    if (type == "directional") {
      light.kind = LightKind::directional;
    } else if (type == "point") {
      light.kind = LightKind::point;
    } else if (type == "spot") {
      light.kind = LightKind::spot;
      const GltfValue cone = source.member("spot");
      // A right angle in single precision is a little wider.
      const double outer =
          std::min(cone.number("outerConeAngle", std::numbers::pi / 4, 1e-3, 1.5708), std::numbers::pi / 2);
      light.innerAngle = static_cast<float>(cone.number("innerConeAngle", 0.0, 0.0, 1.5708));
      light.outerAngle = static_cast<float>(outer);
      if (light.innerAngle >= light.outerAngle) light.innerAngle = 0.999f * light.outerAngle;
    } else {
      source.member("type").refuse(fmt::format("is '{}'", type.substr(0, 20)), "directional, point or spot");
    }
    result.push_back(std::move(light));
  }
  return result;
}

std::string sceneNameOf(const std::string& name, const std::string& fallback, NextNumbers& taken) {
  constexpr std::size_t kLongest = 200;
  std::string result = name.substr(0, kLongest);
  for (char& c : result)
    if (static_cast<unsigned char>(c) <= ' ' || c == '/' || c == '*' || c == '?' || c == '"' || c == '\\' ||
        c == '\x7f')
      c = '_';
  if (result.empty()) result = fallback;
  const auto [entry, isNew] = taken.emplace(result, 2);
  if (isNew) return result;
  for (;;) {
    std::string numbered = fmt::format("{}_{}", result, entry->second++);
    if (taken.emplace(numbered, 2).second) return numbered;
  }
}

}  // namespace lumivox
