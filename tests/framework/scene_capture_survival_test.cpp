// Captures that no good sensor writes: sizes, times and numbers at the ends of their ranges.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "support/capture_files.h"
#include "support/facts.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

const std::string kFolder = std::string("folder \"c\" ") + kPinhole;

/// A capture of one frame whose depth image has this size; colours are 4 x 3, or as large.
CaptureFiles oneFrame(const WordImage& depth, bool coloursAsLarge = true) {
  CaptureFiles files = tum("1.0 rgb/1.0.png 1.0 depth/1.0.png\n", "1.0 0 0 0 0 0 0 1\n");
  files.image("c/depth/1.0.png", depth);
  if (coloursAsLarge) files.image("c/rgb/1.0.png", colourImage(depth.width, depth.height));
  return files;
}

/// The PNG with another width and height in its header, and the checksum that belongs to them.
std::string claiming(std::string png, std::uint32_t width, std::uint32_t height) {
  constexpr std::size_t kType = 12, kWidth = 16, kHeight = 20, kChecksum = 29;
  const auto write = [&](std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) png[at + i] = static_cast<char>(value >> (24 - 8 * i) & 0xffu);
  };
  write(kWidth, width);
  write(kHeight, height);
  write(kChecksum, static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(png.data()) + kType,
                                                    static_cast<uInt>(kChecksum - kType))));
  return png;
}

}  // namespace

TEST_CASE("a picture of one pixel and one that is 16384 pixels wide are read") {
  const int width = GENERATE(1, 16384);
  const int height = width == 1 ? 1 : 2;
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const CaptureFiles files = oneFrame({width, height, std::vector<std::uint16_t>(pixels, 5000)});
  const Scene scene = files.load("folder \"c\" focal 8000 8000 centre 0 0");
  CHECK((only(scene).camera.width == width && only(scene).camera.height == height));
  const auto image = only(scene).image(0);
  REQUIRE(image->depth.size() == pixels);
  CHECK(image->depth.back() == Approx(1.0));
  CHECK(image->colour.size() == 3 * pixels);
}

TEST_CASE("frames with more pixels than a device holds are refused before they are unpacked") {
  const CaptureFiles files = oneFrame(depthImage());
  const std::string png = readFile(files.directory.path() / "c/depth/1.0.png");
  files.text("c/depth/1.0.png", claiming(png, 16384, 16384));
  CHECK_THAT(files.refusal(), Tells("1.0.png", "16384 x 16384", "bytes"));
  // As large as it claims, but wider than a texture may be.
  CHECK_THAT(oneFrame({16385, 1, std::vector<std::uint16_t>(16385, 5000)}).refusal(),
             Tells("1.0.png", "16385 x 1", "16384"));
  Sens made = sens();
  made.width = made.height = 16384;
  CHECK_THAT(withSens(made.bytes()).refusal(kSens), Tells("room.sens", "16384 x 16384", "33554432"));
  // Within the limit, but of far more pixels than its bytes hold.
  made.width = made.height = 4096;
  const CaptureFiles sensor = withSens(made.bytes());
  const Scene scene = sensor.load(kSens);
  CHECK_THAT(messageOf<Error>([&] { only(scene).image(1); }), Tells("room.sens", "frame 1", "cannot hold"));
}

TEST_CASE("a .sens file whose cameras or units have no finite size is refused") {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const auto& change) {
    Sens made = sens();
    change(made);
    return withSens(made.bytes()).refusal(kSens);
  };
  CHECK_THAT(refused([](Sens& made) { made.focal = 1e-30; }), Tells("room.sens", "focal", "1e-30"));
  CHECK_THAT(refused([](Sens& made) { made.focal = INFINITY; }), Tells("room.sens", "focal", "inf"));
  CHECK_THAT(refused([](Sens& made) { made.centre = kNaN; }), Tells("room.sens", "centre", "nan"));
  CHECK_THAT(refused([](Sens& made) { made.shift = 1e-30f; }), Tells("room.sens", "shift", "1e-30"));
  CHECK_THAT(refused([](Sens& made) { made.shift = 0.0f; }), Tells("room.sens", "shift"));
}

TEST_CASE("a .sens file that claims 2^60 frames is refused within a second") {
  Sens made = sens();
  made.claimed = std::uint64_t{1} << 60;
  const CaptureFiles files = withSens(made.bytes());
  const auto before = std::chrono::steady_clock::now();
  CHECK_THAT(files.refusal(kSens), Tells("1152921504606846976 frames"));
  CHECK(std::chrono::steady_clock::now() - before < std::chrono::seconds(1));
}

TEST_CASE("lists that run backwards and name times twice give each time once, in order") {
  CaptureFiles files;
  std::string colours, depths, poses;
  for (const int i : {3, 1, 2, 1, 0}) {
    files.image(fmt::format("c/rgb/{}.png", i), colourImage());
    files.image(fmt::format("c/depth/{}.png", i), depthImage(static_cast<std::uint16_t>(5000 + 1000 * i)));
    colours += fmt::format("{}.004 rgb/{}.png\n", i, i);
    depths += fmt::format("{}.000 depth/{}.png\n", i, i);
    poses += fmt::format("{}.000 {} 0 0 0 0 0 1\n", i, i);
  }
  files.text("c/rgb.txt", colours);
  files.text("c/depth.txt", depths);
  files.text("c/groundtruth.txt", poses);
  const Scene scene = files.load();
  REQUIRE(only(scene).frames.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(only(scene).frames[i].time == Approx(static_cast<double>(i)));
    CHECK(only(scene).frames[i].eye.x == static_cast<double>(i));
    CHECK(only(scene).image(i)->depth[0] == Approx(1.0 + 0.2 * static_cast<double>(i)));
  }
}

TEST_CASE("a list of thousands of images of one time is one frame, and read in a moment") {
  constexpr int kMany = 30000;  // 9 * 10^8 pairs
  CaptureFiles files = tum("", "1.0 0 0 0 0 0 0 1\n");
  std::filesystem::remove(files.directory.path() / "c/associations.txt");
  std::string colours, depths;
  for (int i = 0; i < kMany; ++i) {
    colours += "1.0 rgb/1.0.png\n";
    depths += "1.0 depth/1.0.png\n";
  }
  files.text("c/rgb.txt", colours);
  files.text("c/depth.txt", depths);
  const auto before = std::chrono::steady_clock::now();
  const Scene scene = files.load();
  CHECK(only(scene).frames.size() == 1);
  CHECK(std::chrono::steady_clock::now() - before < std::chrono::seconds(5));
}

TEST_CASE("in a gap between frames the last one before it stays") {
  const Scene scene = tum("1.0 rgb/1.0.png 1.0 depth/1.0.png\n500.0 rgb/1.1.png 500.0 depth/1.1.png\n",
                          "1.0 1 2 3 0 0 0 1\n500.0 2 2 3 0 0 0 1\n")
                          .load();
  CHECK(only(scene).frames[1].time == Approx(499.0));
  CHECK(snapshotOf(scene, 498.9).captures.at(0).frame == 0);
  CHECK(snapshotOf(scene, 499.0).captures.at(0).frame == 1);
}

TEST_CASE("a time that no clock has is refused with its line") {
  const std::string time = GENERATE("1e308", "-1e308", "nan", "inf");
  CHECK_THAT(tum("1.0 rgb/1.0.png 1.0 depth/1.0.png\n1.1 rgb/1.1.png " + time + " depth/1.1.png\n", kTwoPoses)
                 .refusal(),
             Tells("associations.txt:2", "seconds"));
  CHECK_THAT(tum(kPairs, "# poses\n" + time + " 0 0 0 0 0 0 1\n").refusal(),
             Tells("groundtruth.txt:2", "seconds"));
}

TEST_CASE("texts of captures without a line, and a picture that is no file, are refused by name") {
  CHECK_THAT(tum("", kTwoPoses).refusal(), Tells("/c", "colour and a depth image"));
  CHECK_THAT(tum(kPairs, "").refusal(), Tells("/c", "none of 2 frames has a pose"));
  CHECK_THAT(tum("1.0 rgb 1.0 depth/1.0.png\n", kTwoPoses).refusal(), Tells("c/rgb", "regular file"));
}

TEST_CASE("an exposure scales colours alone, from a millionth to a million") {
  const CaptureFiles files = tum(kPairs, kTwoPoses);
  const Scene plain = files.load();
  for (const double exposure : {1e-6, 1e6}) {
    const Scene scaled = files.load(fmt::format("{} exposure {}", kFolder, exposure));
    const auto image = only(scaled).image(0), before = only(plain).image(0);
    CHECK(image->depth == before->depth);
    CHECK(image->saturation == Approx(exposure * before->saturation));
    for (std::size_t i = 0; i < image->colour.size(); ++i)
      REQUIRE(image->colour[i] == Approx(exposure * before->colour[i]).epsilon(1e-5));
  }
}

TEST_CASE("depths and colours of floats beyond all that light is computed with are holes and not known") {
  CaptureFiles files;
  files.create("c/x");
  LayeredImage image;
  image.layers[""] = ImageBuffer(4, 3, 3, 2.0f);
  image.layers["Z"] = ImageBuffer(4, 3, 1, 1.0f);
  image.layers["Z"].at(1, 0, 0) = 3e38f;
  image.layers["Z"].at(2, 0, 0) = -1.0f;
  image.layers["Z"].at(3, 0, 0) = std::numeric_limits<float>::quiet_NaN();
  image.layers[""].at(0, 1, 0) = 3e38f;
  image.layers[""].at(1, 1, 0) = std::numeric_limits<float>::infinity();
  writeExr(files.directory.path() / "c/room_0000.exr", image);
  files.text("c/groundtruth.txt", "0.0 0 0 0 0 0 0 1\n");
  const Scene scene = files.load(std::string("files \"c/room_####.exr\" exposure 1e6 ") + kPinhole);
  const auto read = only(scene).image(0);
  CHECK(read->depth[0] == 1.0f);
  for (const std::size_t hole : {1u, 2u, 3u}) CHECK(read->depth[hole] == 0.0f);
  CHECK(read->colour[0] == Approx(2e6));
  CHECK(std::isnan(read->colour[3 * 4]));
  CHECK(std::isnan(read->colour[3 * 5]));
}
