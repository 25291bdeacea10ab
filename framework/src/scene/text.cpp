#include "lumivox/scene/text.h"

#include <numbers>
#include <string_view>

#include "scene/limits.h"

namespace lumivox {
namespace {

using dsl::BlockSpecification;
using dsl::Dimension;
using dsl::HeaderUse;
using dsl::PropertySpecification;
using dsl::PropertyType;

constexpr double kDegree = std::numbers::pi / 180.0;
// The widest image of OpenGL 4.5's guaranteed minimum texture size.
constexpr double kLargestImage = 16384;
constexpr double kMostExtinction = 1e9;
constexpr double kFastest = 1e6;              // m/s
constexpr double kLargestTurn = 360.0 * 1e3;  // deg, and deg/s
constexpr double kLargestLens = 1e6, kNearestFocus = 1e-6, kFarthestFocus = 1e9;
constexpr double kSmallestScale = 1e-9, kLargestScale = 1e9;
// A limit of time and memory: sums over the particles of a voxel are 64-bit integers with 2^24 units a
// particle.
constexpr double kMostParticles = 1e7;
constexpr double kShortestLife = 1e-3, kLongestLife = 1e6;
constexpr double kLargestSeed = 4294967295.0;

/// Builds the specification of a property; its methods return it, so that a row reads as one line.
struct Row {
  PropertySpecification specification;

  Row(const char* word, PropertyType type, const char* meaning, Dimension dimension = dsl::kNoDimension) {
    specification.word = word;
    specification.type = type;
    specification.dimension = dimension;
    specification.meaning = meaning;
  }
  Row between(double low, double high) const {
    Row row = *this;
    row.specification.low = low;
    row.specification.high = high;
    return row;
  }
  Row upTo(double high) const { return between(0, high); }
  /// The symmetric range of places, directions and speeds.
  Row within(double high) const { return between(-high, high); }
  Row required() const {
    Row row = *this;
    row.specification.required = true;
    return row;
  }
  Row byDefault(const char* text) const {
    Row row = *this;
    row.specification.defaultText = text;
    return row;
  }
  operator PropertySpecification() const { return specification; }  // NOLINT: rows become table entries
};

BlockSpecification block(const char* word, HeaderUse name, const char* meaning,
                         std::vector<PropertySpecification> properties) {
  BlockSpecification result;
  result.word = word;
  result.name = name;
  result.meaning = meaning;
  result.properties = std::move(properties);
  return result;
}

Row position(const char* meaning) {
  return Row("position", PropertyType::vector3, meaning, dsl::kLength).within(kFarthestPlace);
}

Row lightDirection() {
  return Row("direction", PropertyType::vector3, "the way the light travels").within(kFarthestPlace);
}

Row intensity() {
  return Row("intensity", PropertyType::oneOrThree, "radiant intensity in W/sr").upTo(kMostLight);
}

Row irradiance() {
  return Row("irradiance", PropertyType::oneOrThree,
             "irradiance on a plane perpendicular to the light, in W/m^2")
      .upTo(kMostLight);
}

/// Of a spot light.
Row halfAngle(const char* word) {
  return Row(word, PropertyType::number,
             std::string_view(word) == "inner" ? "half angle from the axis up to which the intensity is full"
                                               : "half angle from the axis where the light ends",
             dsl::kAngle)
      .between(0, 90.0 * kDegree);
}

Row fov() {
  return Row("fov", PropertyType::number, "full vertical angle of view", dsl::kAngle)
      .between(0.1 * kDegree, 179.0 * kDegree);
}

Row interpolation() {
  Row row(
      "interpolation", PropertyType::word,
      "how keys are joined: linearly (directions are then scaled to unit length), and before the first key "
      "the value is the first key's; or by steps, and before the first key the value is the block's own");
  row.specification.choices = {"linear", "step"};
  return row.byDefault("linear");
}

/// A key: the values that it sets at a time.
BlockSpecification key(const char* meaning, const std::vector<PropertySpecification>& values) {
  BlockSpecification result = block(
      "key", HeaderUse::none, meaning,
      {Row("time", PropertyType::number, "when the values hold; later than in the key before", dsl::kTime)
           .within(kLongestTime)
           .required()});
  result.properties.insert(result.properties.end(), values.begin(), values.end());
  return result;
}

std::vector<PropertySpecification> cameraValues() {
  return {Row("eye", PropertyType::vector3, "where a camera is", dsl::kLength).within(kFarthestPlace),
          Row("target", PropertyType::vector3, "where a camera looks", dsl::kLength).within(kFarthestPlace),
          fov()};
}

BlockSpecification animate() {
  std::vector<PropertySpecification> values{position("where a point or spot light is"),
                                            lightDirection(),
                                            irradiance(),
                                            intensity(),
                                            halfAngle("inner"),
                                            halfAngle("outer")};
  for (const PropertySpecification& value : cameraValues()) values.push_back(value);
  BlockSpecification result = block(
      "animate", HeaderUse::required,
      "motion of MESH, MESH/OBJECT, a light or a camera: keys of a light's or a camera's values, then a "
      "turn about a point and a way along a line; an area light moves with its mesh",
      {Row("rotate", PropertyType::axisAndNumber, "axis and angular speed", dsl::kAngularSpeed)
           .within(kLargestTurn * kDegree),
       Row("translate", PropertyType::vector3, "velocity", dsl::kSpeed).within(kFastest),
       Row("about", PropertyType::vector3,
           "a point on the axis; without it the centre of the bounds of a mesh, the position in a light's "
           "block, the eye in a camera's",
           dsl::kLength)
           .within(kFarthestPlace),
       interpolation()});
  result.blocks = {
      key("what a light or a camera is at a time; keys that do not set a value are passed over", values)};
  return result;
}

BlockSpecification camera() {
  BlockSpecification result = block(
      "camera", HeaderUse::required,
      "a camera with square pixels, a pinhole or a thin lens; the first one is used unless another is asked for",
      {Row("eye", PropertyType::vector3, "position; required without keys", dsl::kLength)
           .within(kFarthestPlace),
       Row("target", PropertyType::vector3, "the point in the middle of the image; required without keys",
           dsl::kLength)
           .within(kFarthestPlace),
       Row("up", PropertyType::vector3, "the direction that is up in the image")
           .within(kFarthestPlace)
           .byDefault("0 1 0"),
       Row("capture", PropertyType::name,
           "a capture: the camera stands where its depth camera stood and sees as high; instead of eye, target, "
           "up, fov, lens and keys"),
       Row("from", PropertyType::name,
           "MESH/CAMERA, a camera of a glTF file: its place, its motion and its angle of view; instead of eye, "
           "target, up, fov and keys"),
       fov().byDefault("40 deg"),
       Row("resolution", PropertyType::resolution,
           "width and height of the image in pixels; of a camera of a capture: of the capture's pictures unless given")
           .between(1, kLargestImage)
           .byDefault("256 256"),
       Row("aperture", PropertyType::number,
           "diameter of the thin lens, which blurs what is not in focus; 0 is a pinhole", dsl::kLength)
           .between(0, kLargestLens)
           .byDefault("0"),
       Row("focus", PropertyType::number,
           "distance of the plane in focus along the view axis; required with an aperture above 0",
           dsl::kLength)
           .between(kNearestFocus, kFarthestFocus),
       interpolation()});
  result.blocks = {
      key("a point of the camera's path; keys that do not set a value are passed over", cameraValues())};
  result.required = true;
  return result;
}

BlockSpecification material() {
  return block(
      "material", HeaderUse::required,
      "Lambert diffuse/pi plus Phong specular (n+2)/(2 pi) cos^n about the mirror direction",
      {Row("diffuse", PropertyType::oneOrThree, "diffuse albedo, multiplied by the texture")
           .between(0, 1)
           .byDefault("0"),
       Row("specular", PropertyType::oneOrThree,
           "Phong albedo at normal incidence; diffuse + specular is at most 1")
           .between(0, 1)
           .byDefault("0"),
       Row("exponent", PropertyType::number, "Phong exponent n").between(0, kLargestExponent).byDefault("1"),
       Row("emission", PropertyType::oneOrThree, "radiance of the front side in W/(sr m^2)")
           .upTo(kMostLight)
           .byDefault("0"),
       Row("texture", PropertyType::text, "image file that multiplies diffuse; sRGB values are made linear"),
       Row("mask", PropertyType::text,
           "image file of coverage (alpha, else the first channel); below a half is a hole")});
}

BlockSpecification mesh() {
  BlockSpecification use =
      block("use", HeaderUse::none,
            "gives another material to a part or to what an MTL material covers; later ones win",
            {Row("part", PropertyType::name, "object or group of the file; * and ? match any letters"),
             Row("mtl", PropertyType::name, "material name in the file; * and ? match any letters"),
             Row("material", PropertyType::name, "the material block to use").required()});
  BlockSpecification without =
      block("without", HeaderUse::none, "leaves out a part or what an MTL material covers",
            {Row("part", PropertyType::name, "object or group of the file; * and ? match any letters"),
             Row("mtl", PropertyType::name, "material name in the file; * and ? match any letters")});
  BlockSpecification result = block(
      "mesh", HeaderUse::required,
      "a model; its objects and groups are named MESH/OBJECT, a file without any is MESH alone",
      {Row("file", PropertyType::text,
           "OBJ (.obj, .obj.gz), glTF 2.0 (.gltf, .glb) or PLY file (.ply, .ply.gz) beside the scene text "
           "or on the asset path; ## stands for the frame number of a sequence of OBJ files")
           .required(),
       Row("material", PropertyType::name, "one material for the whole mesh in place of the file's"),
       Row("crease", PropertyType::number,
           "recomputes smooth normals where faces meet at no more than this angle, 0 deg for flat "
           "faces; without it the file's "
           "normals are kept and only missing ones are computed, with 30 deg",
           dsl::kAngle)
           .between(0, 180.0 * kDegree),
       Row("scale", PropertyType::oneOrThree,
           "length of the file's unit, along each axis when three; done first", dsl::kLength)
           .between(kSmallestScale, kLargestScale)
           .byDefault("1"),
       Row("rotate", PropertyType::axisAndNumber, "turn about an axis through the origin; done second",
           dsl::kAngle)
           .within(kLargestTurn * kDegree),
       Row("translate", PropertyType::vector3, "shift; done last", dsl::kLength)
           .within(kFarthestPlace)
           .byDefault("0 0 0"),
       Row("sequence", PropertyType::range,
           "first and last frame of a deforming mesh with equal faces in all files")
           .between(0, 1e6),
       Row("rate", PropertyType::number, "frames of the sequence per second")
           .between(1e-3, 1e4)
           .byDefault("24"),
       Row("loop", PropertyType::flag,
           "after the last frame of the sequence, or the end of the animation, comes the first")
           .byDefault("on"),
       Row("animation", PropertyType::name,
           "the animation of a glTF file that plays; without it the file's first")});
  result.blocks = {use, without};
  return result;
}

BlockSpecification light() {
  BlockSpecification result =
      block("light", HeaderUse::optional, "a light source; emissive materials are light sources too", {});
  result.kinds = {"area", "directional", "point", "spot"};
  result.kindProperties = {
      {"area",
       {Row("mesh", PropertyType::name, "MESH or MESH/OBJECT whose triangles shine from their front sides")
            .required(),
        Row("radiance", PropertyType::oneOrThree, "emitted radiance in W/(sr m^2)")
            .upTo(kMostLight)
            .required()}},
      {"directional", {lightDirection().required(), irradiance().required()}},
      {"point", {position("where it is").required(), intensity().required()}},
      {"spot",
       {position("where it is").required(), lightDirection().required(), intensity().required(),
        halfAngle("inner").required(), halfAngle("outer").required()}}};
  return result;
}

BlockSpecification medium() {
  return block(
      "medium", HeaderUse::required,
      "a participating medium with Henyey-Greenstein scattering: homogeneous in a box, of particles, or from a file",
      {Row("extinction", PropertyType::oneOrThree,
           "extinction coefficient sigma_t; of a homogeneous medium: everywhere; of particles: in the middle of one cloud; of a file: where its density is 1",
           dsl::kInverseLength)
           .upTo(kMostExtinction)
           .required(),
       Row("albedo", PropertyType::oneOrThree, "scattering / extinction").between(0, 1).byDefault("0"),
       Row("anisotropy", PropertyType::number, "mean cosine g of the scattering angle")
           .between(-0.999, 0.999)
           .byDefault("0"),
       Row("low", PropertyType::vector3,
           "lowest corner of the box of a homogeneous medium; without both corners it fills the bounds of the scene",
           dsl::kLength)
           .within(kFarthestPlace),
       Row("high", PropertyType::vector3, "highest corner of that box", dsl::kLength).within(kFarthestPlace),
       Row("file", PropertyType::text,
           "volume file (.vdb) beside the scene text or on the asset path; its own transform gives its place"),
       Row("grid", PropertyType::name, "name of the file's float grid; not needed where it has only one"),
       Row("particles", PropertyType::integer, "number of particles; 0 for none")
           .between(0, kMostParticles)
           .byDefault("0"),
       Row("source", PropertyType::vector3, "where particles start", dsl::kLength)
           .within(kFarthestPlace)
           .byDefault("0 0 0"),
       Row("spread", PropertyType::number, "farthest start of a particle from the source along each axis",
           dsl::kLength)
           .upTo(kFarthestPlace)
           .byDefault("0"),
       Row("radius", PropertyType::number, "radius of a particle's cloud, whose density falls as (1 - q^2)^3",
           dsl::kLength)
           .upTo(kFarthestPlace)
           .byDefault("0"),
       Row("rise", PropertyType::number, "speed of particles upwards", dsl::kSpeed)
           .within(kFastest)
           .byDefault("0"),
       Row("drift", PropertyType::number, "largest other speed of a particle along each axis", dsl::kSpeed)
           .upTo(kFastest)
           .byDefault("0"),
       Row("life", PropertyType::number, "time after which a particle is reborn at the source", dsl::kTime)
           .between(kShortestLife, kLongestLife)
           .byDefault("4"),
       Row("seed", PropertyType::integer, "seed of the particles' random numbers")
           .between(0, kLargestSeed)
           .byDefault("1")});
}

BlockSpecification capture() {
  Row format("format", PropertyType::word, "layout of the files; without it, the one whose files are there");
  format.specification.choices = kCaptureFormats;
  Row transfer("transfer", PropertyType::word,
               "transfer function of 8-bit colours; images of floats are linear");
  transfer.specification.choices = {"srgb", "linear"};
  return block(
      "capture", HeaderUse::required,
      "frames of a depth camera: colour, depth along z and the camera's pose (x right, y down, z forward); their pixels can light the scene",
      {Row("folder", PropertyType::text,
           "folder of the capture, beside the scene text or on the asset path; or file, or files"),
       Row("file", PropertyType::text, "a .sens file"),
       Row("files", PropertyType::text,
           "EXR images of linear colour and Z in metres, with #### for the frame number; groundtruth.txt beside them holds the poses"),
       format.specification,
       Row("depth_scale", PropertyType::number,
           "units of the depth images in a metre; by default 5000 for tum, 1000 for frames and redwood; a .sens file has its own")
           .between(1e-3, 1e9),
       Row("focal", PropertyType::vector2,
           "focal lengths in pixels of the depth image; one below 0 along y says that y runs up in the capture's left-handed world, which is then mirrored; required but for redwood (525 525) and .sens")
           .within(1e6),
       Row("centre", PropertyType::vector2,
           "principal point in pixels; the centre of the upper left pixel is 0 0; required as focal (redwood: 319.5 239.5)")
           .within(1e6),
       Row("distortion", PropertyType::any,
           "k1 k2 p1 p2 k3 of OpenCV's model of radial and tangential distortion")
           .byDefault("0 0 0 0 0"),
       transfer.byDefault("srgb"),
       Row("exposure", PropertyType::number, "radiance of a linear colour of 1, W/(sr m^2)")
           .between(1e-12, 1e12)
           .byDefault("1"),
       Row("range", PropertyType::range, "first and last frame, counted from 0 or as the files are numbered")
           .between(0, 1e9),
       Row("rate", PropertyType::number, "frames per second of formats without times")
           .between(1e-3, 1e4)
           .byDefault("30"),
       Row("rotate", PropertyType::axisAndNumber,
           "turn of the capture's world about an axis through its origin; done first", dsl::kAngle)
           .within(kLargestTurn * kDegree),
       Row("translate", PropertyType::vector3, "shift of the capture's world; done last", dsl::kLength)
           .within(kFarthestPlace)
           .byDefault("0 0 0"),
       Row("stands_for", PropertyType::text,
           "scene text of the real scene, which the reference alone reads: the truth needs it")});
}

std::vector<BlockSpecification> makeSpecifications() {
  BlockSpecification environment = block(
      "environment", HeaderUse::none,
      "light from beyond the scene, seen by rays that miss everything: constant, or an image of the sphere",
      {Row("radiance", PropertyType::oneOrThree,
           "constant radiance from all directions, W/(sr m^2); instead of a file")
           .upTo(kMostLight),
       Row("file", PropertyType::text,
           "OpenEXR or Radiance image in latitude and longitude, linear radiance in W/(sr m^2): the upper row is +Y, the middle column -Z, and +X lies to its right"),
       Row("rotate", PropertyType::axisAndNumber, "turn of the map about an axis", dsl::kAngle)
           .within(kLargestTurn * kDegree),
       Row("scale", PropertyType::number, "factor of the map's radiance")
           .between(1e-12, kMostLight)
           .byDefault("1")});
  environment.repeatable = false;
  BlockSpecification scene =
      block("scene", HeaderUse::required,
            "a scene: metres, seconds, Y up, right-handed; all light is linear, in Rec. 709 primaries", {});
  scene.blocks = {camera(), material(), mesh(), light(), environment, medium(), animate(), capture()};
  scene.repeatable = false;
  scene.required = true;
  return {scene};
}

}  // namespace

const std::vector<dsl::BlockSpecification>& sceneSpecifications() {
  static const std::vector<dsl::BlockSpecification> specifications = makeSpecifications();
  return specifications;
}

}  // namespace lumivox
