// Captures: the readers of their formats, poses, rays, and what is refused.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <random>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "lumivox/scene/scene.h"
#include "support/capture_files.h"
#include "support/facts.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("rays of a distorted camera arrive at the pixels that they were taken for") {
  CaptureCamera camera;
  camera.width = 640, camera.height = 480;
  camera.focal = {517.306408, 516.469215};
  camera.centre = {318.643040, 255.313989};
  // Published with the TUM RGB-D benchmark for its sequences Freiburg 1.
  camera.distortion = {0.262383, -0.953104, -0.005358, 0.002628, 1.163314};
  double largest = 0.0, bent = 0.0;
  for (int y = 0; y < camera.height; y += 13)
    for (int x = 0; x < camera.width; x += 13) {
      const glm::dvec2 pixel(x, y), ray = camera.ray(pixel);
      largest = std::max(largest, glm::length(camera.project(ray) - pixel));
      bent = std::max(bent, glm::length((pixel - camera.centre) / camera.focal - ray) * camera.focal.x);
    }
  CHECK(largest < 1e-6);
  CHECK(bent > 5.0);  // pixels: the distortion is there
  // Tangential terms by hand: of ray (x, y) = (0.2, -0.1) with p1 = 0.01, p2 = 0.02 alone.
  camera.distortion = {0, 0, 0.01, 0.02, 0};
  const double x = 0.2, y = -0.1, r2 = x * x + y * y;
  const glm::dvec2 expected(x + 2 * 0.01 * x * y + 0.02 * (r2 + 2 * x * x),
                            y + 0.01 * (r2 + 2 * y * y) + 2 * 0.02 * x * y);
  CHECK(glm::length(camera.project({x, y}) - (camera.focal * expected + camera.centre)) < 1e-9);
  // Beyond the turning point of the polynomial there is no ray.
  camera.distortion = {-1.0, 0, 0, 0, 0};
  CHECK(std::isnan(camera.ray({2000.0, 255.0}).x));
}

TEST_CASE("a capture in the TUM layout gives depth in metres, linear radiance, poses and times") {
  const std::string pairs = GENERATE(
      std::string(kPairs),
      std::string("1.0 depth/1.0.png 1.0 rgb/1.0.png\r\n# a comment\r\n1.1 depth/1.1.png 1.1 rgb/1.1.png"));
  const CaptureFiles files = tum(pairs, kTwoPoses);
  const Scene scene = files.load(std::string("folder \"c\" exposure 2 ") + kPinhole);
  const Capture& capture = only(scene);
  REQUIRE(capture.frames.size() == 2);
  CHECK(capture.frames[0].time == 0.0);
  CHECK(capture.frames[1].time == Approx(0.1));
  CHECK(capture.frames[1].eye == glm::dvec3(2, 2, 3));
  CHECK((capture.camera.width == 4 && capture.camera.height == 3));
  const auto image = capture.image(0);
  CHECK(image->depth[5] == Approx(5500.0 / 5000.0));
  for (const std::size_t i : {0u, 4u, 35u})
    CHECK(image->colour[i] == Approx(2.0f * srgbToLinear(static_cast<float>(i * 7 % 256) / 255.0f)));
  CHECK(image->saturation == Approx(2.0f));
  CHECK(capture.frameAt(-1.0) == 0);
  CHECK(capture.frameAt(0.0999) == 0);
  CHECK(capture.frameAt(0.1) == 1);
  CHECK(capture.frameAt(100.0) == 1);
}

TEST_CASE("without associations, depth images take the colour image nearest in time, within 20 ms") {
  CaptureFiles files;
  for (int i = 0; i < 3; ++i) {
    files.image(fmt::format("c/rgb/{}.png", i), colourImage());
    files.image(fmt::format("c/depth/{}.png", i), depthImage(static_cast<std::uint16_t>(5000 * (i + 1))));
  }
  files.text("c/rgb.txt", "# time file\n1.015 rgb/0.png\n1.100 rgb/1.png\n1.300 rgb/2.png\n");
  files.text("c/depth.txt", "1.000 depth/0.png\n1.012 depth/1.png\n1.321 depth/2.png\n");
  files.text("c/groundtruth.txt", "1.0 0 0 0 0 0 0 1\n1.012 0 0 0 0 0 0 1\n1.321 0 0 0 0 0 0 1\n");
  const Scene scene = files.load();
  // 1.015 belongs to 1.012, the nearer of two; 1.321 is 21 ms from 1.300.
  REQUIRE(only(scene).frames.size() == 1);
  CHECK(only(scene).image(0)->depth[0] == Approx(2.0));
}

TEST_CASE("poses between two are their slerp, and frames without a pose within 50 ms are left out") {
  const CaptureFiles files = tum("1.02 rgb/1.0.png 1.02 depth/1.0.png\n1.2 rgb/1.1.png 1.2 depth/1.1.png\n",
                                 "1.0 0 0 0 0 0 0 1\n1.04 4 0 0 0 0 0.7071067811865476 0.7071067811865476\n"
                                 "1.19 9 9 9 nan 0 0 1\n");
  const Scene scene = files.load();
  const Capture& capture = only(scene);
  REQUIRE(capture.frames.size() == 1);
  CHECK(glm::length(capture.frames[0].eye - glm::dvec3(2, 0, 0)) < 1e-12);
  // Half of a turn by 90 degrees about z.
  const glm::dquat half = glm::angleAxis(0.25 * M_PI, glm::dvec3(0, 0, 1));
  CHECK(std::abs(glm::dot(capture.frames[0].rotation, half)) > 1.0 - 1e-12);
}

TEST_CASE("frames are in the order of their times, each time once") {
  const CaptureFiles files =
      tum("1.1 rgb/1.1.png 1.1 depth/1.1.png\n1.0 rgb/1.0.png 1.0 depth/1.0.png\n"
          "1.1 rgb/1.0.png 1.1 depth/1.0.png\n",
          kTwoPoses);
  const Scene scene = files.load();
  REQUIRE(only(scene).frames.size() == 2);
  CHECK(only(scene).frames[0].eye == glm::dvec3(1, 2, 3));
}

TEST_CASE("matrices and quaternions of one capture give the same bits") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  std::string poses;
  CaptureFiles matrices, quaternions;
  std::string pairs;
  for (int i = 0; i < 20; ++i) {
    const glm::dquat q =
        glm::normalize(glm::dquat(number(random), number(random), number(random), number(random)));
    const glm::dvec3 eye(number(random), number(random), number(random));
    matrices.image(fmt::format("c/frame-{:06}.color.png", i), colourImage());
    matrices.image(fmt::format("c/frame-{:06}.depth.png", i), depthImage());
    matrices.text(fmt::format("c/frame-{:06}.pose.txt", i), matrixText(q, eye));
    quaternions.image(fmt::format("c/rgb/{}.png", i), colourImage());
    quaternions.image(fmt::format("c/depth/{}.png", i), depthImage());
    pairs += fmt::format("{} rgb/{}.png {} depth/{}.png\n", i, i, i, i);
    // Of another length and sign, which mean the same rotation.
    poses += fmt::format("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", i, eye.x, eye.y,
                         eye.z, -0.6 * q.x, -0.6 * q.y, -0.6 * q.z, -0.6 * q.w);
  }
  quaternions.text("c/associations.txt", pairs);
  quaternions.text("c/groundtruth.txt", poses);
  quaternions.text("c/groundtruth.txt", poses);
  const std::string block =
      std::string("folder \"c\" rate 1 translate 1 2 3 rotate 1 0 0 -90 deg ") + kPinhole;
  const Scene a = matrices.load(block), b = quaternions.load(block);
  REQUIRE(only(a).frames.size() == 20);
  REQUIRE(only(b).frames.size() == 20);
  for (std::size_t i = 0; i < 20; ++i) {
    const CaptureState x = captureStateOf(only(a), i, glm::dvec3(0)),
                       y = captureStateOf(only(b), i, glm::dvec3(0));
    CHECK(x == y);
    CHECK(only(a).frames[i].time == only(b).frames[i].time);
  }
}

TEST_CASE("a Redwood trajectory numbers its frames from 1, and the camera has its published pinhole") {
  CaptureFiles files;
  for (int i = 0; i < 3; ++i) {
    files.image(fmt::format("c/color/{:05}.png", i), colourImage());
    files.image(fmt::format("c/depth/{:05}.png", i), depthImage(1000));
  }
  const std::string identity = matrixText(glm::dquat(1, 0, 0, 0), {0, 0, 1}),
                    moved = matrixText(glm::dquat(1, 0, 0, 0), {5, 0, 1});
  files.text("c/trajectory.log", "0 0 1\n" + identity + "2 2 3\n" + moved);
  const Scene scene = files.load("folder \"c\"");
  const Capture& capture = only(scene);
  REQUIRE(capture.frames.size() == 2);  // the second frame has no pose
  CHECK(capture.frames[1].eye == glm::dvec3(5, 0, 1));
  CHECK(capture.frames[1].time == Approx(2.0 / 30.0));
  CHECK(capture.camera.focal == glm::dvec2(525));
  CHECK(capture.camera.centre == glm::dvec2(319.5, 239.5));
  CHECK(capture.image(0)->depth[0] == Approx(1.0));
}

TEST_CASE("EXR images hold linear colour and Z in metres") {
  CaptureFiles files;
  files.create("c/x");
  for (int i = 3; i < 5; ++i) {
    LayeredImage image;
    image.layers[""] = ImageBuffer(4, 3, 3, 2.5f);
    image.layers["Z"] = ImageBuffer(4, 3, 1, static_cast<float>(i));
    image.layers["Z"].at(1, 1, 0) = std::numeric_limits<float>::infinity();
    writeExr(files.directory.path() / fmt::format("c/room_{:04}.exr", i), image);
  }
  files.text("c/groundtruth.txt", "0.0 0 0 0 0 0 0 1\n0.5 1 0 0 0 0 0 1\n");
  const Scene scene = files.load(std::string("files \"c/room_####.exr\" exposure 4 ") + kPinhole);
  const Capture& capture = only(scene);
  REQUIRE(capture.frames.size() == 2);
  CHECK(capture.frames[1].time == Approx(0.5));
  CHECK(capture.image(1)->depth[0] == 4.0f);
  CHECK(capture.image(1)->depth[5] == 0.0f);  // what is not finite is a hole
  CHECK(capture.image(0)->colour[0] == 10.0f);
  CHECK(std::isinf(capture.image(0)->saturation));
}

// ---- .sens
// -------------------------------------------------------------------------------------------------

TEST_CASE(
    "a .sens file gives each depth the colour where its point projects, and none where a nearer one does") {
  Sens made = sens();
  made.poses[1] = glm::dmat4(std::numeric_limits<double>::quiet_NaN());
  const CaptureFiles files = withSens(made.bytes());
  const Scene scene = files.load(kSens);
  const Capture& capture = only(scene);
  REQUIRE(capture.frames.size() == 1);  // the second was not tracked
  CHECK(capture.camera.focal == glm::dvec2(4));
  const auto image = capture.image(0);
  CHECK(image->depth[5] == Approx(1.5));
  // Depth pixel (0, 0) has the ray (-1.5, -1) / 4, which the colour camera sees at (3.5 - 3, 2.5 - 2).
  const int column = 1, row = 1;
  CHECK(image->colour[0] ==
        Approx(srgbToLinear(static_cast<float>((row * 8 + column) * 3 * 7 % 256) / 255.0f)));
  // The colour camera far to the side: near points come before far ones, and most fall outside.
  made.colourPose[3] = {0.3, 0.0, 0.0, 1.0};
  made.depth.values = {1000, 1000, 1000, 1000, 1000, 1500, 3000, 1000, 1000, 1000, 1000, 1000};
  const CaptureFiles others = withSens(made.bytes());
  const Scene shifted = others.load(kSens);
  const auto seen = only(shifted).image(0);
  std::size_t unknown = 0;
  for (std::size_t i = 0; i < 12; ++i) unknown += std::isnan(seen->colour[3 * i]);
  CHECK((unknown > 0 && unknown < 12));
}

TEST_CASE("a .sens file of another kind, or with more frames than it can hold, is refused") {
  Sens made = sens();
  const auto refused = [&] { return withSens(made.bytes()).refusal(kSens); };
  made.claimed = std::uint64_t{1} << 60;
  CHECK_THAT(refused(), Tells("room.sens", "1152921504606846976"));
  made.claimed = 2;
  made.version = 3;
  CHECK_THAT(refused(), Tells("version 3", "4"));
  made.version = 4;
  made.depthKind = 2;
  CHECK_THAT(refused(), Tells("OCCI", "zlib"));
  made.depthKind = 1;
  made.colourKind = -1;
  CHECK_THAT(refused(), Tells("kind -1", "JPEG"));
  made.colourKind = 1;
  CHECK_THAT(withSens(made.bytes().substr(0, 100)).refusal(kSens), Tells("room.sens", "100"));
  CHECK_THAT(withSens(std::string()).refusal(kSens), Tells("room.sens"));
}

TEST_CASE("the last frame of a .sens file that was cut off is left out") {
  const std::string whole = sens().bytes();
  const Scene scene = withSens(whole.substr(0, whole.size() - 5)).load(kSens);
  CHECK(only(scene).frames.size() == 1);
}

// ---- what is refused
// ---------------------------------------------------------------------------------------

TEST_CASE("depth images of 8 bits, of other sizes or absent are refused with their file") {
  CaptureFiles files = tum(kPairs, kTwoPoses);
  files.image("c/depth/1.1.png", WordImage{8, 6, std::vector<std::uint16_t>(48, 1000)});
  const Scene scene = files.load();
  CHECK_THAT(test::messageOf<Error>([&] { only(scene).image(1); }),
             Tells("'c'", "frame 1", "8 x 6", "4 x 3"));
  files.image("c/depth/1.0.png", colourImage());
  CHECK_THAT(files.refusal(), Tells("1.0.png", "8 bits", "16 bits"));
  std::filesystem::remove(files.directory.path() / "c/depth/1.0.png");
  CHECK_THAT(files.refusal(), Tells("1.0.png"));
}

TEST_CASE("colour of another size is read where the depth's pixels are, and of another shape refused") {
  CaptureFiles files = tum(kPairs, kTwoPoses);
  ByteImage grey{8, 6, 3, std::vector<unsigned char>(8 * 6 * 3, 100)};
  files.image("c/rgb/1.0.png", grey);
  CHECK(only(files.load()).image(0)->colour[7] == Approx(srgbToLinear(100.0f / 255.0f)));
  files.image("c/rgb/1.0.png", colourImage(5, 6));
  CHECK_THAT(files.refusal(), Tells("1.0.png", "5 x 6", "4 x 3"));
}

TEST_CASE("a folder that is no capture, or one without poses, says what was expected") {
  CaptureFiles files;
  files.text("c/note.txt", "nothing");
  CHECK_THAT(files.refusal(), Tells("/c", "groundtruth.txt", ".log"));
  files.text("c/scene_00_0000.depth", "1 2 3");
  CHECK_THAT(files.refusal(), Tells("ICL-NUIM", "TUM"));
  CHECK_THAT(tum(kPairs, "9.0 0 0 0 0 0 0 1\n").refusal(), Tells("none of 2 frames", "50 ms"));
  CHECK_THAT(tum(kPairs, "1.0 0 0 0 0 0 1\n").refusal(), Tells("groundtruth.txt:1", "qw"));
  CHECK_THAT(tum(kPairs, "1.0 0 x 0 0 0 0 1\n").refusal(), Tells("groundtruth.txt:1", "'x'"));
  CHECK_THAT(tum("1.0 a.png 1.0 b.png\n", kTwoPoses).refusal(), Tells("associations.txt:1", "depth"));
  CHECK_THAT(tum(kPairs, kTwoPoses).refusal("folder \"c\""), Tells("focal", "capture c"));
  CHECK_THAT(tum(kPairs, kTwoPoses).refusal(std::string("folder \"c\" range 7..9 ") + kPinhole),
             Tells("7", "9", "0 to 1"));
}

TEST_CASE("the text of a capture is checked") {
  const CaptureFiles files = tum(kPairs, kTwoPoses);
  CHECK_THAT(files.refusal(kPinhole), Tells("names no files"));
  CHECK_THAT(files.refusal(std::string("folder \"c\" file \"a.sens\" ") + kPinhole), Tells("twice"));
  CHECK_THAT(files.refusal("folder \"c\" focal 4 4"), Tells("'focal' alone", "centre"));
  CHECK_THAT(files.refusal("folder \"c\" focal -4 4 centre 1 1"), Tells("focal length"));
  CHECK_THAT(files.refusal(std::string("folder \"c\" distortion 1 2 3 ") + kPinhole), Tells("five numbers"));
  CHECK_THAT(files.refusal(std::string("folder \"c\" format sens ") + kPinhole), Tells("'sens'", "folder"));
  CHECK_THAT(files.refusal(std::string("folder \"d\" ") + kPinhole), Tells("'d'", "does not exist"));
  CHECK_THAT(files.refusal(std::string("files \"c/a.exr\" ") + kPinhole), Tells("####"));
  CHECK_THAT(
      test::messageOf<Error>([&] { files.load(std::string("folder \"c\" ") + kPinhole, "capture d"); }),
      Tells("unknown capture 'd'", "c"));
  CHECK_THAT(test::messageOf<Error>(
                 [&] { files.load(std::string("folder \"c\" ") + kPinhole, "capture c eye 0 0 0"); }),
             Tells("'eye'", "capture"));
}

// ---- in a scene
// --------------------------------------------------------------------------------------------

TEST_CASE("a camera stands where the capture's camera stood, and sees as high as its rows") {
  const CaptureFiles files = tum(kPairs, kTwoPoses);
  const Scene scene = files.load(std::string("folder \"c\" translate 10 0 0 ") + kPinhole);
  const SceneTraits traits = SceneTraits::of(scene);
  CHECK((traits.captures && traits.movingCaptures && traits.movingCamera));
  const SceneSnapshot first = snapshotOf(scene, 0.0), second = snapshotOf(scene, 0.1);
  CHECK((first.camera.width == 4 && first.camera.height == 3));
  CHECK(first.camera.tanHalfFov == Approx(0.5 * 3 / 4));
  CHECK(glm::length(glm::dvec3(first.camera.eye) + first.origin - glm::dvec3(11, 2, 3)) < 1e-6);
  CHECK(first.camera.right == glm::vec3(1, 0, 0));
  CHECK(first.camera.up == glm::vec3(0, -1, 0));
  CHECK(first.camera.forward == glm::vec3(0, 0, 1));
  // Turned by 90 degrees about z: right is y, down is -x.
  CHECK(glm::length(second.camera.right - glm::vec3(0, 1, 0)) < 1e-6f);
  CHECK(glm::length(second.camera.up - glm::vec3(1, 0, 0)) < 1e-6f);
  CHECK(second.captures.at(0).frame == 1);
}

TEST_CASE("a negative focal length along y mirrors the capture's left-handed world") {
  const CaptureFiles files =
      tum(kPairs, "1.0 1 2 3 0.7071067811865476 0 0 0.7071067811865476\n1.1 1 2 3 0 0 0 1\n");
  const Scene plain = files.load(), mirrored = files.load("folder \"c\" focal 4 -4 centre 1.5 1");
  CHECK(only(mirrored).camera.focal == glm::dvec2(4));
  // A point of the left-handed camera and world, y up in both, mirrored: that is where ours finds it.
  const glm::dvec3 seen(0.3, 0.2, 2.0);
  const CaptureFrame &theirs = only(plain).frames[0], &ours = only(mirrored).frames[0];
  const glm::dvec3 mirror(1, -1, 1), expected = mirror * (theirs.rotation * seen + theirs.eye),
                                     found = ours.rotation * (mirror * seen) + ours.eye;
  CHECK(glm::length(found - expected) < 1e-12);
}

TEST_CASE("the hash of a scene changes with a pixel of a frame in the range, and with the pose") {
  CaptureFiles files = tum(kPairs, kTwoPoses);
  const std::string both = std::string("folder \"c\" ") + kPinhole, first = both + " range 0..0";
  const ContentHash before = files.load(both).hash, beforeFirst = files.load(first).hash;
  CHECK(before != beforeFirst);
  files.image("c/depth/1.1.png", depthImage(5001));
  CHECK(files.load(both).hash != before);
  CHECK(files.load(first).hash == beforeFirst);
  files.text("c/groundtruth.txt", "1.0 1 2 3.5 0 0 0 1\n1.1 2 2 3 0 0 0 1\n");
  CHECK(files.load(first).hash != beforeFirst);
}

TEST_CASE("a capture stands for a scene, which may hold no captures") {
  CaptureFiles files = tum(kPairs, kTwoPoses);
  files.text("real.scene",
             "scene \"real\" { camera m { eye 0 0 1 target 0 0 0 } environment { radiance 3 } }");
  const std::string block = std::string("folder \"c\" stands_for \"real.scene\" ") + kPinhole;
  const Scene scene = files.load(block);
  REQUIRE(only(scene).realScene != nullptr);
  CHECK(only(scene).realScene->environment == glm::vec3(3.0f));
  files.text("real.scene",
             std::string("scene \"real\" { camera m { eye 0 0 1 target 0 0 0 } capture c { folder \"c\" ") +
                 kPinhole + " } }");
  CHECK_THAT(files.refusal(block), Tells("capture within"));
  CHECK_THAT(files.refusal(std::string("folder \"c\" stands_for \"none.scene\" ") + kPinhole),
             Tells("none.scene"));
}

TEST_CASE("frames far from the world's origin keep the precision of their poses") {
  const CaptureFiles files = tum(kPairs, "1.0 1000000.001 0 0 0 0 0 1\n1.1 1000000.002 0 0 0 0 0 1\n");
  const Scene scene = files.load();
  const SceneSnapshot first = snapshotOf(scene, 0.0), second = snapshotOf(scene, 0.1);
  CHECK(second.camera.eye.x - first.camera.eye.x == Approx(0.001).epsilon(1e-3));
}
