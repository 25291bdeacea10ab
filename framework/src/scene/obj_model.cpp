#include "scene/obj_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "scene/obj_file.h"

namespace lumivox {
namespace {

/// Drops bad triangles and reports them.
class Cleaner {
 public:
  Cleaner(const ObjFile& file, const ModelOptions& options) : file_(file), options_(options) {}

  std::vector<std::uint32_t> keptTriangles() {
    std::vector<bool> bad(file_.positions.size(), false);
    for (const std::uint32_t position : file_.scan.nonFinitePositions) bad[position] = true;
    std::vector<std::uint32_t> kept;
    kept.reserve(file_.materials.size());
    for (std::uint32_t t = 0; t < file_.materials.size(); ++t) {
      const ObjCorner* corner = &file_.corners[3 * std::size_t{t}];
      const auto position = [&](int k) { return static_cast<std::size_t>(corner[k].position); };
      if (bad[position(0)] || bad[position(1)] || bad[position(2)]) {
        ++nonFinite_;
      } else if (!hasArea(file_.positions[position(0)], file_.positions[position(1)],
                          file_.positions[position(2)])) {
        if (flat_++ == 0) firstFlat_ = t;
      } else {
        kept.push_back(t);
      }
    }
    report(kept.size());
    return kept;
  }

 private:
  void report(std::size_t kept) const {
    const ObjScan& scan = file_.scan;
    std::vector<std::string> reasons;
    if (scan.brokenFaces.count > 0) {
      reasons.push_back(fmt::format("{} with an index that no vertex has (first in line {})",
                                    scan.brokenFaces.count, scan.brokenFaces.firstLine));
    }
    if (nonFinite_ > 0 || scan.nonFinite.count > 0) {
      reasons.push_back(
          fmt::format("{} with coordinates that are not finite ({} such statements, first in line {})",
                      nonFinite_, scan.nonFinite.count, scan.nonFinite.firstLine));
    }
    if (flat_ > 0) {
      const ObjCorner* corner = &file_.corners[3 * std::size_t{firstFlat_}];
      const int line = lineOfFace(file_.text, corner[0].position, corner[1].position, corner[2].position);
      reasons.push_back(fmt::format("{} of zero area (first in line {}, object '{}')", flat_, line,
                                    file_.objectNames[file_.objects[firstFlat_]]));
    }
    if (reasons.empty()) return;
    const std::size_t dropped = scan.brokenFaces.count + nonFinite_ + flat_;
    const std::string text = fmt::format("{}: {} of {} triangles are bad: {}", file_.path.string(), dropped,
                                         kept + dropped, fmt::join(reasons, ", "));
    if (options_.strict) throw Error(text + "; refused under --strict");
    if (kept == 0) throw Error(text + "; no triangle is left");
    logWarning("{}; dropped", text);
  }

  const ObjFile& file_;
  const ModelOptions& options_;
  std::size_t nonFinite_ = 0, flat_ = 0;
  std::uint32_t firstFlat_ = 0;
};

/// Numbers the distinct (position, texture coordinate, normal) triples of one object: a hash table with open
/// addressing that is cleared quickly.
class VertexTable {
 public:
  struct Key {
    std::uint32_t position, texcoord, normal;
    bool operator==(const Key&) const = default;
  };

  explicit VertexTable(std::size_t mostKeys) : slots_(std::bit_ceil(2 * mostKeys + 1)) {}

  /// The number of the key, and whether it is new.
  std::pair<std::uint32_t, bool> add(const Key& key, std::uint32_t newNumber) {
    std::uint64_t hash = key.position * 0x9E3779B97F4A7C15ull ^ key.texcoord * 0xC2B2AE3D27D4EB4Full ^
                         key.normal * 0x165667B19E3779F9ull;
    hash ^= hash >> 32;
    for (std::size_t slot = hash & (slots_.size() - 1);; slot = (slot + 1) & (slots_.size() - 1)) {
      if (slots_[slot].generation != generation_) {
        slots_[slot] = {key, newNumber, generation_};
        return {newNumber, true};
      }
      if (slots_[slot].key == key) return {slots_[slot].number, false};
    }
  }
  void clear() { ++generation_; }

 private:
  struct Slot {
    Key key{};
    std::uint32_t number = 0;
    std::uint32_t generation = 0;
  };
  std::vector<Slot> slots_;
  std::uint32_t generation_ = 1;
};

constexpr std::uint32_t kNone = ~std::uint32_t{0};

/// Turns corners into vertices, object by object and material by material.
class Builder {
 public:
  Builder(const ObjFile& file, const ModelOptions& options, std::vector<std::uint32_t> kept)
      : file_(file), options_(options), kept_(std::move(kept)) {}

  Model run() {
    makeNormals();
    // Triangles by object, then by material, each in the order of first appearance; otherwise in the order of
    // the file.
    std::vector<std::uint32_t> order(kept_.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    const std::vector<std::uint32_t> materialRank = ranks();
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      const std::uint32_t objectA = file_.objects[kept_[a]], objectB = file_.objects[kept_[b]];
      if (objectA != objectB) return objectA < objectB;
      return materialRank[file_.materials[kept_[a]]] < materialRank[file_.materials[kept_[b]]];
    });
    model_.indices.reserve(3 * kept_.size());
    for (auto* values : {&model_.positions, &model_.normals}) values->reserve(3 * kept_.size());
    model_.texcoords.reserve(3 * kept_.size());
    positionOfVertex_.reserve(3 * kept_.size());
    normalOfVertex_.reserve(3 * kept_.size());
    VertexTable table(mostCornersOfObject());
    std::uint32_t object = kNone;
    for (const std::uint32_t index : order) {
      const std::uint32_t triangle = kept_[index];
      if (file_.objects[triangle] != object) {
        object = file_.objects[triangle];
        table.clear();
        ModelObject& added = model_.objects.emplace_back();
        added.name = file_.objectNames[object];
        added.firstVertex = static_cast<std::uint32_t>(model_.positions.size());
      }
      ModelObject& current = model_.objects.back();
      const auto material = static_cast<int>(file_.materials[triangle]);
      if (current.parts.empty() || current.parts.back().material != material) {
        current.parts.push_back({material, static_cast<std::uint32_t>(model_.indices.size()), 0});
      }
      for (std::uint32_t k = 0; k < 3; ++k) model_.indices.push_back(vertex(table, triangle, index, k));
      current.parts.back().indexCount += 3;
      current.vertexCount = static_cast<std::uint32_t>(model_.positions.size()) - current.firstVertex;
    }
    model_.materials = file_.materialTable;
    return std::move(model_);
  }

  /// The vertices of another file with the same faces.
  void addFrame(Model& model, const ObjFile& frame) const {
    std::vector<glm::vec3> positions(positionOfVertex_.size()), normals(positionOfVertex_.size());
    const std::vector<glm::vec3> generated = groups_.start.empty()
                                                 ? std::vector<glm::vec3>()
                                                 : groupNormalsOf(frame.positions, triangles_, groups_);
    for (std::size_t v = 0; v < positions.size(); ++v) {
      positions[v] = frame.positions[positionOfVertex_[v]];
      const std::uint32_t normal = normalOfVertex_[v];
      normals[v] = isGenerated(normal) ? generated[normal & ~kGenerated] : unitNormal(frame.normals[normal]);
      if (!std::isfinite(normals[v].x)) normals[v] = model.normals[v];
    }
    model.framePositions.push_back(std::move(positions));
    model.frameNormals.push_back(std::move(normals));
  }

 private:
  static constexpr std::uint32_t kGenerated = 0x80000000u;  // marks the number of a normal group
  static bool isGenerated(std::uint32_t normal) { return (normal & kGenerated) != 0; }

  /// The table of vertices holds one object at a time: a small one stays in the cache.
  std::size_t mostCornersOfObject() const {
    std::vector<std::size_t> corners(file_.objectNames.size(), 0);
    for (const std::uint32_t triangle : kept_) corners[file_.objects[triangle]] += 3;
    return corners.empty() ? 0 : *std::max_element(corners.begin(), corners.end());
  }

  std::vector<std::uint32_t> ranks() const {
    std::vector<std::uint32_t> rank(file_.materialTable.size(), kNone);
    std::uint32_t next = 0;
    for (const std::uint32_t triangle : kept_) {
      if (rank[file_.materials[triangle]] == kNone) rank[file_.materials[triangle]] = next++;
    }
    return rank;
  }

  bool hasOwnNormal(const ObjCorner& corner) const {
    if (options_.crease || corner.normal < 0) return false;
    const glm::vec3& normal = file_.normals[static_cast<std::size_t>(corner.normal)];
    return glm::length(glm::dvec3(normal)) > 1e-6;
  }

  void makeNormals() {
    bool missing = false;
    triangles_.reserve(3 * kept_.size());
    for (const std::uint32_t triangle : kept_) {
      for (std::size_t k = 0; k < 3; ++k) {
        const ObjCorner& corner = file_.corners[3 * std::size_t{triangle} + k];
        triangles_.push_back(static_cast<std::uint32_t>(corner.position));
        missing = missing || !hasOwnNormal(corner);
      }
    }
    if (!missing) return;
    groups_ = groupNormals(file_.positions, triangles_, options_.crease.value_or(kDefaultCrease));
    generated_ = groupNormalsOf(file_.positions, triangles_, groups_);
  }

  std::uint32_t vertex(VertexTable& table, std::uint32_t triangle, std::uint32_t index, std::uint32_t k) {
    const ObjCorner& corner = file_.corners[3 * std::size_t{triangle} + k];
    const std::uint32_t normal = hasOwnNormal(corner)
                                     ? static_cast<std::uint32_t>(corner.normal)
                                     : groups_.groupOfCorner[3 * std::size_t{index} + k] | kGenerated;
    const VertexTable::Key key{static_cast<std::uint32_t>(corner.position),
                               corner.texcoord < 0 ? kNone : static_cast<std::uint32_t>(corner.texcoord),
                               normal};
    const auto [number, isNew] = table.add(key, static_cast<std::uint32_t>(model_.positions.size()));
    if (isNew) {
      model_.positions.push_back(file_.positions[key.position]);
      model_.normals.push_back(isGenerated(normal) ? generated_[normal & ~kGenerated]
                                                   : unitNormal(file_.normals[normal]));
      model_.texcoords.push_back(key.texcoord == kNone ? glm::vec2(0.0f) : file_.texcoords[key.texcoord]);
      positionOfVertex_.push_back(key.position);
      normalOfVertex_.push_back(normal);
    }
    return number;
  }

  const ObjFile& file_;
  const ModelOptions& options_;
  std::vector<std::uint32_t> kept_;
  std::vector<std::uint32_t> triangles_;  // positions of the kept corners
  NormalGroups groups_;
  std::vector<glm::vec3> generated_;
  std::vector<std::uint32_t> positionOfVertex_, normalOfVertex_;
  Model model_;
};

/// A frame must have the faces of the first one and nothing that would have to be dropped.
void requireSameFaces(const ObjFile& first, const ObjFile& frame) {
  const std::string expected =
      fmt::format("the vertices and faces of {} in the same order", first.path.string());
  if (frame.positions.size() != first.positions.size()) {
    throw Error(fmt::format("{}: has {} positions, not {}; expected {}", frame.path.string(),
                            frame.positions.size(), first.positions.size(), expected));
  }
  if (frame.corners.size() != first.corners.size() ||
      !std::equal(frame.corners.begin(), frame.corners.end(), first.corners.begin())) {
    throw Error(fmt::format("{}: has other faces; expected {}", frame.path.string(), expected));
  }
  if (frame.scan.nonFinite.count > 0) {
    throw Error(
        fmt::format("{}:{}: a coordinate is not finite; expected finite numbers in every frame of a sequence",
                    frame.path.string(), frame.scan.nonFinite.firstLine));
  }
}

}  // namespace

Model loadObjModel(const std::vector<std::filesystem::path>& frames, const ModelOptions& options,
                   Hasher& hasher) {
  const ObjFile first = readObjFile(frames.front(), options, hasher);
  Builder builder(first, options, Cleaner(first, options).keptTriangles());
  Model model = builder.run();
  if (frames.size() == 1) return model;
  ModelOptions later = options;
  later.needsMaterials = false;  // only the first frame's are used
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i == 0) {
      requireSameFaces(first, first);
      builder.addFrame(model, first);
      continue;
    }
    const ObjFile frame = readObjFile(frames[i], later, hasher);
    requireSameFaces(first, frame);
    builder.addFrame(model, frame);
  }
  return model;
}

}  // namespace lumivox
