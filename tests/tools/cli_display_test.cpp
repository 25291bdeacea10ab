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
  const auto bytes = [&](const auto&... words) {
    place.rendered("direct_lighting", "-o", place / "a.png", words...);
    return place.read("a.png");
  };
  const CommandResult automatic =
      ran("render", place.scene(), committedPipeline("direct_lighting"), "-o", place / "a.png");
  std::smatch found;
  REQUIRE(std::regex_search(automatic.errors, found, std::regex("a\\.png: .* ms, ([+-][0-9.]+) EV")));
  const std::string first = place.read("a.png");
  const double own = meanGrey(readByteImage(place / "a.png"));
  CHECK(bytes("--exposure auto --tone filmic") == first);
  CHECK(bytes("--exposure", found[1].str()) == first);
  // Its direct light alone, at the exposure of all light.
  CHECK(own > 50.0);
  CHECK(own < 180.0);
  bytes("--exposure=-3EV");
  CHECK(meanGrey(readByteImage(place / "a.png")) < 0.6 * own);
  CHECK(bytes("--tone srgb") != first);
}

TEST_CASE(
    "whoever makes an image of a scene shows it at the same exposure, also from where nobody stood before") {
  const Workplace place;
  const auto told = [](const auto&... words) {
    const CommandResult result = ran(words...);
    std::smatch found;
    REQUIRE(std::regex_search(result.errors, found, std::regex("([+-][0-9.]+) EV")));
    return found[1].str();
  };
  const auto render = [&](const char* pipeline, const char* options) {
    return told("render", place.scene(), committedPipeline(pipeline), options, "-o", place / "a.png");
  };
  const std::string ofReference = told("reference", place.scene(), "--spp 8 -o", place / "t.png");
  CHECK(render("direct_lighting", "") == ofReference);
  CHECK(render("screen_space", "") == ofReference);
  CHECK(render("direct_lighting", "--subpixels 1 --resolution 24x16") == ofReference);
  // Close to a wall that is lit, and the first exposure again: what is kept for one is not taken for the
  // other.
  const char* elsewhere = "--eye 0,0,-0.4 --target 0,0,-1";
  const std::string close = render("direct_lighting", elsewhere);
  CHECK(close != ofReference);
  CHECK(render("screen_space", elsewhere) == close);
  CHECK(render("direct_lighting", "") == ofReference);
}

TEST_CASE("an image is shown at the exposure of another, which its file tells or its pixels") {
  const Workplace place;
  const auto bytesAt = [&](const auto& exposure) {
    place.rendered("direct_lighting", "--subpixels 1 -o", place / "a.png", "--exposure", exposure);
    return place.read("a.png");
  };
  const std::string atOne = bytesAt("1.25");
  place.rendered("direct_lighting", "--subpixels 1 --exposure 1.25 -o", place / "b.png");
  CHECK(readPngAttributes(place / "b.png").at("lumivox.exposure_ev") == "1.25");
  CHECK(bytesAt(place / "b.png") == atOne);
  ran("-q reference", place.scene(), "--spp 4 --exposure 1.25 -o", place / "t.exr");
  CHECK(bytesAt(place / "t.exr") == atOne);
  // An EXR that does not tell: 0.18 / 0.72 is two stops down.
  LayeredImage plain;
  plain.layers[""] = ImageBuffer(4, 4, 3, 0.72f);
  writeExr(place / "plain.exr", plain);
  CHECK(bytesAt(place / "plain.exr") == bytesAt("-2"));
  // A PNG of somebody else, one that is none, one that is not there, and the image itself.
  writePng(place / "foreign.png", plain.layers[""]);
  place.write("text.png", "a text");
  const auto refused = [&](const char* file, const auto&... facts) {
    checkRefused(place.render("direct_lighting", "-o", place / "c.png", "--exposure", place / file),
                 facts...);
    CHECK_FALSE(place.has("c.png"));
  };
  refused("foreign.png", "foreign.png", "exposure");
  refused("text.png", "text.png", "PNG");
  refused("absent.png", "absent.png");
  refused("a.jpg", "auto", "EV");
  checkRefused(place.render("direct_lighting", "-o", place / "b.png", "--exposure", place / "b.png"), "b.png",
               "read");
}

TEST_CASE("edges of images to look at are smooth, and an EXR holds a frame as it is unless somebody asks") {
  const Workplace place;
  const auto made = [&](const char* name, const char* options) {
    place.rendered("direct_lighting", "--exposure 1", options, "-o", place / name);
  };
  made("frame.exr", "");
  made("four.exr", "--subpixels 4");
  made("frame.png", "--subpixels 1");
  made("smooth.png", "");
  const ImageBuffer frame = readExr(place / "frame.exr").layers.at(""),
                    four = readExr(place / "four.exr").layers.at("");
  const auto shown = [&](const char* name) { return readByteImage(place / name).values; };
  CHECK(shown("frame.png") == displayBytes(frame, {1.0, kShownTone}));
  CHECK(shown("smooth.png") == displayBytes(four, {1.0, kShownTone}));
  CHECK(shown("smooth.png") != shown("frame.png"));
  // Smoothed and not another picture.
  CHECK(meanOf(four) == Approx(meanOf(frame)).epsilon(0.05));
  checkRefused(place.render("direct_lighting", "--subpixels 4 --accumulate 3 -o", place / "x.png"),
               "--accumulate");
  checkRefused(place.render("direct_lighting", "--subpixels 0 -o", place / "x.png"), "--subpixels");
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
  const auto render = [&](const char* options, const char* name) {
    ran("-q render", place.scene(), place / "cubes.pipeline", options, "-o", place / name);
  };
  render("", "a.exr");
  LayeredImage image = readExr(place / "a.exr");
  CHECK_FALSE(image.layers.at("cubes").isRadiance());
  CHECK(image.layers.at("direct").isRadiance());
  render("--subpixels 1 --output cubes", "cubes.png");
  const ByteImage shown = readByteImage(place / "cubes.png");
  CHECK(shown.values == displayBytes(image.layers.at("cubes")));
  // What somebody asks for holds.
  render("--exposure=-2 --output cubes", "dark.png");
  CHECK(meanGrey(readByteImage(place / "dark.png")) < 0.7 * meanGrey(shown));
  CHECK(contains(unwrapped(typed("compare", place / "a.exr", place / "a.exr").output), "as they are"));
}

TEST_CASE("exposure and tone curve change no EXR, and the reference's header says its exposure") {
  const Workplace place;
  place.rendered("direct_lighting", "-o", place / "a.exr");
  place.rendered("direct_lighting", "--exposure 4 --tone filmic -o", place / "b.exr");
  const LayeredImage a = readExr(place / "a.exr"), b = readExr(place / "b.exr");
  for (const auto& [name, image] : a.layers) CHECK(image.values() == b.layers.at(name).values());

  const auto reference = [&](const char* name, const std::string& exposure) {
    ran("reference", place.scene(), "-q --spp 8 --resolution 16x16 --exposure", exposure, "-o", place / name);
  };
  reference("t.exr", "auto");
  reference("t.png", "auto");
  const std::string bytes = place.read("t.png");
  reference("t.png", readExrAttributes(place / "t.exr").at("lumivox.exposure_ev"));
  CHECK(place.read("t.png") == bytes);
}

TEST_CASE("compare takes the exposure of the reference's header, and says which one it took") {
  const Workplace place;
  const auto write = [&](const char* name, float value, const std::string& exposure) {
    LayeredImage image;
    image.layers["full"] = ImageBuffer(16, 16, 3, value);
    image.layers["direct"] = ImageBuffer(16, 16, 3, 0.5f * value);
    if (!exposure.empty()) image.attributes["lumivox.exposure_ev"] = exposure;
    writeExr(place / name, image);
  };
  write("a.exr", 0.9f, "");
  write("b.exr", 0.72f, "-1.50");
  const auto json = [&](const std::string& options) {
    const CommandResult result =
        ran("compare", place.file("a.exr"), place.file("b.exr"), "--json", Raw{options});
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
  const CommandResult table = ran("compare", place.file("a.exr"), place.file("b.exr"), "--sheet",
                                  place.file("s.png"), "--tone filmic");
  CHECK(contains(table.output, "SSIM and FLIP LDR are taken at -2.00 EV (all pixels of"));
  // Three panels of at least 160 pixels for each of two layers.
  const ByteImage sheet = readByteImage(place / "s.png");
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
    for (const char* name : {"l.exr", "l.png"})
      ran("reference", place / "lamp.scene", "-q --spp 16 -o", place / name);
    const ImageBuffer full = readExr(place / "l.exr").layers.at("full");
    const ByteImage shown = readByteImage(place / "l.png");
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
  for (const char* name : {"f##.png", "f##.exr"})
    ran("render", sourceDirectory() / "scenes/spinning_box.scene", committedPipeline("voxel_cone_tracing"),
        "-q --resolution 48x48 --set resolution=16 --frames 0..11 --fps 4 -o", place / name);
  double leastGrey = 255.0, mostGrey = 0.0, leastMean = 1e9, mostMean = 0.0;
  for (int frame = 0; frame <= 11; ++frame) {
    const std::string stem = fmt::format("f{:02}", frame);
    const double grey = meanGrey(readByteImage(place / (stem + ".png"))),
                 mean = meanOf(readExr(place / (stem + ".exr")).layers.at(""));
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
  const auto made = [&](const char* options, const char* name) {
    return ran("render", place.scene(), committedPipeline("direct_lighting"),
               "--resolution 12x8 --subpixels 1 --frames 0..7", options, "-o", place / name);
  };
  const CommandResult result = made("", "f#.png");
  const std::regex told("f[0-7]\\.png: .* ms, ([+-][0-9.]+) EV");
  std::set<std::string> exposures;
  int count = 0;
  for (std::sregex_iterator one(result.errors.begin(), result.errors.end(), told), end; one != end;
       ++one, ++count)
    exposures.insert((*one)[1].str());
  CHECK(count == 8);
  CHECK(exposures.size() == 1);
  made("-q --accumulate 2", "g#.png");
  for (int frame = 0; frame < 8; ++frame)
    CHECK(place.read(fmt::format("f{}.png", frame)) == place.read(fmt::format("g{}.png", frame)));
}

TEST_CASE(
    "a sheet shows the whole image and every output, or the frames of a sequence, without an image beside it") {
  const Workplace place;
  const auto panels = [&](int count, const auto&... options) {
    const CommandResult result = ran("render", place.scene(), committedPipeline("voxel_cone_tracing"),
                                     "--set resolution=16 --sheet", place / "- a sheet.png", options...);
    CHECK_THAT(result.errors, Tells(count, "panels"));
    return readByteImage(place / "- a sheet.png").width;
  };
  CHECK(panels(4) ==
        2 * 166 + 6);  // direct, final, which is the whole image, indirect_diffuse, indirect_glossy
  CHECK(place.fileCount() == 5);  // room.obj, room.mtl, room.scene, the sheet and the cache of references
  CHECK(panels(6, "--frames 0..5 --resolution 30x20") == 3 * 166 + 6);
  checkRefused(place.render("voxel_cone_tracing", "--sheet", place / "s.jpg"), "--sheet");
}

TEST_CASE("wrong exposures and tone curves are told by what was given and what was expected") {
  const Workplace place;
  const std::string direct = committedPipeline("direct_lighting");
  const std::string commands[] = {
      lineOf("lumivox", {}, "render", place.scene(), direct, "-q -o", place / "x.png"),
      lineOf("lumivox", {}, "reference", place.scene(), "--spp 2 --resolution 4x4 -q -o", place / "x.png"),
      lineOf("lumivox", {}, "report", place.scene(), "-q -o", place / "r.html")};
  for (const std::string& command : commands) {
    CAPTURE(command);
    for (const char* wrong : {"bright", "nan", "inf", "1e9", "-101", "2EVs", "2,5"}) {
      CAPTURE(wrong);
      checkRefused(runCommand(command + " --exposure=" + wrong), wrong, "auto", "EV", -100, 100);
    }
    checkRefused(runCommand(command + " --exposure="), "--exposure");
    checkRefused(runCommand(command + " --tone sRGB"), "linear");
  }
  CHECK_FALSE(place.has("x.png"));
  CHECK_FALSE(place.has("r.html"));
  checkRefused(place.render("direct_lighting"), "--sheet", "--video");
}

TEST_CASE(
    "a video needs ffmpeg, frames and a name that ends in .mp4, and says so before it renders anything") {
  const Workplace place;
  checkRefused(place.render("direct_lighting", "--video", place / "v.mp4"), "--frames");
  checkRefused(place.render("direct_lighting", "--frames 0..2 --video", place / "v.gif"), ".mp4");
  checkRefused(typed(Before{"env PATH='" + place.file("cache") + "'"}, "render -q", place.scene(),
                     committedPipeline("direct_lighting"), "--frames 0..2 --video", place / "v.mp4"),
               "--video", "ffmpeg", "PATH");
  CHECK_FALSE(place.has("v.mp4"));
}

TEST_CASE("what ffmpeg says when it fails is told, and the video that was there stays") {
  const Workplace place;
  std::filesystem::create_directories(place / "bin");
  const auto with = [&](const std::string& script) {
    place.write("bin/ffmpeg", "#!/bin/sh\n" + script);
    std::filesystem::permissions(place / "bin/ffmpeg", std::filesystem::perms::owner_all);
    place.write("v.mp4", "an older video");
    return typed(Before{"env PATH='" + place.file("bin") + "':\"$PATH\""}, "render -q", place.scene(),
                 committedPipeline("direct_lighting"), "--resolution 64x64 --frames 0..20 --video",
                 place / "v.mp4");
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
    CHECK_THAT(result.errors, Tells("v.mp4", "ffmpeg", 3));
    CHECK(place.read("v.mp4") == "an older video");
  }
  checkRefused(with("cat > /dev/null\n"), "v.mp4", "ffmpeg", "no video");
  checkRefused(with("kill -9 $$\n"), "signal", 9);
  // What it is given: the bytes of the frames, and a file to write.
  REQUIRE(
      with("cat > \"" + place.file("frames") + "\"; for last; do :; done; echo done > \"${last#file:}\"\n")
          .exitCode == 0);
  CHECK(place.read("v.mp4") == "done\n");
  CHECK(std::filesystem::file_size(place / "frames") == 21 * 64 * 64 * 3);
}

TEST_CASE("ffmpeg makes a video of the frames under any name, also of an odd number of pixels") {
  if (runCommand("ffmpeg -version").exitCode != 0 || runCommand("ffprobe -version").exitCode != 0)
    return skip("ffmpeg is not on the PATH");
  const Workplace place;
  for (const char* name : {"-dash and blank.mp4", "http:colon.mp4", "v.mp4"}) {
    CAPTURE(name);
    ran(in(place.path()), "render room.scene", committedPipeline("direct_lighting"),
        "-q --resolution 33x21 --frames 0..9 --fps 12.5", ("--video=" + std::string(name)));
    const CommandResult probed = runCommand(
        "ffprobe -v error -count_frames -show_entries stream=width,height,r_frame_rate,nb_read_frames "
        "-of csv=p=0 " +
        std::string("'file:") + place.file(name) + "'");
    CHECK(contains(probed.output, "34,22,25/2,10"));
  }
  // The first frame is the image that render writes, but for what the encoder loses.
  place.rendered("direct_lighting", "--resolution 33x21 --frames 0..9 -o", place / "f#.png");
  REQUIRE(runCommand("cd '" + place.path().string() + "' && ffmpeg -v error -i v.mp4 -frames:v 1 v.png")
              .exitCode == 0);
  const double grey = meanGrey(readByteImage(place / "f0.png"));
  CHECK(meanGrey(readByteImage(place / "v.png")) == Approx(grey).epsilon(0.12));
}
