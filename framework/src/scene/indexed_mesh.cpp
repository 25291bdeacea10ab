#include "scene/indexed_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <unordered_map>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "scene/parallel.h"

namespace lumivox {
namespace {

constexpr std::uint32_t kNoVertex = ~std::uint32_t{0};
constexpr double kShortestNormal = 1e-6;

bool isFinite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

enum class TriangleKind : unsigned char { good, nonFinite, flat };

TriangleKind kindOf(const IndexedMesh& mesh, std::size_t triangle) {
  const glm::vec3 &a = mesh.positions[mesh.indices[3 * triangle]],
                  &b = mesh.positions[mesh.indices[3 * triangle + 1]],
                  &c = mesh.positions[mesh.indices[3 * triangle + 2]];
  if (!isFinite(a) || !isFinite(b) || !isFinite(c)) return TriangleKind::nonFinite;
  return hasArea(a, b, c) ? TriangleKind::good : TriangleKind::flat;
}

void dropBadTriangles(IndexedMesh& mesh, const std::string& place, TriangleFindings& findings) {
  const std::size_t triangles = mesh.indices.size() / 3;
  findings.triangles += triangles;
  std::atomic<bool> anyBad = false;
  inParallel(triangles, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      if (kindOf(mesh, t) != TriangleKind::good) anyBad = true;
  });
  if (!anyBad) return;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < triangles; ++t) {
    const TriangleKind kind = kindOf(mesh, t);
    if (kind == TriangleKind::good) {
      std::copy_n(mesh.indices.begin() + static_cast<std::ptrdiff_t>(3 * t), 3,
                  mesh.indices.begin() + static_cast<std::ptrdiff_t>(3 * kept++));
      continue;
    }
    const bool isFlat = kind == TriangleKind::flat;
    std::size_t& count = isFlat ? findings.flat : findings.nonFinite;
    if (count++ == 0)
      (isFlat ? findings.firstFlat : findings.firstNonFinite) = fmt::format("triangle {} of {}", t, place);
  }
  mesh.indices.resize(3 * kept);
}

/// Keeps only vertices that triangles use, in the order of their first use.
void compact(FinishedMesh& result) {
  IndexedMesh& mesh = result.mesh;
  std::vector<std::uint32_t> numbers(mesh.positions.size(), kNoVertex);
  for (std::uint32_t& index : mesh.indices) {
    if (numbers[index] == kNoVertex) {
      numbers[index] = static_cast<std::uint32_t>(result.source.size());
      result.source.push_back(index);
    }
    index = numbers[index];
  }
  const auto pick = [&](auto& values) {
    if (values.empty()) return;
    auto all = std::move(values);
    values = {};
    values.reserve(result.source.size());
    for (const std::uint32_t vertex : result.source) values.push_back(all[vertex]);
  };
  pick(mesh.positions);
  pick(mesh.normals);
  pick(mesh.texcoords);
}

/// Normalises the file's normals; false if a used vertex has none.
bool keepNormals(IndexedMesh& mesh) {
  if (mesh.normals.empty()) return false;
  const auto isUsable = [](const glm::vec3& normal) {
    return isFinite(normal) && glm::length(glm::dvec3(normal)) > kShortestNormal;
  };
  std::atomic<bool> anyMissing = false;
  inParallel(mesh.normals.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (isUsable(mesh.normals[v]))
        mesh.normals[v] = unitNormal(mesh.normals[v]);
      else
        anyMissing = true;
    }
  });
  if (!anyMissing) return true;
  bool allUsed = true;
  for (const std::uint32_t index : mesh.indices) allUsed = allUsed && isUsable(mesh.normals[index]);
  if (allUsed) {
    for (glm::vec3& normal : mesh.normals)
      if (!isUsable(normal)) normal = glm::vec3(0, 1, 0);
  }
  return allUsed;
}

/// Generates all normals: a vertex becomes several where its faces do not share one.
void generateNormals(FinishedMesh& result, double crease) {
  IndexedMesh& mesh = result.mesh;
  result.groups = groupNormals(mesh.positions, mesh.indices, crease);
  const std::vector<glm::vec3> generated = groupNormalsOf(mesh.positions, mesh.indices, result.groups);
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;
  numbers.reserve(mesh.positions.size());
  IndexedMesh split;
  std::vector<std::uint32_t> source;
  for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
    const std::uint32_t vertex = mesh.indices[corner], group = result.groups.groupOfCorner[corner];
    const auto [entry, isNew] = numbers.emplace(std::uint64_t{vertex} << 32 | group,
                                                static_cast<std::uint32_t>(split.positions.size()));
    if (isNew) {
      split.positions.push_back(mesh.positions[vertex]);
      split.normals.push_back(generated[group]);
      if (!mesh.texcoords.empty()) split.texcoords.push_back(mesh.texcoords[vertex]);
      source.push_back(result.source.empty() ? vertex : result.source[vertex]);
    }
    split.indices.push_back(entry->second);
  }
  mesh = std::move(split);
  result.source = std::move(source);
}

}  // namespace

void TriangleFindings::report(const std::filesystem::path& file, bool strict) const {
  if (triangles == 0)
    throw Error(fmt::format("{}: contains no triangles; expected a model of triangles", file.string()));
  std::vector<std::string> reasons;
  if (nonFinite > 0)
    reasons.push_back(
        fmt::format("{} with coordinates that are not finite (first: {})", nonFinite, firstNonFinite));
  if (flat > 0) reasons.push_back(fmt::format("{} of zero area (first: {})", flat, firstFlat));
  if (reasons.empty()) return;
  const std::string text = fmt::format("{}: {} of {} triangles are bad: {}", file.string(), nonFinite + flat,
                                       triangles, fmt::join(reasons, ", "));
  if (strict) throw Error(text + "; refused under --strict");
  if (nonFinite + flat == triangles) throw Error(text + "; no triangle is left");
  logWarning("{}; dropped", text);
}

FinishedMesh finished(IndexedMesh mesh, const ModelOptions& options, const std::string& place,
                      TriangleFindings& findings) {
  FinishedMesh result;
  result.mesh = std::move(mesh);
  dropBadTriangles(result.mesh, place, findings);
  if (result.mesh.indices.size() < result.mesh.positions.size()) compact(result);
  if (options.crease || !keepNormals(result.mesh))
    generateNormals(result, options.crease.value_or(kDefaultCrease));
  if (result.mesh.texcoords.empty()) {
    result.mesh.texcoords.assign(result.mesh.positions.size(), glm::vec2(0.0f));
  } else {
    inParallel(result.mesh.texcoords.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        glm::vec2& texcoord = result.mesh.texcoords[v];
        if (!std::isfinite(texcoord.x) || !std::isfinite(texcoord.y)) texcoord = glm::vec2(0.0f);
      }
    });
  }
  // Unused vertices may be anything in the file.
  inParallel(result.mesh.positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      if (!isFinite(result.mesh.positions[v])) result.mesh.positions[v] = glm::vec3(0.0f);
  });
  return result;
}

void append(Model& model, FinishedMesh finished, int material) {
  IndexedMesh& mesh = finished.mesh;
  ModelObject& object = model.objects.back();
  const auto firstVertex = static_cast<std::uint32_t>(model.positions.size());
  const auto firstIndex = static_cast<std::uint32_t>(model.indices.size());
  const auto indexCount = static_cast<std::uint32_t>(mesh.indices.size());
  if (model.positions.empty()) {
    model.positions = std::move(mesh.positions);
    model.normals = std::move(mesh.normals);
    model.texcoords = std::move(mesh.texcoords);
    model.indices = std::move(mesh.indices);
  } else {
    const auto add = [](auto& all, const auto& more) { all.insert(all.end(), more.begin(), more.end()); };
    add(model.positions, mesh.positions);
    add(model.normals, mesh.normals);
    add(model.texcoords, mesh.texcoords);
    for (const std::uint32_t index : mesh.indices) model.indices.push_back(index + firstVertex);
  }
  object.vertexCount = static_cast<std::uint32_t>(model.positions.size()) - object.firstVertex;
  if (indexCount == 0) return;
  if (!object.parts.empty() && object.parts.back().material == material)
    object.parts.back().indexCount += indexCount;
  else
    object.parts.push_back({material, firstIndex, indexCount});
}

}  // namespace lumivox
