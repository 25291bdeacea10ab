// Exposure and tone curve from the command line: images, sheets and videos that are looked at.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <regex>
#include <set>

#include "lumivox/base/image.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

std::string quoted(const std::string& text) {
  return "'" + text + "'";
}

/// Mean of the bytes, 0 to 255.
double meanGrey(const ByteImage& image) {
  double sum = 0.0;
  for (const unsigned char value : image.values) sum += value;
  return sum / static_cast<double>(image.values.size());
}

double meanOf(const ImageBuffer& image) {
  double sum = 0.0;
  for (const float value : image.values()) sum += value;
  return sum / static_cast<double>(image.values().size());
}

/// The little room with a square lamp in front of its back wall that fills about this share of the view.
std::string roomWithLamp(double share) {
  // Where the lamp hangs, 1 m before the camera, the view is 1.4 m high and 2.1 m wide.
  const double side = std::sqrt(share * 1.4 * 2.1);
  return fmt::format(
      "scene \"Room with a lamp\" {{\n"
      "  camera main {{ eye 0 0 0.9  target 0 0 -1  fov 70 deg  resolution 48 32 }}\n"
      "  mesh room {{ file \"room.obj\" }}\n"
      "  mesh lamp {{ file \"lamp.obj\"  translate 0 0.05 -0.1  scale {} }}\n"
      "  light shine area {{ mesh lamp  radiance 40 40 40 }}\n"
      "}}\n",
      0.5 * side);
}

}  // namespace

TEST_CASE("an image says its exposure in the terminal, and that number gives the same bytes again") {
  const Workplace place;
  const std::string command = "lumivox render " + quoted(place.scene()) + " " +
                              quoted(committedPipeline("direct_lighting")) + " -o " +
                              quoted(place.file("a.png"));
  const CommandResult automatic = runCommand(command);
  REQUIRE(automatic.exitCode == 0);
  std::smatch found;
  REQUIRE(std::regex_search(automatic.errors, found, std::regex("a\\.png: .* ms, ([+-][0-9.]+) EV")));
  const std::string bytes = place.read("a.png");
  REQUIRE(runCommand(command + " -q --exposure auto --tone filmic").exitCode == 0);
  CHECK(place.read("a.png") == bytes);
  REQUIRE(runCommand(command + " -q --exposure " + found[1].str()).exitCode == 0);
  CHECK(place.read("a.png") == bytes);
  const double own = meanGrey(readByteImage(place.path() / "a.png"));
  // Its direct light alone, at the exposure of all light.
  CHECK(own > 50.0);
  CHECK(own < 180.0);
  REQUIRE(runCommand(command + " -q --exposure=-3EV").exitCode == 0);
  CHECK(meanGrey(readByteImage(place.path() / "a.png")) < 0.6 * own);
  REQUIRE(runCommand(command + " -q --tone srgb").exitCode == 0);
  CHECK(place.read("a.png") != bytes);
}

TEST_CASE(
    "whoever makes an image of a scene shows it at the same exposure, also from where nobody stood before") {
  const Workplace place;
  const std::string reference = "lumivox reference " + quoted(place.scene()) + " --spp 8 -o ";
  const auto told = [](const CommandResult& result) {
    INFO(result.errors);
    REQUIRE(result.exitCode == 0);
    std::smatch found;
    REQUIRE(std::regex_search(result.errors, found, std::regex("([+-][0-9.]+) EV")));
    return found[1].str();
  };
  const auto render = [&](const char* pipeline, const std::string& options) {
    return told(runCommand("lumivox render " + quoted(place.scene()) + " " +
                           quoted(committedPipeline(pipeline)) + " -o " + quoted(place.file("a.png")) +
                           options));
  };
  const std::string ofReference = told(runCommand(reference + quoted(place.file("t.png"))));
  CHECK(render("direct_lighting", "") == ofReference);
  CHECK(render("screen_space", "") == ofReference);
  CHECK(render("direct_lighting", " --subpixels 1 --resolution 24x16") == ofReference);
  // Close to a wall that is lit, and the first exposure again: what is kept for one is not taken for the
  // other.
  const std::string elsewhere = " --eye 0,0,-0.4 --target 0,0,-1";
  const std::string close = render("direct_lighting", elsewhere);
  CHECK(close != ofReference);
  CHECK(render("screen_space", elsewhere) == close);
  CHECK(render("direct_lighting", "") == ofReference);
}

TEST_CASE("an image is shown at the exposure of another, which its file tells or its pixels") {
  const Workplace place;
  const std::string render = "lumivox -q render " + quoted(place.scene()) + " " +
                             quoted(committedPipeline("direct_lighting")) + " --subpixels 1 -o ";
  const auto bytesAt = [&](const std::string& exposure) {
    const CommandResult result = runCommand(render + quoted(place.file("a.png")) + " --exposure=" + exposure);
    INFO(result.errors);
    REQUIRE(result.exitCode == 0);
    return place.read("a.png");
  };
  const std::string atOne = bytesAt("1.25");
  REQUIRE(runCommand(render + quoted(place.file("b.png")) + " --exposure 1.25").exitCode == 0);
  CHECK(readPngAttributes(place.path() / "b.png").at("lumivox.exposure_ev") == "1.25");
  CHECK(bytesAt(quoted(place.file("b.png"))) == atOne);
  REQUIRE(runCommand("lumivox -q reference " + quoted(place.scene()) + " --spp 4 --exposure 1.25 -o " +
                     quoted(place.file("t.exr")))
              .exitCode == 0);
  CHECK(bytesAt(quoted(place.file("t.exr"))) == atOne);
  // An EXR that does not tell: 0.18 / 0.72 is two stops down.
  LayeredImage plain;
  plain.layers[""] = ImageBuffer(4, 4, 3, 0.72f);
  writeExr(place.path() / "plain.exr", plain);
  CHECK(bytesAt(quoted(place.file("plain.exr"))) == bytesAt("-2"));
  // A PNG of somebody else, one that is none, one that is not there, and the image itself.
  writePng(place.path() / "foreign.png", plain.layers[""]);
  place.write("text.png", "a text");
  const auto refused = [&](const std::string& file, const std::string& why) {
    checkRefused(runCommand(render + quoted(place.file("c.png")) + " --exposure " + quoted(place.file(file))),
                 why);
    CHECK_FALSE(place.has("c.png"));
  };
  refused("foreign.png", "foreign.png: tells no exposure");
  refused("text.png", "text.png: is not a PNG");
  refused("absent.png", "absent.png");
  refused("a.jpg", "expected auto or a number of EV");
  checkRefused(
      runCommand(render + quoted(place.file("b.png")) + " --exposure " + quoted(place.file("b.png"))),
      "was read for the same work");
}

TEST_CASE("edges of images to look at are smooth, and an EXR holds a frame as it is unless somebody asks") {
  const Workplace place;
  const std::string render = "lumivox -q render " + quoted(place.scene()) + " " +
                             quoted(committedPipeline("direct_lighting")) + " --exposure 1 -o ";
  const auto made = [&](const char* name, const std::string& options) {
    const CommandResult result = runCommand(render + quoted(place.file(name)) + options);
    INFO(result.errors);
    REQUIRE(result.exitCode == 0);
  };
  made("frame.exr", "");
  made("four.exr", " --subpixels 4");
  made("frame.png", " --subpixels 1");
  made("smooth.png", "");
  const ImageBuffer frame = readExr(place.path() / "frame.exr").layers.at(""),
                    four = readExr(place.path() / "four.exr").layers.at("");
  const auto shown = [&](const char* name) { return readByteImage(place.path() / name).values; };
  CHECK(shown("frame.png") == displayBytes(frame, {1.0, kShownTone}));
  CHECK(shown("smooth.png") == displayBytes(four, {1.0, kShownTone}));
  CHECK(shown("smooth.png") != shown("frame.png"));
  // Smoothed and not another picture.
  CHECK(meanOf(four) == Approx(meanOf(frame)).epsilon(0.05));
  checkRefused(runCommand(render + quoted(place.file("x.png")) + " --subpixels 4 --accumulate 3"),
               "--accumulate");
  checkRefused(runCommand(render + quoted(place.file("x.png")) + " --subpixels 0"), "--subpixels");
}

TEST_CASE(
    "what is no radiance is shown as it is although it has three channels, also by what reads its EXR") {
  const Workplace place;
  place.write("cubes.pipeline",
              "pipeline \"Cubes\" {\n"
              "  pass gbuffer direct_lighting.gbuffer { }\n"
              "  pass direct direct_lighting.shade { gbuffer gbuffer }\n"
              "  pass voxels voxelization.conservative { resolution 8 }\n"
              "  pass look voxel_cone_tracing.look { voxels voxels.fragments }\n"
              "  output direct direct.radiance\n"
              "  output cubes look.radiance\n"
              "}\n");
  const std::string command =
      "lumivox -q render " + quoted(place.scene()) + " " + quoted(place.file("cubes.pipeline"));
  REQUIRE(runCommand(command + " -o " + quoted(place.file("a.exr"))).exitCode == 0);
  LayeredImage image = readExr(place.path() / "a.exr");
  CHECK_FALSE(image.layers.at("cubes").isRadiance());
  CHECK(image.layers.at("direct").isRadiance());
  REQUIRE(
      runCommand(command + " --subpixels 1 --output cubes -o " + quoted(place.file("cubes.png"))).exitCode ==
      0);
  const ByteImage shown = readByteImage(place.path() / "cubes.png");
  CHECK(shown.values == displayBytes(image.layers.at("cubes")));
  // What somebody asks for holds.
  REQUIRE(
      runCommand(command + " --exposure=-2 --output cubes -o " + quoted(place.file("dark.png"))).exitCode ==
      0);
  CHECK(meanGrey(readByteImage(place.path() / "dark.png")) < 0.7 * meanGrey(shown));
  const CommandResult compared =
      runCommand("lumivox compare " + quoted(place.file("a.exr")) + " " + quoted(place.file("a.exr")));
  CHECK(contains(unwrapped(compared.output), "as they are"));
}

TEST_CASE("exposure and tone curve change no EXR, and the reference's header says its exposure") {
  const Workplace place;
  for (const char* name : {"a.exr", "b.exr"})
    REQUIRE(runCommand("lumivox render " + quoted(place.scene()) + " " +
                       quoted(committedPipeline("direct_lighting")) + " -q -o " + quoted(place.file(name)) +
                       (name[0] == 'b' ? " --exposure 4 --tone filmic" : ""))
                .exitCode == 0);
  const LayeredImage a = readExr(place.path() / "a.exr"), b = readExr(place.path() / "b.exr");
  for (const auto& [name, image] : a.layers) CHECK(image.values() == b.layers.at(name).values());

  const std::string reference =
      "lumivox reference " + quoted(place.scene()) + " -q --spp 8 --resolution 16x16 -o ";
  REQUIRE(runCommand(reference + quoted(place.file("t.exr"))).exitCode == 0);
  REQUIRE(runCommand(reference + quoted(place.file("t.png"))).exitCode == 0);
  const std::string kept = readExrAttributes(place.path() / "t.exr").at("lumivox.exposure_ev");
  const std::string bytes = place.read("t.png");
  REQUIRE(runCommand(reference + quoted(place.file("t.png")) + " --exposure " + kept).exitCode == 0);
  CHECK(place.read("t.png") == bytes);
}

TEST_CASE("compare takes the exposure of the reference's header, and says which one it took") {
  const Workplace place;
  const auto write = [&](const char* name, float value, const std::string& exposure) {
    LayeredImage image;
    image.layers["full"] = ImageBuffer(16, 16, 3, value);
    image.layers["direct"] = ImageBuffer(16, 16, 3, 0.5f * value);
    if (!exposure.empty()) image.attributes["lumivox.exposure_ev"] = exposure;
    writeExr(place.path() / name, image);
  };
  write("a.exr", 0.9f, "");
  write("b.exr", 0.72f, "-1.50");
  const auto json = [&](const std::string& options) {
    const CommandResult result = runCommand("lumivox compare " + quoted(place.file("a.exr")) + " " +
                                            quoted(place.file("b.exr")) + " --json " + options);
    INFO(result.errors);
    REQUIRE(result.exitCode == 0);
    return nlohmann::json::parse(result.output);
  };
  const auto kept = json("");
  CHECK(kept["exposure_ev"] == -1.5);
  CHECK(contains(kept["exposure_from"], "the header of"));
  for (const auto& layer : kept["layers"]) CHECK(layer["exposure_ev"] == -1.5);
  CHECK(json("--exposure 2")["layers"][0]["exposure_ev"] == 2.0);
  CHECK(json("--exposure 2")["exposure_from"] == "--exposure");
  // Of the whole light, for all layers: 0.18 / 0.72 is two stops down.
  for (const char* header : {"", "bright", "nan"}) {
    CAPTURE(header);
    write("b.exr", 0.72f, header);
    const auto own = json("-q");
    CHECK(own["exposure_ev"] == -2.0);
    CHECK(own["layers"][0]["exposure_ev"] == -2.0);
    CHECK(contains(own["exposure_from"], "all pixels of the layer 'full'"));
  }
  const CommandResult table =
      runCommand("lumivox compare " + quoted(place.file("a.exr")) + " " + quoted(place.file("b.exr")) +
                 " --sheet " + quoted(place.file("s.png")) + " --tone filmic");
  REQUIRE(table.exitCode == 0);
  CHECK(contains(table.output, "SSIM and FLIP LDR are taken at -2.00 EV (all pixels of"));
  // Three panels of at least 160 pixels for each of two layers.
  const ByteImage sheet = readByteImage(place.path() / "s.png");
  CHECK(sheet.width == 3 * 166 + 6);
  CHECK(sheet.height > 2 * 160);
}

TEST_CASE("a lamp that fills 1 to 20 % of the image turns nothing else black") {
  const Workplace place;
  place.write("lamp.obj", "o lamp\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
  std::vector<double> greys;
  for (const double share : {0.01, 0.05, 0.1, 0.2}) {
    CAPTURE(share);
    place.write("lamp.scene", roomWithLamp(share));
    const std::string command = "lumivox reference " + quoted(place.file("lamp.scene")) + " -q --spp 16 -o ";
    REQUIRE(runCommand(command + quoted(place.file("l.exr"))).exitCode == 0);
    const CommandResult made = runCommand(command + quoted(place.file("l.png")));
    INFO(made.errors);
    REQUIRE(made.exitCode == 0);
    const ImageBuffer full = readExr(place.path() / "l.exr").layers.at("full");
    const ByteImage shown = readByteImage(place.path() / "l.png");
    std::size_t lamp = 0, others = 0;
    double grey = 0.0;
    for (std::size_t i = 0; i < full.pixelCount(); ++i) {
      const bool shines = full.values()[3 * i] > 20.0f;
      lamp += shines ? 1 : 0;
      others += shines ? 0 : 1;
      if (!shines) grey += shown.values[3 * i + 1];
    }
    // As large as it should be, by half at the most.
    CHECK(static_cast<double>(lamp) / static_cast<double>(full.pixelCount()) == Approx(share).epsilon(0.5));
    greys.push_back(grey / static_cast<double>(others));
    CHECK(greys.back() > 90.0);
    CHECK(greys.back() < 150.0);
  }
}

TEST_CASE("an animation does not flash: its images become brighter and darker only as their radiance does") {
  const Workplace place;
  const std::string command = "lumivox render " +
                              quoted((sourceDirectory() / "scenes/spinning_box.scene").string()) + " " +
                              quoted(committedPipeline("voxel_cone_tracing")) +
                              " -q --resolution 48x48 --set resolution=16 --frames 0..11 --fps 4 -o ";
  REQUIRE(runCommand(command + quoted(place.file("f##.png"))).exitCode == 0);
  REQUIRE(runCommand(command + quoted(place.file("f##.exr"))).exitCode == 0);
  double leastGrey = 255.0, mostGrey = 0.0, leastMean = 1e9, mostMean = 0.0;
  for (int frame = 0; frame <= 11; ++frame) {
    const std::string stem = fmt::format("f{:02}", frame);
    const double grey = meanGrey(readByteImage(place.path() / (stem + ".png"))),
                 mean = meanOf(readExr(place.path() / (stem + ".exr")).layers.at(""));
    leastGrey = std::min(leastGrey, grey);
    mostGrey = std::max(mostGrey, grey);
    leastMean = std::min(leastMean, mean);
    mostMean = std::max(mostMean, mean);
  }
  INFO("grey " << leastGrey << " to " << mostGrey << ", mean " << leastMean << " to " << mostMean);
  CHECK(mostGrey / leastGrey <= mostMean / leastMean);
  CHECK(leastGrey > 40.0);
  CHECK(mostGrey < 200.0);
}

TEST_CASE("the frames of a sequence share an exposure, whichever of them is darkest, and keep their bits") {
  const Workplace place;
  // The camera turns from the bulb's wall, close, to the dark corner.
  const std::string command = "lumivox render " + quoted(place.scene()) + " " +
                              quoted(committedPipeline("direct_lighting")) +
                              " --resolution 12x8 --subpixels 1 --frames 0..7 ";
  const CommandResult result = runCommand(command + "-o " + quoted(place.file("f#.png")));
  REQUIRE(result.exitCode == 0);
  const std::regex told("f[0-7]\\.png: .* ms, ([+-][0-9.]+) EV");
  std::set<std::string> exposures;
  int count = 0;
  for (std::sregex_iterator one(result.errors.begin(), result.errors.end(), told), end; one != end;
       ++one, ++count)
    exposures.insert((*one)[1].str());
  CHECK(count == 8);
  CHECK(exposures.size() == 1);
  REQUIRE(runCommand(command + "-q --accumulate 2 -o " + quoted(place.file("g#.png"))).exitCode == 0);
  for (int frame = 0; frame < 8; ++frame)
    CHECK(place.read(fmt::format("f{}.png", frame)) == place.read(fmt::format("g{}.png", frame)));
}

TEST_CASE(
    "a sheet shows the whole image and every output, or the frames of a sequence, without an image beside it") {
  const Workplace place;
  const std::string command = "lumivox render " + quoted(place.scene()) + " " +
                              quoted(committedPipeline("voxel_cone_tracing")) +
                              " --set resolution=16 --sheet " + quoted(place.file("- a sheet.png"));
  const CommandResult outputs = runCommand(command);
  INFO(outputs.errors);
  REQUIRE(outputs.exitCode == 0);
  CHECK(contains(outputs.errors,
                 "4 panels"));  // direct, final, which is the whole image, indirect_diffuse, indirect_glossy
  const ByteImage sheet = readByteImage(place.path() / "- a sheet.png");
  CHECK(sheet.width == 2 * 166 + 6);
  CHECK(place.fileCount() == 5);  // room.obj, room.mtl, room.scene, the sheet and the cache of references
  const CommandResult frames = runCommand(command + " --frames 0..5 --resolution 30x20");
  REQUIRE(frames.exitCode == 0);
  CHECK(contains(frames.errors, "6 panels"));
  CHECK(readByteImage(place.path() / "- a sheet.png").width == 3 * 166 + 6);
  checkRefused(runCommand(command + " --sheet " + quoted(place.file("s.jpg"))), "--sheet");
}

TEST_CASE("wrong exposures and tone curves are told by what was given and what was expected") {
  const Workplace place;
  const std::string output = " -q -o " + quoted(place.file("x.png")) + " ";
  const std::string commands[] = {
      "lumivox render " + quoted(place.scene()) + " " + quoted(committedPipeline("direct_lighting")) + output,
      "lumivox reference " + quoted(place.scene()) + " --spp 2 --resolution 4x4" + output,
      "lumivox report " + quoted(place.scene()) + " -q -o " + quoted(place.file("r.html")) + " "};
  for (const std::string& command : commands) {
    CAPTURE(command);
    for (const char* wrong : {"bright", "nan", "inf", "1e9", "-101", "2EVs", "2,5"}) {
      CAPTURE(wrong);
      checkRefused(runCommand(command + "--exposure=" + wrong),
                   "expected auto or a number of EV from -100 to 100");
    }
    checkRefused(runCommand(command + "--exposure="), "--exposure");
    checkRefused(runCommand(command + "--tone sRGB"), "linear");
  }
  CHECK_FALSE(place.has("x.png"));
  CHECK_FALSE(place.has("r.html"));
  checkRefused(runCommand("lumivox render " + quoted(place.scene()) + " " +
                          quoted(committedPipeline("direct_lighting"))),
               "--sheet or --video");
}

TEST_CASE(
    "a video needs ffmpeg, frames and a name that ends in .mp4, and says so before it renders anything") {
  const Workplace place;
  const std::string render = "lumivox render " + quoted(place.scene()) + " " +
                             quoted(committedPipeline("direct_lighting")) + " -q --resolution 9x7 ";
  checkRefused(runCommand(render + "--video " + quoted(place.file("v.mp4"))), "--frames");
  checkRefused(runCommand(render + "--frames 0..2 --video " + quoted(place.file("v.gif"))), ".mp4");
  const std::string lumivox = (binaryDirectory() / "bin/lumivox").string() + render.substr(7);
  const CommandResult without = runCommand("env PATH=" + quoted(place.file("cache")) + " " + lumivox +
                                           "--frames 0..2 --video " + quoted(place.file("v.mp4")));
  checkRefused(without, "--video: ffmpeg, which encodes videos, is not on the PATH");
  CHECK_FALSE(place.has("v.mp4"));
}

TEST_CASE("what ffmpeg says when it fails is told, and the video that was there stays") {
  const Workplace place;
  std::filesystem::create_directories(place.path() / "bin");
  const auto with = [&](const std::string& script) {
    place.write("bin/ffmpeg", "#!/bin/sh\n" + script);
    std::filesystem::permissions(place.path() / "bin/ffmpeg", std::filesystem::perms::owner_all);
    place.write("v.mp4", "an older video");
    return runCommand("env PATH=" + quoted(place.file("bin")) + ":\"$PATH\" " +
                      (binaryDirectory() / "bin/lumivox").string() + " render " + quoted(place.scene()) +
                      " " + quoted(committedPipeline("direct_lighting")) +
                      " -q --resolution 64x64 --frames 0..20 --video " + quoted(place.file("v.mp4")));
  };
  // At once, after the first bytes, after the last one; with more words than a pipe holds.
  for (const char* script :
       {"echo 'no such encoder' >&2; exit 3\n",
        "head -c 4000 > /dev/null; echo 'no such encoder' >&2; exit 3\n",
        "cat > /dev/null; echo 'no such encoder' >&2; exit 3\n",
        "i=0; while [ $i -lt 20000 ]; do echo 'many words' >&2; i=$((i + 1)); done; cat > /dev/null; "
        "echo 'no such encoder' >&2; exit 3\n"}) {
    CAPTURE(script);
    const CommandResult result = with(script);
    checkRefused(result, "no such encoder");
    CHECK(contains(result.errors, "v.mp4: ffmpeg ended with exit code 3"));
    CHECK(place.read("v.mp4") == "an older video");
  }
  checkRefused(with("cat > /dev/null\n"), "v.mp4: ffmpeg wrote no video");
  checkRefused(with("kill -9 $$\n"), "killed by signal 9");
  // What it is given: the bytes of the frames, and a file to write.
  REQUIRE(
      with("cat > \"" + place.file("frames") + "\"; for last; do :; done; echo done > \"${last#file:}\"\n")
          .exitCode == 0);
  CHECK(place.read("v.mp4") == "done\n");
  CHECK(std::filesystem::file_size(place.path() / "frames") == 21 * 64 * 64 * 3);
}

TEST_CASE("ffmpeg makes a video of the frames under any name, also of an odd number of pixels") {
  if (runCommand("ffmpeg -version").exitCode != 0 || runCommand("ffprobe -version").exitCode != 0)
    return skip("ffmpeg is not on the PATH");
  const Workplace place;
  for (const char* name : {"-dash and blank.mp4", "http:colon.mp4", "v.mp4"}) {
    CAPTURE(name);
    const CommandResult made = runCommand(
        "cd " + quoted(place.path().string()) + " && " + (binaryDirectory() / "bin/lumivox").string() +
        " render room.scene " + quoted(committedPipeline("direct_lighting")) +
        " -q --resolution 33x21 --frames 0..9 --fps 12.5 --video=" + quoted(name));
    INFO(made.errors);
    REQUIRE(made.exitCode == 0);
    const CommandResult probed = runCommand(
        "ffprobe -v error -count_frames -show_entries stream=width,height,r_frame_rate,nb_read_frames "
        "-of csv=p=0 " +
        quoted("file:" + place.file(name)));
    CHECK(contains(probed.output, "34,22,25/2,10"));
  }
  // The first frame is the image that render writes, but for what the encoder loses.
  REQUIRE(runCommand(
              "cd " + quoted(place.path().string()) + " && " + (binaryDirectory() / "bin/lumivox").string() +
              " render room.scene " + quoted(committedPipeline("direct_lighting")) +
              " -q --resolution 33x21 --frames 0..9 -o f#.png && ffmpeg -v error -i v.mp4 -frames:v 1 v.png")
              .exitCode == 0);
  const double grey = meanGrey(readByteImage(place.path() / "f0.png"));
  CHECK(meanGrey(readByteImage(place.path() / "v.png")) == Approx(grey).epsilon(0.12));
}
