// What a person sees and types: one line of progress, tables and help that fit, colours, words that are
// nearly right, units, and what an interrupted command says.
#include <algorithm>
#include <regex>
#include <sstream>

#include "lumivox/base/image.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/pipeline/sweep_text.h"
#include "lumivox/results/reproduction.h"
#include "lumivox/scene/text.h"
#include "tools/cli_support.h"
#include "tools/started.h"
#include "tools/terminal.h"

using namespace lumivox;
using namespace lumivox::test;
using Json = nlohmann::json;

namespace {

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

}  // namespace

TEST_CASE("progress in a terminal is one line that fits its width, whatever that is") {
  const Place place;
  for (const int columns : {40, 80}) {
    INFO(columns);
    const TerminalResult shown =
        runInTerminal("lumivox reference " + place.quoted("room.scene") +
                          " --resolution 96x64 --spp 256 --no-cache -o " + place.quoted("reference.exr"),
                      columns);
    INFO(shown.written);
    REQUIRE(shown.exitCode == 0);
    CHECK(countOf(shown.written, "reference of ") > 2);
    // Lines of progress begin with a carriage return and are never ended by a line feed.
    std::size_t lines = 0;
    for (std::size_t at = shown.written.find("\r\x1b[K"); at != std::string::npos;
         at = shown.written.find("\r\x1b[K", at + 1)) {
      const std::size_t end = std::min(shown.written.find_first_of("\r\n", at + 4), shown.written.size());
      const std::string line = shown.written.substr(at + 4, end - at - 4);
      if (!contains(line, " left")) continue;
      ++lines;
      INFO(line);
      CHECK(shownWidth(line) < static_cast<std::size_t>(columns));
    }
    CHECK(lines > 1);
  }
}

TEST_CASE(
    "measuring commands tell done, total and time left from the first point on, outside of a terminal too") {
  const Place place;
  for (const CommandResult& result :
       {place.measured({}, "report", "fast.pipeline", "-o", place / "page.html"),
        place.measured({}, "sweep", "fast.pipeline", "--store", place / "results.sqlite")}) {
    INFO(result.errors);
    REQUIRE(result.exitCode == 0);
    CHECK_THAT(result.errors,
               Tells("measuring", 1, "of", 4, "points", "about") && Tells("measuring", 4, "of", 4, "points"));
  }
  CHECK_THAT(place
                 .measured({}, "tune", "fast.pipeline", "--frame-time 1000s --evaluations 6 --store",
                           place / "tuned.sqlite")
                 .errors,
             Tells("tuning", 1, "of", 6, "points", "about"));
  const CommandResult voxels =
      typed("voxels", place.file("room.scene"), "--resolution 8,16 --repeats 2 --no-sweep --pipeline",
            committedPipeline("voxelizers/conservative"));
  INFO(voxels.errors);
  CHECK(voxels.exitCode == 0);
  CHECK_THAT(voxels.errors, Tells("room", 1, "of", 6, "about") && Tells("room", 6, "of", 6));
}

TEST_CASE("in a terminal a measuring command ends without its line of progress, and quiet ones show none") {
  const Place place;
  const std::string command = place.program() + "report " + place.quoted("room.scene") + " --pipeline " +
                              place.quoted("fast.pipeline") + place.quick() + "-o " +
                              place.quoted("page.html");
  const TerminalResult shown = runInTerminal(command, 100);
  INFO(shown.written);
  REQUIRE(shown.exitCode == 0);
  CHECK(contains(shown.written, "] measuring: 1 of 4 points"));
  CHECK(shown.written.rfind("points, about") < shown.written.find("Pipeline"));
  const TerminalResult quiet = runInTerminal(command + " --quiet", 100);
  CHECK_FALSE(contains(quiet.written, "measuring"));
}

TEST_CASE("a repeated warning is told once, and at the end how often it was repeated") {
  const Place place;
  place.write("direct.pipeline", readFile(committedPipeline("direct_lighting")));
  const CommandResult result = typed("voxels", place.file("room.scene"), "--resolution 8,16,32 --pipeline",
                                     place.file("direct.pipeline"));
  INFO(result.errors);
  CHECK(result.exitCode == 1);
  CHECK(countOf(result.errors, "warning: ") == 2);
  CHECK(countOf(result.errors, "it has no parameter 'resolution'\n") == 1);
  CHECK(contains(result.errors, "it has no parameter 'resolution' (3 times)\n"));
}

TEST_CASE("tables fit 80 and 100 columns by blocks, and lose nothing") {
  const Place place;
  const std::string store = place.quoted("results.sqlite"), image = place.quoted("image.exr");
  REQUIRE(place.measured({}, "-q sweep", "fast.pipeline", "--store", place / "results.sqlite").exitCode == 0);
  ran("-q reference", place.file("room.scene"), "--spp 2 -o", Raw{image});
  const std::string room = place.quoted("room.scene"),
                    conservative = committedPipeline("voxelizers/conservative"),
                    cones = committedPipeline("voxel_cone_tracing");
  const std::vector<std::pair<std::string, std::vector<std::string>>> commands{
      {"list pipelines", {"voxel_cone_tracing", ".pipeline"}},
      {"list passes", {"direct_lighting.gbuffer"}},
      {"stress --list", {"camera_on_surface", "cells"}},
      {"results list --store " + store, {"fast value=4", "good"}},
      {"results front --store " + store, {"value=4"}},
      {"compare " + image + " " + image, {"RMSE", "FLIP LDR", "NaN or Inf", "indirect_diffuse"}},
      {"voxels -q " + room + " --resolution 8 --repeats 1 --pipeline '" + conservative + "'",
       {"recall", "oblique holes %"}},
      {"explain -q " + room + " '" + cones + "' --set resolution=8 --repeats 1 --resolution 8x8",
       {"passes kept", "whole frame", "reasons"}},
      {"help render", {"--keep-everything", "Options of every command"}}};
  for (const auto& [command, parts] : commands)
    for (const int columns : {80, 100}) {
      const CommandResult result = typed(test::columns(columns), Raw{command});
      INFO(command << "\n" << result.output << result.errors);
      REQUIRE(result.exitCode == 0);
      for (const std::string& part : parts) CHECK(contains(result.output, part));
      std::istringstream lines(result.output);
      for (std::string line; std::getline(lines, line);) {
        // What has no space cannot be broken: names of files.
        if (contains(line, "/") && line.find(' ', line.find_first_not_of(' ')) == std::string::npos) continue;
        if (contains(line, place.path().string())) continue;
        INFO(line);
        CHECK(shownWidth(line) <= static_cast<std::size_t>(columns));
      }
    }
}

TEST_CASE("stored runs and their front have one line a run at 80 columns, and everything at 160") {
  const Place place;
  REQUIRE(place.measured({}, "-q sweep", "fast.pipeline", "--store", place / "results.sqlite").exitCode == 0);
  const auto at = [&](int columns, const char* what) {
    return typed(test::columns(columns), "results", what, "--store", place / "results.sqlite").output;
  };
  const std::string list = at(80, "list");
  INFO(list);
  static const std::regex run(" *[0-9]+  fast value=[1-4]  +[0-9.]+  +[0-9.e-]+ ± [0-9.e-]+ +good\n");
  CHECK(std::distance(std::sregex_iterator(list.begin(), list.end(), run), std::sregex_iterator()) == 4);
  CHECK(countOf(list, "Pipeline") == 1);
  CHECK(contains(at(160, "list"), "Memory"));
  const std::string front = at(80, "front --component whole_image");
  INFO(front);
  static const std::regex point(
      " *[1-4]  fast value=[1-4]  +[0-9.]+  +[0-9.]+ ± [0-9.e-]+ +(on the front|beaten by "
      "[1-4]|undecided)\n");
  CHECK(std::distance(std::sregex_iterator(front.begin(), front.end(), point), std::sregex_iterator()) == 4);
  CHECK(contains(at(160, "front"), "Parameters"));
}

TEST_CASE("no word of a table is cut that fits the terminal, though lines behind the first are indented") {
  const Place place;
  // A name of a parameter as long as any, behind others, so that it begins a line of its own.
  place.write(
      "long.pipeline",
      "pipeline \"Long\" {\n  param a 1 in 0..10\n  param smoke_resolution_of_it 6 in 0..10\n"
      "  pass paint hostile.paint { deed paint  value $a }\n  pass other hostile.paint { deed paint  value "
      "$smoke_resolution_of_it }\n\n  output direct paint.radiance\n}\n\n"
      "sweep both { a [1 2]  smoke_resolution_of_it [6 7] }\n");
  REQUIRE(place.measured({}, "-q sweep", "long.pipeline", "--store", place / "results.sqlite").exitCode == 0);
  for (const int columns : {70, 80, 100}) {
    const CommandResult listed =
        typed(test::columns(columns), "results list --store", place / "results.sqlite");
    INFO(listed.output);
    CHECK(contains(listed.output, "smoke_resolution_of_it=6"));
  }
}

TEST_CASE("an animation counts the frames that were asked for, whatever is rendered for their exposure") {
  const Place place;
  const CommandResult result = typed("render", place.file("room.scene"), committedPipeline("direct_lighting"),
                                     "--resolution 8x8 --frames 0..6 -o", place.file("frame.png"));
  INFO(result.errors);
  CHECK(contains(result.errors, "rendering: 7 of 7 frames"));
}

TEST_CASE("explain begins with its summary and names what has the same reason together") {
  const Place place;
  const CommandResult result =
      ran("explain -q --no-times", place.file("room.scene"), committedPipeline("voxel_cone_tracing"),
          "--set resolution=8 --resolution 8x8");
  CHECK(std::regex_search(result.output, std::regex("^[0-9]+ of [0-9]+ passes kept; ")));
  std::smatch counts;
  REQUIRE(std::regex_search(result.output, counts,
                            std::regex("([0-9]+) things left out for ([0-9]+) reasons?\n")));
  CHECK(std::stoi(counts[1]) > std::stoi(counts[2]));
}

TEST_CASE("colours are for terminals, and NO_COLOR is heard") {
  CHECK(contains(runInTerminal("lumivox list techniques", 100).written, "\x1b[1m"));
  CHECK_FALSE(contains(runInTerminal("NO_COLOR=1 lumivox list techniques", 100).written, "\x1b[1m"));
  CHECK_FALSE(contains(runInTerminal("TERM=dumb lumivox list techniques", 100).written, "\x1b[1m"));
  CHECK_FALSE(contains(typed("list techniques").output, "\x1b"));
}

TEST_CASE("an interrupted animation says which images are kept and how it goes on") {
  const Place place;
  Started command({"render", place.scene(), committedPipeline("direct_lighting"), "--resolution", "16x16",
                   "--frames", "0..99999", "-o", place.file("frame.exr")},
                  place.file("errors.txt"));
  REQUIRE(becomes([&] { return place.has("frame_0002.exr"); }));
  command.signalAfter(std::chrono::milliseconds(0), SIGINT);
  const int status = command.wait();
  CHECK((WIFSIGNALED(status) && WTERMSIG(status) == SIGINT));
  std::smatch said;
  const std::string errors = place.read("errors.txt");
  INFO(errors.substr(errors.size() - std::min<std::size_t>(errors.size(), 600)));
  REQUIRE(std::regex_search(
      errors, said,
      std::regex("interrupted: images up to .*frame_0*([0-9]+)\\.exr are kept; to go on: --frames "
                 "([0-9]+)\\.\\.99999 in lumivox render ")));
  CHECK(std::stoi(said[1]) + 1 == std::stoi(said[2]));
  // The last one that it names is there and whole.
  const int last = std::stoi(said[1]);
  REQUIRE(last >= 2);
  std::string name = std::to_string(last);
  name.insert(0, 4 - std::min<std::size_t>(4, name.size()), '0');
  CHECK(readExr(place.file("frame_" + name + ".exr")).layers.at("direct").width() == 16);
  CHECK(place.has("frame_0000.exr"));
}

TEST_CASE("a word that is no command or option is named with the nearest one") {
  checkRefused(typed("rendr a b -o c.exr"), "rendr", "lumivox", "did you mean", "render");
  checkRefused(typed("--device software results lst"), "lst", "lumivox results", "did you mean", "list");
  checkRefused(typed("render a.scene b.pipeline -o c.exr --resolutoin 8x8"), "lumivox render", "--resolutoin",
               "did you mean", "--resolution");
  checkRefused(typed("help rendr"), "did you mean", "render");
}

TEST_CASE("help is asked for before or behind a command, and ends with the options of every command") {
  const CommandResult help = typed("help render"), behind = typed("render --help");
  CHECK(help.exitCode == 0);
  CHECK(behind.exitCode == 0);
  CHECK(contains(help.output, "--keep-everything"));
  for (const char* command :
       {"check", "render", "report", "results list", "stress", "new technique", "cache prune"}) {
    INFO(command);
    for (const CommandResult& result : {typed("help", command), typed(command, "--help")}) {
      CHECK(result.exitCode == 0);
      for (const char* part : {"Options of every command", "--assets", "--arithmetic", "--strict", "--quiet"})
        CHECK(contains(result.output, part));
    }
  }
  CHECK(contains(typed("help").output, "reproduce"));
}

TEST_CASE("an option never takes the scene for its own, and pipelines are told from scenes") {
  const Place place;
  const std::string fast = place.quoted("fast.pipeline"), room = place.quoted("room.scene");
  for (const std::string& inputs : {"--pipeline " + fast + " " + room, room + " " + fast}) {
    INFO(inputs);
    CHECK(answered("--techniques", Place::techniques(), "report", Raw{inputs + Place::quick()},
                   "--no-sweep --json -o", place / "page.html")
              .at("scenes")
              .at(0)
              .at("points")
              .size() == 1);
  }
  checkRefused(typed("report", place / "fast.pipeline"), "scene");
}

TEST_CASE("times have units as in the texts, and a budget without one is refused") {
  const Place place;
  checkRefused(typed("report", place.scene(), "--budget 30"), "--budget", 30, 0, "unit", "s", "ms", "min");
  checkRefused(typed("report", place.scene(), "--budget 0s"), "--budget", "0s", "above", 0);
  checkRefused(typed("tune", place.scene(), "--frame-time 16"), "--frame-time", 16);
  checkRefused(typed("stress --time-limit 3"), "--time-limit", 3);
  checkRefused(typed("report", place.scene(), "--equal-time 3"), "--equal-time", 3);
  const auto render = [&](const char* time) {
    return place.render("direct_lighting", "--resolution 8x8 --json -o", place / "image.exr", "--time", time);
  };
  for (const char* time : {"300ms", "0.3s", "0.3", "'0.3 s'"}) {
    const CommandResult result = render(time);
    INFO(time << "\n" << result.errors);
    REQUIRE(result.exitCode == 0);
    CHECK(Json::parse(result.output).at("images").at(0).at("time").get<double>() == Approx(0.3));
  }
  checkRefused(render("3kg"), "--time", "3kg", "time");
  checkRefused(typed("reference", place.scene(), "--occlusion-distance 1s -o a.exr"), "--occlusion-distance",
               "1s", "0.5m");
}

TEST_CASE("a seed is a whole number from 0 in every command") {
  const Place place;
  for (const char* seed : {"-1", "1.5", "one", "18446744073709551616"})
    for (const CommandResult& result :
         {place.render("direct_lighting", "-o", place / "image.exr", "--seed", seed),
          typed("reference", place.scene(), "-o", place / "image.exr", "--seed", seed),
          typed("report", place.scene(), "--seed", seed), typed("voxels", place.scene(), "--seed", seed),
          typed("reproduce --seed", seed)})
      checkRefused(result, "--seed", seed, "whole", 0);
}

TEST_CASE("render, reference and fmt answer in JSON") {
  const Place place;
  const std::string room = place.quoted("room.scene");
  const CommandResult rendered =
      typed("render", Raw{room}, committedPipeline("direct_lighting"),
            "-q --resolution 8x8 --frames 0..1 --json -o", place.file("image.exr"));
  INFO(rendered.errors);
  const Json images = Json::parse(rendered.output).at("images");
  REQUIRE(images.size() == 2);
  CHECK(images.at(1).at("frame") == 1);
  CHECK(images.at(1).at("file") == place.file("image_0001.exr"));
  CHECK(images.at(1).at("frame_ms").get<double>() > 0.0);
  const Json reference =
      Json::parse(typed("reference", Raw{room}, "-q --spp 2 --json -o", place.file("reference.exr")).output);
  CHECK(reference.at("width") == 24);
  CHECK(reference.at("samples_per_pixel") == 2);
  CHECK(std::count(reference.at("layers").begin(), reference.at("layers").end(), "indirect_glossy") == 1);
  const std::string untidy = place.write("untidy.scene", "scene   \"A\" { }\n").string();
  const CommandResult formatted = typed("fmt --check --json", untidy, Raw{room});
  CHECK(formatted.exitCode == 1);
  CHECK(Json::parse(formatted.output).at(0).at("changed") == true);
  CHECK(Json::parse(formatted.output).at(1).at("changed") == false);
}

TEST_CASE("the grammars of editors have every word of the texts") {
  const CommandResult textMate = typed("describe --highlighting textmate"),
                      vim = typed("describe --highlighting vim");
  REQUIRE(textMate.exitCode == 0);
  REQUIRE(vim.exitCode == 0);
  const Json grammar = Json::parse(textMate.output);
  CHECK(grammar.at("scopeName") == "source.lumivox");
  CHECK(grammar.at("fileTypes") == Json{"scene", "pipeline", "sweep", "reproduction"});
  std::string patterns;
  for (const Json& pattern : grammar.at("patterns"))
    if (pattern.contains("match")) patterns += "|" + pattern.at("match").get<std::string>();
  std::replace_if(
      patterns.begin(), patterns.end(), [](char c) { return c == '(' || c == ')' || c == ':' || c == '?'; },
      '|');
  for (const auto* specifications : {&sceneSpecifications(), &pipelineSpecifications(),
                                     &sweepSpecifications(), &reproductionSpecifications()})
    for (const std::string& word : dsl::words(*specifications)) {
      INFO(word);
      CHECK(contains(patterns, "|" + word + "|"));
      CHECK(
          std::regex_search(vim.output, std::regex("syntax keyword lumivox(Block|Property) " + word + "\n")));
    }
  checkRefused(typed("describe --highlighting emacs"), "emacs");
  if (runCommand("command -v vim").exitCode != 0) return skip("vim is not installed");
  const Place place;
  const std::string file = place.write("lumivox.vim", vim.output).string();
  const CommandResult read = runCommand(
      "vim -u NONE -es -c 'syntax on' -c 'source " + file + "' -c 'redir! > " + place.file("groups.txt") +
      "' -c 'silent highlight lumivoxBlock' -c 'qa!' " + place.quoted("room.scene"));
  INFO(read.output << read.errors);
  CHECK(contains(place.read("groups.txt"), "Keyword"));
}
