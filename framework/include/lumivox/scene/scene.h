// A scene: geometry, materials, lights, cameras and their motion. Everything is physical and linear: metres,
// seconds, radians, W, Rec. 709 primaries with independent channels; Y up, right-handed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lumivox/base/hash.h"
#include "lumivox/scene/capture.h"
#include "lumivox/scene/environment.h"

namespace lumivox {

/// An image that modulates a material, decoded to linear values (diffuse maps) or as stored (masks).
struct SurfaceTexture {
  std::string name;  ///< path as written in the material file
  int width = 0, height = 0;
  bool mask = false;  ///< one channel, a coverage mask; otherwise linear RGB
  std::vector<float>
      values;  ///< width*height*(mask ? 1 : 3); row 0 is the top of the image (texture coordinate v = 1)
  bool operator==(const SurfaceTexture&) const = default;
};

/// Lambert `diffuse/pi` plus Phong `specular (n+2)/(2 pi) max(0, cos a)^n`, a from the mirror direction; with
/// n = 0 the lobe is constant where cos a > 0 and 0 elsewhere. Two-sided.
struct Material {
  std::string name;
  glm::vec3 diffuse{0.0f};   ///< albedo; multiplied by the diffuse texture
  glm::vec3 specular{0.0f};  ///< Phong albedo at normal incidence
  float exponent = 1.0f;     ///< Phong n >= 0
  glm::vec3 emission{0.0f};  ///< emitted radiance, W/(sr m^2), front side only
  int diffuseTexture = -1;   ///< index into Scene::textures, -1 for none
  int maskTexture = -1;      ///< coverage below 0.5 is a hole
  bool glossy() const { return specular != glm::vec3(0.0f); }
  bool emissive() const { return emission != glm::vec3(0.0f); }
  bool operator==(const Material&) const = default;
};

/// A run of triangles of one object with one material.
struct Part {
  int material = 0;
  std::uint32_t firstIndex = 0;  ///< into Scene::indices
  std::uint32_t indexCount = 0;  ///< three per triangle
  bool operator==(const Part&) const = default;
};

/// Rigid motion about a point, as functions of the time in seconds; parts add up in the order translate after
/// rotate.
struct RigidMotion {
  glm::dvec3 axis{0, 1, 0};
  double angularSpeed = 0.0;  ///< rad/s
  glm::dvec3 pivot{0};        ///< of the rotation, in metres, world space before motion
  glm::dvec3 velocity{0};     ///< m/s
  bool operator==(const RigidMotion&) const = default;
};

/// Whole vertex sets of a deforming object at equal steps of time; between them positions are interpolated
/// linearly.
struct VertexSequence {
  double framesPerSecond = 24.0;
  bool loop = true;
  std::vector<std::vector<glm::vec3>> positions;  ///< [frame][vertex of the object]
  std::vector<std::vector<glm::vec3>> normals;
  bool operator==(const VertexSequence&) const = default;
};

/// Motion that a model file brings along: of nodes, by morph targets and by skins (scene/model_animation.h).
class ModelAnimation;

/// A named piece of geometry that moves as one: "room/tall_box" is the object or group tall_box of the mesh
/// block room.
struct Object {
  std::string name;
  std::uint32_t firstVertex = 0, vertexCount = 0;  ///< into Scene::positions
  std::vector<Part> parts;
  glm::dmat4 placement{1.0};  ///< object to world, before motion
  std::optional<RigidMotion> motion;
  std::optional<VertexSequence> sequence;
  std::shared_ptr<const ModelAnimation> animation;  ///< null where the model file brings none
  /// World bounds (low, high) of the placed vertices before motion; the loader fills them in, so that no
  /// frame computes them again. Computed whenever they are needed when absent.
  std::optional<std::pair<glm::dvec3, glm::dvec3>> placedBounds;
  /// World bounds (low, high) of everything that it covers while it turns and deforms, before it travels.
  /// Filled in by the loader like placedBounds.
  std::optional<std::pair<glm::dvec3, glm::dvec3>> sweptBounds;
  bool real = false;  ///< of the scene that a capture stands for: the reference alone has such objects
  bool animated() const { return motion.has_value() || sequence.has_value() || animation != nullptr; }
  bool operator==(const Object&) const = default;
};

enum class LightKind { directional, point, spot };

/// How the keys of an animation are joined: linearly, or each value stays until the next key.
enum class Interpolation { linear, step };

/// What a light is at a time. A key sets what it names; a value passes from key to key among those that set
/// it and stays behind the last. Before the first it is the first's, or by steps the light's own.
struct LightKey {
  double time = 0.0;  ///< s
  std::optional<glm::dvec3> position, direction;
  std::optional<glm::vec3> power;
  std::optional<float> innerAngle, outerAngle;
  bool operator==(const LightKey&) const = default;
};

/// Keys first; then the rigid motion turns and moves place and direction.
struct LightMotion {
  std::optional<RigidMotion> rigid;
  std::vector<LightKey> keys;  ///< in rising order of time
  Interpolation interpolation = Interpolation::linear;
  bool operator==(const LightMotion&) const = default;
};

/// A light without extent. Lights with extent are emissive triangles (Material::emission); the sky is
/// Environment.
struct Light {
  std::string name;
  LightKind kind = LightKind::directional;
  glm::dvec3 position{0};          ///< point, spot; metres
  glm::dvec3 direction{0, -1, 0};  ///< the way the light travels, unit length; directional, spot
  glm::vec3 power{
      0.0f};  ///< directional: irradiance on a perpendicular plane, W/m^2; point, spot: intensity, W/sr
  float innerAngle = 0.0f;  ///< spot, half angle of full intensity, rad
  float outerAngle =
      0.0f;  ///< spot, half angle where it ends, rad; intensity * smoothstep(cos outer, cos inner, cos theta)
  std::optional<LightMotion> motion = std::nullopt;
};

struct CameraKey {
  double time = 0.0;  ///< s
  glm::dvec3 eye{0}, target{0};
  std::optional<double> fov = std::nullopt;  ///< rad; without it the camera's
};

/// Pinhole or thin lens, with square pixels. With keys, eye, target and fov are interpolated in time and
/// clamp at the ends; then the rigid motion turns and moves the whole camera.
struct Camera {
  std::string name;
  glm::dvec3 eye{0, 0, 1}, target{0}, up{0, 1, 0};
  double fov = 0.7;  ///< full vertical angle, rad
  int width = 256, height = 256;
  double aperture = 0.0;  ///< diameter of the lens, m; 0: a pinhole
  double focus =
      0.0;  ///< distance of the plane in focus along the view axis, m; above 0 where there is a lens
  std::vector<CameraKey> keys;
  Interpolation interpolation = Interpolation::linear;  ///< of the keys
  std::optional<RigidMotion> motion;
  /// Index into Scene::captures: the camera stands where that capture's camera stood, and eye, target, up,
  /// fov, lens and keys do not count. -1 for none.
  int capture = -1;
};

/// Densities at the centres of cubic voxels in world space: trilinear between the centres, zero outside.
struct DensityVolume {
  glm::dvec3 low{0};  ///< corner of voxel (0,0,0), m
  double voxelSize = 1.0;
  glm::ivec3 resolution{0};
  std::vector<float> values;  ///< not negative; x fastest, then y
};

/// A participating medium: extinction and scattering are its density times constants. The density is 1 in a
/// box (homogeneous), the sum of the clouds of rising particles, or that of a volume file. Scattering is
/// Henyey-Greenstein's. See scene/medium.h.
struct Medium {
  std::string name;
  glm::vec3 extinction{0.0f};  ///< sigma_t at density 1, 1/m
  glm::vec3 albedo{0.0f};      ///< sigma_s / sigma_t
  float anisotropy = 0.0f;     ///< Henyey-Greenstein mean cosine g
  /// Of a homogeneous medium: corners of its box, m; without it the bounds of the scene.
  std::optional<std::pair<glm::dvec3, glm::dvec3>> box;
  int particles = 0;                            ///< how many; 0: the medium has none
  glm::dvec3 source{0};                         ///< middle of the place where particles start, m
  double spread = 0.0;                          ///< farthest start from the source along each axis, m
  double radius = 0.0;                          ///< of the cloud of one particle, m
  double rise = 0.0;                            ///< speed upwards, m/s
  double drift = 0.0;                           ///< largest other speed along each axis, m/s
  double life = 1.0;                            ///< s, after which a particle is reborn at the source
  std::uint32_t seed = 1;                       ///< of the particles' random numbers
  std::shared_ptr<const DensityVolume> volume;  ///< of a volume file; else null
  bool homogeneous() const { return particles == 0 && volume == nullptr; }
  bool operator==(const Medium&) const = default;
};

struct Scene {
  std::string name;            ///< the string in the text
  std::filesystem::path file;  ///< the scene text it came from; empty when made by code
  ContentHash hash;  ///< of the text, every file that it includes and every model, material and image file

  std::vector<glm::vec3> positions, normals;  ///< object space; same length; normals unit length
  std::vector<glm::vec2> texcoords;           ///< same length; (0,0) is the lower left of a texture
  std::vector<std::uint32_t> indices;         ///< absolute, into the arrays above
  std::vector<Object> objects;
  std::vector<Material> materials;
  std::vector<SurfaceTexture> textures;
  std::vector<Light> lights;
  std::vector<Camera> cameras;  ///< at least one
  /// Radiance of the sky, W/(sr m^2): constant over the sphere, or the mean of the map.
  glm::vec3 environment{0.0f};
  std::shared_ptr<const EnvironmentMap> environmentMap;  ///< null: the environment is constant
  std::vector<Medium> media;
  std::vector<std::shared_ptr<const Capture>> captures;

  std::size_t triangleCount() const { return indices.size() / 3; }
  const Camera& camera(
      const std::string& wanted = {}) const;  ///< first when empty; Error listing the names otherwise
};

/// Features of a scene, and so what a pipeline can leave out. Computed from the content, never declared.
struct SceneTraits {
  bool triangles = false, textures = false, masks = false, glossy = false, emission = false,
       environment = false, environmentMap = false, medium = false, particles = false, captures = false;
  bool movingGeometry = false, movingCamera = false, movingLights = false,
       movingCaptures = false;  ///< movingCaptures: one of more than one frame
  int directionalLights = 0, pointLights = 0, spotLights = 0,
      areaLights = 0;  ///< area: objects with emissive parts

  static SceneTraits of(const Scene& scene);
  static SceneTraits everything();  ///< all present, for --keep-everything
  bool operator==(const SceneTraits&) const = default;
};

/// One camera as the renderers need it: relative to SceneSnapshot::origin, orthonormal basis.
struct CameraView {
  glm::vec3 eye{0.0f}, right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
  float tanHalfFov = 0.5f;  ///< of the vertical angle
  int width = 0, height = 0;
  /// Where rays pass the image plane, right and down from where they would, in pixels: samples of a pixel
  /// beside its centre. Renderers that take directions from direction() heed it; rasterisers move what they
  /// draw the other way.
  glm::vec2 shift{0.0f};
  /// Of the thin lens around the eye, perpendicular to the view axis, m: its diameter, and the distance of
  /// the plane in focus. All rays of one point of the image meet in that plane where the ray through the eye
  /// does. An aperture of 0 is a pinhole, whatever the focus.
  float aperture = 0.0f, focus = 0.0f;
  bool operator==(const CameraView&) const = default;

  /// Direction (not normalised, forward component 1) through a point of the image; (0,0) is the upper left
  /// corner, (width,height) the lower right.
  glm::vec3 direction(float x, float y) const;
};

struct ObjectState {
  glm::mat4 toWorld{1.0f};        ///< object space to metres relative to the snapshot's origin
  glm::mat3 normalToWorld{1.0f};  ///< inverse transpose of its upper part
  std::vector<glm::vec3> positions,
      normals;  ///< only for deforming objects: object space at this time; else empty
};

struct LightState {
  LightKind kind;
  glm::vec3 position, direction, power;
  float innerAngle, outerAngle;
  bool operator==(const LightState&) const = default;
};

struct Bounds {
  glm::vec3 low{0.0f}, high{0.0f};
  bool empty = true;
  void grow(const glm::vec3& point);
};

/// A scene at one time. All positions are in metres relative to `origin`, so that a scene far from the
/// world's origin loses no precision: the subtraction happens in double precision, here and only here.
struct SceneSnapshot {
  double time = 0.0;  ///< s
  glm::dvec3 origin{0};
  CameraView camera;
  std::vector<LightState> lights;
  std::vector<ObjectState> objects;    ///< parallel to Scene::objects
  std::vector<CaptureState> captures;  ///< parallel to Scene::captures
  Bounds bounds;                       ///< of all triangles
  /// Bounds for grids around the scene, so that a grid stays where it is while things move: of everything
  /// that the objects cover while they turn and deform; where they travel, grown in steps. A function of the
  /// time alone.
  Bounds gridBounds;
};

/// The bounds of an object over a whole turn and its whole sequence of deformations, without its travel: what
/// the loader keeps as Object::sweptBounds. The object must have vertices.
std::pair<glm::dvec3, glm::dvec3> sweptBoundsOf(const Scene& scene, const Object& object);

/// Distance within which ambient occlusion looks for surfaces by default, m: a tenth of the diagonal
/// of the scene's bounds; 0 without a triangle.
double ambientOcclusionDistance(const Bounds& bounds);

/// Evaluates motion. `origin` is the centre of the static scene's bounds (of everything at rest, before
/// motion, where nothing is static), the same for all times. `width`/`height` of 0 keep the camera's
/// resolution.
SceneSnapshot snapshotOf(const Scene& scene, double time, const std::string& camera = {}, int width = 0,
                         int height = 0);

struct SceneLoadOptions {
  std::vector<std::filesystem::path>
      assetPath;  ///< --assets; then $LUMIVOX_ASSETS, then ../shared/models beside the project
  /// Refuse bad triangles in place of dropping them with a warning; refuse missing material files and unknown
  /// materials in place of a warning and grey 0.8; refuse maps and statements that are not used.
  bool strict = false;
  bool mayHoldCaptures = true;  ///< false for the scene that a capture stands for
};

/// Reads a scene text and everything that it names. Of MTL materials Kd, Ks, Ns, Ke, map_Kd, d and map_d are
/// used as given: map_d is taken from the image's alpha, or its first channel where it has none, times d; a
/// surface without map_d and with d below a half is a hole, so its triangles are left out. Normals that are
/// missing are smooth where faces meet at up to 30 degrees (`crease`). Throws DiagnosticsError with all
/// findings of the text, Error for a bad model or image file, AbsentError for a model that is on no search
/// path (the message lists where it was sought).
Scene loadScene(const std::filesystem::path& file, const SceneLoadOptions& options = {});

/// Loads like loadScene(), but goes on behind each finding; DiagnosticsError with all of them, each at its
/// line. An absent model is a finding too. Warnings are logged with their places (base/findings.h).
void checkScene(const std::filesystem::path& file, const SceneLoadOptions& options = {});

}  // namespace lumivox
