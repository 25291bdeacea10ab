// Voxel grids as OpenVDB files: every value and position as on the device, files whole or absent, differences
// that have a closed form.
#include <openvdb/io/File.h>
#include <openvdb/math/Maps.h>
#include <openvdb/openvdb.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <random>
#include <regex>
#include <sstream>

#include "lumivox/base/error.h"
#include "support/scene_builder.h"
#include "support/techniques.h"
#include "tools/cli_support.h"
#include "vdbexport/difference.h"
#include "vdbexport/export.h"
#include "vdbexport/vdb_file.h"

using namespace lumivox;
using namespace lumivox::test;
namespace fs = std::filesystem;

namespace {

// ---- a pass that gives every kind of port, with known content ------------------------------------------

/// What the pass put into its ports: kept here, so that the test reads the device by itself.
struct Content {
  GridPlacement grid;
  VoxelFragments fragments;
  OccupancyGrid occupancy;
  BinaryGrid binary;
  AttributeGrid attributes;
  RadianceGrid radiance;
  ShGrid harmonics;
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
  made.radiance = {made.grid, randomVolume(gpu::Format::rgba32f, size, 5, 6)};
  ShGrid::Level fine{made.grid, {}, {}}, coarse{made.grid, {}, {}};
  coarse.grid.voxelSize *= 2.0f;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    fine.coefficients[channel] =
        randomVolume(gpu::Format::rgba16f, size, 1, 20 + static_cast<unsigned>(channel));
    coarse.coefficients[channel] =
        randomVolume(gpu::Format::rgba16f, size, 1, 30 + static_cast<unsigned>(channel));
  }
  fine.closed = randomVolume(gpu::Format::rgba8, size + 1, 1, 40);
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
  Out<ScatteringGrid> media{this, "media"};
  Out<Image> picture{this, "picture", Contributes::direct};
  void run(PassContext& frame) override {
    const Content& made = content();
    fragments = made.fragments;
    occupancy = made.occupancy;
    binary = made.binary;
    attributes = made.attributes;
    radiance = made.radiance;
    harmonics = made.harmonics;
    media = made.media;
    if (picture.wanted()) picture = {frame.image(gpu::Format::rgba32f, "picture")};
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
      "pipeline \"kinds\" {\n  pass all toy.kinds { width 4 m }\n  output direct all.picture\n}\n",
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

using Grids = std::map<std::string, openvdb::GridBase::Ptr>;

/// As any other program reads it: by OpenVDB's own reader, not ours.
Grids readByOpenVdb(const fs::path& file) {
  openvdb::initialize();
  openvdb::io::File stream(file.string());
  stream.open(/*delayLoad=*/false);
  Grids grids;
  const openvdb::GridPtrVecPtr all = stream.getGrids();
  for (const auto& grid : *all) grids[grid->getName()] = grid;
  return grids;
}

Grids exportKinds(const fs::path& file, vdb::ExportRequest request, Scene scene) {
  if (!content().radiance.radiance) makeContent();
  OneTechnique source;
  vdb::Exporter exporter(device(), source, scene, kindsPipeline(), {}, std::move(request));
  openvdb::GridCPtrVec grids;
  openvdb::initialize();
  for (const vdb::NamedField& field : exporter.render(0.5, 12))
    grids.push_back(exporter.grid(field, {{"lumivox.scene_hash", "abc"}}));
  vdb::writeVdb(file, grids);
  return readByOpenVdb(file);
}

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

std::string metaText(const openvdb::GridBase& grid, const std::string& name) {
  const auto value = grid[name];
  return value ? value->str() : "(none)";
}

/// vdbexport in place of lumivox.
CommandResult vdbexport(const std::string& arguments) {
  return runCommand("'" + (binaryDirectory() / "bin/vdbexport").string() + "' " + arguments);
}

bool hasProgram(const std::string& name) {
  return runCommand("command -v " + name).exitCode == 0;
}

}  // namespace

// ---- values and positions ------------------------------------------------------------------------------

TEST_CASE("every value of every kind of port reads back from the file as the device has it") {
  const TemporaryDirectory directory;
  const Grids grids = exportKinds(directory.path() / "all.vdb", {{}, {}, false}, farScene());
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
  checkRgb(grids, "all.harmonics.closed", made.harmonics.levels[0].closed, 0);

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
  const TemporaryDirectory directory;
  const Grids grids =
      exportKinds(directory.path() / "bits.vdb", {{"all.binary", "all.fragments"}, {0}, false}, farScene());
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
  const TemporaryDirectory directory;
  const Scene scene = farScene();
  const Grids grids = exportKinds(directory.path() / "all.vdb", {{}, {}, false}, scene);
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
  const TemporaryDirectory directory;
  makeContent();
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
  const Grids grids = exportKinds(directory.path() / "o.vdb", {{"all.occupancy"}, {0}, false}, farScene());
  const auto opacity = openvdb::gridPtrCast<openvdb::FloatGrid>(grids.at("all.occupancy.opacity"));
  CHECK(opacity->activeVoxelCount() == 32 * 32 * 32 + 1);
  CHECK(opacity->tree().leafCount() == 1);
  CHECK(opacity->tree().activeTileCount() == 4 * 4 * 4);
  CHECK(opacity->background() == 0.0f);
  CHECK(fs::file_size(directory.path() / "o.vdb") < 64 * 64 * 64 / 16);
  makeContent();
}

TEST_CASE("half floats keep what came from half floats to the bit, and round the rest to eleven bits") {
  const TemporaryDirectory directory;
  const vdb::ExportRequest request{{"all.attributes", "all.media"}, {0}, true};
  const Grids grids = exportKinds(directory.path() / "half.vdb", request, farScene());
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
  const TemporaryDirectory directory;
  const Grids grids = exportKinds(directory.path() / "all.vdb", {{}, {0}, false}, farScene());
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

TEST_CASE("the only density of a medium is called as viewers expect it") {
  const TemporaryDirectory directory;
  makeContent();
  content().media.media.pop_back();
  const Grids grids = exportKinds(directory.path() / "smoke.vdb", {{"all.media"}, {0}, false}, farScene());
  makeContent();
  REQUIRE(grids.size() == 1);
  CHECK(grids.begin()->first == "density");
  CHECK(grids.begin()->second->getGridClass() == openvdb::GRID_FOG_VOLUME);
}

TEST_CASE("the same grids give the same bytes") {
  const TemporaryDirectory directory;
  const auto bytes = [&] {
    exportKinds(directory.path() / "a.vdb", {{"all.radiance", "all.binary"}, {}, false}, farScene());
    return readFile(directory.path() / "a.vdb");
  };
  const std::string first = bytes();
  sleep(1);  // OpenVDB's own tag is made from the clock's seconds
  CHECK(first == bytes());
}

// ---- a sphere of one metre -----------------------------------------------------------------------------

namespace {

/// A sphere of `slices` meridians and half as many parallels; its corners lie on the sphere.
Scene sphereScene(const glm::vec3& centre, float radius, int slices) {
  SceneBuilder builder;
  const int material = builder.lambert(0.5f);
  const auto corner = [&](int i, int j) {
    const double across = 2.0 * kPi * i / slices, down = kPi * j / (slices / 2);
    return centre + radius * glm::vec3(std::sin(down) * std::cos(across), std::cos(down),
                                       std::sin(down) * std::sin(across));
  };
  Scene& scene = builder.scene;
  Object object;
  object.name = "sphere";
  for (int j = 0; j <= slices / 2; ++j)
    for (int i = 0; i <= slices; ++i) {
      scene.positions.push_back(corner(i, j));
      scene.normals.push_back(glm::normalize(scene.positions.back() - centre));
      scene.texcoords.emplace_back(0.0f);
    }
  for (int j = 0; j < slices / 2; ++j)
    for (int i = 0; i < slices; ++i) {
      const auto a = static_cast<std::uint32_t>(i + (slices + 1) * j),
                 b = a + static_cast<std::uint32_t>(slices) + 1;
      if (j > 0) scene.indices.insert(scene.indices.end(), {a, a + 1, b});
      if (j + 1 < slices / 2) scene.indices.insert(scene.indices.end(), {b, a + 1, b + 1});
    }
  object.vertexCount = static_cast<std::uint32_t>(scene.positions.size());
  object.parts.push_back({material, 0, static_cast<std::uint32_t>(scene.indices.size())});
  scene.objects.push_back(object);
  builder.look({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 0.7, 8, 8);
  return scene;
}

}  // namespace

TEST_CASE("a voxelised sphere of one metre measures one metre through the file's transform") {
  const TemporaryDirectory directory;
  const glm::dvec3 centre(3.0, -2.0, 7.0);
  const Scene scene = sphereScene(glm::vec3(centre), 0.5f, 96);
  const Pipeline pipeline = Pipeline::parse(
      "pipeline \"sphere\" {\n  pass gbuffer direct_lighting.gbuffer { }\n  pass shadow "
      "direct_lighting.shadow_map { }\n  pass direct direct_lighting.shade {\n    gbuffer gbuffer\n    shadow "
      "shadow.depth\n  }\n  pass voxels voxelization.conservative { resolution 64 }\n  output direct "
      "direct.radiance\n}\n",
      "sphere.pipeline");
  vdb::Exporter exporter(device(), techniques(), scene, pipeline, {}, {{"voxels.fragments"}, {0}, false});
  openvdb::initialize();
  openvdb::GridCPtrVec grids;
  for (const vdb::NamedField& field : exporter.render(0.0, 0)) grids.push_back(exporter.grid(field, {}));
  vdb::writeVdb(directory.path() / "sphere.vdb", grids);
  const Grids read = readByOpenVdb(directory.path() / "sphere.vdb");
  const auto shell = openvdb::gridPtrCast<openvdb::BoolGrid>(read.at("voxels.fragments.occupancy"));
  REQUIRE(shell);
  const double voxel = shell->voxelSize().x();
  CHECK(voxel == Approx(1.0 / 62.0).epsilon(1e-3));

  // The voxels that the surface touches reach out to it and at most one voxel beyond on each side.
  const openvdb::CoordBBox box = shell->evalActiveVoxelBoundingBox();
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Vec3d low = shell->indexToWorld(box.min()), high = shell->indexToWorld(box.max());
    const double outer = high[axis] - low[axis] + voxel;
    CHECK(outer >= 1.0);
    CHECK(outer <= 1.0 + 2.0 * voxel);
    CHECK(std::abs(0.5 * (high[axis] + low[axis]) - centre[axis]) <= 0.5 * voxel);
  }
  // Their centres lie on both sides of the surface alike: a plane that is conservatively voxelised has a
  // symmetric distribution, and curvature shifts it by terms of order voxel^2 / radius.
  double mean = 0.0, farthest = 0.0;
  openvdb::Vec3d middle(0.0);
  for (auto value = shell->cbeginValueOn(); value; ++value) {
    const openvdb::Vec3d at = shell->indexToWorld(value.getCoord());
    const double radius = (at - openvdb::Vec3d(centre.x, centre.y, centre.z)).length();
    mean += radius / static_cast<double>(shell->activeVoxelCount());
    farthest = std::max(farthest, std::abs(radius - 0.5));
    middle += at / static_cast<double>(shell->activeVoxelCount());
  }
  CHECK(2.0 * mean == Approx(1.0).margin(2.0 * voxel * voxel / 0.5));
  CHECK(farthest <= 0.5 * std::sqrt(3.0) * voxel + 1e-3);  // half a diagonal, and the facets' sagitta
  CHECK((middle - openvdb::Vec3d(centre.x, centre.y, centre.z)).length() < 0.1 * voxel);
}

// ---- differences ---------------------------------------------------------------------------------------

namespace {

template <class GridType>
typename GridType::Ptr gridWithVoxels(double size, const openvdb::Vec3d& lowCorner) {
  openvdb::initialize();
  auto grid = GridType::create();
  // As exported grids lie: the index is the voxel's centre.
  grid->setTransform(std::make_shared<openvdb::math::Transform>(openvdb::math::MapBase::Ptr(
      new openvdb::math::UniformScaleTranslateMap(size, lowCorner + openvdb::Vec3d(0.5 * size)))));
  grid->setName("grid");
  return grid;
}

/// A box of voxels with values that grow along x, in steps that a float holds exactly.
openvdb::FloatGrid::Ptr ramp(int voxels, double size, double perMetre) {
  auto grid = gridWithVoxels<openvdb::FloatGrid>(size, openvdb::Vec3d(0.0));
  for (int z = 0; z < voxels; ++z)
    for (int y = 0; y < voxels; ++y)
      for (int x = 0; x < voxels; ++x)
        grid->tree().setValue({x, y, z}, static_cast<float>(perMetre * (x + 0.5) * size));
  return grid;
}

}  // namespace

TEST_CASE("a grid does not differ from itself, and one changed voxel is found with its place") {
  const auto grid = ramp(20, 0.25, 8.0);
  CHECK(vdb::difference(*grid, *grid, 0.0, "test").same(0.0));
  const auto changed = grid->deepCopy();
  changed->tree().setValue({7, 3, 5}, grid->tree().getValue({7, 3, 5}) + 2.0f);
  const vdb::GridDifference found = vdb::difference(*grid, *changed, 0.0, "test");
  CHECK(found.voxels == 8000);
  CHECK(found.differing == 1);
  CHECK(found.largest == 2.0);
  CHECK(found.rms == Approx(2.0 / std::sqrt(8000.0)));
  CHECK(found.where == openvdb::Coord(7, 3, 5));
  CHECK(found.lattice == "same");
  CHECK_FALSE(found.same(0.0));
  CHECK(vdb::difference(*grid, *changed, 2.0, "test").same(2.0));
}

TEST_CASE("voxels that are active in one grid alone are counted apart and compared with the background") {
  const auto first = gridWithVoxels<openvdb::Vec3fGrid>(1.0, openvdb::Vec3d(0.0)), second = first->deepCopy();
  first->fill(openvdb::CoordBBox({0, 0, 0}, {15, 15, 15}), openvdb::Vec3f(1, 2, 2));  // becomes tiles
  second->tree().setValue({0, 0, 0}, openvdb::Vec3f(1, 2, 2));
  second->tree().setValue({90, 0, 0}, openvdb::Vec3f(0, 0, 0));
  const vdb::GridDifference found = vdb::difference(*first, *second, 0.0, "test");
  CHECK(found.voxels == 4097);
  CHECK(found.onlyFirst == 4095);
  CHECK(found.onlySecond == 1);
  CHECK(found.differing == 4095);  // an active zero equals the background
  CHECK(found.largest == 2.0);
  CHECK(found.rms == Approx(std::sqrt(4095.0 * 9.0 / (3.0 * 4097.0))));
}

TEST_CASE("where either value is not a number the difference is infinite, but not where both are") {
  const auto first = ramp(4, 1.0, 1.0), second = ramp(4, 1.0, 1.0);
  first->tree().setValue({1, 1, 1}, std::nanf(""));
  CHECK(std::isinf(vdb::difference(*first, *second, 1e9, "test").largest));
  second->tree().setValue({1, 1, 1}, std::nanf(""));
  CHECK(vdb::difference(*first, *second, 0.0, "test").same(0.0));
}

TEST_CASE("a ramp averaged over coarser voxels is the ramp again") {
  // The mean of a linear function over a box is its value at the centre, exactly where whole voxels fill it.
  const vdb::GridDifference found = vdb::difference(*ramp(32, 0.25, 8.0), *ramp(8, 1.0, 8.0), 0.0, "test");
  CHECK(found.lattice == "second");
  CHECK(found.voxels == 512);
  CHECK(found.same(1e-12));
  CHECK(vdb::difference(*ramp(8, 1.0, 8.0), *ramp(32, 0.25, 8.0), 0.0, "test").lattice == "first");
}

TEST_CASE("averaging onto voxels of any ratio and place keeps the integral") {
  // 30 voxels of 0.1 m against voxels of 0.23 m shifted by 0.07 m: every border cuts voxels.
  auto fine = gridWithVoxels<openvdb::FloatGrid>(0.1, openvdb::Vec3d(0.0));
  std::mt19937 random(3);
  double integral = 0.0;
  for (int z = 0; z < 30; ++z)
    for (int y = 0; y < 30; ++y)
      for (int x = 0; x < 30; ++x) {
        const float value = static_cast<float>(random() % 100);
        fine->tree().setValue({x, y, z}, value);
        integral += value * 0.1 * 0.1 * 0.1;
      }
  // Against zeros everywhere the differences are the means themselves; where they are, counts do not matter.
  auto zeros = gridWithVoxels<openvdb::FloatGrid>(0.23, openvdb::Vec3d(0.07));
  zeros->tree().setValue({0, 0, 0}, 0.0f);
  const vdb::GridDifference found = vdb::difference(*fine, *zeros, 0.0, "test");
  REQUIRE(found.lattice == "second");
  // Sum of squares needs the means; of a constant they are known: all voxels inside are 1.
  auto ones = gridWithVoxels<openvdb::FloatGrid>(0.1, openvdb::Vec3d(0.0));
  ones->fill(openvdb::CoordBBox({0, 0, 0}, {29, 29, 29}), 1.0f);
  const vdb::GridDifference constant = vdb::difference(*ones, *zeros, 1.0 - 1e-9, "test");
  CHECK(constant.largest == Approx(1.0).epsilon(1e-12));
  // From 0 to 3 m: borders at 0.07 + 0.23 k; 12 whole voxels (k = 0..11), and 0.07 and 0.17 m at the ends.
  CHECK(constant.voxels == 14 * 14 * 14);
  CHECK(constant.differing == 12 * 12 * 12);
  // Separable: the squares of the shares along one axis are 12 + (0.07/0.23)^2 + (0.17/0.23)^2.
  const double alongOneAxis = 12.0 + (0.07 * 0.07 + 0.17 * 0.17) / (0.23 * 0.23);
  CHECK(constant.rms == Approx(std::sqrt(std::pow(alongOneAxis, 3) / std::pow(14.0, 3))));
  CHECK(found.largest < 100.0);
  CHECK(found.largest * found.voxels * std::pow(0.23, 3) > integral);  // no mean exceeds the largest
}

TEST_CASE("grids on one lattice with another first voxel are compared where they lie in the world") {
  const auto first = ramp(8, 0.5, 2.0);
  auto shifted = gridWithVoxels<openvdb::FloatGrid>(0.5, openvdb::Vec3d(-1.5, 0.5, 0.0));
  for (auto value = first->cbeginValueOn(); value; ++value)
    shifted->tree().setValue(value.getCoord() + openvdb::Coord(3, -1, 0), *value);
  const vdb::GridDifference found = vdb::difference(*first, *shifted, 0.0, "test");
  CHECK(found.voxels == 512);
  CHECK(found.same(0.0));
}

TEST_CASE("grids whose voxels are no cubes along the axes are refused by name") {
  using namespace openvdb::math;
  const auto good = ramp(4, 1.0, 1.0);
  const auto refused = [&](const MapBase::Ptr& map) {
    const auto bad = ramp(4, 1.0, 1.0);
    bad->setTransform(std::make_shared<Transform>(map));
    const std::string message =
        messageOf<Error>([&] { vdb::difference(*good, *bad, 0.0, "a.vdb and b.vdb"); });
    CHECK(contains(message, "a.vdb and b.vdb: grid 'grid' has"));
    CHECK(contains(message, "expected a linear transform with cubic voxels"));
    return message;
  };
  CHECK(contains(refused(MapBase::Ptr(new ScaleMap({1, 1, 2}))), "1 x 1 x 2 m"));
  CHECK(contains(refused(MapBase::Ptr(new UnitaryMap({0, 1, 0}, 0.3))), "rotation"));
  CHECK(contains(refused(MapBase::Ptr(new ScaleMap({-1, -1, -1}))), "mirrored"));
  const auto frustum =
      Transform::createFrustumTransform(openvdb::BBoxd({0, 0, 0}, {10, 10, 10}), 0.5, 1.0, 1.0);
  CHECK(contains(refused(frustum->baseMap()), "perspective"));
  // The same transform needs no averaging, so there the shape does not matter; a perspective is refused all
  // the same.
  const auto flat = ramp(4, 1.0, 1.0), bent = ramp(4, 1.0, 1.0);
  flat->setTransform(std::make_shared<Transform>(MapBase::Ptr(new ScaleMap({1, 1, 2}))));
  CHECK(vdb::difference(*flat, *flat, 0.0, "x").same(0.0));
  bent->setTransform(frustum);
  CHECK(contains(messageOf<Error>([&] { vdb::difference(*bent, *bent, 0.0, "x"); }), "perspective"));
  const auto vectors = gridWithVoxels<openvdb::Vec3fGrid>(1.0, openvdb::Vec3d(0.0));
  CHECK(contains(messageOf<Error>([&] { vdb::difference(*good, *vectors, 0.0, "x"); }), "the same type"));
}

// ---- files ---------------------------------------------------------------------------------------------

TEST_CASE("a file that ends too early or is no OpenVDB file is refused with its name, wherever it is cut") {
  const TemporaryDirectory directory;
  const fs::path whole = directory.path() / "whole.vdb", cut = directory.path() / "cut.vdb";
  vdb::writeVdb(whole, {ramp(20, 0.25, 8.0), ramp(9, 0.5, 1.0)});
  CHECK(vdb::readVdb(whole).size() == 2);
  const std::string bytes = readFile(whole);
  REQUIRE(bytes.size() > 2000);
  for (std::size_t part = 0; part < 60; ++part) {
    const std::size_t size = part < 30 ? part * 7 : bytes.size() - 1 - (part - 30) * bytes.size() / 31;
    directory.write("cut.vdb", bytes.substr(0, size));
    INFO(size << " of " << bytes.size() << " bytes");
    CHECK(contains(messageOf<Error>([&] { vdb::readVdb(cut); }), "cut.vdb: "));
  }
  directory.write("text.vdb", "scene \"no grid at all\" { }\n");
  CHECK(contains(messageOf<Error>([&] { vdb::readVdb(directory.path() / "text.vdb"); }),
                 "expected a whole OpenVDB file"));
  CHECK(contains(messageOf<Error>([&] { vdb::readVdb(directory.path() / "none.vdb"); }),
                 "none.vdb: cannot read"));
  CHECK(contains(messageOf<Error>([&] { vdb::readVdb(directory.path()); }), "is a directory"));
}

TEST_CASE("a full disk is told, and leaves the old file as it was") {
  const Workplace place;
  // The file-size limit stands for the disk: both refuse the bytes that are too many.
  const std::string program = "'" + (binaryDirectory() / "bin/vdbexport").string() + "' ";
  place.write("out.vdb", "old");
  const CommandResult result =
      runCommand("trap '' XFSZ; ulimit -f 4; " + program + place.scene() + " " +
                 committedPipeline("voxel_cone_tracing") + " --grid grid.mips -o " + place.file("out.vdb"));
  checkRefused(result, "out.vdb: cannot write");
  CHECK(place.read("out.vdb") == "old");
  CHECK(place.fileCount() == 4);  // nothing half-written beside it
}

// ---- the command line ----------------------------------------------------------------------------------

TEST_CASE("bad input of vdbexport is refused with what was expected, and nothing is written") {
  const Workplace place;
  const std::string inputs = place.scene() + " " + committedPipeline("voxel_cone_tracing");
  const std::string out = " -o " + place.file("out.vdb");
  checkRefused(vdbexport(inputs + out + " --grid grid.mip"), "did you mean 'grid.mips'");
  checkRefused(vdbexport(inputs + out + " --grid direct.radiance"),
               "is of kind Image; expected one of the kinds");
  checkRefused(vdbexport(inputs + out + " --grid grid.mips --level 42"),
               "has no level 42; it has levels 0, 1");
  checkRefused(vdbexport(inputs + out + " --grid light.radiance --level 1"), "it has level 0");
  checkRefused(vdbexport(inputs + out + " --level fine"), "--level 'fine': expected a whole number");
  checkRefused(vdbexport(inputs + out + " --frame 9..3"), "--frame '9..3': expected FIRST..LAST");
  checkRefused(vdbexport(inputs + " -o " + place.file("out.exr")), "expected a name that ends in .vdb");
  checkRefused(vdbexport(inputs), "expected a name that ends in .vdb");
  checkRefused(vdbexport(place.scene() + out), "1 inputs given; expected SCENE PIPELINE");
  checkRefused(vdbexport(inputs + out + " --all --grid grid.mips"), "--all");
  checkRefused(vdbexport(inputs + " -o /proc/none/out.vdb"), "/proc/none");
  checkRefused(vdbexport(place.scene() + " " + committedPipeline("direct_lighting") + out),
               "has no voxel grid to export");
  checkRefused(vdbexport("--diff " + place.scene() + " " + place.scene()), "expected a whole OpenVDB file");
  checkRefused(vdbexport("--list " + place.file("none.vdb")), "none.vdb: cannot read");
  CHECK(place.fileCount() == 3);
}

TEST_CASE("a grid without an occupied voxel is told, not written") {
  const Workplace place;
  // The only light stands behind a camera that sees nothing; the smoke's source is at rest far away.
  place.write(
      "empty.scene",
      "scene \"Nothing\" {\n  camera main { eye 0 0 0.9  target 0 0 -1  fov 70 deg  resolution 8 8 }\n}\n");
  const CommandResult result =
      vdbexport(place.file("empty.scene") + " " + committedPipeline("voxel_cone_tracing") +
                " --grid voxels.fragments -o " + place.file("out.vdb"));
  INFO(result.errors);
  CHECK(result.exitCode == 2);
  CHECK(contains(result.errors, "voxels.fragments"));
  CHECK_FALSE(place.has("out.vdb"));
}

TEST_CASE("vdbexport lists what a pipeline and a file hold, exports it, and finds no difference to itself") {
  const Workplace place;
  const std::string inputs =
      place.scene() + " " + committedPipeline("voxel_cone_tracing") + " --set resolution=16";
  const auto listed = nlohmann::json::parse(vdbexport("--list --json " + inputs).output);
  std::map<std::string, int> found;
  for (const auto& entry : listed)
    ++found[entry["grid"].get<std::string>() + "." + entry["field"].get<std::string>()];
  CHECK(found["voxels.fragments.fragments"] == 1);
  CHECK(found["grid.mips.radiance"] == 5);       // 16, 8, 4, 2, 1
  CHECK(found["light.radiance.radiance"] == 0);  // the same texture as grid.mips
  for (const auto& entry : listed)
    if (entry["field"] == "radiance" && entry["level"] == 0) CHECK(entry["bytes"] == 16 * 16 * 16 * 16);

  const auto kinds =
      nlohmann::json::parse(vdbexport("--list --json " + committedPipeline("voxel_cone_tracing")).output);
  CHECK(kinds.size() == 3);

  REQUIRE(vdbexport(inputs + " -q --all --level all -o " + place.file("a.vdb")).exitCode == 0);
  REQUIRE(vdbexport(inputs + " -q --grid grid.mips -o " + place.file("b.vdb")).exitCode == 0);
  const auto file = nlohmann::json::parse(vdbexport("--list --json " + place.file("a.vdb")).output);
  CHECK(file.size() == 12);  // 5 levels of radiance and opacity, occupancy, fragments
  for (const auto& entry : file) CHECK(entry["active_voxels"] > 0);

  const CommandResult same = vdbexport("--diff --json " + place.file("a.vdb") + " " + place.file("b.vdb") +
                                       " --grid grid.mips.radiance --grid grid.mips.opacity");
  CHECK(same.exitCode == 0);
  for (const auto& entry : nlohmann::json::parse(same.output)) CHECK(entry["largest"] == 0.0);
  const CommandResult more = vdbexport("--diff " + place.file("a.vdb") + " " + place.file("b.vdb"));
  CHECK(more.exitCode == 1);
  CHECK(contains(more.output, "only the first has it"));
  const CommandResult levels = vdbexport("--diff " + place.file("a.vdb") + " " + place.file("b.vdb") +
                                         " --grid grid.mips.opacity.level1=grid.mips.opacity");
  CHECK(levels.exitCode == 1);
  CHECK(contains(levels.output, "first"));
  checkRefused(
      vdbexport("--diff " + place.file("a.vdb") + " " + place.file("b.vdb") + " --grid grid.mips.opacty"),
      "did you mean 'grid.mips.opacity'");
}

TEST_CASE("a range of frames becomes numbered files that say which frame and time they are") {
  const Workplace place;
  const std::string inputs = place.scene() + " " + committedPipeline("voxel_cone_tracing") +
                             " --set resolution=8 -q --grid grid.mips ";
  REQUIRE(vdbexport(inputs + "--frame 2..3 --fps 10 -o " + place.file("s.vdb")).exitCode == 0);
  REQUIRE(vdbexport(inputs + "--frame 7 -o " + place.file("one.vdb")).exitCode == 0);
  CHECK_FALSE(place.has("s.vdb"));
  REQUIRE(place.has("s_0002.vdb"));
  REQUIRE(place.has("s_0003.vdb"));
  const Grids grids = readByOpenVdb(place.file("s_0003.vdb"));
  CHECK(metaText(*grids.at("grid.mips.radiance"), "lumivox.frame") == "3");
  CHECK(metaText(*grids.at("grid.mips.radiance"), "lumivox.time") == "0.3");
  CHECK(metaText(*readByOpenVdb(place.file("one.vdb")).at("grid.mips.opacity"), "lumivox.frame") == "7");
}

// ---- other programs ------------------------------------------------------------------------------------

TEST_CASE("the commands of the guide work, and OpenVDB's own printer reads what they write") {
  if (!hasProgram("vdb_print")) return skip("vdb_print is absent");
  const TemporaryDirectory directory;
  fs::create_directory_symlink(sourceDirectory() / "scenes", directory.path() / "scenes");
  const std::string guide = readFile(sourceDirectory() / "docs/looking_at_grids.md");
  static const std::regex command("\n((?:vdbexport|vdb_print) [^\n]+)");
  int ran = 0;
  for (std::sregex_iterator match(guide.begin(), guide.end(), command), end; match != end; ++match) {
    const std::string line = (*match)[1];
    INFO(line);
    const CommandResult result = runCommand("cd '" + directory.path().string() + "' && PATH='" +
                                            (binaryDirectory() / "bin").string() + "':\"$PATH\" " + line);
    INFO(result.output << result.errors);
    // Grids of two resolutions differ: that is what the guide shows.
    CHECK(result.exitCode == (contains(line, "--diff") ? 1 : 0));
    if (contains(line, "vdb_print")) CHECK(contains(result.output, "radiance"));
    ++ran;
  }
  CHECK(ran >= 5);
}

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
  const fs::path control = directory.path() / "control.vdb", exported = directory.path() / "exported.vdb";
  exportKinds(exported, {{"all.occupancy", "all.radiance"}, {0}, false}, farScene());
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
  const fs::path file = directory.path() / "smoke.vdb";
  makeContent();
  content().media.media.pop_back();
  exportKinds(file, {{"all.media"}, {0}, false}, farScene());
  makeContent();
  const fs::path script = directory.write(
      "load.py",
      "import bpy\nvolume = bpy.data.volumes.new('smoke')\nvolume.filepath = '" + file.string() +
          "'\nvolume.grids.load()\nprint('GRIDS', [(g.name, g.data_type) for g in volume.grids])\n");
  const CommandResult result =
      runCommand("blender --background --factory-startup --python '" + script.string() + "'");
  INFO(result.output << result.errors);
  CHECK(contains(result.output, "GRIDS [('density', 'FLOAT')]"));
}
