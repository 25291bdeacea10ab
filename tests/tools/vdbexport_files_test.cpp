// OpenVDB files and the command line: whole or absent, differences that have a closed form, bad input
// refused.
#include <openvdb/math/Maps.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <map>
#include <regex>

#include "lumivox/base/error.h"
#include "lumivox/base/image.h"
#include "support/scene_builder.h"
#include "support/techniques.h"
#include "tools/cli_support.h"
#include "tools/vdbexport_support.h"
#include "vdbexport/difference.h"
#include "vdbexport/export.h"
#include "vdbexport/vdb_file.h"

using namespace lumivox;
using namespace lumivox::test;
namespace fs = std::filesystem;

namespace {

/// vdbexport in place of lumivox.
template <class... Words>
CommandResult vdbexport(const Words&... words) {
  return runCommand(lineOf("vdbexport", {}, words...));
}
template <class... Words>
nlohmann::json listed(const Words&... words) {
  return nlohmann::json::parse(vdbexport("--list --json", words...).output);
}

// ---- a sphere of one metre -----------------------------------------------------------------------------

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

TEST_CASE("a voxelized sphere of one metre measures one metre through the file's transform") {
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
  // Their centres lie on both sides of the surface alike: a plane that is conservatively voxelized has a
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

TEST_CASE("several grids lie in a file byte for byte as OpenVDB itself writes them, but for its tag") {
  const TemporaryDirectory directory;
  const auto small = ramp(9, 0.5, 1.0), named = ramp(30, 0.5, 1.0), wide = ramp(20, 0.25, 8.0);
  small->setName("half floats");
  small->setSaveFloatAsHalf(true);
  named->setName("a longer name");
  const fs::path file = directory.path() / "theirs.vdb";
  const auto withoutTag = [](std::string bytes) {
    static const std::regex tag("[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}");
    return std::regex_replace(bytes.substr(0, 128), tag, "tag") + bytes.substr(128);
  };
  // The last two: a name that comes twice and a tree that two grids share, which OpenVDB writes otherwise.
  const auto shared = wide->copy();
  shared->setName("shared");
  for (const openvdb::GridCPtrVec& grids :
       {openvdb::GridCPtrVec{small, wide, named}, openvdb::GridCPtrVec{named},
        openvdb::GridCPtrVec{named, named}, openvdb::GridCPtrVec{wide, shared, small}}) {
    openvdb::io::File stream(file.string());
    stream.write(grids);
    stream.close();
    CHECK(withoutTag(vdb::encode(grids)) == withoutTag(readFile(file)));
  }
}

TEST_CASE("a full disk is told, and leaves the old file as it was") {
  const Workplace place;
  // The file-size limit stands for the disk: both refuse the bytes that are too many.
  place.write("out.vdb", "old");
  checkRefused(
      runCommand(lineOf("vdbexport", Before{"trap '' XFSZ; ulimit -f 4;"}, place.scene(),
                        committedPipeline("voxel_cone_tracing"), "--grid grid.mips -o", place / "out.vdb")),
      "out.vdb", "cannot write");
  CHECK(place.read("out.vdb") == "old");
  CHECK(place.fileCount() == 4);  // nothing half-written beside it
}

// ---- the command line ----------------------------------------------------------------------------------

TEST_CASE("bad input of vdbexport is refused with what was expected, and nothing is written") {
  const Workplace place;
  const std::string cones = committedPipeline("voxel_cone_tracing");
  for (const auto& [options, facts] : std::vector<std::pair<const char*, Tells>>{
           {"--grid grid.mip", Tells("did you mean", "grid.mips")},
           {"--list --seed -1", Tells("--seed", "-1")},
           {"--grid direct.radiance", Tells("Image", "expected")},
           {"--grid grid.mips --level 42", Tells("level", 42, "levels", 0, 1)},
           {"--grid light.radiance --level 1", Tells("level", 0)},
           {"--level fine", Tells("--level", "fine", "whole number")},
           {"--frames 9..3", Tells("--frames", "9..3", "FIRST..LAST")},
           {"--all --grid grid.mips", Tells("--all")},
           {"-o out.exr", Tells(".vdb")},
           {"-o /proc/none/out.vdb", Tells("/proc/none")}}) {
    CAPTURE(options);
    const std::string output = contains(options, "-o ") || contains(options, "--list") ? "" : "-o out.vdb";
    const CommandResult result =
        runCommand("cd '" + place.path().string() + "' && " +
                   lineOf("vdbexport", {}, place.scene(), cones, options, output.c_str()));
    checkRefused(result);
    CHECK_THAT(result.errors, facts);
  }
  checkRefused(vdbexport(place.scene(), cones), ".vdb");
  checkRefused(vdbexport(place.scene(), "-o", place / "out.vdb"), 1, "SCENE PIPELINE");
  checkRefused(vdbexport(place.scene(), committedPipeline("direct_lighting"), "-o", place / "out.vdb"),
               "no voxel grid");
  checkRefused(vdbexport("--diff", place.scene(), place.scene()), "OpenVDB");
  checkRefused(vdbexport("--list", place / "none.vdb"), "none.vdb");
  CHECK(place.fileCount() == 3);
}

TEST_CASE("a grid without an occupied voxel is told, not written") {
  const Workplace place;
  // The only light stands behind a camera that sees nothing; the smoke's source is at rest far away.
  place.write(
      "empty.scene",
      "scene \"Nothing\" {\n  camera main { eye 0 0 0.9  target 0 0 -1  fov 70 deg  resolution 8 8 }\n}\n");
  checkRefused(vdbexport(place / "empty.scene", committedPipeline("voxel_cone_tracing"),
                         "--grid voxels.fragments -o", place / "out.vdb"),
               "voxels.fragments");
  CHECK_FALSE(place.has("out.vdb"));
}

TEST_CASE("vdbexport lists what a pipeline and a file hold, exports it, and finds no difference to itself") {
  const Workplace place;
  const std::string cones = committedPipeline("voxel_cone_tracing");
  const auto grids = listed(place.scene(), cones, "--set resolution=16");
  std::map<std::string, int> found;
  for (const auto& entry : grids)
    ++found[entry["grid"].get<std::string>() + "." + entry["field"].get<std::string>()];
  CHECK(found["voxels.fragments.fragments"] == 1);
  CHECK(found["grid.mips.radiance"] == 5);       // 16, 8, 4, 2, 1
  CHECK(found["light.radiance.radiance"] == 0);  // the same texture as grid.mips
  for (const auto& entry : grids)
    if (entry["field"] == "radiance" && entry["level"] == 0) CHECK(entry["bytes"] == 16 * 16 * 16 * 16);
  CHECK(listed(cones).size() == 3);

  for (const auto& [options, name] : {std::pair("--all --level all", "a.vdb"), {"--grid grid.mips", "b.vdb"}})
    REQUIRE(vdbexport(place.scene(), cones, "--set resolution=16 -q", options, "-o", place / name).exitCode ==
            0);
  const auto file = listed(place / "a.vdb");
  CHECK(file.size() == 12);  // 5 levels of radiance and opacity, occupancy, fragments
  for (const auto& entry : file) CHECK(entry["active_voxels"] > 0);

  const auto diff = [&](const char* options) {
    return vdbexport("--diff", place / "a.vdb", place / "b.vdb", options);
  };
  const CommandResult same = diff("--json --grid grid.mips.radiance --grid grid.mips.opacity");
  CHECK(same.exitCode == 0);
  for (const auto& entry : nlohmann::json::parse(same.output)) CHECK(entry["largest"] == 0.0);
  const CommandResult more = diff(""), levels = diff("--grid grid.mips.opacity.level1=grid.mips.opacity");
  CHECK(more.exitCode == 1);
  CHECK_THAT(more.output, Tells("only", "first"));
  CHECK(levels.exitCode == 1);
  CHECK_THAT(levels.output, Tells("first"));
  checkRefused(diff("--grid grid.mips.opacty"), "did you mean", "grid.mips.opacity");
}

TEST_CASE("a range of frames becomes numbered files that say which frame and time they are") {
  const Workplace place;
  for (const auto& [frames, name] : {std::pair("--frames 2..3 --fps 10", "s.vdb"), {"--frames 7", "one.vdb"}})
    REQUIRE(vdbexport(place.scene(), committedPipeline("voxel_cone_tracing"),
                      "--set resolution=8 -q --grid grid.mips", frames, "-o", place / name)
                .exitCode == 0);
  CHECK_FALSE(place.has("s.vdb"));
  REQUIRE(place.has("s_0002.vdb"));
  REQUIRE(place.has("s_0003.vdb"));
  const Grids grids = readByOpenVdb(place.file("s_0003.vdb"));
  CHECK(metaText(*grids.at("grid.mips.radiance"), "lumivox.frame") == "3");
  CHECK(metaText(*grids.at("grid.mips.radiance"), "lumivox.time") == "0.3");
  CHECK(metaText(*readByOpenVdb(place.file("one.vdb")).at("grid.mips.opacity"), "lumivox.frame") == "7");
}

TEST_CASE("vdbexport writes a preview beside the grids, with the exposure that images have") {
  const Workplace place;
  const auto exported = [&](const char* options, const char* name) {
    return vdbexport(place.scene(), committedPipeline("voxel_cone_tracing"),
                     "-q --set resolution=16 --grid grid.mips -o", place / "g.vdb", "--preview", place / name,
                     options);
  };
  const auto preview = [&](const char* options) {
    const CommandResult result = exported(options, "p.png");
    INFO(result.errors);
    REQUIRE(result.exitCode == 0);
    return readByteImage(place / "p.png");
  };
  const ByteImage automatic = preview(""), dark = preview(" --exposure -20");
  // Two grids, radiance and opacity, each along three axes.
  CHECK(automatic.width == 6 * 166 + 6);
  CHECK(dark.values != automatic.values);
  CHECK(preview(" --frames 0..1").height > 3 * automatic.height / 2);
  checkRefused(exported("--exposure dark", "p.png"), "auto", "EV");
  checkRefused(exported("--tone sepia", "p.png"), "linear");
  checkRefused(exported("", "p.jpg"), ".png");
}
