// A scene at one time for ray tracing: all triangles in world space in one Embree scene, with their shading
// data.
#pragma once

#include <embree3/rtcore.h>

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <vector>

#include "lumivox/scene/scene.h"
#include "reference/texture.h"

namespace lumivox::reference {

/// Shading data of a triangle: two adjacent cache lines. Only curved or textured triangles use the second.
struct alignas(64) TriangleRecord {
  glm::vec3 corner;        ///< first vertex, metres relative to the snapshot's origin
  glm::vec3 edge1, edge2;  ///< from the first to the second and third vertex
  glm::vec3 normal;        ///< geometric, unit length, on the front (counter-clockwise) side
  float offset;            ///< m; rays leave the surface from this far above it (see selfIntersectionOffset)
  std::uint32_t material;  ///< index into RayScene::materials
  float emitterDensity;  ///< 1/m^2: density at which light sampling picks points of this triangle; 0 when it
                         ///< emits nothing
  std::uint32_t interpolate;  ///< nonzero: the vertices' normals differ from the geometric normal
  glm::vec3 normals[3];       ///< of the vertices, unit length or zero
  glm::vec2 texcoords[3];

  glm::vec2 texcoordAt(float u, float v) const {
    return (1.0f - u - v) * texcoords[0] + u * texcoords[1] + v * texcoords[2];
  }
};
static_assert(sizeof(TriangleRecord) == 128);

/// A material for the path tracer.
struct SurfaceMaterial {
  glm::vec3 diffuse, specular, emission;
  float exponent;
  const Texture* diffuseTexture;
  const Texture* maskTexture;
  bool glossy, emissive;
  bool real = false;  ///< of an object of the scene that a capture stands for
};

struct Hit {
  std::uint32_t triangle;
  float u, v;      ///< barycentric coordinates of the second and third vertex
  float distance;  ///< in lengths of the ray's direction
};

/// A point of a surface seen from one side. Both normals are on the viewer's side, so no light passes through
/// a surface.
struct Surface {
  glm::vec3 position;         ///< offset from the surface to the viewer's side: the origin of rays
  glm::vec3 geometricNormal;  ///< unit, on the viewer's side
  glm::vec3 normal;           ///< interpolated, unit, turned to the side of geometricNormal
  glm::vec3 diffuse;          ///< albedo; without the texture until readTexture() has been called
  glm::vec3 specular;
  glm::vec3 mirror;  ///< mirror direction of the viewing direction; set where glossy
  float exponent;
  float glossyProbability;  ///< of choosing the Phong lobe when sampling; set where glossy
  bool glossy;
  const Texture* texture;
  Texture::Place place;  ///< in the texture, where there is one

  /// Multiplies the albedo by the texture. Separate, because texels come from main memory: they arrive while
  /// a shadow ray is traced.
  void readTexture() {
    if (texture != nullptr) diffuse *= texture->read(place);
  }
};

class RayScene {
 public:
  RayScene(const Scene& scene, const SceneSnapshot& snapshot);
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  /// The nearest surface along the ray that is not cut out by a mask.
  bool closestHit(const glm::vec3& origin, const glm::vec3& direction, Hit& hit) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit ray;
    setRay(ray.ray, origin, direction, std::numeric_limits<float>::infinity());
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    hit = {ray.hit.primID + (ray.hit.geomID == kMaskedGeometry ? maskedBegin_ : 0u), ray.hit.u, ray.hit.v,
           ray.ray.tfar};
    return true;
  }

  /// Whether a surface lies between the origin and `reach` lengths of the direction.
  bool occluded(const glm::vec3& origin, const glm::vec3& direction, float reach) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay ray;
    setRay(ray, origin, direction, reach);
    rtcOccluded1(scene_.get(), &context, &ray);
    return ray.tfar < 0.0f;
  }

  /// The surface at a hit, seen from a ray with this unit direction. Filled in place, since a copy would
  /// stall on its many separately written members.
  void surfaceAt(const Hit& hit, const glm::vec3& direction, Surface& surface) const;

  /// Emitted radiance towards a ray with this direction: from the front side only.
  glm::vec3 emissionTowards(const TriangleRecord& triangle, const glm::vec3& direction) const {
    const bool shines = triangle.emitterDensity > 0.0f && glm::dot(triangle.normal, direction) < 0.0f;
    return shines ? materials[triangle.material].emission : glm::vec3(0.0f);
  }

  /// Whether the hit surface is of the scene that a capture stands for.
  bool isReal(const Hit& hit) const { return materials[triangles[hit.triangle].material].real; }

  /// Whether a mask cuts the surface out at this point of a triangle.
  bool cutOut(std::uint32_t triangle, float u, float v) const;

  std::vector<TriangleRecord> triangles;  ///< those without a mask first
  std::vector<SurfaceMaterial> materials;
  RTCScene embree() const { return scene_.get(); }

  static void setRay(RTCRay& ray, const glm::vec3& origin, const glm::vec3& direction, float reach) {
    ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
    ray.tnear = 0.0f;
    ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
    ray.time = 0.0f;
    ray.tfar = reach;
    ray.mask = ~0u, ray.id = 0u, ray.flags = 0u;
  }

 private:
  static constexpr unsigned kPlainGeometry = 0, kMaskedGeometry = 1;

  void collect(const Scene& scene, const SceneSnapshot& snapshot);
  void build();
  void attach(unsigned geometryId, std::uint32_t begin, std::uint32_t end);
  static void filter(const RTCFilterFunctionNArguments* arguments);

  struct Release {
    void operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
    void operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }
  };
  std::vector<Texture> textures_;
  std::vector<glm::vec3> vertices_;     ///< with one more at the end: Embree reads 16 bytes at each
  std::vector<std::uint32_t> corners_;  ///< three vertices per triangle
  std::uint32_t maskedBegin_ = 0;
  std::unique_ptr<RTCDeviceTy, Release> device_;
  std::unique_ptr<RTCSceneTy, Release> scene_;
};

}  // namespace lumivox::reference
