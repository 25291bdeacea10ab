// Numbers, names and texts that nobody means: refused with a sentence, before any work, and soon.
#include <ctime>

#include "lumivox/base/image.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

std::string quoted(const std::string& text) {
  return "'" + text + "'";
}

std::string renderRoom(const Workplace& place, const std::string& more) {
  return "lumivox render -q " + quoted(place.scene()) + " " + quoted(committedPipeline("direct_lighting")) +
         " " + more;
}

/// Command, and seconds by the clock until it was done.
std::pair<CommandResult, double> timed(const std::string& command) {
  timespec start{}, end{};
  clock_gettime(CLOCK_MONOTONIC, &start);
  CommandResult result = runCommand(command);
  clock_gettime(CLOCK_MONOTONIC, &end);
  return {std::move(result), static_cast<double>(end.tv_sec - start.tv_sec) +
                                 1e-9 * static_cast<double>(end.tv_nsec - start.tv_nsec)};
}
constexpr double kSoon = 60.0;  // s, on a machine that does other things too

}  // namespace

TEST_CASE("numbers of options that nothing could be computed with are refused, and nothing is written") {
  const Workplace place;
  const std::string out = " -o " + quoted(place.file("x.png"));
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
    checkRefused(runCommand(renderRoom(place, option + out)), name.substr(0, name.find(' ')));
  }
  CHECK_FALSE(place.has("x.png"));
  checkRefused(runCommand(renderRoom(place, "--eye 0,0,0 --target 0,0,0" + out)),
               "eye and target are the same point");
  checkRefused(runCommand(renderRoom(place, "--eye 0,0,0 --target 0,1,0" + out)), "looks along 'up'");
  CHECK_FALSE(place.has("x.png"));
  checkRefused(runCommand("lumivox reference -q --occlusion-distance nan " + quoted(place.scene()) + out),
               "--occlusion-distance");
  checkRefused(runCommand("lumivox reproduce --scale nan"), "--scale");
  checkRefused(runCommand("lumivox cache prune --unused-for nan"), "--unused-for");
  checkRefused(runCommand("lumivox tune --error nan " + quoted(place.scene())), "--error");
  checkRefused(runCommand("lumivox tune --frame-time 1e300s " + quoted(place.scene())), "--frame-time");
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
    checkRefused(runCommand("lumivox check " + quoted(place.file("bad.scene"))), word);
    checkRefused(
        runCommand("lumivox render " + quoted(place.file("bad.scene")) + " " +
                   quoted(committedPipeline("direct_lighting")) + " -o " + quoted(place.file("x.png"))),
        word);
  }
  CHECK_FALSE(place.has("x.png"));
}

TEST_CASE(
    "texts of one endless line and of very many unknown names are checked soon, and the findings are counted") {
  const Workplace place;
  place.write("line.scene", std::string(std::size_t{4} << 20, '@'));
  const auto [line, lineSeconds] = timed("lumivox check " + quoted(place.file("line.scene")));
  checkRefused(line, "unexpected character '@'");
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
  const auto [names, nameSeconds] = timed("lumivox check " + quoted(place.file("names.scene")));
  checkRefused(names, "unknown material 'k0'");
  CHECK(contains(names.errors, "and 24800 more findings; the first 200 are shown"));
  CHECK(nameSeconds < kSoon);
  const auto json =
      nlohmann::json::parse(runCommand("lumivox check --json " + quoted(place.file("names.scene"))).output);
  CHECK(json[0]["findings"].size() == 200);
  CHECK(json[0]["more_findings"] == 24800);

  place.write("names.pipeline", pipeline + "}\n");
  const auto [passes, passSeconds] = timed("lumivox check " + quoted(place.file("names.pipeline")));
  checkRefused(passes, "too many blocks or properties 'pass'; expected at most 1000 in a pipeline");
  CHECK(passSeconds < kSoon);
}

TEST_CASE("an output that is an input, another output or a file of another kind is refused before the work") {
  const Workplace place;
  const std::string store = place.file("store.sqlite");
  const CommandResult stored = runCommand(
      "lumivox sweep -q --resolution 8x8 --spp 2 --subpixels 1 --repeats 1 --seeds 1 --flicker-frames 0 "
      "--pipeline " +
      quoted(committedPipeline("direct_lighting")) + " --store " + quoted(store) + " " +
      quoted(place.scene()));
  INFO(stored.errors);
  REQUIRE(stored.exitCode == 0);
  const std::string before = place.read("store.sqlite");
  std::filesystem::create_symlink("store.sqlite", place.path() / "link.csv");
  std::filesystem::create_hard_link(store, place.path() / "hard.csv");
  const std::string exported = "lumivox results export --store " + quoted(store) + " -o ";
  checkRefused(runCommand(exported + quoted(store)), "-o");
  checkRefused(runCommand(exported + quoted(place.file("link.csv"))), "is read; expected another name");
  checkRefused(runCommand(exported + quoted(place.file("hard.csv"))), "is read; expected another name");
  checkRefused(runCommand(exported + quoted(place.file("x.json"))), "expected a name that ends in .csv");
  checkRefused(runCommand(exported + quoted(place.file("x.csv")) + " --format json"), "ends in .json");
  CHECK(place.read("store.sqlite") == before);
  CHECK(runCommand(exported + quoted(place.file("runs.csv"))).exitCode == 0);
  CHECK(runCommand(exported + quoted(place.file("runs"))).exitCode == 0);
  CHECK(runCommand(exported + "/dev/stdout").exitCode == 0);

  // A store that is made only now is an input as well, and so is that in which points wait for their page.
  const std::string room = " -q " + quoted(place.scene()) + " --pipeline " +
                           quoted(committedPipeline("direct_lighting")) + " --store ";
  for (const char* name : {"page.csv", "page.json"})
    checkRefused(runCommand("lumivox report" + room + quoted(place.file(name)) + " -o " +
                            quoted(place.file("page.html"))),
                 "is read; expected another name");
  checkRefused(runCommand("lumivox tune --frame-time 16ms" + room + quoted(place.file("own.pipeline")) +
                          " -o " + quoted(place.file("own.pipeline"))),
               "is read; expected another name");
  const std::string waiting = place.file("page.unfinished.sqlite");
  std::filesystem::copy_file(store, waiting);
  checkRefused(
      runCommand("lumivox report" + room + quoted(waiting) + " -o " + quoted(place.file("page.html"))),
      "is read; expected another name");
  CHECK(readFile(waiting) == before);
  checkRefused(runCommand("lumivox report" + room + quoted(store) + " -o " +
                          quoted(place.file(std::string(245, 'p') + ".html"))),
               "too long");

  const std::string report = "lumivox report -q " + quoted(place.scene()) + " -o ";
  checkRefused(runCommand(report + quoted(place.file("page.png"))), "ends in .html");
  checkRefused(runCommand(report + quoted(place.scene())), "ends in .html");
  for (const auto& [files, why] : std::vector<std::pair<std::string, std::string>>{
           {"-o out.exr --sheet out.png --frames 0..1 --video out.png", "--video 'out.png': expected a name"},
           {"-o room.scene", "-o 'room.scene': expected a name that ends in .exr or .png"},
           {"-o x.jpg", "-o 'x.jpg': expected a name that ends in .exr or .png"},
           {"-o x.exr --sheet x.exr", "--sheet 'x.exr': expected a name that ends in .png"},
           {"-o x.png --sheet x.png", "--sheet 'x.png': that is the file of -o too"},
           {"-o x.png --sheet ./x.png", "--sheet './x.png': that is the file of -o too"}}) {
    CAPTURE(files);
    checkRefused(runCommand("PATH=" + quoted((binaryDirectory() / "bin").string()) + ":$PATH; cd " +
                            quoted(place.path().string()) + " && " + renderRoom(place, files)),
                 why);
  }
  // What is read by a text counts as well: a texture, an included text, under any name.
  place.write(
      "mapped.scene",
      "scene \"x\" {\n  camera main { eye 0 0 0.9  target 0 0 -1  resolution 8 8 }\n"
      "  material m { diffuse 0.5  texture \"map.png\" }\n  mesh room { file \"room.obj\"  material m }\n}\n");
  REQUIRE(runCommand(renderRoom(place, "--resolution 8x8 -o " + quoted(place.file("map.png")))).exitCode ==
          0);
  std::filesystem::create_symlink("map.png", place.path() / "other.png");
  const std::string map = place.read("map.png");
  // Also in the midst of a sequence.
  std::filesystem::create_symlink("map.png", place.path() / "frame_0001.png");
  checkRefused(runCommand("lumivox render -q " + quoted(place.file("mapped.scene")) + " " +
                          quoted(committedPipeline("direct_lighting")) + " --frames 0..2 -o " +
                          quoted(place.file("frame_####.png"))),
               "frame_0001.png': that file was read for the same work");
  CHECK_FALSE(place.has("frame_0000.png"));
  for (const char* name : {"map.png", "other.png"})
    checkRefused(runCommand("lumivox render -q " + quoted(place.file("mapped.scene")) + " " +
                            quoted(committedPipeline("direct_lighting")) + " -o " + quoted(place.file(name))),
                 "was read for the same work");
  CHECK(place.read("map.png") == map);
  // And what tune and report choose by themselves: a pipeline beside the scene, a text without an ending.
  std::filesystem::create_directories(place.path() / "scenes/pipelines");
  const std::string direct = readFile(committedPipeline("direct_lighting")),
                    small = " --resolution 8x8 --spp 2 --store " + quoted(store);
  place.write("scenes/pipelines/beside.pipeline", direct);
  for (const char* name : {"room.obj", "room.mtl", "room.scene"})
    std::filesystem::copy_file(place.path() / name, place.path() / "scenes" / name);
  checkRefused(runCommand("lumivox tune -q --frame-time 16ms " + quoted(place.file("scenes/room.scene")) +
                          small + " -o " + quoted(place.file("scenes/pipelines/beside.pipeline"))),
               "was read for the same work");
  CHECK(place.read("scenes/pipelines/beside.pipeline") == direct);
  place.write("rest", "material grey { diffuse 0.5 }\n");
  place.write(
      "included.scene",
      std::string(kRoomScene).replace(std::string(kRoomScene).rfind('}'), 1, "  include \"rest\"\n}"));
  for (const char* command : {"tune --frame-time 16ms", "report"})
    checkRefused(
        runCommand(std::string("lumivox ") + command + " -q " + quoted(place.file("included.scene")) +
                   " --pipeline " + quoted(committedPipeline("direct_lighting")) + small + " -o " +
                   quoted(place.file("rest"))),
        command[0] == 't' ? "was read for the same work" : "rest");
  CHECK_FALSE(place.has("page.png"));
  CHECK_FALSE(place.has("x.png"));
}

TEST_CASE("a battery whose cells cannot be written beside its page is refused before the first of them") {
  const Workplace place;
  std::filesystem::create_directories(place.path() / "out/index.json");
  checkRefused(runCommand("lumivox -q stress --quick --workers 1 --case camera_on_surface --pipeline " +
                          quoted(committedPipeline("direct_lighting")) + " --store " +
                          quoted(place.file("cells.sqlite")) + " -o " + quoted(place.file("out"))),
               "index.json: cannot write: is a directory; expected a file");
  CHECK_FALSE(place.has("cells.sqlite"));
}

TEST_CASE("an output with the longest name is written, a longer one refused before the work") {
  const Workplace place;
  const std::string name = std::string(251, 'n') + ".png";
  REQUIRE(runCommand(renderRoom(place, "--resolution 8x8 -o " + quoted(place.file(name)))).exitCode == 0);
  CHECK(place.has(name));
  // Before the texts are looked at, which are not there.
  checkRefused(
      runCommand("lumivox render -q absent.scene absent.pipeline -o " + quoted(place.file("n" + name))),
      "too long");
}

TEST_CASE("the recorded command is one that a shell reads back, quotes and all") {
  const Workplace place;
  place.write("it's here.scene", kRoomScene);
  const std::string command = "lumivox render -q \"" + place.file("it's here.scene") + "\" " +
                              quoted(committedPipeline("direct_lighting")) + " --resolution 8x8 -o " +
                              quoted(place.file("a.exr"));
  REQUIRE(runCommand(command).exitCode == 0);
  const std::string recorded = readExr(place.path() / "a.exr").attributes.at("lumivox.command");
  CHECK(contains(recorded, "it'\\''s here.scene'"));
  std::filesystem::remove(place.path() / "a.exr");
  CHECK(runCommand(recorded).exitCode == 0);
  CHECK(place.has("a.exr"));
}

TEST_CASE("a medium that no pass reads is said by render and by explain, and not where one does") {
  const Workplace place;
  place.write("fog.scene", std::string(kRoomScene)
                               .insert(std::string(kRoomScene).rfind('}'),
                                       "  medium fog { extinction 0.1 /m  albedo 0.5 }\n"));
  const std::string scene = " " + quoted(place.file("fog.scene")) + " ", more = " --resolution 8x8 ";
  const CommandResult clear =
      runCommand("lumivox render" + scene + quoted(committedPipeline("voxel_cone_tracing")) + more +
                 "--set resolution=16 -o " + quoted(place.file("a.png")));
  INFO(clear.errors);
  CHECK(clear.exitCode == 0);
  CHECK(
      contains(clear.errors, "leaves out medium 'fog': no pass reads media: the image is that of clear air"));
  CHECK_FALSE(contains(clear.errors, "leaves out the"));
  const CommandResult explained =
      runCommand("lumivox explain --no-times" + scene + quoted(committedPipeline("voxel_cone_tracing")) +
                 more + "--set resolution=16 --json");
  REQUIRE(explained.exitCode == 0);
  CHECK(contains(explained.output, "medium 'fog'"));
  const CommandResult seen =
      runCommand("lumivox render" + scene + quoted(committedPipeline("volumetric_smoke")) + more + "-o " +
                 quoted(place.file("b.png")));
  INFO(seen.errors);
  CHECK(seen.exitCode == 0);
  CHECK_FALSE(contains(seen.errors, "leaves out"));
}
