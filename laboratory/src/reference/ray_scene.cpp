#include "reference/ray_scene.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cassert>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox::reference {
namespace {

/// How far above a triangle rays start, so that rounding never puts the start below it. The vertices, the
/// interpolated point and Embree's differences each carry an error of about one unit in the last place
/// (2^-23) of the largest coordinate or of the triangle's extent; the factor of 16 covers their sum with room
/// to spare and stays below 2e-6 of the scene.
float selfIntersectionOffset(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  constexpr float kUnitsInLastPlace = 16.0f * 0x1.0p-23f;
  float largest = std::numeric_limits<float>::min();
  for (int axis = 0; axis < 3; ++axis) {
    largest = std::max({largest, std::abs(a[axis]), std::abs(b[axis]), std::abs(c[axis])});
  }
  return kUnitsInLastPlace * largest;
}

void throwOnEmbreeError(RTCDevice device, const char* step) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw Error(fmt::format("reference: not enough memory to {}", step));
  throw Error(fmt::format("reference: Embree failed to {} (error code {})", step, static_cast<int>(error)));
}

/// A triangle that rays can hit: its vertices and material.
struct CollectedTriangle {
  std::uint32_t corner[3];
  std::uint32_t material;
};

}  // namespace

RayScene::RayScene(const Scene& scene, const SceneSnapshot& snapshot) {
  textures_.reserve(scene.textures.size());
  for (const SurfaceTexture& texture : scene.textures) textures_.emplace_back(texture);
  materials.reserve(scene.materials.size());
  for (const Material& material : scene.materials) {
    const auto textureAt = [&](int index) {
      return index < 0 ? nullptr : &textures_.at(static_cast<std::size_t>(index));
    };
    materials.push_back({material.diffuse, material.specular, material.emission, material.exponent,
                         textureAt(material.diffuseTexture), textureAt(material.maskTexture),
                         material.glossy(), material.emissive()});
  }
  for (const Object& object : scene.objects)
    for (const Part& part : object.parts)
      materials.at(static_cast<std::size_t>(part.material)).real = object.real;
  collect(scene, snapshot);
  build();
}

void RayScene::collect(const Scene& scene, const SceneSnapshot& snapshot) {
  assert(snapshot.objects.size() == scene.objects.size());
  // Per triangle: its record, three indices and about 200 bytes of Embree's tree while it is built.
  constexpr std::uint64_t kBytesPerTriangle = sizeof(TriangleRecord) + 12 + 200;
  requireMemory(scene.triangleCount() * kBytesPerTriangle, "the reference path tracer's triangles");

  std::vector<CollectedTriangle> plain, masked;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec2> texcoords;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    const ObjectState& state = snapshot.objects[i];
    const std::uint32_t base = static_cast<std::uint32_t>(vertices_.size());
    const bool deformed = !state.positions.empty();
    for (std::uint32_t k = 0; k < object.vertexCount; ++k) {
      const std::uint32_t source = object.firstVertex + k;
      const glm::vec3 position = deformed ? state.positions[k] : scene.positions[source];
      const glm::vec3 normal = deformed && !state.normals.empty() ? state.normals[k] : scene.normals[source];
      vertices_.push_back(glm::vec3(state.toWorld * glm::vec4(position, 1.0f)));
      const glm::vec3 turned = state.normalToWorld * normal;
      const float length = glm::length(turned);
      normals.push_back(length > 0.0f ? turned / length : glm::vec3(0.0f));
      texcoords.push_back(scene.texcoords[source]);
    }
    for (const Part& part : object.parts) {
      const bool cut = scene.materials[static_cast<std::size_t>(part.material)].maskTexture >= 0;
      for (std::uint32_t k = part.firstIndex; k + 2 < part.firstIndex + part.indexCount; k += 3) {
        const auto vertex = [&](std::uint32_t n) {
          assert(scene.indices[k + n] - object.firstVertex < object.vertexCount);
          return scene.indices[k + n] - object.firstVertex + base;
        };
        (cut ? masked : plain)
            .push_back({{vertex(0), vertex(1), vertex(2)}, static_cast<std::uint32_t>(part.material)});
      }
    }
  }

  triangles.reserve(plain.size() + masked.size());
  corners_.reserve(3 * (plain.size() + masked.size()));
  const auto append = [&](const CollectedTriangle& triangle) {
    const auto [a, b, c] = triangle.corner;
    const glm::vec3 edge1 = vertices_[b] - vertices_[a], edge2 = vertices_[c] - vertices_[a];
    const glm::dvec3 cross = glm::cross(glm::dvec3(edge1), glm::dvec3(edge2));
    const double length = glm::length(cross);
    if (!(length > 0.0)) return;  // no area, so no ray hits it
    const glm::vec3 normal(cross / length);
    // Vertex normals within 0.08 degrees of the geometric one (cosine 1 - 1e-6) differ by rounding, not by
    // curvature.
    const auto bent = [&](std::uint32_t vertex) {
      return normals[vertex] != glm::vec3(0.0f) && glm::dot(normals[vertex], normal) < 1.0f - 1e-6f;
    };
    triangles.push_back({vertices_[a],
                         edge1,
                         edge2,
                         normal,
                         selfIntersectionOffset(vertices_[a], vertices_[b], vertices_[c]),
                         triangle.material,
                         0.0f,
                         bent(a) || bent(b) || bent(c) ? 1u : 0u,
                         {normals[a], normals[b], normals[c]},
                         {texcoords[a], texcoords[b], texcoords[c]}});
    corners_.insert(corners_.end(), {a, b, c});
  };
  std::for_each(plain.begin(), plain.end(), append);
  maskedBegin_ = static_cast<std::uint32_t>(triangles.size());
  std::for_each(masked.begin(), masked.end(), append);
  vertices_.emplace_back(0.0f);
}

void RayScene::build() {
  device_.reset(rtcNewDevice(nullptr));
  if (device_ == nullptr) throw Error("reference: Embree cannot be started on this processor");
  scene_.reset(rtcNewScene(device_.get()));
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);  // watertight: no light between adjoining triangles
  rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_HIGH);
  attach(kPlainGeometry, 0, maskedBegin_);
  attach(kMaskedGeometry, maskedBegin_, static_cast<std::uint32_t>(triangles.size()));
  // One thread builds, so that the tree, and with it the choice among hits at equal distance, does not depend
  // on the number of threads. (Embree's own setting "threads=1" would hold for all of TBB as long as the
  // device lives.)
  tbb::task_arena(1).execute([&] { rtcJoinCommitScene(scene_.get()); });
  throwOnEmbreeError(device_.get(), "build the tree over the triangles");
}

void RayScene::attach(unsigned geometryId, std::uint32_t begin, std::uint32_t end) {
  if (begin == end) return;
  RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices_.data(), 0,
                             sizeof(glm::vec3), vertices_.size() - 1);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, corners_.data(),
                             std::size_t{begin} * 3 * sizeof(std::uint32_t), 3 * sizeof(std::uint32_t),
                             end - begin);
  if (geometryId == kMaskedGeometry) {
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryIntersectFilterFunction(geometry, filter);
    rtcSetGeometryOccludedFilterFunction(geometry, filter);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_.get(), geometry, geometryId);
  rtcReleaseGeometry(geometry);
  throwOnEmbreeError(device_.get(), "commit the triangles");
}

void RayScene::filter(const RTCFilterFunctionNArguments* arguments) {
  const auto& self = *static_cast<const RayScene*>(arguments->geometryUserPtr);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    const std::uint32_t triangle = RTCHitN_primID(arguments->hit, arguments->N, i) + self.maskedBegin_;
    if (self.cutOut(triangle, RTCHitN_u(arguments->hit, arguments->N, i),
                    RTCHitN_v(arguments->hit, arguments->N, i))) {
      arguments->valid[i] = 0;
    }
  }
}

bool RayScene::cutOut(std::uint32_t triangle, float u, float v) const {
  const Texture* mask = materials[triangles[triangle].material].maskTexture;
  if (mask == nullptr) return false;
  return mask->read(mask->find(triangles[triangle].texcoordAt(u, v))).x < kMaskThreshold;
}

void RayScene::surfaceAt(const Hit& hit, const glm::vec3& direction, Surface& surface) const {
  const TriangleRecord& triangle = triangles[hit.triangle];
  const SurfaceMaterial& material = materials[triangle.material];
  const float side = -std::copysign(1.0f, glm::dot(triangle.normal, direction));
  surface.geometricNormal = side * triangle.normal;

  // Points stay slightly inside their triangle, so that rounding never moves a point on an edge behind the
  // adjoining surface: 2^-18 of the triangle's extent exceeds the rounding of its coordinates.
  constexpr float kInset = 0x1.0p-18f;
  float u = std::max(hit.u, kInset), v = std::max(hit.v, kInset);
  if (u + v > 1.0f - kInset) {
    const float scale = (1.0f - kInset) / (u + v);
    u *= scale, v *= scale;
  }
  surface.position =
      triangle.corner + u * triangle.edge1 + v * triangle.edge2 + triangle.offset * surface.geometricNormal;

  surface.normal = surface.geometricNormal;
  if (triangle.interpolate != 0) {
    const glm::vec3 sum =
        (1.0f - u - v) * triangle.normals[0] + u * triangle.normals[1] + v * triangle.normals[2];
    const float squared = glm::dot(sum, sum);
    if (squared > 0.0f) {
      const float facing = glm::dot(sum, surface.geometricNormal) < 0.0f ? -1.0f : 1.0f;
      surface.normal = (facing / std::sqrt(squared)) * sum;
    }
  }

  surface.diffuse = material.diffuse;
  surface.texture = material.diffuseTexture;
  if (surface.texture != nullptr) {
    surface.place = surface.texture->find(triangle.texcoordAt(u, v));
  }
  surface.glossy = material.glossy;
  if (surface.glossy) {
    surface.specular = material.specular;
    surface.exponent = material.exponent;
    surface.mirror = direction - 2.0f * glm::dot(direction, surface.normal) * surface.normal;
    const float diffuse = surface.diffuse.x + surface.diffuse.y + surface.diffuse.z;
    const float specular = surface.specular.x + surface.specular.y + surface.specular.z;
    surface.glossyProbability = specular / (diffuse + specular);
  }
}

}  // namespace lumivox::reference
