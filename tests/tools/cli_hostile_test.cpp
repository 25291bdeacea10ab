// Numbers, names and texts that nobody means: refused with a sentence, before any work, and soon.
#include <algorithm>
#include <chrono>

#include "lumivox/base/image.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// What check finds, and seconds by the clock until it was done.
std::pair<CommandResult, double> timedCheck(const Workplace& place, const char* name) {
  const auto start = std::chrono::steady_clock::now();
  CommandResult result = typed("check", place / name);
  return {std::move(result), std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
}
constexpr double kSoon = 60.0;  // s, on a machine that does other things too

}  // namespace

TEST_CASE("numbers of options that nothing could be computed with are refused, and nothing is written") {
  const Workplace place;
  for (const char* option : {"--eye nan,0,0",
                             "--eye 0,0,inf",
                             "--eye 1e200,0,0",
                             "--target 0,-nan,0",
                             "--target 0,0",
                             "--fov nan",
                             "--fov inf",
                             "--fov 0",
                             "--fov 4",
                             "--time nan",
                             "--time inf",
                             "--time 1e300",
                             "--frames 0..1 --fps nan",
                             "--frames 0..1 --fps inf",
                             "--frames 0..1 --fps 0",
                             "--frames 0..1 --fps -24",
                             "--frames 0..1 --fps 1e-300",
                             "--frames 2147483646..2147483647",
                             "--frames 4294967296..4294967297",
                             "--frames 99999999999999999999",
                             "--frames 5..3",
                             "--frames -1..3",
                             "--frames 1..",
                             "--frames ..",
                             "--resolution 4294967297x8",
                             "--resolution -4x4",
                             "--resolution 0x0",
                             "--resolution 8x8x8",
                             "--exposure nan",
                             "--exposure 1e300",
                             "--accumulate 99999999999",
                             "--seed -1",
                             "--seed 1e300"}) {
    CAPTURE(option);
    const std::string name = std::string(option).substr(std::string(option).rfind("--"));
    checkRefused(place.render("direct_lighting", option, "-o", place / "x.png"),
                 name.substr(0, name.find(' ')));
  }
  const char* origin = "--eye 0,0,0 --target";
  checkRefused(place.render("direct_lighting", origin, "0,0,0 -o", place / "x.png"), "eye", "target", "same");
  checkRefused(place.render("direct_lighting", origin, "0,1,0 -o", place / "x.png"), "along", "'up'");
  CHECK_FALSE(place.has("x.png"));
  checkRefused(typed("reference -q --occlusion-distance nan", place.scene(), "-o", place / "x.png"),
               "--occlusion-distance");
  checkRefused(typed("reproduce --scale nan"), "--scale");
  checkRefused(typed("cache prune --unused-for nan"), "--unused-for");
  checkRefused(typed("tune --error nan", place.scene()), "--error");
  checkRefused(typed("tune --frame-time 1e300s", place.scene()), "--frame-time");
}

TEST_CASE("check names the numbers of a scene that render would have made NaN or black of") {
  const Workplace place;
  for (const auto& [word, light] :
       {std::pair("direction", "light l directional { direction 1e200 -1e200 0  irradiance 1 }"),
        std::pair("intensity", "light l point { position 0 0 0  intensity 1e39 }"),
        std::pair("emission", "material m { emission 1e39 }")}) {
    place.write("bad.scene", std::string("scene \"x\" {\n  camera main { eye 0 0 0.9  target 0 0 -1 }\n"
                                         "  mesh room { file \"room.obj\" }\n  ") +
                                 light + "\n}\n");
    checkRefused(typed("check", place / "bad.scene"), word);
    checkRefused(
        typed("render", place / "bad.scene", committedPipeline("direct_lighting"), "-o", place / "x.png"),
        word);
  }
  CHECK_FALSE(place.has("x.png"));
}

TEST_CASE(
    "texts of one endless line and of very many unknown names are checked soon, and the findings are counted") {
  const Workplace place;
  place.write("line.scene", std::string(std::size_t{4} << 20, '@'));
  const auto [line, lineSeconds] = timedCheck(place, "line.scene");
  checkRefused(line, "'@'");
  CHECK(lineSeconds < kSoon);

  constexpr int kNames = 25000;
  std::string scene = "scene \"x\" {\n  camera main { eye 0 0 0.9  target 0 0 -1 }\n",
              pipeline = "pipeline \"x\" {\n";
  for (int i = 0; i < kNames; ++i) {
    scene += "  material m" + std::to_string(i) + " { }\n  mesh n" + std::to_string(i) +
             " { file \"room.obj\"  material k" + std::to_string(i) + " }\n";
    pipeline += "  pass p" + std::to_string(i) + " unknown" + std::to_string(i) + ".x { }\n";
  }
  place.write("names.scene", scene + "}\n");
  const auto [names, nameSeconds] = timedCheck(place, "names.scene");
  checkRefused(names, "material", "k0", 24800, 200);
  CHECK(nameSeconds < kSoon);
  const auto json = nlohmann::json::parse(typed("check --json", place.file("names.scene")).output);
  CHECK(json[0]["findings"].size() == 200);
  CHECK(json[0]["more_findings"] == 24800);

  place.write("names.pipeline", pipeline + "}\n");
  const auto [passes, passSeconds] = timedCheck(place, "names.pipeline");
  checkRefused(passes, "pass", 1000);
  CHECK(passSeconds < kSoon);
}

TEST_CASE("an output that is an input, another output or a file of another kind is refused before the work") {
  const Workplace place;
  const std::string direct = committedPipeline("direct_lighting"), taken = "read";
  ran("sweep -q --resolution 8x8 --spp 2 --subpixels 1 --repeats 1 --seeds 1 --flicker-frames 0 --pipeline",
      direct, "--store", place / "store.sqlite", place.scene());
  const std::string before = place.read("store.sqlite");
  std::filesystem::create_symlink("store.sqlite", place / "link.csv");
  std::filesystem::create_hard_link(place / "store.sqlite", place / "hard.csv");
  const auto exported = [&](const auto&... output) {
    return typed("results export --store", place / "store.sqlite", "-o", output...);
  };
  checkRefused(exported(place / "store.sqlite"), "-o");
  checkRefused(exported(place / "link.csv"), "link.csv", taken);
  checkRefused(exported(place / "hard.csv"), "hard.csv", taken);
  checkRefused(exported(place / "x.json"), "x.json", ".csv");
  checkRefused(exported(place / "x.csv", "--format json"), "x.csv", ".json");
  CHECK(place.read("store.sqlite") == before);
  CHECK(exported(place / "runs.csv").exitCode == 0);
  CHECK(exported(place / "runs").exitCode == 0);
  CHECK(exported("/dev/stdout").exitCode == 0);

  // A store that is made only now is an input as well, and so is that in which points wait for their page.
  const auto stored = [&](const char* command, const std::string& store, const std::string& output) {
    return typed(command, "-q", place.scene(), "--pipeline", direct, "--store", place / store, "-o",
                 place / output);
  };
  for (const char* name : {"page.csv", "page.json"})
    checkRefused(stored("report", name, "page.html"), name, taken);
  checkRefused(stored("tune --frame-time 16ms", "own.pipeline", "own.pipeline"), "own.pipeline", taken);
  std::filesystem::copy_file(place / "store.sqlite", place / "page.unfinished.sqlite");
  checkRefused(stored("report", "page.unfinished.sqlite", "page.html"), "page.unfinished.sqlite", taken);
  CHECK(place.read("page.unfinished.sqlite") == before);
  checkRefused(stored("report", "store.sqlite", std::string(245, 'p') + ".html"), "too long");
  for (const char* name : {"page.png", "room.scene"})
    checkRefused(typed("report -q", place.scene(), "-o", place / name), name, ".html");
  for (const auto& [files, facts] : std::vector<std::pair<const char*, Tells>>{
           {"-o out.exr --sheet out.png --frames 0..1 --video out.png", Tells("--video", "out.png")},
           {"-o room.scene", Tells("-o", "room.scene", ".exr", ".png")},
           {"-o x.jpg", Tells("-o", "x.jpg", ".exr", ".png")},
           {"-o x.exr --sheet x.exr", Tells("--sheet", "x.exr", ".png")},
           {"-o x.png --sheet x.png", Tells("--sheet", "x.png", "-o")},
           {"-o x.png --sheet ./x.png", Tells("--sheet", "./x.png", "-o")}}) {
    CAPTURE(files);
    const CommandResult result = typed(in(place.path()), "render -q", place.scene(), direct, files);
    checkRefused(result);
    CHECK_THAT(result.errors, facts);
  }
  // What is read by a text counts as well: a texture, an included text, under any name.
  place.write(
      "mapped.scene",
      "scene \"x\" {\n  camera main { eye 0 0 0.9  target 0 0 -1  resolution 8 8 }\n"
      "  material m { diffuse 0.5  texture \"map.png\" }\n  mesh room { file \"room.obj\"  material m }\n}\n");
  place.rendered("direct_lighting", "--resolution 8x8 -o", place / "map.png");
  std::filesystem::create_symlink("map.png", place / "other.png");
  const std::string map = place.read("map.png");
  // Also in the midst of a sequence.
  std::filesystem::create_symlink("map.png", place / "frame_0001.png");
  const auto mapped = [&](const char* frames, const char* name) {
    return typed("render -q", place / "mapped.scene", direct, frames, "-o", place / name);
  };
  checkRefused(mapped("--frames 0..2", "frame_####.png"), "frame_0001.png", taken);
  CHECK_FALSE(place.has("frame_0000.png"));
  for (const char* name : {"map.png", "other.png"}) checkRefused(mapped("", name), name, taken);
  CHECK(place.read("map.png") == map);
  // And what tune and report choose by themselves: a pipeline beside the scene, a text without an ending.
  std::filesystem::create_directories(place / "scenes/pipelines");
  place.write("scenes/pipelines/beside.pipeline", readFile(direct));
  for (const char* name : {"room.obj", "room.mtl", "room.scene"})
    std::filesystem::copy_file(place / name, place / "scenes" / name);
  const auto small = [&](const char* command, const std::string& scene, const auto&... output) {
    return typed(command, "-q --resolution 8x8 --spp 2", place / scene, "--store", place / "store.sqlite",
                 output...);
  };
  checkRefused(
      small("tune --frame-time 16ms", "scenes/room.scene", "-o", place / "scenes/pipelines/beside.pipeline"),
      "beside.pipeline", taken);
  CHECK(place.read("scenes/pipelines/beside.pipeline") == readFile(direct));
  place.write("rest", "material grey { diffuse 0.5 }\n");
  place.write(
      "included.scene",
      std::string(kRoomScene).replace(std::string(kRoomScene).rfind('}'), 1, "  include \"rest\"\n}"));
  for (const char* command : {"tune --frame-time 16ms", "report"})
    checkRefused(small(command, "included.scene", "--pipeline", direct, "-o", place / "rest"), "rest");
  CHECK(place.read("rest") == "material grey { diffuse 0.5 }\n");
  CHECK_FALSE(place.has("page.png"));
  CHECK_FALSE(place.has("x.png"));
}

TEST_CASE("a battery whose cells cannot be written beside its page is refused before the first of them") {
  const Workplace place;
  std::filesystem::create_directories(place / "out/index.json");
  checkRefused(
      typed("-q stress --quick --workers 1 --case camera_on_surface --pipeline",
            committedPipeline("direct_lighting"), "--store", place / "cells.sqlite", "-o", place / "out"),
      "index.json", "directory", "file");
  CHECK_FALSE(place.has("cells.sqlite"));
}

TEST_CASE("an output with the longest name is written, a longer one refused before the work") {
  const Workplace place;
  const std::string name = std::string(251, 'n') + ".png";
  place.rendered("direct_lighting", "--resolution 8x8 -o", place / name);
  CHECK(place.has(name));
  // Before the texts are looked at, which are not there.
  checkRefused(typed("render -q absent.scene absent.pipeline -o", place / ("n" + name)), "too long");
}

TEST_CASE("the recorded command is one that a shell reads back, quotes and all") {
  const Workplace place;
  place.write("it's here.scene", kRoomScene);
  ran("render -q", Raw{"\"" + place.file("it's here.scene") + "\""}, committedPipeline("direct_lighting"),
      "--resolution 8x8 -o", place / "a.exr");
  const std::string recorded = readExr(place / "a.exr").attributes.at("lumivox.command");
  CHECK(contains(recorded, "it'\\''s here.scene'"));
  std::filesystem::remove(place / "a.exr");
  CHECK(runCommand(recorded).exitCode == 0);
  CHECK(place.has("a.exr"));
}

TEST_CASE("a medium that no pass reads is said by render and by explain, and not where one does") {
  const Workplace place;
  place.write("fog.scene", std::string(kRoomScene)
                               .insert(std::string(kRoomScene).rfind('}'),
                                       "  medium fog { extinction 0.1 /m  albedo 0.5 }\n"));
  const auto made = [&](const char* command, const char* pipeline, const auto&... more) {
    return ran(command, place / "fog.scene", committedPipeline(pipeline), "--resolution 8x8", more...);
  };
  const CommandResult clear = made("render", "voxel_cone_tracing", "--set resolution=16 -o", place / "a.png");
  CHECK_THAT(clear.errors, Tells("leaves out", "medium", "fog", "clear air"));
  CHECK_FALSE(contains(clear.errors, "leaves out the"));
  const nlohmann::json explained = nlohmann::json::parse(
      made("explain --no-times", "voxel_cone_tracing", "--set resolution=16 --json").output);
  CHECK(std::any_of(explained["left_out"].begin(), explained["left_out"].end(),
                    [](const nlohmann::json& one) { return one["what"] == "medium 'fog'"; }));
  CHECK_FALSE(contains(made("render", "volumetric_smoke", "-o", place / "b.png").errors, "leaves out"));
}
