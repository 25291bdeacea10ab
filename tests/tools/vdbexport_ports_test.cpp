// Ports of passes as OpenVDB grids: every value and position as on the device, read by other programs too.
#include <openvdb/openvdb.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "../../techniques/light_propagation_volumes/occluded_faces.h"
#include "support/scene_builder.h"
#include "support/techniques.h"
#include "tools/cli_support.h"
#include "tools/vdbexport_support.h"
#include "vdbexport/export.h"
#include "vdbexport/vdb_file.h"

using namespace lumivox;
using namespace lumivox::test;
namespace fs = std::filesystem;

namespace {

// ---- a pass that gives every kind of port, with known content ------------------------------------------

/// The contents of the pass's ports: kept here, so that the test reads the device by itself.
struct Content {
  GridPlacement grid;
  VoxelFragments fragments;
  OccupancyGrid occupancy;
  BinaryGrid binary;
  AttributeGrid attributes;
  RadianceGrid radiance;
  ShGrid harmonics;
  light_propagation_volumes::OccludedFaces faces;
  ScatteringGrid media;
};
Content& content() {
  static Content instance;
  return instance;
}

/// Random values in about one of five voxels of a slab, zero elsewhere; mip levels too.
gpu::TextureRef randomVolume(gpu::Format format, const glm::ivec3& size, int levels, unsigned seed) {
  const gpu::TextureDescription description{gpu::TextureKind::d3, format, size.x, size.y, size.z, levels};
  auto texture = std::make_shared<gpu::Texture>(device(), description, "random volume");
  std::mt19937 random(seed);
  for (int level = 0; level < levels; ++level) {
    const glm::ivec3 voxels = glm::max(glm::ivec3(size.x >> level, size.y >> level, size.z >> level), 1);
    const int components = gpu::componentCount(format);
    std::vector<float> values(static_cast<std::size_t>(voxels.x * voxels.y * voxels.z * components), 0.0f);
    for (int voxel = 0; voxel < voxels.x * voxels.y * voxels.z; ++voxel) {
      const int z = voxel / (voxels.x * voxels.y);
      if (voxel > 0 && (random() % 5 != 0 || 3 * z > 2 * voxels.z)) continue;
      for (int c = 0; c < components; ++c)
        values[static_cast<std::size_t>(voxel * components + c)] =
            static_cast<float>(1 + random() % 1023) / (format == gpu::Format::r8 ? 1023.0f : 64.0f);
    }
    texture->uploadFloats(level, values);
  }
  return texture;
}

struct FragmentWords {
  std::uint32_t voxel, others[5];
};

VoxelFragments someFragments(const GridPlacement& grid) {
  VoxelFragments result;
  result.grid = grid;
  std::vector<FragmentWords> list;
  std::mt19937 random(5);
  for (int i = 0; i < 400; ++i) {
    // From a few voxels, so that some hold several.
    const auto below = [&](int end) {
      return static_cast<std::uint32_t>(random()) % static_cast<std::uint32_t>(end);
    };
    const std::uint32_t x = below(7), y = below(grid.resolution.y), z = 5 + below(3);
    list.push_back({x | y << 10 | z << 20, {1, 2, 3, 4, 5}});
  }
  result.capacity = list.size() + 100;  // room is left, as passes leave some
  result.fragments =
      std::make_shared<gpu::Buffer>(device(), result.capacity * VoxelFragments::kFragmentBytes, "fragments");
  result.fragments->clear(~0u);
  result.fragments->upload(std::as_bytes(std::span(list)));
  const std::array<std::uint32_t, 4> count{static_cast<std::uint32_t>(list.size()), 7, 1, 1};
  result.count = std::make_shared<gpu::Buffer>(device(), sizeof(count), "count");
  result.count->upload(std::as_bytes(std::span(count)));
  return result;
}

BinaryGrid someStacks(const GridPlacement& grid) {
  BinaryGrid result;
  result.grid = grid;
  gpu::TextureDescription description{
      gpu::TextureKind::d2Array, gpu::Format::rgba32ui, grid.resolution.x, grid.resolution.y, 2, 2};
  result.stacks = std::make_shared<gpu::Texture>(device(), description, "stacks");
  std::mt19937 random(11);
  for (int level = 0; level < 2; ++level) {
    const std::size_t texels = static_cast<std::size_t>((grid.resolution.x >> level) *
                                                        (grid.resolution.y >> level) * description.depth);
    std::vector<std::uint32_t> words(4 * texels);
    for (std::uint32_t& word : words) word = random() & random() & random();
    // The second stack reaches beyond the grid: no voxel is there.
    result.stacks->upload(level, std::as_bytes(std::span(words)));
  }
  return result;
}

void makeContent() {
  Content& made = content();
  made.grid = {{-0.25f, 0.5f, 3.0f}, 0.125f, {20, 17, 26}};
  const glm::ivec3 size = made.grid.resolution;
  made.fragments = someFragments(made.grid);
  made.occupancy = {made.grid, randomVolume(gpu::Format::r8, size, 1, 1)};
  GridPlacement tall = made.grid;
  tall.resolution = {10, 6, 150};
  made.binary = someStacks(tall);
  made.attributes = {made.grid, randomVolume(gpu::Format::rgba16f, size, 1, 2),
                     randomVolume(gpu::Format::rgba16f, size, 1, 3),
                     randomVolume(gpu::Format::rgba32f, size, 1, 4)};
  made.radiance.grid = made.grid;
  made.radiance.radiance = randomVolume(gpu::Format::rgba32f, size, 5, 6);
  ShGrid::Level fine{made.grid, {}}, coarse{made.grid, {}};
  coarse.grid.voxelSize *= 2.0f;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    fine.coefficients[channel] =
        randomVolume(gpu::Format::rgba16f, size, 1, 20 + static_cast<unsigned>(channel));
    coarse.coefficients[channel] =
        randomVolume(gpu::Format::rgba16f, size, 1, 30 + static_cast<unsigned>(channel));
  }
  made.faces.levels = {{made.grid, randomVolume(gpu::Format::rgba8, size + 1, 1, 40), nullptr, nullptr}};
  made.harmonics.levels = {fine, coarse};
  ScatteringGrid::Medium smoke, fog;
  smoke.name = "smoke";
  smoke.grid = made.grid;
  smoke.density = randomVolume(gpu::Format::r32f, size, 1, 50);
  smoke.extinction = {1.0f, 2.0f, 3.0f};
  smoke.albedo = glm::vec3(0.9f);
  smoke.anisotropy = 0.6f;
  fog.name = "fog";
  fog.bounds.grow({-1.0f, -2.0f, -3.0f});
  fog.bounds.grow({1.0f, 2.0f, 5.0f});
  made.media.media = {smoke, fog};
}

class EveryKind : public Pass {
 public:
  Param<float> width{this, "width", 2.5f, {0.0f, 10.0f}, "m", "of something"};
  Out<VoxelFragments> fragments{this, "fragments"};
  Out<OccupancyGrid> occupancy{this, "occupancy"};
  Out<BinaryGrid> binary{this, "binary"};
  Out<AttributeGrid> attributes{this, "attributes"};
  Out<RadianceGrid> radiance{this, "radiance"};
  Out<ShGrid> harmonics{this, "harmonics"};
  Out<light_propagation_volumes::OccludedFaces> faces{this, "faces"};  // a kind that a technique brought
  Out<ScatteringGrid> media{this, "media"};
  Out<Image> image{this, "image", Contributes::direct};
  void run(PassContext& frame) override {
    const Content& made = content();
    fragments = made.fragments;
    occupancy = made.occupancy;
    binary = made.binary;
    attributes = made.attributes;
    radiance = made.radiance;
    harmonics = made.harmonics;
    faces = made.faces;
    media = made.media;
    if (image.wanted()) image = {frame.image("image")};
  }
};

class OneTechnique : public TechniqueSource {
 public:
  OneTechnique() {
    technique_.name = "toy";
    technique_.passes.push_back(
        {"kinds", "every kind of port", [] { return std::make_unique<EveryKind>(); }});
  }
  const Technique* technique(const std::string& wanted) override {
    return wanted == "toy" ? &technique_ : nullptr;
  }
  std::vector<std::string> available() const override { return {"toy"}; }
  const std::vector<SkippedTechnique>& skipped() const override { return skipped_; }

 private:
  Technique technique_;
  std::vector<SkippedTechnique> skipped_;
};

Pipeline kindsPipeline() {
  return Pipeline::parse(
      "pipeline \"kinds\" {\n  pass all toy.kinds { width 4 m }\n  output direct all.image\n}\n",
      "kinds.pipeline");
}

/// A thousand kilometres from the world's origin, so that positions must be right in double precision.
Scene farScene() {
  SceneBuilder builder;
  builder.box({0, 0, 0}, {1, 1, 1}, builder.lambert(0.5f), false);
  for (Object& object : builder.scene.objects) object.placement[3] = glm::dvec4(1e6, -2e5, 3e5, 1.0);
  builder.look({1e6, -2e5, 3e5 + 4}, {1e6, -2e5, 3e5}, {0, 1, 0}, 0.7, 8, 8);
  return builder.scene;
}

/// What a file holds that is exported from a scene, by default far away; its bytes too where they are asked
/// for.
Grids exportKinds(const vdb::ExportRequest& request, const Scene& scene = farScene(),
                  std::string* bytes = nullptr) {
  if (!content().radiance.radiance) makeContent();
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "kinds.vdb";
  OneTechnique source;
  vdb::Exporter exporter(device(), source, scene, kindsPipeline(), {}, request);
  openvdb::GridCPtrVec grids;
  openvdb::initialize();
  for (const vdb::NamedField& field : exporter.render(0.5, 12))
    grids.push_back(exporter.grid(field, {{"lumivox.scene_hash", "abc"}}));
  vdb::writeVdb(file, grids);
  if (bytes != nullptr) *bytes = readFile(file);
  return readByOpenVdb(file);
}

/// Changes the content while it lives.
struct Changed {
  Changed() { makeContent(); }
  ~Changed() { makeContent(); }
};

/// Every voxel of a grid, and a margin around it, against `expected(voxel)`: its value and whether it is
/// active.
template <class GridType, class Expected>
void checkVoxels(const Grids& grids, const std::string& name, const glm::ivec3& size,
                 const Expected& expected) {
  INFO(name);
  REQUIRE(grids.count(name) == 1);
  const auto grid = openvdb::gridPtrCast<GridType>(grids.at(name));
  REQUIRE(grid);
  const auto accessor = grid->getConstAccessor();
  std::size_t wrongValues = 0, wrongActive = 0, active = 0;
  for (int z = -2; z < size.z + 2; ++z)
    for (int y = -2; y < size.y + 2; ++y)
      for (int x = -2; x < size.x + 2; ++x) {
        const glm::ivec3 voxel(x, y, z);
        const bool inside =
            glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) && glm::all(glm::lessThan(voxel, size));
        typename GridType::ValueType value{};
        const bool isActive = accessor.probeValue({x, y, z}, value);
        active += isActive ? 1 : 0;
        const auto [wanted, wantedActive] =
            inside ? expected(voxel) : std::pair(openvdb::zeroVal<typename GridType::ValueType>(), false);
        if (!(value == wanted)) ++wrongValues;
        if (isActive != wantedActive) ++wrongActive;
      }
  CHECK(wrongValues == 0);
  CHECK(wrongActive == 0);
  CHECK(active > 0);
  CHECK(grid->activeVoxelCount() == active);  // nothing lies further out
}

/// Texels of a volume level as the device gives them.
class DeviceVolume {
 public:
  DeviceVolume(const gpu::TextureRef& texture, int level)
      : components_(gpu::componentCount(texture->description().format)),
        size_(
            glm::max(glm::ivec3(texture->description().width >> level, texture->description().height >> level,
                                texture->description().depth >> level),
                     1)),
        values_(texture->downloadFloats(level)) {
    if (gpu::bytesPerTexel(texture->description().format) != static_cast<std::size_t>(components_)) return;
    // A byte means its 255th part; the driver's own conversion may be off by the last bit.
    const std::vector<std::byte> bytes = texture->download(level);
    for (std::size_t i = 0; i < values_.size(); ++i)
      values_[i] = static_cast<float>(std::to_integer<int>(bytes[i])) / 255.0f;
  }
  const glm::ivec3& size() const { return size_; }
  float at(const glm::ivec3& voxel, int component) const {
    const int texel = voxel.x + size_.x * (voxel.y + size_.y * voxel.z);
    return values_[static_cast<std::size_t>(texel * components_ + component)];
  }
  bool any(const glm::ivec3& voxel) const {
    for (int c = 0; c < components_; ++c)
      if (at(voxel, c) != 0.0f) return true;
    return false;
  }
  openvdb::Vec3f rgb(const glm::ivec3& voxel) const { return {at(voxel, 0), at(voxel, 1), at(voxel, 2)}; }

 private:
  int components_;
  glm::ivec3 size_;
  std::vector<float> values_;
};

void checkComponent(const Grids& grids, const std::string& name, const gpu::TextureRef& texture, int level,
                    int component) {
  const DeviceVolume volume(texture, level);
  checkVoxels<openvdb::FloatGrid>(grids, name, volume.size(), [&](const glm::ivec3& voxel) {
    return std::pair(volume.at(voxel, component), volume.any(voxel));
  });
}
void checkRgb(const Grids& grids, const std::string& name, const gpu::TextureRef& texture, int level) {
  const DeviceVolume volume(texture, level);
  checkVoxels<openvdb::Vec3fGrid>(grids, name, volume.size(), [&](const glm::ivec3& voxel) {
    return std::pair(volume.rgb(voxel), volume.any(voxel));
  });
}

void checkPlace(const Grids& grids, const std::string& name, const glm::dvec3& low, const glm::dvec3& voxel) {
  INFO(name);
  const openvdb::GridBase& grid = *grids.at(name);
  for (const glm::ivec3 index : {glm::ivec3(0), glm::ivec3(3, 5, 7), glm::ivec3(-4, 100, 1)}) {
    const openvdb::Vec3d world = grid.indexToWorld(openvdb::Coord(index.x, index.y, index.z));
    const glm::dvec3 centre = low + (glm::dvec3(index) + 0.5) * voxel;
    for (int axis = 0; axis < 3; ++axis) CHECK(world[axis] == Approx(centre[axis]).epsilon(1e-15));
  }
}

}  // namespace

// ---- values and positions ------------------------------------------------------------------------------

TEST_CASE("every value of every kind of port reads back from the file as the device has it") {
  const Grids grids = exportKinds({{}, {}, false});
  const Content& made = content();

  checkComponent(grids, "all.occupancy.opacity", made.occupancy.opacity, 0, 0);
  checkRgb(grids, "all.attributes.albedo", made.attributes.albedo, 0);
  checkComponent(grids, "all.attributes.coverage", made.attributes.albedo, 0, 3);
  checkRgb(grids, "all.attributes.normal", made.attributes.normal, 0);
  checkRgb(grids, "all.attributes.emission", made.attributes.emission, 0);
  for (int level = 0; level < 5; ++level) {
    const std::string suffix = level == 0 ? "" : ".level" + std::to_string(level);
    checkRgb(grids, "all.radiance.radiance" + suffix, made.radiance.radiance, level);
    checkComponent(grids, "all.radiance.opacity" + suffix, made.radiance.radiance, level, 3);
  }
  checkComponent(grids, "all.media.density_smoke", made.media.media[0].density, 0, 0);
  checkVoxels<openvdb::FloatGrid>(grids, "all.media.density_fog", glm::ivec3(8),
                                  [](const glm::ivec3&) { return std::pair(1.0f, true); });
  checkRgb(grids, "all.faces.occluded", made.faces.levels[0].occluded, 0);

  const std::array<const char*, 4> coefficients{"Y00", "Y1-1", "Y10", "Y11"};
  for (int level = 0; level < 2; ++level) {
    const auto& textures = made.harmonics.levels[static_cast<std::size_t>(level)].coefficients;
    const std::array<DeviceVolume, 3> channels{DeviceVolume(textures[0], 0), DeviceVolume(textures[1], 0),
                                               DeviceVolume(textures[2], 0)};
    for (int i = 0; i < 4; ++i)
      checkVoxels<openvdb::Vec3fGrid>(
          grids,
          std::string("all.harmonics.") + coefficients[static_cast<std::size_t>(i)] +
              (level == 0 ? "" : ".level1"),
          channels[0].size(), [&](const glm::ivec3& voxel) {
            return std::pair(
                openvdb::Vec3f(channels[0].at(voxel, i), channels[1].at(voxel, i), channels[2].at(voxel, i)),
                channels[0].any(voxel) || channels[1].any(voxel) || channels[2].any(voxel));
          });
  }
}

TEST_CASE("bits of stacks and fragments of a list read back as occupied voxels and their numbers") {
  const Grids grids = exportKinds({{"all.binary", "all.fragments"}, {0}, false});
  const Content& made = content();

  const auto words = made.binary.stacks->download(0);
  const glm::ivec3 size = made.binary.grid.resolution;
  checkVoxels<openvdb::BoolGrid>(grids, "all.binary.occupancy", size, [&](const glm::ivec3& voxel) {
    // By the contract of the port: bit b of component c of layer l is voxel 128 l + 32 c + b.
    const int layer = voxel.z / 128, component = voxel.z % 128 / 32, bit = voxel.z % 32;
    const std::size_t texel = static_cast<std::size_t>(voxel.x + size.x * (voxel.y + size.y * layer));
    std::uint32_t word = 0;
    std::memcpy(&word, words.data() + 16 * texel + 4 * static_cast<std::size_t>(component), 4);
    const bool occupied = (word >> bit & 1u) != 0;
    return std::pair(occupied, occupied);
  });

  std::map<std::uint32_t, int> counts;
  const auto list = made.fragments.fragments->downloadValues<FragmentWords>();
  for (int i = 0; i < 400; ++i) ++counts[list[static_cast<std::size_t>(i)].voxel];
  const auto countOf = [&](const glm::ivec3& voxel) {
    const auto found = counts.find(static_cast<std::uint32_t>(voxel.x | voxel.y << 10 | voxel.z << 20));
    return found == counts.end() ? 0 : found->second;
  };
  CHECK(std::any_of(counts.begin(), counts.end(), [](const auto& one) { return one.second > 1; }));
  checkVoxels<openvdb::Int32Grid>(
      grids, "all.fragments.fragments", made.grid.resolution,
      [&](const glm::ivec3& voxel) { return std::pair(countOf(voxel), countOf(voxel) > 0); });
  checkVoxels<openvdb::BoolGrid>(
      grids, "all.fragments.occupancy", made.grid.resolution,
      [&](const glm::ivec3& voxel) { return std::pair(countOf(voxel) > 0, countOf(voxel) > 0); });
}

TEST_CASE("a whole index is the centre of its voxel in metres of the world, far from its origin too") {
  const Scene scene = farScene();
  const Grids grids = exportKinds({{}, {}, false}, scene);
  const Content& made = content();
  const glm::dvec3 origin = snapshotOf(scene, 0.0).origin;
  REQUIRE(glm::length(origin) > 1e6);
  const glm::dvec3 low = origin + glm::dvec3(made.grid.low), voxel(made.grid.voxelSize);
  for (const char* name :
       {"all.occupancy.opacity", "all.attributes.normal", "all.radiance.radiance", "all.harmonics.Y00",
        "all.media.density_smoke", "all.fragments.fragments", "all.binary.occupancy"})
    checkPlace(grids, name, low, voxel);
  checkPlace(grids, "all.harmonics.Y00.level1", low, 2.0 * voxel);
  // 20 x 17 x 26 voxels become 10 x 8 x 13 over the same box.
  checkPlace(grids, "all.radiance.opacity.level1", low, voxel * glm::dvec3(2.0, 17.0 / 8.0, 2.0));
  // Stacks halve along x and y alone.
  checkPlace(grids, "all.binary.occupancy.level1", low, voxel * glm::dvec3(2.0, 2.0, 1.0));
  // A homogeneous medium fills its bounds exactly.
  checkPlace(grids, "all.media.density_fog", origin + glm::dvec3(-1, -2, -3), glm::dvec3(2, 4, 8) / 8.0);
}

TEST_CASE("what does not touch a surface costs nothing, and what is constant is one tile") {
  const Changed changed;
  // 64 voxels a side: a block of 32 voxels of one value in the corner, one voxel apart, zero elsewhere.
  GridPlacement grid{{0, 0, 0}, 0.1f, {64, 64, 64}};
  std::vector<float> values(64 * 64 * 64, 0.0f);
  for (int z = 0; z < 32; ++z)
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) values[static_cast<std::size_t>(x + 64 * (y + 64 * z))] = 1.0f;
  values[static_cast<std::size_t>(50 + 64 * (50 + 64 * 50))] = 0.5f;
  auto texture = std::make_shared<gpu::Texture>(
      device(), gpu::TextureDescription{gpu::TextureKind::d3, gpu::Format::r8, 64, 64, 64, 1}, "opacity");
  texture->uploadFloats(0, values);
  content().occupancy = {grid, texture};
  std::string bytes;
  const Grids grids = exportKinds({{"all.occupancy"}, {0}, false}, farScene(), &bytes);
  const auto opacity = openvdb::gridPtrCast<openvdb::FloatGrid>(grids.at("all.occupancy.opacity"));
  CHECK(opacity->activeVoxelCount() == 32 * 32 * 32 + 1);
  CHECK(opacity->tree().leafCount() == 1);
  CHECK(opacity->tree().activeTileCount() == 4 * 4 * 4);
  CHECK(opacity->background() == 0.0f);
  CHECK(bytes.size() < 64 * 64 * 64 / 16);
}

TEST_CASE("half floats keep what came from half floats to the bit, and round the rest to eleven bits") {
  const Grids grids = exportKinds({{"all.attributes", "all.media"}, {0}, true});
  CHECK(grids.at("all.attributes.albedo")->saveFloatAsHalf());
  checkRgb(grids, "all.attributes.albedo", content().attributes.albedo, 0);
  const DeviceVolume density(content().media.media[0].density, 0);
  const auto stored = openvdb::gridPtrCast<openvdb::FloatGrid>(grids.at("all.media.density_smoke"));
  for (auto value = stored->cbeginValueOn(); value; ++value) {
    const openvdb::Coord at = value.getCoord();
    CHECK(*value == Approx(density.at({at.x(), at.y(), at.z()}, 0)).epsilon(std::ldexp(1.0, -11)));
  }
}

TEST_CASE("a grid says what it is, its unit, who made it with which parameters, and from what") {
  const Grids grids = exportKinds({{}, {0}, false});
  const openvdb::GridBase& radiance = *grids.at("all.radiance.radiance");
  for (const auto& [name, value] : std::map<std::string, std::string>{
           {"lumivox.technique", "toy.kinds"},
           {"lumivox.pass", "all"},
           {"lumivox.port", "radiance"},
           {"lumivox.kind", "RadianceGrid"},
           {"lumivox.unit", "W/(sr m^2)"},
           {"lumivox.pass_parameter.width", "4 m"},
           {"lumivox.level", "0"},
           {"lumivox.frame", "12"},
           {"lumivox.scene_hash", "abc"},
           {"lumivox.length_unit", "m"},
           {"lumivox.quantity", "outgoing radiance, multiplied by the opacity"}}) {
    INFO(name);
    CHECK(metaText(radiance, name) == value);
  }
  CHECK(radiance.getGridClass() == openvdb::GRID_UNKNOWN);
  CHECK(grids.at("all.radiance.opacity")->getGridClass() == openvdb::GRID_FOG_VOLUME);
  CHECK(grids.at("all.attributes.normal")->getVectorType() == openvdb::VEC_COVARIANT);
  const openvdb::GridBase& smoke = *grids.at("all.media.density_smoke");
  CHECK(smoke.metaValue<openvdb::Vec3s>("lumivox.extinction") == openvdb::Vec3s(1, 2, 3));
  CHECK(smoke.metaValue<float>("lumivox.anisotropy") == 0.6f);
}

TEST_CASE(
    "coefficients of light say whether they are of flux or of radiance, and one volume is all three colours") {
  const Changed changed;
  Content& made = content();
  for (const ShGrid::Quantity quantity : {ShGrid::Quantity::flux, ShGrid::Quantity::radiance}) {
    made.harmonics.quantity = quantity;
    const Grids grids = exportKinds({{"all.harmonics"}, {0}, false});
    REQUIRE(grids.count("all.harmonics.Y00") == 1);
    CHECK(metaText(*grids.at("all.harmonics.Y00"), "lumivox.coefficients_of") == name(quantity));
    CHECK(metaText(*grids.at("all.harmonics.Y00"), "lumivox.unit") ==
          (quantity == ShGrid::Quantity::flux ? "W/sr" : "W/(sr m^2)"));
    CHECK_FALSE((*grids.at("all.harmonics.Y00"))["lumivox.read_for"]);
  }
  // Whoever reads the file must know that most voxels were left out.
  made.harmonics.readFor = "'voxels six'";
  CHECK(metaText(*exportKinds({{"all.harmonics"}, {0}, false}).at("all.harmonics.Y00"), "lumivox.read_for") ==
        "'voxels six'");
  made.harmonics.readFor.clear();
  made.harmonics.levels.resize(1);
  auto& coefficients = made.harmonics.levels[0].coefficients;
  coefficients[1] = coefficients[2] = nullptr;
  const Grids grids = exportKinds({{"all.harmonics"}, {0}, false});
  const DeviceVolume volume(coefficients[0], 0);
  checkVoxels<openvdb::Vec3SGrid>(grids, "all.harmonics.Y10", volume.size(), [&](const glm::ivec3& voxel) {
    return std::pair(openvdb::Vec3f(volume.at(voxel, 2)), volume.any(voxel));
  });
}

TEST_CASE("the only density of a medium is called as viewers expect it") {
  const Changed changed;
  content().media.media.pop_back();
  const Grids grids = exportKinds({{"all.media"}, {0}, false});
  REQUIRE(grids.size() == 1);
  CHECK(grids.begin()->first == "density");
  CHECK(grids.begin()->second->getGridClass() == openvdb::GRID_FOG_VOLUME);
}

TEST_CASE("the same grids give the same bytes") {
  std::string first, second;
  exportKinds({{"all.radiance", "all.binary"}, {}, false}, farScene(), &first);
  sleep(1);  // OpenVDB's own tag is made from the clock's seconds
  exportKinds({{"all.radiance", "all.binary"}, {}, false}, farScene(), &second);
  CHECK(first == second);
}

// ---- other programs ------------------------------------------------------------------------------------

TEST_CASE("OpenVDB's viewer shows an exported grid", "[slow]") {
  if (!hasProgram("vdb_view") || !hasProgram("Xvfb")) return skip("vdb_view or Xvfb is absent");
  const TemporaryDirectory directory;
  // The viewer runs until it is closed: stopped by the time limit is as it should be.
  const auto view = [](const fs::path& file) {
    const std::string display = ":" + std::to_string(100 + getpid() % 400);
    return runCommand("Xvfb " + display +
                      " -screen 0 640x480x24 >/dev/null 2>&1 & server=$!; sleep 2; DISPLAY=" + display +
                      " timeout 5 vdb_view '" + file.string() +
                      "'; code=$?; kill $server; wait $server 2>/dev/null; exit $code");
  };
  constexpr int kStopped = 124;
  std::string bytes;
  exportKinds({{"all.occupancy", "all.radiance"}, {0}, false}, farScene(), &bytes);
  const fs::path control = directory.path() / "control.vdb",
                 exported = directory.write("exported.vdb", bytes);
  {
    openvdb::io::File file(control.string());
    file.write(openvdb::GridCPtrVec{ramp(20, 0.25, 8.0)});
  }
  const CommandResult asItShould = view(control);
  if (asItShould.exitCode != kStopped)
    return skip("vdb_view shows no file of OpenVDB's own here: it ends with exit code " +
                std::to_string(asItShould.exitCode) + ": " + asItShould.errors);
  const CommandResult result = view(exported);
  INFO(result.output << result.errors);
  CHECK(result.exitCode == kStopped);
  CHECK_FALSE(contains(result.errors, "ERROR"));
}

TEST_CASE("Blender loads exported smoke as a volume with a density", "[slow]") {
  if (!hasProgram("blender")) return skip("blender is absent");
  const TemporaryDirectory directory;
  const Changed changed;
  content().media.media.pop_back();
  std::string bytes;
  exportKinds({{"all.media"}, {0}, false}, farScene(), &bytes);
  const fs::path file = directory.write("smoke.vdb", bytes);
  const fs::path script = directory.write(
      "load.py",
      "import bpy\nvolume = bpy.data.volumes.new('smoke')\nvolume.filepath = '" + file.string() +
          "'\nvolume.grids.load()\nprint('GRIDS', [(g.name, g.data_type) for g in volume.grids])\n");
  const CommandResult result =
      runCommand("blender --background --factory-startup --python '" + script.string() + "'");
  INFO(result.output << result.errors);
  CHECK(contains(result.output, "GRIDS [('density', 'FLOAT')]"));
}
