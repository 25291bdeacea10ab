// Measuring voxelizers: the right numbers for a room whose voxels are known, the committed scenes without a
// miss, and bad input.
#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "lumivox/analysis/scaling.h"
#include "lumivox/base/file.h"
#include "lumivox/experiment/voxelizers.h"
#include "support/drawn_page.h"
#include "support/scene_builder.h"
#include "support/techniques.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;
namespace fs = std::filesystem;

namespace {

constexpr const char* kVoxels =
    "pipeline \"Voxels\" {\n  param resolution 16 in 1..1024\n"
    "  pass voxels voxelization.conservative { resolution $resolution }\n}\n";

/// A room of two metres: its walls fill the shell of the voxels within the empty margin.
std::uint64_t shellOf(std::uint64_t side) {
  const std::uint64_t outer = side - 2, inner = side - 4;
  return outer * outer * outer - inner * inner * inner;
}

template <class... Words>
CommandResult measure(const Workplace& place, const Words&... words) {
  place.write("voxels.pipeline", kVoxels);
  return typed("-q voxels", place.scene(), "--repeats 1 --pipelines", place / "voxels.pipeline", words...);
}

VoxelizerOptions committedConservative(std::vector<int> resolutions) {
  VoxelizerOptions options;
  options.pipelines = {committedPipeline("voxelizers/conservative")};
  options.resolutions = std::move(resolutions);
  options.openSweeps = false;
  options.repeats = 1;
  return options;
}

/// Whether a scene's text names a model that is not among the committed ones.
bool showsPublishedModels(const std::string& text) {
  const std::string word = "file \"";
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::string path = text.substr(at + word.size(), 10);
    if (path.rfind("models/", 0) != 0 && path.rfind("../models/", 0) != 0) return true;
  }
  return false;
}

/// Recall and precision of the conservative voxelizer on every scene of a folder; what the machine lacks is
/// counted.
void requireNothingMissed(const fs::path& folder, const std::vector<int>& resolutions, bool withModels,
                          int& measured, int& absent) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".scene") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    if (showsPublishedModels(readFile(file)) != withModels) continue;
    INFO(file);
    try {
      const Scene scene = loadScene(file);
      for (const VoxelizerRecord& record :
           measureVoxelizers(device(), techniques(), scene, committedConservative(resolutions))) {
        INFO("resolution " << record.resolution << ", missed " << record.error.falseNegative << ", wrong "
                           << record.error.falsePositive << " of " << record.occupied);
        CHECK(record.whyNot.empty());
        CHECK(record.error.falseNegative == 0);
        CHECK(record.error.precision() >= 0.98);
        CHECK(record.holes.axisHoles == 0);
        CHECK(record.holes.obliqueHoles == 0);
        ++measured;
      }
    } catch (const AbsentError&) {
      ++absent;
    }
  }
}

}  // namespace

TEST_CASE("a room's walls fill the shell of its grid, at what the fragments cost") {
  Workplace place;
  const CommandResult result = measure(place, "--resolution 16,32 --json");
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);
  const auto json = nlohmann::json::parse(result.output);
  REQUIRE(json["records"].size() == 2);
  for (const auto& record : json["records"]) {
    CHECK(record["occupied"] == shellOf(record["resolution"]));
    CHECK(record["reference"] == record["occupied"]);
    CHECK(record["recall"] == 1.0);
    CHECK(record["precision"] == 1.0);
    CHECK(record["oblique_holes"] == 0);
    CHECK(record["axis_crossings"] > 0);
    CHECK(record["output"] == "voxels.fragments");
    CHECK(record["bytes"] == 24 * record["fragments"].get<std::uint64_t>());
    CHECK(record["bytes_per_fragment"] == 24.0);
    CHECK(record["allocated_bytes"] >= record["bytes"]);
    CHECK(record["frame_ms"]["median"] > 0.0);
    CHECK(record["triangles"] == 12);
  }
  REQUIRE(json["scaling"].size() == 1);
  CHECK(json["scaling"][0].contains("with_resolution"));
}

TEST_CASE("splitting triangles leaves the surface and its voxels, and four times the triangles") {
  Workplace place;
  const CommandResult result = measure(place, "--resolution 16 --scaling --json");
  REQUIRE(result.exitCode == 0);
  const auto json = nlohmann::json::parse(result.output);
  REQUIRE(json["records"].size() == 3);
  for (int i = 0; i < 3; ++i) {
    CHECK(json["records"][i]["triangles"] == 12 << 2 * i);
    CHECK(json["records"][i]["occupied"] == shellOf(16));
  }
  CHECK(json["scaling"][0].contains("with_triangles"));

  SceneBuilder builder;
  builder.box({0, 0, 0}, {1, 2, 3}, builder.lambert(0.5f), false);
  const Scene finer = subdivided(builder.scene);
  const auto areaOf = [](const Scene& scene) {
    double area = 0.0;
    for (std::size_t i = 0; i < scene.indices.size(); i += 3) {
      const glm::vec3 &a = scene.positions[scene.indices[i]], &b = scene.positions[scene.indices[i + 1]],
                      &c = scene.positions[scene.indices[i + 2]];
      area += 0.5 * static_cast<double>(glm::length(glm::cross(b - a, c - a)));
      CHECK(glm::dot(glm::cross(b - a, c - a), scene.normals[scene.indices[i]]) > 0.0f);
    }
    return area;
  };
  CHECK(finer.triangleCount() == 4 * builder.scene.triangleCount());
  CHECK(areaOf(finer) == Approx(areaOf(builder.scene)));
  Scene deforming = builder.scene;
  deforming.objects.front().sequence = VertexSequence{};
  CHECK_THROWS_AS(subdivided(deforming), Error);
}

TEST_CASE("a power law through the medians has the exponent that made them") {
  std::vector<VoxelizerRecord> records;
  for (const int resolution : {16, 32, 64}) {
    VoxelizerRecord record;
    record.scene = "s", record.pipeline = "p";
    record.resolution = resolution;
    record.triangles = 10;
    record.frameMs.median = 0.1 * std::pow(resolution, 1.5);
    records.push_back(record);
  }
  VoxelizerRecord more = records.front();
  more.subdivisions = 1;
  more.triangles = 40;
  more.frameMs.median *= 2.0;
  records.push_back(more);
  const auto scaling = scalingOf(records);
  REQUIRE(scaling.size() == 1);
  CHECK(*scaling[0].withResolution == Approx(1.5));
  CHECK(*scaling[0].withTriangles == Approx(0.5));
}

TEST_CASE("the page, the CSV and the JSON hold the same records, and the page needs nothing else") {
  Workplace place;
  const CommandResult result = measure(place, "--resolution 16,32 -o", place / "out");
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);
  CHECK(contains(result.output, "voxels voxels.fragments"));
  const auto json = nlohmann::json::parse(place.read("out/voxels.json"));
  CHECK(json["records"].size() == 2);
  const std::string csv = place.read("out/voxels.csv"), page = place.read("out/index.html");
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 3);
  // What runs have too is called as in theirs.
  const std::string head = csv.substr(0, csv.find("\r\n"));
  CHECK(contains(head, "device,driver,scene,pipeline,default,"));
  CHECK(contains(head, ",frame_ms,frame_ms_lower_quartile,frame_ms_upper_quartile,repeats,"));
  CHECK(contains(head, ",parameter_resolution"));
  CHECK(pageRecords(page).at("voxels") == json["records"]);
  CHECK(pageRecords(page).at("scaling") == json["scaling"]);
  CHECK(!contains(page, "src=\"http"));
}

TEST_CASE("a report has a section on voxelizers when it is asked for, and only then") {
  Workplace place;
  place.write("direct.pipeline",
              "pipeline \"Direct\" {\n  pass gbuffer direct_lighting.gbuffer { }\n"
              "  pass shadow direct_lighting.shadow_map { size 64 }\n"
              "  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }\n"
              "  output direct direct.radiance\n}\n");
  const auto report = [&](const char* voxels) {
    ran("-q report", place.scene(), "--pipeline", place / "direct.pipeline",
        "--spp 4 --subpixels 1 --repeats 1 --seeds 1 --no-sweep", voxels, "-o", place / "report.html");
    return pageRecords(place.read("report.html")).contains("voxels");
  };
  CHECK_FALSE(report(""));
  CHECK(!nlohmann::json::parse(place.read("report.json")).contains("voxels"));
  CHECK(report("--voxels 16"));
  bool conservative = false;
  const nlohmann::json json = nlohmann::json::parse(place.read("report.json"));
  for (const auto& record : json["voxels"])
    if (record["label"] == "conservative voxels.fragments") conservative = record["recall"] == 1.0;
  CHECK(conservative);
}

TEST_CASE("a pipeline without voxels and one without a resolution are passed over with the reason") {
  Workplace place;
  place.write("other.pipeline",
              "pipeline \"View\" {\n  param resolution 16 in 1..64\n  pass shadow "
              "direct_lighting.shadow_map { size $resolution }\n}\n");
  place.write("fixed.pipeline",
              "pipeline \"Fixed\" {\n  pass voxels voxelization.conservative { resolution 16 }\n}\n");
  const CommandResult result = measure(place, "--resolution 16 --pipelines", place / "other.pipeline",
                                       "--pipelines", place / "fixed.pipeline");
  INFO(result.errors);
  CHECK(result.exitCode == 0);
  CHECK_THAT(unwrapped(result.output), Tells("other", 16, "no voxels") && Tells("fixed", 16, "resolution"));
  CHECK(typed("-q voxels", place.scene(), "--repeats 1 --pipelines", place / "fixed.pipeline").exitCode == 1);
  // Beyond what a text allows, that voxelizer alone has no numbers.
  place.write("small.pipeline",
              "pipeline \"Small\" {\n  param resolution 16 in 1..32\n  pass voxels "
              "voxelization.conservative { resolution $resolution }\n}\n");
  const CommandResult beyond = measure(place, "--resolution 64 --pipelines", place / "small.pipeline");
  CHECK(beyond.exitCode == 0);
  CHECK_THAT(unwrapped(beyond.output), Tells("1..32"));
}

TEST_CASE("bad input of the voxels command is refused before any work, and names what it is about") {
  Workplace place;
  fs::create_directory(place / "empty");
  place.write("wrong.pipeline", "pipeline \"Wrong\" {\n  pass a voxelization.conservativ { }\n}\n");
  place.write("file", "");
  checkRefused(measure(place, "--resolution 0"), "--resolution", 0, "1..1024");
  checkRefused(measure(place, "--resolution 2000"), "--resolution", 2000, "1..1024");
  checkRefused(measure(place, "--resolution 16,x"), "--resolution", "16,x");
  checkRefused(measure(place, "--resolution 16 --set nothing=3"), "nothing");
  checkRefused(measure(place, "--camera nobody"), "nobody");
  checkRefused(measure(place, "--pipelines", place / "nowhere"), "nowhere");
  checkRefused(measure(place, "--pipelines", place / "empty"), "empty", "no pipeline");
  checkRefused(measure(place, "--pipelines", place / "wrong.pipeline"), "conservativ");
  checkRefused(measure(place, "-o", place / "file"), "file");
}

TEST_CASE("the conservative voxelizer misses no voxel of any committed scene, and hardly any is wrong",
          "[slow]") {
  int measured = 0, absent = 0;
  requireNothingMissed(sourceDirectory() / "scenes", {32, 64}, false, measured, absent);
  requireNothingMissed(sourceDirectory() / "scenes/stress", {32}, false, measured, absent);
  CHECK(measured > 20);
  CHECK(absent == 0);
}

TEST_CASE("the conservative voxelizer misses no voxel of the published models", "[slow]") {
  int measured = 0, absent = 0;
  requireNothingMissed(sourceDirectory() / "scenes", {64}, true, measured, absent);
  // Models that no committed scene shows.
  Workplace place;
  for (const char* name : {"armadillo", "horse"}) {
    place.write(std::string(name) + ".scene",
                std::string("scene \"Model\" {\n  camera main { eye 0 0 3  target 0 0 0  fov 40 deg  "
                            "resolution 16 16 }\n  mesh model { file \"") +
                    name + "/" + name + ".obj\" }\n}\n");
  }
  fs::remove(place.scene());
  requireNothingMissed(place.path(), {64}, true, measured, absent);
  if (measured == 0) skip("none of the published models is on the asset path");
}
