#include "scene/gltf_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "lumivox/base/log.h"
#include "scene/gltf_material.h"
#include "scene/gltf_nodes.h"
#include "scene/indexed_mesh.h"
#include "scene/parallel.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kTriangles = 4, kStrip = 5, kFan = 6;

/// One primitive of a mesh.
struct Primitive {
  FinishedMesh mesh;
  int material = 0;
  /// In the order of the finished vertices.
  std::vector<std::vector<glm::vec3>> positionDeltas, normalDeltas;
  std::vector<VertexDeformation::Influence> influences;
  std::size_t sets = 0;
};

class GltfLoader {
 public:
  GltfLoader(const fs::path& file, const ModelOptions& options, Hasher& hasher)
      : document_(file, hasher),
        options_(options),
        root_(document_.root()),
        materials_(document_, hasher, losses_) {}

  Model run() {
    requireExtensions();
    nodes_ = readGltfNodes(document_, options_);
    countTriangles();
    for (const std::size_t node : nodes_.visible) {
      const auto mesh = root_.item("nodes", node).index("mesh", root_.count("meshes"), "meshes");
      if (mesh) addNode(node, *mesh);
    }
    findings_.report(document_.file(), options_.strict);
    model_.cameras = readGltfCameras(document_, nodes_, losses_);
    model_.lights = readGltfLights(document_, nodes_, losses_);
    model_.motions = std::move(nodes_.motions);
    model_.materials = std::move(materials_).table();
    tellLosses();
    return std::move(model_);
  }

 private:
  void requireExtensions() {
    static const std::vector<std::string> known{"KHR_lights_punctual", "KHR_materials_emissive_strength",
                                                "KHR_materials_unlit", "KHR_mesh_quantization",
                                                "KHR_texture_transform"};
    const auto required = root_.find("extensionsRequired");
    for (std::size_t i = 0; required && i < required->size(); ++i) {
      const std::string name = required->at(i).asText();
      // Its surfaces have no metallic-roughness form to fall back on.
      const bool isMaterial =
          name.substr(0, 14) == "KHR_materials_" && name != "KHR_materials_pbrSpecularGlossiness";
      if (std::find(known.begin(), known.end(), name) == known.end() && !isMaterial)
        required->at(i).refuse(fmt::format("the file cannot be read without '{}'", name.substr(0, 80)),
                               "no other than " + listed(known));
    }
    const auto used = root_.find("extensionsUsed");
    for (std::size_t i = 0; used && i < used->size(); ++i) {
      const std::string name = used->at(i).asText();
      if (std::find(known.begin(), known.end(), name) == known.end() &&
          name.substr(0, 14) != "KHR_materials_")
        losses_.dropped.insert(name.substr(0, 80));
    }
  }

  /// Triangles and vertices of all nodes from the counts of accessors, before anything is read.
  void countTriangles() {
    const std::size_t meshes = root_.count("meshes"), accessors = root_.count("accessors");
    std::vector<std::uint64_t> triangles(meshes, 0), vertices(meshes, 0), uses(meshes, 0);
    for (std::size_t m = 0; m < meshes; ++m) {
      const GltfValue mesh = root_.item("meshes", m);
      for (std::size_t p = 0; p < mesh.count("primitives"); ++p) {
        const GltfValue primitive = mesh.item("primitives", p);
        const auto countOf = [&](const std::optional<std::size_t>& accessor) {
          return accessor ? root_.item("accessors", *accessor).member("count").asWhole(1'000'000'000) : 0;
        };
        const auto indices = primitive.index("indices", accessors, "accessors");
        const std::uint64_t positions =
            countOf(primitive.member("attributes").index("POSITION", accessors, "accessors"));
        const std::uint64_t corners = indices ? countOf(indices) : positions;
        const std::uint64_t most =
            primitive.whole("mode", kTriangles, kFan) == kTriangles ? corners / 3 : corners;
        triangles[m] += most;
        vertices[m] += std::min(positions, 3 * most);
      }
    }
    std::uint64_t triangleCount = 0, vertexCount = 0;
    for (const std::size_t node : nodes_.visible) {
      const auto mesh = root_.item("nodes", node).index("mesh", meshes, "meshes");
      if (!mesh) continue;
      triangleCount += triangles[*mesh];
      vertexCount += vertices[*mesh];
      if (uses_.size() < meshes) uses_.resize(meshes, 0);
      ++uses_[*mesh];
      if (std::max(triangleCount, vertexCount) > kMostModelTriangles)
        root_.item("nodes", node)
            .refuse(
                fmt::format("the nodes up to this one have {} triangles and {} vertices, each node its own",
                            triangleCount, vertexCount),
                fmt::format("at most {} of each", kMostModelTriangles));
    }
    constexpr std::uint64_t kPerTriangle = 24, kPerVertex = 80;
    requireMemory(kPerTriangle * triangleCount + kPerVertex * vertexCount, document_.file().string());
  }

  void addNode(std::size_t node, std::size_t mesh) {
    const GltfValue source = root_.item("nodes", node);
    const auto skin = source.index("skin", nodes_.animated->skins.size(), "skins");
    const AnimatedModel& animated = *nodes_.animated;
    ModelObject object;
    object.name = nodes_.names[node];
    object.firstVertex = static_cast<std::uint32_t>(model_.positions.size());
    if (!skin) object.placement = animated.globalOf(node, 0.0);
    model_.objects.push_back(object);
    auto deformation = std::make_shared<VertexDeformation>();
    std::size_t vertices = 0;
    // The last use of a mesh may take its memory.
    const bool isLast = --uses_[mesh] == 0;
    std::vector<Primitive>& primitives = primitivesOf(mesh, skin.has_value());
    for (Primitive& primitive : primitives) {
      if (!primitive.positionDeltas.empty() || primitive.sets > 0) {
        // Each node has its own copy.
        requireMemory(
            primitive.positionDeltas.size() * primitive.mesh.mesh.positions.size() * 2 * sizeof(glm::vec3),
            document_.file().string());
        addDeformation(primitive, vertices, *deformation);
      }
      vertices += primitive.mesh.mesh.positions.size();
      if (isLast)
        append(model_, std::move(primitive.mesh), primitive.material);
      else
        append(model_, primitive.mesh, primitive.material);
    }
    if (isLast) meshes_.erase({mesh, skin.has_value()});
    finishNode(node, mesh, skin, vertices, std::move(deformation));
  }

  /// The vertices of a primitive behind those of the ones before it, which may deform in another way.
  static void addDeformation(const Primitive& primitive, std::size_t before, VertexDeformation& deformation) {
    const auto add = [&](std::vector<std::vector<glm::vec3>>& all,
                         const std::vector<std::vector<glm::vec3>>& targets) {
      all.resize(std::max(all.size(), targets.size()));
      for (std::size_t t = 0; t < targets.size(); ++t) {
        all[t].resize(before, glm::vec3(0.0f));
        all[t].insert(all[t].end(), targets[t].begin(), targets[t].end());
      }
    };
    add(deformation.positionDeltas, primitive.positionDeltas);
    add(deformation.normalDeltas, primitive.normalDeltas);
    // One set after another of the whole object; they are put in that order at the end.
    deformation.sets = std::max(deformation.sets, primitive.sets);
  }

  void finishNode(std::size_t node, std::size_t mesh, const std::optional<std::size_t>& skin,
                  std::size_t vertices, std::shared_ptr<VertexDeformation> deformation) {
    const AnimatedModel& animated = *nodes_.animated;
    ModelObject& object = model_.objects.back();
    const bool morphs = !deformation->positionDeltas.empty();
    deformation->skin = skin.value_or(AnimatedNode::kNone);
    if (!morphs && !skin) {
      if (animated.moves(node))
        object.animation = std::make_shared<const ModelAnimation>(nodes_.animated, node);
      return;
    }
    requireMemory(2 * deformation->positionDeltas.size() * vertices * sizeof(glm::vec3),
                  "morph targets of one object");
    for (auto* targets : {&deformation->positionDeltas, &deformation->normalDeltas})
      for (auto& target : *targets) target.resize(vertices, glm::vec3(0.0f));
    if (skin) gatherInfluences(*skin, vertices, *deformation);
    readWeights(node, mesh, *deformation);
    const auto first = model_.positions.begin() + object.firstVertex;
    const auto firstNormal = model_.normals.begin() + object.firstVertex;
    deformation->positions.assign(first, first + static_cast<std::ptrdiff_t>(vertices));
    deformation->normals.assign(firstNormal, firstNormal + static_cast<std::ptrdiff_t>(vertices));
    const auto& joints = skin ? animated.skins[*skin].joints : std::vector<std::size_t>();
    const bool jointsMove =
        std::any_of(joints.begin(), joints.end(), [&](std::size_t joint) { return animated.moves(joint); });
    const bool isDeforming =
        jointsMove || (morphs && animated.nodes[node].weightsTrack != AnimatedNode::kNone);
    const auto animation = std::make_shared<const ModelAnimation>(nodes_.animated, node, deformation);
    // The state at the start is what stands in the scene for those who ask for no time.
    std::vector<glm::vec3> positions, normals;
    animation->deform(0.0, positions, normals);
    std::copy(positions.begin(), positions.end(), first);
    std::copy(normals.begin(), normals.end(), firstNormal);
    if (isDeforming)
      object.animation = animation;
    else if (!skin && animated.moves(node))
      object.animation = std::make_shared<const ModelAnimation>(nodes_.animated, node);
  }

  void gatherInfluences(std::size_t skin, std::size_t vertices, VertexDeformation& deformation) {
    const std::size_t joints = nodes_.animated->skins[skin].joints.size();
    deformation.influences.resize(deformation.sets * vertices);
    std::size_t first = 0;
    for (const auto& [count, sets, influences] : influences_) {
      for (std::size_t i = 0; i < influences.size(); ++i) {
        for (std::size_t k = 0; k < 4; ++k)
          if (influences[i].weights[k] != 0.0f && influences[i].joints[k] >= joints)
            root_.item("skins", skin)
                .refuse(fmt::format("a vertex has joint {}", influences[i].joints[k]),
                        fmt::format("one of its {} joints", joints));
        deformation.influences[i / count * vertices + first + i % count] = influences[i];
      }
      first += count;
    }
    influences_.clear();
  }

  void readWeights(std::size_t node, std::size_t mesh, VertexDeformation& deformation) {
    const std::size_t targets = deformation.positionDeltas.size();
    auto given = root_.item("nodes", node).find("weights");
    if (!given) given = root_.item("meshes", mesh).find("weights");
    deformation.weights.assign(targets, 0.0f);
    for (std::size_t i = 0; given && i < std::min(targets, given->size()); ++i)
      deformation.weights[i] = static_cast<float>(given->at(i).asNumber(-1e6, 1e6));
    const std::size_t track = nodes_.animated->nodes[node].weightsTrack;
    if (track != AnimatedNode::kNone && targets > 0 && nodes_.animated->tracks[track].components != targets)
      root_.item("nodes", node)
          .refuse(fmt::format("its animation has {} weights for {} morph targets",
                              nodes_.animated->tracks[track].components, targets),
                  "one weight for each target");
  }

  std::vector<Primitive>& primitivesOf(std::size_t mesh, bool isSkinned) {
    const auto [entry, isNew] = meshes_.try_emplace({mesh, isSkinned});
    if (isNew) {
      const GltfValue source = root_.item("meshes", mesh);
      for (std::size_t p = 0; p < source.count("primitives"); ++p) {
        const GltfValue primitive = source.item("primitives", p);
        if (primitive.whole("mode", kTriangles, kFan) < kTriangles)
          losses_.dropped.insert("points and lines");
        else
          entry->second.push_back(read(primitive, isSkinned));
      }
    }
    influences_.clear();
    if (isSkinned)
      for (const Primitive& primitive : entry->second)
        influences_.push_back({primitive.mesh.mesh.positions.size(), primitive.sets, primitive.influences});
    return entry->second;
  }

  std::optional<GltfAccessor> attribute(const GltfValue& attributes, const std::string& name) {
    const auto index = attributes.index(name.c_str(), root_.count("accessors"), "accessors");
    if (!index) return std::nullopt;
    return GltfAccessor(document_, *index);
  }

  Primitive read(const GltfValue& source, bool isSkinned) {
    const GltfValue attributes = source.member("attributes");
    const auto material = source.index("material", root_.count("materials"), "materials");
    const TexcoordUse use = materials_.texcoordsOf(material);
    IndexedMesh mesh;
    const auto positions = attribute(attributes, "POSITION");
    if (!positions) attributes.refuse("lacks 'POSITION'", "positions of the vertices");
    mesh.positions = positions->vectors3();
    const std::size_t vertices = mesh.positions.size();
    const auto requireCount = [&](const GltfAccessor& accessor) {
      if (accessor.count() != vertices)
        accessor.place().refuse(fmt::format("{} values for {} positions", accessor.count(), vertices),
                                "as many as positions");
    };
    if (const auto normals = attribute(attributes, "NORMAL")) {
      requireCount(*normals);
      mesh.normals = normals->vectors3();
    }
    if (const auto texcoords = attribute(attributes, fmt::format("TEXCOORD_{}", use.set))) {
      requireCount(*texcoords);
      mesh.texcoords = texcoords->vectors2();
      placeTexcoords(use, mesh.texcoords);
    }
    mesh.indices = trianglesOf(source, vertices);
    Primitive result;
    result.material = materials_.numberOf(material, colourOf(attributes, mesh, requireCount));
    const bool isDeforming = isSkinned || source.count("targets") > 0;
    const std::vector<glm::vec3> filePositions = isDeforming ? mesh.positions : std::vector<glm::vec3>();
    result.mesh = finished(std::move(mesh), options_, source.pointer(), findings_);
    if (isDeforming) readDeformation(source, filePositions, isSkinned, result);
    return result;
  }

  static void placeTexcoords(const TexcoordUse& use, std::vector<glm::vec2>& texcoords) {
    const bool isPlain = use.offset == glm::dvec2(0) && use.scale == glm::dvec2(1) && use.rotation == 0.0;
    inParallel(texcoords.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        texcoords[i] = isPlain ? glm::vec2(texcoords[i].x, 1.0f - texcoords[i].y) : use(texcoords[i]);
    });
  }

  std::vector<std::uint32_t> trianglesOf(const GltfValue& source, std::size_t vertices) {
    std::vector<std::uint32_t> corners;
    if (const auto index = source.index("indices", root_.count("accessors"), "accessors")) {
      const GltfAccessor accessor(document_, *index);
      corners = accessor.indices();
      std::atomic<bool> anyBeyond = false;
      inParallel(corners.size(), [&](std::size_t begin, std::size_t end) {
        std::uint32_t most = 0;
        for (std::size_t i = begin; i < end; ++i) most = std::max(most, corners[i]);
        if (end > begin && most >= vertices) anyBeyond = true;
      });
      const auto most = anyBeyond ? std::max_element(corners.begin(), corners.end()) : corners.end();
      if (anyBeyond)
        accessor.place().refuse(fmt::format("index {} is {}", most - corners.begin(), *most),
                                fmt::format("one of {} vertices", vertices));
    } else {
      corners.resize(vertices);
      for (std::size_t i = 0; i < vertices; ++i) corners[i] = static_cast<std::uint32_t>(i);
    }
    const std::uint64_t mode = source.whole("mode", kTriangles, kFan);
    if (mode == kTriangles) {
      if (corners.size() % 3 != 0)
        source.refuse(fmt::format("{} corners", corners.size()), "three for each triangle");
      return corners;
    }
    std::vector<std::uint32_t> triangles;
    for (std::size_t i = 2; i < corners.size(); ++i) {
      if (mode == kFan)
        triangles.insert(triangles.end(), {corners[i - 1], corners[i], corners[0]});
      else
        triangles.insert(triangles.end(), {corners[i - 2], corners[i - 1 + i % 2], corners[i - i % 2]});
    }
    return triangles;
  }

  /// The mean of vertex colours: a factor of the albedo.
  glm::vec3 colourOf(const GltfValue& attributes, const IndexedMesh& mesh, const auto& requireCount) {
    const auto colours = attribute(attributes, "COLOR_0");
    if (!colours) return glm::vec3(1.0f);
    requireCount(*colours);
    const std::vector<float> values = colours->require({3, 4}, "colours").floats();
    glm::dvec3 sum(0.0);
    for (const std::uint32_t index : mesh.indices)
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = values[index * colours->components() + c];
        if (value > 0.0f) sum[static_cast<int>(c)] += std::min(value, 1.0f);
      }
    if (mesh.indices.empty()) return glm::vec3(1.0f);
    const glm::vec3 mean(sum / static_cast<double>(mesh.indices.size()));
    if (mean != glm::vec3(1.0f)) losses_.reduced.insert("colours of vertices become their mean");
    return mean;
  }

  void readDeformation(const GltfValue& source, const std::vector<glm::vec3>& filePositions, bool isSkinned,
                       Primitive& result) {
    const IndexedMesh& mesh = result.mesh.mesh;
    const auto fileVertex = [&](std::size_t v) {
      return result.mesh.source.empty() ? v : std::size_t{result.mesh.source[v]};
    };
    constexpr std::size_t kMostTargets = 4096;
    const std::size_t targets = source.count("targets");
    if (targets > kMostTargets)
      source.member("targets").refuse(fmt::format("{} targets", targets),
                                      fmt::format("at most {}", kMostTargets));
    requireMemory(targets * mesh.positions.size() * 2 * sizeof(glm::vec3), document_.file().string());
    for (std::size_t t = 0; t < targets; ++t) {
      const GltfValue target = source.item("targets", t);
      const auto deltasOf = [&](const char* name) {
        std::vector<glm::vec3> deltas(mesh.positions.size(), glm::vec3(0.0f));
        const auto accessor = attribute(target, name);
        if (!accessor) return deltas;
        if (accessor->count() != filePositions.size())
          accessor->place().refuse(
              fmt::format("{} values for {} positions", accessor->count(), filePositions.size()),
              "as many as positions");
        const std::vector<glm::vec3> values = accessor->vectors3();
        for (std::size_t v = 0; v < deltas.size(); ++v) {
          deltas[v] = values[fileVertex(v)];
          if (!std::isfinite(glm::dot(deltas[v], deltas[v])))
            accessor->place().refuse(fmt::format("value {} is not finite", fileVertex(v)), "finite values");
        }
        return deltas;
      };
      result.positionDeltas.push_back(deltasOf("POSITION"));
      const bool hasNormals = target.has("NORMAL") && result.mesh.groups.start.empty();
      result.normalDeltas.push_back(hasNormals ? deltasOf("NORMAL")
                                               : generatedDeltas(mesh, result.positionDeltas.back()));
    }
    if (isSkinned) readInfluences(source.member("attributes"), filePositions.size(), fileVertex, result);
  }

  /// Changes of smooth normals where the whole target is added.
  std::vector<glm::vec3> generatedDeltas(const IndexedMesh& mesh,
                                         const std::vector<glm::vec3>& deltas) const {
    std::vector<glm::vec3> moved = mesh.positions;
    for (std::size_t v = 0; v < moved.size(); ++v) moved[v] += deltas[v];
    const NormalGroups groups =
        groupNormals(mesh.positions, mesh.indices, options_.crease.value_or(kDefaultCrease));
    const std::vector<glm::vec3> before = groupNormalsOf(mesh.positions, mesh.indices, groups),
                                 after = groupNormalsOf(moved, mesh.indices, groups);
    std::vector<glm::vec3> result(mesh.positions.size(), glm::vec3(0.0f));
    for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
      const glm::vec3 change = after[groups.groupOfCorner[corner]] - before[groups.groupOfCorner[corner]];
      if (std::isfinite(glm::dot(change, change))) result[mesh.indices[corner]] = change;
    }
    return result;
  }

  void readInfluences(const GltfValue& attributes, std::size_t fileVertices, const auto& fileVertex,
                      Primitive& result) {
    const std::size_t vertices = result.mesh.mesh.positions.size();
    for (std::size_t set = 0; attributes.has(fmt::format("JOINTS_{}", set).c_str()); ++set) {
      const auto joints = attribute(attributes, fmt::format("JOINTS_{}", set));
      const auto weights = attribute(attributes, fmt::format("WEIGHTS_{}", set));
      if (!weights) attributes.refuse(fmt::format("lacks 'WEIGHTS_{}'", set), "weights beside the joints");
      const std::vector<float> jointValues = joints->require({4}, "joints").floats(),
                               weightValues = weights->require({4}, "weights").floats();
      if (joints->count() != fileVertices || weights->count() != fileVertices)
        joints->place().refuse("other counts of joints and weights than of positions",
                               "as many as positions");
      for (std::size_t v = 0; v < vertices; ++v) {
        VertexDeformation::Influence influence;
        for (std::size_t k = 0; k < 4; ++k) {
          const float weight = weightValues[4 * fileVertex(v) + k],
                      joint = jointValues[4 * fileVertex(v) + k];
          if (!std::isfinite(weight) || !(joint >= 0.0f && joint < 65536.0f))
            weights->place().refuse(fmt::format("weight {} of joint {}", weight, joint),
                                    "finite weights of joints below 65536");
          influence.joints[k] = static_cast<std::uint32_t>(joint);
          influence.weights[k] = weight;
        }
        result.influences.push_back(influence);
      }
      ++result.sets;
    }
    for (std::size_t v = 0; v < vertices && result.sets > 0; ++v) {
      float sum = 0.0f;
      for (std::size_t set = 0; set < result.sets; ++set)
        for (const float weight : result.influences[set * vertices + v].weights) sum += weight;
      if (!(sum > 0.0f)) {
        result.influences[v].weights[0] = sum = 1.0f;  // it follows its first joint
        continue;
      }
      for (std::size_t set = 0; set < result.sets; ++set)
        for (float& weight : result.influences[set * vertices + v].weights) weight /= sum;
    }
    if (result.sets == 0) attributes.refuse("lacks 'JOINTS_0' of a mesh with a skin", "joints and weights");
  }

  void tellLosses() const {
    if (!options_.needsMaterials) return;
    const std::string file = document_.file().string();
    if (!losses_.reduced.empty())
      logInformation("{}: simplified: {}", file, fmt::join(losses_.reduced, "; "));
    if (root_.count("materials") > 0)
      logDetails("{}: metallic-roughness materials become Lambert plus Phong (docs/own_models.md)", file);
    if (losses_.dropped.empty()) return;
    const std::string text = fmt::format("{}: not used: {}", file, fmt::join(losses_.dropped, ", "));
    if (options_.strict) throw Error(text + "; refused under --strict");
    logWarning("{}", text);
  }

  struct NodeInfluences {
    std::size_t vertices, sets;
    std::vector<VertexDeformation::Influence> influences;
  };

  GltfDocument document_;
  const ModelOptions& options_;
  GltfValue root_;
  GltfLosses losses_;
  GltfMaterials materials_;
  GltfNodes nodes_;
  TriangleFindings findings_;
  std::map<std::pair<std::size_t, bool>, std::vector<Primitive>>
      meshes_;                              // by mesh and whether it has a skin
  std::vector<std::size_t> uses_;           // nodes to come, by mesh
  std::vector<NodeInfluences> influences_;  // of the node at hand
  Model model_;
};

}  // namespace

Model loadGltfModel(const fs::path& file, const ModelOptions& options, Hasher& hasher) {
  return GltfLoader(file, options, hasher).run();
}

}  // namespace lumivox
