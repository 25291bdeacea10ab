// The graph of a pipeline: its text, its file, and the pictures of the paper cards, made again.
#include "lumivox/experiment/pipeline_graph.h"

#include <filesystem>

#include "lumivox/base/error.h"
#include "support/techniques.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;
namespace fs = std::filesystem;

namespace {

std::string quoted(const std::string& path) {
  return "'" + path + "'";
}

std::string graphOf(const Pipeline& pipeline, const fs::path& file) {
  const Scene scene = loadScene(file);
  const PipelineExecutor executor(device(), techniques(), scene, pipeline, {});
  return graphText(pipeline, techniques(), {}, executor.explain(), file.stem().string());
}

/// The text in a picture; empty where it has none.
std::string textIn(const std::string& svg) {
  const std::string begin = "<!--\ndigraph";
  const std::size_t from = svg.find(begin), to = svg.find("-->\n", from);
  return from == std::string::npos || to == std::string::npos ? "" : svg.substr(from + 5, to - from - 5);
}

/// The scene of each card's picture: one on which a run needs as much of the pipeline as on any.
fs::path sceneFor(const std::string& technique) {
  const std::string name = technique == "volumetric_smoke"  ? "smoke"
                           : technique == "captured_frames" ? "mixed_reality"
                                                            : "cornell_glossy";
  return sourceDirectory() / "scenes" / (name + ".scene");
}

constexpr const char* kCones =
    "pipeline \"\\\"Cones\\\" & \\\\ --> more\" {\n"
    "  pass gbuffer direct_lighting.gbuffer { }\n"
    "  pass shadow direct_lighting.shadow_map { }\n"
    "  pass voxels voxelization.conservative { resolution 8 }\n"
    "  pass light voxel_cone_tracing.inject {\n    fragments voxels.fragments\n    shadow shadow.depth\n  }\n"
    "  pass grid voxel_cone_tracing.filter { radiance light.radiance }\n"
    "  pass gather voxel_cone_tracing.gather {\n    gbuffer gbuffer\n    grid grid.mips\n  }\n"
    "  output indirect_diffuse gather.diffuse\n"
    "  output indirect_glossy gather.glossy\n"
    "}\n";

/// `lumivox explain` of the little room with these options, and this PATH.
CommandResult explain(const Workplace& place, const std::string& options, const std::string& path) {
  return runCommand("env PATH=" + path + " " + quoted((binaryDirectory() / "bin/lumivox").string()) +
                    " explain " + quoted(place.scene()) + " " + quoted(place.file("cones.pipeline")) +
                    " -q --no-times --resolution 9x7 " + options);
}

}  // namespace

TEST_CASE("the graph of a pipeline has its passes, what flows between them, and what the scene leaves out") {
  const Workplace place;
  const std::string text = graphOf(Pipeline::parse(kCones, "cones.pipeline"), place.scene());
  INFO(text);
  CHECK(contains(text, "digraph \"\\\"Cones\\\" &amp; \\\\ --> more\" {"));
  CHECK(contains(text, ", on the scene room\""));
  CHECK(contains(text, "\"pass gather\" [label=\"gather\\nvoxel_cone_tracing.gather\"]\n"));
  CHECK(contains(text, "\"pass gbuffer\" -> \"pass gather\" [label=\" gbuffer \" tooltip=\"GBuffer\"]\n"));
  CHECK(contains(text,
                 "\"pass grid\" -> \"pass gather\" [label=\" mips → grid \" tooltip=\"RadianceGrid\"]\n"));
  CHECK(contains(text, "\"output indirect_diffuse\" [label=\"indirect_diffuse\" shape=ellipse]\n"));
  // Nothing in the room is glossy.
  const std::string why = "needs a glossy material, which the scene does not have";
  CHECK(contains(text,
                 "\"output indirect_glossy\" [label=\"indirect_glossy\\nneeds a glossy material, "
                 "which\\nthe scene does not have\" shape=ellipse style=dashed "));
  CHECK(contains(text,
                 "\"pass gather\" -> \"output indirect_glossy\" [label=\" glossy \" "
                 "tooltip=\"Image: " +
                     why + "\" style=dashed "));
}

TEST_CASE("a pass that is left out is grey with its arrows, and says why") {
  const Workplace place;
  const std::string text = graphOf(pipeline("volumetric_smoke"), place.scene());
  INFO(text);
  const std::string grey = " style=dashed color=\"#8a8a8a\" fontcolor=\"#666666\"]\n",
                    why = "needs a medium, which the scene does not have";
  CHECK(contains(text,
                 "\"pass march\" [label=\"march\\nvolumetric_smoke.march\\nneeds a medium, which the\\nscene "
                 "does not have\"" +
                     grey));
  // An arrow is left out with its reader, with its source, or both.
  for (const char* arrow :
       {"\"pass gbuffer\" -> \"pass march\" [label=\" gbuffer \" tooltip=\"GBuffer: ",
        "\"pass smoke\" -> \"pass direct\" [label=\" media \" tooltip=\"ScatteringGrid: ",
        "\"pass smooth\" -> \"output scattered\" [label=\" scattered \" tooltip=\"Image: "})
    CHECK(contains(text, arrow + why + "\"" + grey));
  CHECK(contains(text, "\"output scattered\" [label=\"scattered\" shape=ellipse" + grey));
  CHECK(contains(text, "\"pass gbuffer\" -> \"pass direct\" [label=\" gbuffer \" tooltip=\"GBuffer\"]\n"));
}

TEST_CASE("explain --graph refuses what it cannot write before it renders, and leaves nothing behind") {
  const Workplace place;
  place.write("cones.pipeline", kCones);
  const std::string empty = quoted(place.file("cache"));
  const auto refused = [&](const std::string& options, const std::string& named) {
    const std::size_t before = place.fileCount();
    checkRefused(explain(place, options, empty), named);
    CHECK(place.fileCount() == before);
  };
  refused("--graph " + quoted(place.file("graph.png")), "expected a name that ends in .svg or .dot or .gv");
  refused("--graph " + quoted(place.file("graph")), "expected a name that ends in .svg or .dot or .gv");
  refused("--graph " + quoted(place.file("room.obj/graph.dot")), "room.obj");
  refused(
      "--graph " + quoted(place.file("graph.svg")),
      "--graph: dot, which draws graphs, is not on the PATH; install it (Debian: apt-get install graphviz)");
  refused("--graph " + quoted(place.file("graph.dot")) + " --pipeline " +
              quoted(committedPipeline("direct_lighting")),
          "--graph draws one pipeline on one scene");
}

TEST_CASE("explain --graph writes the text without Graphviz, and what Graphviz makes of it") {
  const Workplace place;
  place.write("cones.pipeline", kCones);
  const std::string text = graphOf(Pipeline::parse(kCones, "cones.pipeline"), place.scene());
  for (const char* name : {"graph.dot", "graph.gv"}) {
    CAPTURE(name);
    const CommandResult result =
        explain(place, "--graph " + quoted(place.file(name)), quoted(place.file("cache")));
    INFO(result.errors);
    REQUIRE(result.exitCode == 0);
    CHECK(contains(result.output, "passes kept"));
    CHECK(place.read(name) == text);
  }

  fs::create_directories(place.path() / "bin");
  const auto with = [&](const std::string& script) {
    place.write("bin/dot", "#!/bin/sh\n" + script);
    fs::permissions(place.path() / "bin/dot", fs::perms::owner_all);
    place.write("graph.svg", "an older picture");
    return explain(place, "--graph " + quoted(place.file("graph.svg")),
                   quoted(place.file("bin")) + ":\"$PATH\"");
  };
  const auto fails = [&](const std::string& script, const std::string& named) {
    CAPTURE(script);
    const std::size_t before = (with("exit 1\n"), place.fileCount());
    checkRefused(with(script), named);
    CHECK(place.read("graph.svg") == "an older picture");
    CHECK(place.fileCount() == before);
  };
  fails("echo 'no such font' >&2; exit 3\n", "graph.svg: dot ended with exit code 3: no such font");
  fails("cat > /dev/null; kill -9 $$\n", "killed by signal 9");
  fails("cat > /dev/null; echo nothing\n", "graph.svg: dot wrote no picture");
  REQUIRE(with("cat > " + quoted(place.file("given")) + "; echo '<?xml?>'; echo '<svg>'; echo '</svg>'\n")
              .exitCode == 0);
  CHECK(place.read("given") == text);
  // Two hyphens would end the comment.
  CHECK(contains(place.read("graph.svg"), "<?xml?>\n<!--\ndigraph \"\\\"Cones\\\" &amp; \\\\ - -> more\" {"));
  CHECK(contains(place.read("graph.svg"), "}\n-->\n<svg>\n</svg>\n"));
}

TEST_CASE("Graphviz draws every box and every arrow of a pipeline") {
  if (runCommand("dot -V").exitCode != 0) return skip("dot is not installed (Debian package graphviz)");
  const Workplace place;
  place.write("cones.pipeline", kCones);
  const CommandResult result = explain(place, "--graph " + quoted(place.file("graph.svg")), "\"$PATH\"");
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);
  const std::string svg = place.read("graph.svg");
  const auto count = [&](const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = svg.find(part); at != std::string::npos; at = svg.find(part, at + 1)) ++found;
    return found;
  };
  CHECK(count("class=\"node\"") == 8);
  CHECK(count("class=\"edge\"") == 7);
  CHECK(contains(svg, ">voxel_cone_tracing.gather</text>"));
  CHECK(contains(svg, ">&quot;Cones&quot; &amp; \\ "));
}

TEST_CASE("the picture of each technique's pipeline is the graph of the committed pipeline") {
  std::size_t pictures = 0;
  for (const auto& entry : fs::directory_iterator(sourceDirectory() / "techniques")) {
    const std::string name = entry.path().filename().string();
    const fs::path file = committedPipeline(name), picture = entry.path() / "pipeline.svg";
    if (!fs::exists(file)) continue;
    INFO(name << ": lumivox explain " << sceneFor(name).string() << " " << file.string()
              << " --no-times --graph " << picture.string());
    REQUIRE(fs::exists(picture));
    CHECK(fs::file_size(picture) <= 64 * 1024);
    CHECK(textIn(readFile(picture)) == graphOf(Pipeline::load(file), sceneFor(name)));
    ++pictures;
  }
  CHECK(pictures >= 10);
}
