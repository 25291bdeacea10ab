// The content of a scene text before any model is read. It keeps source places, so that problems found in
// models are reported at their lines.
#pragma once

#include <array>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/dsl/document.h"
#include "lumivox/scene/scene.h"

namespace lumivox {

/// A word in the text with its place.
struct PlacedText {
  std::string text;
  SourcePlace place;
  int length = 1;
};

/// Part or MTL material of a mesh, as a pattern; without both: everything.
struct Selection {
  std::optional<PlacedText> part, mtl;
  SourcePlace place;
};

struct MeshText {
  std::string name;
  PlacedText file;
  std::optional<std::string> material;
  std::vector<std::pair<Selection, std::string>> uses;  ///< parts and their materials
  std::vector<Selection> without;
  std::optional<double> crease;  ///< rad
  glm::dmat4 placement{1.0};
  struct Sequence {
    int first = 0, last = 0;
    double framesPerSecond = 24.0;
    bool loop = true;
  };
  std::optional<Sequence> sequence;
  std::optional<std::string> animation;  ///< of the model file, by name
  bool loop = true;                      ///< of the model file's animation
  bool isSound = true;  ///< false: the text has findings on it, and only its file can be looked at
};

struct MaterialText {
  Material material;
  std::optional<PlacedText> texture, mask;
};

struct MediumText {
  Medium medium;
  std::optional<PlacedText> file, grid;
  SourcePlace place;
};

/// Where a capture is and how it is read.
struct CaptureText {
  std::string name;
  SourcePlace place;
  std::optional<PlacedText> folder, file, files;  ///< exactly one
  std::optional<std::string> format;
  std::optional<double> depthScale;
  std::optional<glm::dvec2> focal, centre;  ///< pixels; a negative focal.y: y runs up
  std::array<double, 5> distortion{};
  bool linear = false;
  double exposure = 1.0;  ///< W/(sr m^2)
  std::optional<std::pair<int, int>> range;
  double rate = 30.0;
  glm::dquat rotation{1, 0, 0, 0};  ///< of the capture's world
  glm::dvec3 translation{0};
  std::optional<PlacedText> standsFor;
  const PlacedText& source() const { return folder ? *folder : file ? *file : *files; }
};

struct AreaLightText {
  std::string name;
  PlacedText mesh;
  glm::vec3 radiance{0.0f};
};

/// Motion of a mesh or of objects. Lights and cameras hold theirs.
struct AnimationText {
  PlacedText target;
  RigidMotion motion;
  bool hasPivot = false;
};

/// An environment map; without a file the environment is constant.
struct EnvironmentText {
  std::optional<PlacedText> file;
  glm::dmat3 rotation{1.0};
  double scale = 1.0;
};

/// A camera that is one of a model file.
struct ModelCameraText {
  std::size_t camera = 0;  ///< into SceneDescription::cameras
  PlacedText from;         ///< MESH/CAMERA
};

struct SceneDescription {
  std::string name;
  std::vector<Camera> cameras;
  std::vector<ModelCameraText> modelCameras;
  std::vector<MaterialText> materials;
  std::vector<MeshText> meshes;
  std::vector<AreaLightText> areaLights;
  std::vector<Light> lights;
  glm::vec3 environment{0.0f};
  EnvironmentText environmentMap;
  std::vector<MediumText> media;
  std::vector<AnimationText> animations;
  std::set<std::string> animatedCameras;  ///< by blocks `animate`
  std::vector<CaptureText> captures;
};

/// Checks a parsed text against the grammar and its references; appends to `findings`. The result is complete
/// only without findings. Otherwise it lacks refused blocks, except for the names and files of refused
/// meshes, materials and media, and may lack named materials.
SceneDescription describeScene(const dsl::Document& document, std::vector<Diagnostic>& findings);

/// File name endings of readable formats.
inline const std::vector<std::string> kModelFormats{".obj", ".obj.gz", ".gltf", ".glb", ".ply", ".ply.gz"};
inline const std::vector<std::string> kGltfFormats{".gltf", ".glb"}, kPlyFormats{".ply", ".ply.gz"};
inline const std::vector<std::string> kImageFormats{".png", ".jpg", ".jpeg", ".tga"};
inline const std::vector<std::string> kVolumeFormats{".vdb"};
inline const std::vector<std::string> kSensorFormats{".sens"}, kFloatImageFormats{".exr"},
    kSceneFormats{".scene"}, kEnvironmentFormats{".exr", ".hdr"};
bool hasFormat(const std::string& name, const std::vector<std::string>& formats);

/// Whether `name` matches a pattern, in which * stands for any letters and ? for one.
bool matches(const std::string& pattern, const std::string& name);
/// The mesh in "mesh" or "mesh/object".
std::string meshOf(const std::string& path);

}  // namespace lumivox
