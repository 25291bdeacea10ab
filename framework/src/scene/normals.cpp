#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "scene/model.h"

namespace lumivox {
namespace {

struct FaceGeometry {
  std::vector<glm::dvec3> normal;  // unit, or zero for a face without area
  std::vector<double> angle;       // at each corner
};

FaceGeometry faceGeometry(const std::vector<glm::vec3>& positions,
                          const std::vector<std::uint32_t>& triangles) {
  const std::size_t faces = triangles.size() / 3;
  FaceGeometry result;
  result.normal.resize(faces);
  result.angle.resize(triangles.size());
  for (std::size_t face = 0; face < faces; ++face) {
    const glm::dvec3 p[3] = {positions[triangles[3 * face]], positions[triangles[3 * face + 1]],
                             positions[triangles[3 * face + 2]]};
    const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double length = glm::length(normal);
    result.normal[face] = length > 0 ? normal / length : glm::dvec3(0);
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 a = p[(k + 1) % 3] - p[k], b = p[(k + 2) % 3] - p[k];
      result.angle[3 * face + k] = std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
    }
  }
  return result;
}

struct PositionHash {
  std::size_t operator()(const glm::vec3& p) const {
    // Adding +0 maps -0 to 0, since both compare equal.
    std::uint64_t hash = 0x9E3779B97F4A7C15ull;
    for (int i = 0; i < 3; ++i)
      hash = (hash ^ std::bit_cast<std::uint32_t>(p[i] + 0.0f)) * 0xBF58476D1CE4E5B9ull;
    return static_cast<std::size_t>(hash ^ (hash >> 29));
  }
};

/// The corners at each distinct position, since files may not share vertices between neighbouring faces.
struct CornerLists {
  std::vector<std::uint32_t> start, corners, pointOfCorner;
};

CornerLists cornersAtPoints(const std::vector<glm::vec3>& positions,
                            const std::vector<std::uint32_t>& triangles) {
  std::unordered_map<glm::vec3, std::uint32_t, PositionHash> points;
  points.reserve(positions.size());
  std::vector<std::uint32_t> pointOfPosition(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    pointOfPosition[i] =
        points.emplace(positions[i], static_cast<std::uint32_t>(points.size())).first->second;
  }
  CornerLists result;
  result.start.assign(points.size() + 1, 0);
  result.pointOfCorner.resize(triangles.size());
  for (std::size_t c = 0; c < triangles.size(); ++c) {
    result.pointOfCorner[c] = pointOfPosition[triangles[c]];
    ++result.start[result.pointOfCorner[c] + 1];
  }
  for (std::size_t i = 1; i < result.start.size(); ++i) result.start[i] += result.start[i - 1];
  result.corners.resize(triangles.size());
  std::vector<std::uint32_t> next(result.start.begin(), result.start.end() - 1);
  for (std::size_t c = 0; c < triangles.size(); ++c) {
    result.corners[next[result.pointOfCorner[c]]++] = static_cast<std::uint32_t>(c);
  }
  return result;
}

}  // namespace

NormalGroups groupNormals(const std::vector<glm::vec3>& positions,
                          const std::vector<std::uint32_t>& triangles, double crease) {
  // Comparing all faces at a point is quadratic. Where more faces meet than this, they stay flat.
  constexpr std::size_t kMostFacesAtPoint = 512;
  const FaceGeometry faces = faceGeometry(positions, triangles);
  const CornerLists lists = cornersAtPoints(positions, triangles);
  // Normals in one plane differ by rounding; 1e-6 is 0.1 degrees at an angle of zero and negligible
  // elsewhere.
  const double least = std::cos(crease) - 1e-6;
  NormalGroups result;
  result.start.push_back(0);
  result.groupOfCorner.resize(triangles.size());
  std::vector<std::vector<std::uint32_t>> groupsHere;
  std::vector<std::uint32_t> members, numbers;
  for (std::size_t point = 0; point + 1 < lists.start.size(); ++point) {
    const auto first = lists.corners.begin() + lists.start[point],
               last = lists.corners.begin() + lists.start[point + 1];
    const bool crowded = static_cast<std::size_t>(last - first) > kMostFacesAtPoint;
    groupsHere.clear();
    numbers.clear();
    for (auto corner = first; corner != last; ++corner) {
      members.clear();
      for (auto other = first; other != last && !crowded; ++other) {
        if (*other == *corner || glm::dot(faces.normal[*corner / 3], faces.normal[*other / 3]) >= least)
          members.push_back(*other);
      }
      if (crowded) members.push_back(*corner);
      // Corners with the same neighbours share a normal, and so a vertex.
      const auto same = crowded ? groupsHere.end() : std::find(groupsHere.begin(), groupsHere.end(), members);
      if (same != groupsHere.end()) {
        result.groupOfCorner[*corner] = numbers[static_cast<std::size_t>(same - groupsHere.begin())];
        continue;
      }
      const auto number = static_cast<std::uint32_t>(result.start.size() - 1);
      if (!crowded) {
        groupsHere.push_back(members);
        numbers.push_back(number);
      }
      result.groupOfCorner[*corner] = number;
      result.corners.insert(result.corners.end(), members.begin(), members.end());
      result.start.push_back(static_cast<std::uint32_t>(result.corners.size()));
    }
  }
  return result;
}

std::vector<glm::vec3> groupNormalsOf(const std::vector<glm::vec3>& positions,
                                      const std::vector<std::uint32_t>& triangles,
                                      const NormalGroups& groups) {
  const FaceGeometry faces = faceGeometry(positions, triangles);
  std::vector<glm::vec3> normals(groups.start.size() - 1);
  for (std::size_t group = 0; group < normals.size(); ++group) {
    glm::dvec3 sum(0);
    for (std::uint32_t i = groups.start[group]; i < groups.start[group + 1]; ++i) {
      sum += faces.angle[groups.corners[i]] * faces.normal[groups.corners[i] / 3];
    }
    if (glm::length(sum) < 1e-6) sum = faces.normal[groups.corners[groups.start[group]] / 3];
    // A face of a deforming mesh may lose its area in some frame.
    normals[group] = glm::length(sum) > 0 ? glm::normalize(sum) : glm::dvec3(0, 1, 0);
  }
  return normals;
}

}  // namespace lumivox
