// render, reference, explain and shaders on real input, good and bad.
#include <regex>

#include "lumivox/base/image.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE(
    "render writes every output as a layer, their sum as the main layer, and where the image comes from") {
  const Workplace place;
  const CommandResult result = ran("render", place.scene(), committedPipeline("voxel_cone_tracing"),
                                   "--set resolution=16 --seed 3 -o", place.file("a.exr"));
  const LayeredImage image = readExr(place / "a.exr");
  for (const char* layer : {"", "direct", "indirect_diffuse", "indirect_glossy"}) {
    INFO(layer);
    REQUIRE(image.layers.count(layer) == 1);
    CHECK(image.layers.at(layer).width() == 24);
    CHECK(image.layers.at(layer).height() == 16);
  }
  const auto& main = image.layers.at("").values();
  double sum = 0.0;
  for (std::size_t i = 0; i < main.size(); ++i) {
    const double parts = image.layers.at("direct").values()[i] +
                         image.layers.at("indirect_diffuse").values()[i] +
                         image.layers.at("indirect_glossy").values()[i];
    CHECK(main[i] ==
          Approx(parts).epsilon(2e-3).margin(1e-4));  // outputs may be stored as half floats: 11 bits
    sum += main[i];
  }
  CHECK(sum > 0.0);
  CHECK(contains(image.attributes.at("lumivox.parameters"), "resolution=16"));
  CHECK(image.attributes.at("lumivox.seed") == "3");
  CHECK(image.attributes.at("lumivox.scene_hash").size() == 32);
  for (const char* name : {"lumivox.pipeline_hash", "lumivox.device", "lumivox.driver", "lumivox.command"})
    CHECK(image.attributes.count(name) == 1);
}

TEST_CASE("the same seed and device give the same bits twice") {
  const Workplace place;
  for (const char* name : {"a.exr", "b.exr"}) place.rendered("direct_lighting", "-o", place.file(name));
  const LayeredImage a = readExr(place / "a.exr"), b = readExr(place / "b.exr");
  for (const auto& [name, image] : a.layers) CHECK(image.values() == b.layers.at(name).values());
}

TEST_CASE("render numbers the images of an animation, with a run of # or before the extension") {
  const Workplace place;
  for (const char* name : {"out.png", "f##.png"})
    place.rendered("direct_lighting", "--resolution 8x8 --frames 9..11 -o", place / name);
  for (const char* name : {"out_0009.png", "out_0010.png", "out_0011.png", "f09.png", "f10.png", "f11.png"}) {
    INFO(name);
    CHECK(place.has(name));
  }
  CHECK_FALSE(place.has("out.png"));
  CHECK(readByteImage(place / "f10.png").width == 8);
}

TEST_CASE("render of one output alone has it as the main layer, and a wrong name names the nearest") {
  const Workplace place;
  place.rendered("direct_lighting", "--output direct -o", place / "a.exr");
  CHECK(readExr(place / "a.exr").layers.size() == 1);
  checkRefused(place.render("direct_lighting", "--output dirext -o", place / "a.exr"), "did you mean",
               "direct");
  checkRefused(typed("render", committedPipeline("direct_lighting"),
                     sourceDirectory() / "scenes/cornell.scene", "-o", place / "swapped.exr"),
               "SCENE PIPELINE");
}

TEST_CASE("render accumulates frames at each time; without anything that does, the image stays to the bit") {
  const Workplace place;
  place.rendered("direct_lighting", "-o", place / "alone.exr");
  place.rendered("direct_lighting", "--accumulate 3 -o", place / "third.exr");
  const LayeredImage alone = readExr(place / "alone.exr"), third = readExr(place / "third.exr");
  for (const auto& [name, image] : alone.layers) CHECK(image.values() == third.layers.at(name).values());
  CHECK(alone.attributes.count("lumivox.accumulate") == 0);
  CHECK(third.attributes.at("lumivox.accumulate") == "3");
  for (const char* wrong : {"0", "-1", "2.5", "many"})
    checkRefused(place.render("direct_lighting", "-o", place / "x.exr", "--accumulate", wrong),
                 "--accumulate");
  CHECK_FALSE(place.has("x.exr"));
}

TEST_CASE("render says that frames accumulate anew where something moves, and not where nothing does") {
  const Workplace place;
  const auto said = [&](const char* scene) {
    return typed("render", sourceDirectory() / "scenes" / scene, committedPipeline("near_field_voxels"),
                 "--set resolution=16 --set rays=4 --resolution 8x8 --fps 1 --frames 0..2 --accumulate 3 -o",
                 place / "f#.exr");
  };
  const CommandResult moving = said("spinning_box.scene"), still = said("cornell.scene");
  INFO(moving.errors << still.errors);
  REQUIRE(moving.exitCode == 0);
  REQUIRE(still.exitCode == 0);
  const std::string fact = "accumulates from 1 s on anew";
  const std::size_t at = unwrapped(moving.errors).find(fact);
  CHECK(at != std::string::npos);
  CHECK(unwrapped(moving.errors).find("accumulates from", at + 1) == std::string::npos);  // once
  CHECK_FALSE(contains(unwrapped(still.errors), "accumulates from"));
}

TEST_CASE("render --check-reads finds nothing in techniques that say what they read") {
  const Workplace place;
  for (const char* pipeline : {"voxel_cone_tracing", "light_propagation_volumes"})
    CHECK(place
              .rendered(pipeline, "--set resolution=16 --resolution 8x8 --frames 0..1 --check-reads -o",
                        place / "f#.exr")
              .errors.empty());
}

TEST_CASE("the reference has layers of numbers of bounces when they are asked for") {
  const Workplace place;
  const auto reference = [&](const char* layers) {
    return typed("reference", place.scene(),
                 "-q --no-cache --resolution 8x8 --spp 2 --bounces 4 --bounce-layers", layers, "-o",
                 place / "t.exr");
  };
  REQUIRE(reference("1,3").exitCode == 0);
  const LayeredImage image = readExr(place / "t.exr");
  for (const char* layer : {"bounces_1", "bounces_3_diffuse", "bounces_3_glossy.variance"})
    CHECK(image.layers.count(layer) == 1);
  CHECK(image.layers.count("bounces_2") == 0);
  checkRefused(reference("5"), "bounces", 5);
  checkRefused(reference("one"), "--bounce-layers");
}

TEST_CASE("a frame that cannot be written ends the render with its name, and those before it are whole") {
  const Workplace place;
  std::filesystem::create_directories(place / "f_1.png" / "in the way");
  const CommandResult result = typed("render", place.scene(), committedPipeline("direct_lighting"),
                                     "-q --resolution 8x8 --frames 0..3 -o", place.file("f_#.png"));
  CHECK(result.exitCode == 2);
  CHECK_THAT(result.errors, Catch::Contains("f_1.png") && Catch::Contains("cannot write"));
  CHECK(readByteImage(place / "f_0.png").width == 8);
  CHECK_FALSE(std::filesystem::exists(place / "f_3.png"));
  for (const auto& entry : std::filesystem::directory_iterator(place.path()))
    CHECK(entry.path().extension() != ".new");
}

TEST_CASE("an image is written to the file that a symbolic link names") {
  const Workplace place;
  std::filesystem::create_symlink("there.png", place / "link.png");
  const CommandResult result = typed("render", place.scene(), committedPipeline("direct_lighting"),
                                     "-q --resolution 8x8 -o", place.file("link.png"));
  INFO(result.errors);
  CHECK(result.exitCode == 0);
  CHECK(std::filesystem::is_symlink(place / "link.png"));
  CHECK(readByteImage(place / "there.png").width == 8);
}

TEST_CASE("the cache of references is listed and pruned") {
  const Workplace place;
  for (const int seed : {1, 2})
    ran("reference", place.scene(), "-q --resolution 8x8 --spp 2 -o", place / "t.exr", "--seed", seed);
  // And the view that both are exposed by.
  CHECK_THAT(ran("cache list").output, Tells(3, "references") && Tells("4.0 GiB") && Tells("8 8"));
  CHECK(answered("cache list --json").at("limit_bytes") == 4294967296);
  CHECK_THAT(typed("cache prune --dry-run --all").output, Tells("would remove", 3));
  CHECK_THAT(typed("cache prune --limit 1GiB").output, Tells("removed", 0));
  CHECK_THAT(typed("cache prune --limit plenty").errors, Tells("plenty"));
  CHECK_THAT(typed("cache prune --all").output, Tells("removed", 3));
  CHECK_THAT(typed("cache list").output, Tells(0, "references"));
}

TEST_CASE(
    "bad options are told before any work: parameter, range, resolution, frames, kind of image, place") {
  const Workplace place;
  place.write("old.exr", "an earlier result");
  for (const auto& [option, facts] : std::vector<std::pair<const char*, Tells>>{
           {"--set resolutoin=64", Tells("did you mean", "resolution")},
           {"--set resolution=0", Tells("resolution", 0)},
           {"--set resolution=many", Tells("resolution", "many")},
           {"--set resolution", Tells("resolution")},
           {"--resolution 0x5", Tells("--resolution")},
           {"--resolution 99999x99999", Tells("--resolution")},
           {"--frames 5..2", Tells("--frames")},
           {"--camera mane", Tells("mane", "main")}}) {
    CAPTURE(option);
    const CommandResult result = place.render("voxel_cone_tracing", option, "-o", place / "old.exr");
    checkRefused(result);
    CHECK_THAT(result.errors, facts);
  }
  CHECK(place.read("old.exr") == "an earlier result");
  checkRefused(place.render("voxel_cone_tracing", "-o", place / "a.jpg"), "a.jpg");
  checkRefused(place.render("voxel_cone_tracing", "-o", place / "old.exr/a.exr"), "old.exr");
  checkRefused(place.render("voxel_cone_tracing", "-o", place.file("cache.exr/")), "cache.exr");
}

TEST_CASE("every kind of bad input file gives one clear error and leaves the earlier image alone") {
  const Workplace place;
  place.write("old.exr", "an earlier result");
  const auto scene = [&](const std::string& name, const std::string& mesh) {
    place.write(name, "scene \"Bad\" {\n  camera main { eye 0 0 0.9  target 0 0 -1 }\n  mesh room { file \"" +
                          mesh + "\" }\n  light bulb point { position 0 0 0  intensity 1 1 1 }\n}\n");
    return place.file(name);
  };
  place.write("empty.obj", "");
  place.write("binary.obj", std::string("\0\1\2\3\xff\xfe", 6));
  place.write("cut.obj.gz", std::string("\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\x03\x4b", 11));
  place.write("no_mtl.obj", std::string("mtllib nowhere.mtl\n") + kRoomObj);
  place.write("image.mtl", "newmtl grey\nKd 0.5 0.5 0.5\nmap_Kd broken.png\n");
  place.write(
      "image.obj",
      std::string("mtllib image.mtl\nusemtl grey\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n"));
  place.write("broken.png", "\x89PNG\r\n\x1a\n and no more");
  const struct {
    std::string scene, named;
  } cases[] = {{scene("missing.scene", "nowhere.obj"), "nowhere.obj"},
               {scene("empty_model.scene", "empty.obj"), "empty.obj"},
               {scene("binary_model.scene", "binary.obj"), "binary.obj"},
               {scene("cut_model.scene", "cut.obj.gz"), "cut.obj.gz"},
               {scene("image.scene", "image.obj"), "broken.png"},
               {place.file("nowhere.scene"), "nowhere.scene"}};
  for (const auto& bad : cases) {
    INFO(bad.scene);
    checkRefused(
        typed("render -q", bad.scene, committedPipeline("direct_lighting"), "-o", place.file("old.exr")),
        bad.named);
  }
  place.write("cut.pipeline", "pipeline \"Cut\" {\n  pass gbuffer direct_lighting.gbuffer {\n");
  place.write("unknown.pipeline",
              "pipeline \"Unknown\" {\n  pass a astrology.horoscope { }\n  output direct a.future\n}\n");
  for (const char* pipeline : {"cut.pipeline", "unknown.pipeline", "nowhere.pipeline"}) {
    INFO(pipeline);
    checkRefused(typed("render -q", place.scene(), place.file(pipeline), "-o", place.file("old.exr")),
                 pipeline);
  }
  CHECK(place.read("old.exr") == "an earlier result");
}

TEST_CASE("a broken technique library or shader pack is named with its path and the reason") {
  const Workplace place;
  const auto source = binaryDirectory() / "lib/techniques";
  const std::string library = readFile(source / "libdirect_lighting.so"),
                    pack = readFile(source / "direct_lighting.shaderpack");
  // A technique of a name that nothing else has.
  place.write("plugins/libmy_paper.so", library);
  place.write(
      "own.pipeline",
      "pipeline \"Own\" {\n  pass gbuffer my_paper.gbuffer { }\n  pass shadow my_paper.shadow_map { }\n"
      "  pass direct my_paper.shade { gbuffer gbuffer  shadow shadow.depth }\n  output direct "
      "direct.radiance\n}\n");
  const auto refused = [&](const char* named) {
    checkRefused(typed("render -q", place.scene(), place / "own.pipeline", "--techniques", place / "plugins",
                       "-o", place / "a.exr"),
                 named);
  };
  for (const std::string& bytes :
       {std::string(), pack.substr(0, pack.size() / 2), std::string("no pack at all"), pack}) {
    place.write("plugins/my_paper.shaderpack", bytes);  // the last one is whole, but another technique's
    refused("my_paper.shaderpack");
  }
  for (const std::string& bytes : {library.substr(0, 1000), std::string()}) {
    place.write("plugins/libmy_paper.so", bytes);
    refused("libmy_paper.so");
  }
  CHECK_FALSE(place.has("a.exr"));
}

TEST_CASE("a grid that cannot fit in memory is refused with its size") {
  const Workplace place;
  place.write("huge.pipeline",
              "pipeline \"Huge\" {\n  pass voxels voxelization.conservative { resolution 512 }\n  pass "
              "gbuffer direct_lighting.gbuffer { }\n"
              "  pass shadow direct_lighting.shadow_map { size 8192 }\n"
              "  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }\n  output direct "
              "direct.radiance\n}\n");
  std::string lights;
  for (int i = 0; i < 64; ++i)
    lights += "  light bulb" + std::to_string(i) + " point { position 0.2 0.5 0  intensity 1 1 1 }\n";
  place.write("many.scene",
              std::string("scene \"Many\" {\n  camera main { eye 0 0 0.9  target 0 0 -1  resolution 8 8 }\n"
                          "  mesh room { file \"room.obj\" }\n") +
                  lights + "}\n");
  // 64 point lights, 6 faces of 8192 x 8192 texels of 4 bytes each: 96 GiB.
  const CommandResult result =
      typed("render -q", place.file("many.scene"), place.file("huge.pipeline"), "-o", place.file("a.exr"));
  INFO(result.errors);
  CHECK(result.exitCode == 2);
  CHECK(contains(result.errors, "iB"));
  CHECK_FALSE(place.has("a.exr"));
}

TEST_CASE("strict refuses a model with a bad triangle that is otherwise dropped with a warning") {
  const Workplace place;
  place.write("room.obj", std::string(kRoomObj) + "v nan 0 0\nf 1 2 9\nf 1 1 2\n");
  const auto render = [&](const char* strict) {
    return typed("render", place.scene(), committedPipeline("direct_lighting"), "--resolution 8x8", strict,
                 "-o", place / "a.exr");
  };
  checkRefused(render("--strict"), "room.obj");
  CHECK_FALSE(place.has("a.exr"));
  const CommandResult lenient = render("");
  CHECK(lenient.exitCode == 0);
  CHECK_THAT(lenient.errors, Tells("room.obj"));
}

TEST_CASE("reference writes the reference with its variances, and compare judges an image by it") {
  const Workplace place;
  const CommandResult result =
      ran("reference", place.scene(), "-q --spp 16 --bounces 4 -o", place.file("reference.exr"));
  const LayeredImage reference = readExr(place / "reference.exr");
  for (const char* layer :
       {"", "direct", "one_bounce_diffuse", "indirect_diffuse", "full", "direct.variance", "full.variance"}) {
    INFO(layer);
    CHECK(reference.layers.count(layer) == 1);
  }
  CHECK(reference.layers.at("").values() == reference.layers.at("full").values());
  ran("render -q", place.scene(), committedPipeline("direct_lighting"), "-o", place.file("a.exr"));
  const CommandResult compared =
      typed("compare", place.file("a.exr"), place.file("reference.exr"), "--layer direct --json");
  INFO(compared.errors);
  const auto layer = nlohmann::json::parse(compared.output).at("layers").at(0);
  // A point light on Lambert surfaces: direct lighting is exact but for the image's edges and the shadow
  // map.
  CHECK(layer["mean_ratio"]["value"].get<double>() == Approx(1.0).epsilon(0.1));
  CHECK(typed("reference", place.scene(), "--spp 0 -o a.exr").exitCode == 2);
}

TEST_CASE("explain says what was left out, what it saved, and that the image is the same") {
  const Workplace place;
  const auto json = answered("explain", place.scene(), committedPipeline("voxel_cone_tracing"),
                             "-q --set resolution=16 --repeats 1 --json");
  CHECK(json.at("same_image").get<bool>());
  for (const char* frame : {"frame_ms", "frame_ms_keep_everything"})
    CHECK(json.at(frame).at("median").get<double>() > 0.0);
  bool glossy = false;  // the room has nothing glossy
  for (const auto& one : json.at("left_out"))
    glossy = glossy || contains(one.at("why").get<std::string>(), "glossy");
  CHECK(glossy);
  CHECK_THAT(ran("explain", place.scene(), committedPipeline("direct_lighting"), "-q --repeats 1").output,
             Tells("passes kept"));
}

TEST_CASE(
    "shaders lists the variants that are possible, compiled and needed, and prints any of them as GLSL") {
  const Workplace place;
  const auto json = answered("shaders -q", place.scene(), committedPipeline("voxel_cone_tracing"),
                             "--set resolution=16 --json");
  REQUIRE_FALSE(json.at("programs").empty());
  for (const auto& program : json.at("programs")) {
    CHECK(program.at("possible").get<std::size_t>() >= program.at("compiled").get<std::size_t>());
    CHECK(program.at("compiled").get<std::size_t>() >= program.at("needed").size());
  }
  const CommandResult glsl = typed("shaders --print voxel_cone_tracing/gather");
  INFO(glsl.errors);
  CHECK(glsl.exitCode == 0);
  CHECK(contains(glsl.output, "#version 450"));
  CHECK(contains(glsl.output, "void main()"));
  CHECK(contains(typed("shaders --print toolkit/scan").output, "void main()"));
  checkRefused(typed("shaders --print voxel_cone_tracing/gahter"), "gather");
  checkRefused(typed("shaders --print voxel_cone_tracing/gather --variant purple"), "--variant");
  checkRefused(typed("shaders"), "SCENE");
}

TEST_CASE(
    "what exceeds the memory that a run may take is refused with pass, resource, sum and limit, each once") {
  const Workplace place;
  const auto within = [&](const char* memory) {
    return place.render("voxel_cone_tracing", "--set resolution=64 -o", place / "a.exr", "--memory", memory);
  };
  // Each resource of the grid alone is smaller.
  const CommandResult result = within("7MiB");
  checkRefused(result, "7.0 MiB", "other textures and buffers");
  CHECK(std::regex_search(result.errors,
                          std::regex("pass \\w+: (texture|buffer) '\\w+: [^']+' \\(.*\\) needs ")));
  const std::size_t pass = result.errors.find("pass ");
  CHECK(result.errors.find("pass ", pass + 1) == std::string::npos);
  CHECK_FALSE(place.has("a.exr"));
  CHECK(within("1GiB").exitCode == 0);
  checkRefused(within("lots"), "--memory");
}

TEST_CASE("what the driver refuses in a pass names the pass once") {
  const Workplace place;
  // 96 views of 4096 x 4096 texels: more than a software rasteriser takes in one texture.
  place.write("big.pipeline",
              "pipeline \"Big\" {\n  pass gbuffer direct_lighting.gbuffer { }\n"
              "  pass shadow direct_lighting.shadow_map { area_size 4096  area_samples 16 }\n"
              "  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }\n"
              "  output direct direct.radiance\n}\n");
  const CommandResult result =
      typed("--device software render", sourceDirectory() / "scenes/cornell.scene",
            place.file("big.pipeline"), "-q --resolution 16x16 -o", place.file("a.exr"));
  INFO(result.errors);
  checkRefused(result, "pass shadow: ");
  CHECK(contains(result.errors, "'shadow: shadow depth'"));
  const std::size_t pass = result.errors.find("pass shadow");
  CHECK(result.errors.find("pass shadow", pass + 1) == std::string::npos);
}
